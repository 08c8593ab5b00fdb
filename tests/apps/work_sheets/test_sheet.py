"""kerfwise sheet: what is printed, what is refused, and the same bytes each time."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
import zxingcpp

import kerfwise as package
from kerfwise.apps.work_sheets.work_sheet import work_sheet
from kerfwise.jobs.nest_job.request import NestRequest, inputs_for
from kerfwise.models.plan.plan import Dropped, RuleReport
from kerfwise.rule_kit import rect
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.nest_file import nest_file
from kerfwise.tests.paper import pages_of

PARTS = [{"id": f"P{k}", "outer": rect(20 + 120 * k, 20, 100, 100)} for k in range(3)]


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the nest, its program and its plan."""
    folder = tmp_path_factory.mktemp("solved")
    with pytest.MonkeyPatch.context() as patched:
        patched.chdir(folder)
        nest_file("sheet.json", PARTS)
        assert kerfwise("solve", "sheet.json", "--work", 1, "-o", "a.nc", "--plan", "a.plan.json").code == 0
    return folder


@pytest.fixture
def plan(solved: Path) -> Path:
    for name in ("sheet.json", "a.nc", "a.plan.json"):
        shutil.copy(solved / name, name)
    return Path("a.plan.json")


def test_a_reason_is_one_line_with_all_that_it_is_about(plan: Path) -> None:
    sheet = work_sheet(inputs_for("sheet.json", NestRequest()), package.read_plan(plan))
    pairs = [("P0.outer", "P1.outer"), ("P0.outer", "P2.outer")]
    relaxed = tuple(Dropped("level-ahead", pair, "relaxed: the sum") for pair in pairs)
    excused = RuleReport("part-rigidity", "hard", True, tuple(((f"P{k}.outer",), "thin") for k in range(3)))
    changed = replace(sheet.plan, rules=(excused,), dropped=relaxed)
    lines = replace(sheet, plan=changed).not_kept
    assert [line.split(" – ")[0] for line in lines] == [
        "P0.outer; P1.outer; P2.outer: thin",
        "P0.outer before P1.outer; P0.outer before P2.outer: not kept: relaxed: the sum",
    ]


def test_what_stands_on_it(plan: Path) -> None:
    Path("shop.yaml").write_text(
        "based_on: plasma-carbon-steel\nmaterial: {amps: 65 A, gas: air}\nprices: {machine_hour: 80}\n"
        "locks: [{contour: P1.outer, position: first}]\n"
    )
    assert (
        kerfwise("solve", "sheet.json", "--work", 1, "-p", "shop.yaml", "-o", "b.nc", "--plan", "b.plan.json").code == 0
    )
    words = ["--program", "b.nc", "--date", "2026-11-22", "--about", "order=47/11", "-o", "b.pdf"]
    ended = kerfwise("sheet", "sheet.json", "b.plan.json", "-p", "shop.yaml", *words)
    assert (ended.code, ended.out) == (0, "written: b.pdf\n"), ended.err
    (page,) = pages_of("b.pdf")
    text = page.text
    assert "Z1" not in text, "one zone says nothing, and stands in the way"
    sha256 = hashlib.sha256(Path("b.nc").read_bytes()).hexdigest()
    assert sha256 in text.replace("\n", "")
    for said in (
        "sheet.json",
        "program b.nc",
        "2026-11-22",
        "47/11",
        "S235, 6 mm, 400 × 140 mm, 3 parts",
        "65 A",
        "air",
        "cut 2500",
        "EUR",
        "P1.outer first",
        "3 cuts, in order",
        "page 1 of 1",
    ):
        assert said in text, said
    assert "Not as it was" not in text
    order = [cut["contour"] for cut in json.loads(Path("b.plan.json").read_text())["cuts"]]
    assert re.findall(r"\S+\.outer", text[text.index("in order") :]) == order
    _, bottom, right, _ = page.box("contour")
    assert bottom > 0
    assert right < page.size[0]


@pytest.mark.slow
def test_settings_of_another_profile_are_not_taken_for_those_of_the_plan(plan: Path) -> None:
    Path("shop.yaml").write_text("based_on: plasma-carbon-steel\nmaterial: {amps: 65 A, gas: air}\n")
    ended = kerfwise("sheet", "sheet.json", plan, "-p", "shop.yaml", "--program", "a.nc", "-o", "b.pdf")
    said = "the profile is not the one the plan was made with"
    assert (ended.code, said in ended.err) == (0, True), ended.err
    text = pages_of("b.pdf")[0].text
    assert "65 A" in text
    assert "Not as it was when the plan was made" in text
    assert said in text


@pytest.mark.slow
def test_without_the_program_it_is_the_one_that_solve_writes(plan: Path) -> None:
    assert kerfwise("sheet", "sheet.json", plan, "-o", "one.pdf", "--program", "a.nc").code == 0
    Path("sheet.nc").write_bytes(Path("a.nc").read_bytes())
    assert kerfwise("sheet", "sheet.json", plan, "-o", "two.pdf", "--program", "sheet.nc").code == 0
    assert kerfwise("sheet", "sheet.json", plan).code == 0
    assert Path("sheet.pdf").read_bytes() == Path("two.pdf").read_bytes()
    assert Path("one.pdf").read_bytes() != Path("two.pdf").read_bytes(), "the program's name is printed"


@pytest.mark.slow
def test_the_job_file_of_the_nest_is_on_it(plan: Path) -> None:
    Path("sheet.job.yaml").write_text("order: A-77\ndue: 2026-12-24\nquantity: 4\nlocks: [P1.outer first]\n")
    assert kerfwise("solve", "sheet.json", "--work", 1, "-o", "j.nc", "--plan", "j.plan.json").code == 0
    assert kerfwise("sheet", "sheet.json", "j.plan.json", "--about", "due=Monday", "-o", "j.pdf").code == 0
    text = pages_of("j.pdf")[0].text
    assert all(said in text for said in ("A-77", "Monday", "4 of the same", "P1.outer first"))
    assert "2026-12-24" not in text
    assert kerfwise("sheet", "sheet.json", plan, "--no-job", "-o", "n.pdf").code == 0
    assert "A-77" not in pages_of("n.pdf")[0].text


def test_the_code_is_read_from_the_paper(plan: Path) -> None:
    assert kerfwise("sheet", "sheet.json", plan, "--program", "a.nc").code == 0
    (found,) = zxingcpp.read_barcodes(pages_of("sheet.pdf")[0].picture(dpi=150))
    assert found.text == f"SHA256 {hashlib.sha256(Path('a.nc').read_bytes()).hexdigest().upper()}"


@pytest.mark.slow
def test_the_same_bytes_in_another_process(plan: Path) -> None:
    assert kerfwise("sheet", "sheet.json", plan, "-o", "here.pdf").code == 0
    env = {**os.environ, "PYTHONHASHSEED": "1", "PYTHONPATH": str(Path(package.__file__).parents[1])}
    env["PYTHONPATH"] = os.pathsep.join([env["PYTHONPATH"], os.environ.get("PYTHONPATH", "")])
    command = [sys.executable, "-m", "kerfwise", "sheet", "sheet.json", str(plan), "-o", "there.pdf"]
    subprocess.run(command, check=True, env=env)
    assert Path("here.pdf").read_bytes() == Path("there.pdf").read_bytes()


def test_a_plan_that_the_check_refuses_has_no_sheet(plan: Path) -> None:
    data = json.loads(plan.read_text())
    data["cuts"] = [*data["cuts"][:-1]]
    Path("short.plan.json").write_text(json.dumps(data))
    ended = kerfwise("sheet", "sheet.json", "short.plan.json")
    assert ended.code == 1
    assert "the check refuses the plan: " in ended.err
    assert not Path("sheet.pdf").exists()


def test_a_program_that_does_not_follow_the_plan_is_refused(plan: Path) -> None:
    first = json.loads(plan.read_text())["cuts"][0]["contour"]
    Path("last.yaml").write_text(f"based_on: plasma-carbon-steel\nlocks: [{{contour: {first}, position: last}}]\n")
    assert kerfwise("solve", "sheet.json", "--work", 1, "-p", "last.yaml", "-o", "b.nc").code == 0
    ended = kerfwise("sheet", "sheet.json", plan, "--program", "b.nc")
    assert ended.code == 1
    assert "does not follow the plan" in ended.err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["a.plan.json", "-o", "x.png"], "give a name ending in .pdf"),
        (["a.plan.json", "-o", "a.plan.json.pdf", "--about", "order"], "expected a name and a text"),
        (["a.plan.json", "-o", "gone/x.pdf"], "there is no folder"),
        (["gone.plan.json"], "gone.plan.json: cannot read the plan"),
        (["a.plan.json", "--program", "gone.nc"], "gone.nc: cannot read the program"),
    ],
)
def test_what_cannot_be(plan: Path, words: list[str], said: str) -> None:
    ended = kerfwise("sheet", "sheet.json", *words)
    assert (ended.code, said in ended.err) == (2, True), ended.err
    assert not list(Path().glob("*.pdf"))


def test_a_plan_of_another_nest_is_one_message(plan: Path) -> None:
    nest_file("other.json", PARTS[:1])
    ended = kerfwise("sheet", "other.json", plan)
    assert ended.code == 2
    assert ended.err.splitlines()[-1].startswith("kerfwise: other.json: the plan was made from another nest")


@pytest.mark.slow
def test_plot_and_compare_print_too(plan: Path) -> None:
    assert kerfwise("plot", "sheet.json", plan, "-o", "plan.pdf").code == 0
    assert "P2" not in pages_of("plan.pdf")[0].text
    assert kerfwise("plot", "sheet.json", "-o", "nest.pdf").code == 0
    assert kerfwise("compare", "sheet.json", plan, "a.nc", "-o", "both.pdf").code == 0
    text = pages_of("both.pdf")[0].text
    assert "both make the same cuts in the same order" in text
    assert "idle travel" in text


@pytest.fixture
def listed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """What `make --sheets` writes of a list of two kinds of parts for two orders."""
    monkeypatch.chdir(tmp_path)
    for name, side in (("bracket-of-the-left-hand-door", 80), ("plate", 50)):
        nest_file(f"{name}.json", [{"id": name, "outer": rect(10, 10, side, side)}], (200, 200))
    Path("list.csv").write_text(
        "file;qty;order;due\nbracket-of-the-left-hand-door;3;A7;2026-12-24\nplate;2;B8;2026-12-20\n"
    )
    words = ("--sheet", "200x200", "--rounds", 1, "--work", 0.2, "--sheets", "-o", "out")
    ended = kerfwise("make", "list.csv", *words)
    assert ended.code == 0, ended.err
    return Path("out")


def test_parts_are_counted_with_order_size_and_weight(listed: Path) -> None:
    pages = pages_of(str(listed / "sheets.pdf"))
    text = "".join(page.text for page in pages)
    assert "sheet 1 of 2" in text
    assert "sheet 2 of 2" in text
    weight = 80 * 80 * 6 * 7850e-9
    assert f"80 × 80\n{weight:.3g}" in text or f"{weight:.3g}" in text
    for said in ("A7", "B8", "2026-12-20", "kg each", "lower left corner of the sheet", "left over"):
        assert said in text, said
    for copy in (1, 2, 3):
        assert f"bracket-of-the-left-hand-door-{copy}.outer" in text, "no name is cut where there is room"
    for word in ("soft rule", "part-rigidity", "excused"):
        assert word not in text


def test_labels_have_a_code_that_names_part_and_order(listed: Path) -> None:
    (page,) = pages_of(str(listed / "labels.pdf"))
    codes = sorted(found.text for found in zxingcpp.read_barcodes(page.picture(dpi=200)))
    assert len(codes) == 5
    assert codes[0] == "bracket-of-the-left-hand-door-1;A7;2026-12-24;S235;6;sheet1.json"
    assert "order A7" in page.text
    words = (listed / "sheet2.json", listed / "sheet2.plan.json", "-o", "one.pdf", "--labels", "labels.pdf")
    ended = kerfwise("sheet", *words)
    assert ended.code == 0, ended.err
    assert "sheet 2 of 2" in pages_of("one.pdf")[0].text
    assert kerfwise("sheet", *words[:-1], "labels.txt").code == 2


def test_the_program_of_a_list_names_sheet_orders_and_parts(listed: Path) -> None:
    head = (listed / "sheet1.nc").read_text().splitlines()[:12]
    for said in ("(SHEET 200 X 200 MM, PARTS ", "(ORDER A7)", "(DUE 2026-12-2", "OF bracket-of-the-left-hand-door)"):
        assert any(said in line for line in head), (said, head)
    assert kerfwise("check", listed / "sheet1.json", listed / "sheet1.nc").code == 0


@pytest.mark.parametrize(("language", "heading", "cuts", "weight"), [
    ("de", "Vorher und nachher", "3 Schnitte, in Reihenfolge", "kg"),
    ("es", "Antes y después", "3 cortes, en orden", "kg"),
    ("ru", "До и после", "3 реза по порядку", "кг"),
])  # fmt: skip
def test_it_speaks_other_languages(plan: Path, language: str, heading: str, cuts: str, weight: str) -> None:
    """Work sheet and labels; what is said of single places stays English."""
    words = ["--language", language, "-o", "b.pdf", "--labels", "l.pdf"]
    ended = kerfwise("sheet", "sheet.json", plan, *words)
    assert (ended.code, ended.out) == (0, "written: b.pdf, l.pdf\n"), ended.err
    (page,), (labels,) = pages_of("b.pdf"), pages_of("l.pdf")
    assert heading in page.text
    assert cuts in page.text
    assert "Before and after" not in page.text
    assert weight in labels.text


def test_a_language_that_is_none_is_refused(plan: Path) -> None:
    ended = kerfwise("sheet", "sheet.json", plan, "--language", "fr")
    assert ended.code == 2
    assert "'fr' is not one of" in ended.err
