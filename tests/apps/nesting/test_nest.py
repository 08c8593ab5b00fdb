"""kerfwise nest: files of parts to files of nests, and what is wrong said in one message."""

from __future__ import annotations

import json
import re
import signal
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise import read_nest
from kerfwise.apps.nesting.placement.fill import Room
from kerfwise.apps.nesting.placement.layout import Layout, nest_dxf
from kerfwise.apps.nesting.placement.nofit import Placed
from kerfwise.apps.nesting.placement.shapes import Key
from kerfwise.apps.nesting.verbs import NestProgress
from kerfwise.arrays import Floats
from kerfwise.encoder.readers.json_nest import nest_json
from kerfwise.rule_kit import circle, nest, part, rect
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.commands.test_program_head import plate

BRACKET = part("bracket", [(10, 10), (90, 10), (90, 40), (40, 40), (40, 90), (10, 90)], [circle(25, 25, 6)])


@pytest.fixture
def parts(tmp_path: Path) -> Path:
    """A folder with a bracket as DXF and as JSON, and a plate."""
    (tmp_path / "bracket.dxf").write_text(nest_dxf(nest(200, 200, BRACKET)))
    (tmp_path / "bracket.json").write_text(nest_json(nest(200, 200, BRACKET)))
    (tmp_path / "plate.json").write_text(nest_json(nest(200, 200, part("plate", rect(10, 10, 60, 30)))))
    return tmp_path


def test_parts_become_nests_that_can_be_read(parts: Path) -> None:
    out = parts / "out"
    ended = kerfwise(
        "nest", f"{parts / 'bracket.dxf'}=5", f"{parts / 'plate.json'}=7", "--sheet", "400x200", "-o", out, "--dxf"
    )
    assert ended.code == 0, ended.err
    assert "12 of 12 parts on 1 sheet" in ended.out
    read = read_nest(out / "sheet1.json")
    assert sorted(p.id for p in read.parts)[:2] == ["bracket-1", "bracket-2"]
    assert {p.attributes["of"] for p in read.parts} == {"bracket", "plate"}
    drawn = read_nest(out / "sheet1.dxf")
    assert sorted(round(p.polygon.area) for p in drawn.parts) == sorted(round(p.polygon.area) for p in read.parts)
    table = json.loads((out / "nests.json").read_text())
    assert table["gap_mm"] == 7.5
    assert [row["missing"] for row in table["parts"]] == [0, 0]
    assert (out / "nests.csv").read_text().splitlines()[1].startswith("sheet1.json,400x200,400.0,200.0,12,")
    assert (out / "sheet1.svg").read_text().startswith("<svg")
    assert "sheet1.json" in (out / "sheet1.svg").read_text()


def test_a_list_says_the_same_and_more(parts: Path) -> None:
    (parts / "day.yaml").write_text(
        "parts:\n"
        "  - {part: bracket.dxf, quantity: 3, order: 4711, rotations: [0, 90], mirror: true}\n"
        "  - {part: plate.json, quantity: 2, priority: 2, grain: along}\n"
        "sheets:\n"
        "  - {size: 400x200, stock: 2, price: 50}\n"
    )
    assert kerfwise("nest", parts / "day.yaml", "-o", parts / "out").code == 0
    read = read_nest(parts / "out" / "sheet1.json")
    assert {p.attributes["turned"] for p in read.parts if p.attributes["of"] == "plate"} <= {0.0, 180.0}
    assert {p.attributes.get("order") for p in read.parts if p.attributes["of"] == "bracket"} == {"4711"}


def test_a_remnant_that_solve_saves_is_cut_from_first(parts: Path) -> None:
    (parts / "rest.json").write_text(
        '{"format": "kerfwise-nest/1", "units": "mm", "sheet": {"outline": '
        '[[0, 0], [150, 0], [150, 60], [80, 60], [80, 150], [0, 150]]}, "parts": []}\n'
    )
    out = parts / "out"
    ended = kerfwise(
        "nest", f"{parts / 'plate.json'}=9", "--remnant", parts / "rest.json", "--sheet", "200x200", "-o", out
    )
    assert ended.code == 0, ended.err
    assert [row["stock"] for row in json.loads((out / "nests.json").read_text())["sheets"]] == ["rest.json", "200x200"]


@pytest.mark.slow
def test_the_list_among_the_examples_is_laid_its_remnant_first_and_once(tmp_path: Path) -> None:
    day = Path(package.__file__).parent / "examples" / "parts" / "day.yaml"
    ended = kerfwise("nest", day, "--rounds", "1", "-o", tmp_path / "out")
    assert ended.code == 0, ended.err
    assert "137 of 137 parts on 3 sheets" in ended.out
    stock = [row["stock"] for row in json.loads((tmp_path / "out" / "nests.json").read_text())["sheets"]]
    assert stock == ["rest.json", "1500x1000", "1500x1000"]


def test_a_second_run_leaves_nothing_of_the_first(parts: Path) -> None:
    out = parts / "out"
    for quantity, names in ((11, ["sheet1.json", "sheet2.json", "sheet3.json"]), (2, ["sheet1.json"])):
        assert kerfwise("nest", f"{parts / 'plate.json'}={quantity}", "--sheet", "160x120", "-o", out).code == 0
        assert sorted(path.name for path in out.glob("sheet*.json")) == names


def test_parts_that_did_not_fit_are_named(parts: Path) -> None:
    ended = kerfwise("nest", f"{parts / 'plate.json'}=9", "--sheet", "160x120=1", "-o", parts / "out")
    assert ended.code == 1
    assert "did not fit: 4 of 9 plate" in ended.out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["plate.json=0", "--sheet", "400x200"], "the quantity behind = is '0': expected a whole number from 1"),
        (["plate.json=two", "--sheet", "400x200"], "expected a whole number from 1"),
        (["plate.json", "--sheet", "50x50"], "it is 60.0 × 30.0 mm: give a larger sheet"),
        (["plate.json", "--sheet", "400x200", "--edge", "0"], "the torch runs half a kerf, 0.75 mm, beside each part"),
        (["plate.json", "--sheet", "400x200", "--edge", "90 mm"], "plate: fits on no sheet"),
        (["plate.json", "--sheet", "400x200", "--edge", "150 mm"], "plate: fits on no sheet"),
        (["plate.json"], "there is nothing to lay parts on"),
        (["plate.json", "--sheet", "400"], "'400' is not a size"),
        (["plate.json", "--sheet", "400x200", "--gap", "wide"], "--gap 'wide': expected a length"),
        (["plate.json", "--remnant", "plate.json", "--sheet", "9x9"], "holds 1 parts: expected a sheet alone"),
        (["missing.dxf", "--sheet", "400x200"], "there is no such file"),
        (["open.dxf", "--sheet", "400x200"], "do not close to contours"),
        (["rest.yaml"], "rest.yaml:2:11: there is no such file: rest.json"),
        (["rest.yaml=2"], "rest.yaml: a list of parts has quantities of its own: leave =2 out"),
        (["wrong.yaml"], "wrong.yaml:2:14: parts[1].quantity: expected a whole number from 1 to 100000, got '0'"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_and_nothing_is_written(
    parts: Path, words: list[str], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(parts)
    polylines = (parts / "bracket.dxf").read_text().split("POLYLINE")
    (parts / "open.dxf").write_text(
        "POLYLINE".join([*polylines[:2], *(p.replace("\n1\n0", "\n0\n0", 1) for p in polylines[2:])])
    )
    (parts / "rest.yaml").write_text("parts: [{part: plate.json}]\nsheets: [ {file: rest.json}]\n")
    (parts / "wrong.yaml").write_text("parts:\n- {quantity: 0, part: plate.json}\nsheets: [{size: 400x200}]\n")
    ended = kerfwise("nest", *words, "-o", "out")
    assert ended.code == 2, ended.out
    assert said in ended.err
    assert not (parts / "out").exists()


def test_a_part_that_crosses_itself_is_mended_where_that_is_asked_for(parts: Path) -> None:
    crossed = part("crossed", [(20, 10), (110, 10), (110, 110), (10, 110), (10, 5), (40, 15)])
    (parts / "crossed.json").write_text(nest_json(nest(200, 200, crossed)))
    words = ("nest", parts / "crossed.json", "--sheet", "200x200", "--rounds", "1", "-o", parts / "out")
    refused, mended = kerfwise(*words), kerfwise(*words, "--repair")
    assert (refused.code, mended.code) == (3, 0), mended.err
    assert "crossed.json" in refused.err
    assert "crossed.json: crossed.outer" in mended.err


def test_files_of_others_are_left_alone(parts: Path) -> None:
    ended = kerfwise("nest", parts / "plate.json", "--sheet", "400x200", "-o", parts)
    assert ended.code == 2
    assert "holds files that kerfwise nest did not write" in ended.err


def test_the_cheapest_to_cut_is_taken_and_never_dearer_than_the_densest(parts: Path) -> None:
    words = (f"{parts / 'bracket.json'}=2", f"{parts / 'plate.json'}=2", "--sheet", "300x200")
    weighing = ("--for", "cutting", "--weigh", "2", "--weigh-work", "0.2")
    ended = kerfwise("nest", *words, *weighing, "-o", parts / "out")
    assert ended.code == 0, ended.err
    rows = re.findall(
        r"^(?:densest|layout \d+) +1 +[\d.]+ +[\d:]+ +\d+ +[\d.]+ +([\d.]+) +[\d.]+( ← taken)?", ended.out, re.M
    )
    prices = [float(price) for price, _ in rows]
    [taken] = [k for k, (_, mark) in enumerate(rows) if mark]
    assert prices[taken] == min(prices) <= prices[0]
    assert len(prices) == 2


@pytest.mark.slow
def test_a_nest_without_room_for_a_pierce_is_repaired_or_said_to_have_no_plan(parts: Path) -> None:
    words = (f"{parts / 'plate.json'}=4", "--gap", "0.2", "--edge", "1 mm", "--rounds", "1", "--for", "cutting")
    ended = kerfwise("nest", *words, "--sheet", "122.4x62.4", "-o", parts / "out")
    assert ended.code == 0, ended.err
    assert "no plan: sheet1:" in ended.out
    assert "parts lie 0.2 mm apart, and the cut is 1.5 mm wide" in ended.err
    wider = kerfwise("nest", *words, "--sheet", "140x80", "-o", parts / "out")
    assert wider.code == 0, wider.err
    assert "sheet1 repaired: " in wider.out


def test_parts_become_programs_in_one_command(parts: Path) -> None:
    words = (f"{parts / 'bracket.json'}=2", f"{parts / 'plate.json'}=1", "--sheet", "300x200")
    ended = kerfwise("make", *words, "--work", "0.5", "-o", parts / "out")
    assert ended.code == 0, ended.err
    assert "sheet1.nc: 5 contours, 5 pierces" in ended.out
    names = {path.name for path in (parts / "out").iterdir()}
    assert names == {
        "nests.csv", "nests.json", "sheet1.json", "sheet1.nc", "sheet1.nest.svg", "sheet1.plan.json", "sheet1.svg",
    }  # fmt: skip
    checked = kerfwise("check", parts / "out" / "sheet1.json", parts / "out" / "sheet1.nc")
    assert checked.code == 0, checked.out


def test_what_the_first_run_leaves_is_cut_from_in_the_second(parts: Path) -> None:
    (parts / "saving.yaml").write_text("based_on: plasma-carbon-steel\ncuts:\n  scrap: {remnant: right}\n")
    words = (f"{parts / 'plate.json'}=2", "--rounds", "1")
    first = kerfwise(
        "make", *words, "--sheet", "300x120", "-p", parts / "saving.yaml", "--work", "0.3", "-o", parts / "out"
    )
    assert first.code == 0, first.err
    [remnant] = (parts / "out").glob("*.remnant.json")
    second = kerfwise("nest", *words, "--sheet", "300x120", "--remnant", remnant, "-o", parts / "again")
    assert second.code == 0, second.err
    assert [row["stock"] for row in json.loads((parts / "again" / "nests.json").read_text())["sheets"]] == [
        remnant.name
    ]


def test_where_a_sheet_has_no_plan_nothing_is_written(parts: Path) -> None:
    words = (f"{parts / 'plate.json'}=4", "--sheet", "122.4x62.4", "--gap", "0.2", "--edge", "1 mm", "--rounds", "1")
    ended = kerfwise("make", *words, "--work", "0.5", "-o", parts / "out")
    assert ended.code in (1, 2)
    assert "sheet1" in ended.err
    assert not (parts / "out").exists()


def test_ctrl_c_keeps_the_best_nests(parts: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    heard = NestProgress.__call__

    def press_after_the_first_round(progress: NestProgress, number: int, best: Layout) -> bool:
        signal.raise_signal(signal.SIGINT)
        return heard(progress, number, best)

    monkeypatch.setattr(NestProgress, "__call__", press_after_the_first_round)
    words = (f"{parts / 'plate.json'}=20", "--sheet", "300x200", "--time-limit", "600")
    assert kerfwise("nest", *words, "-o", parts / "out").code == 130
    assert (parts / "out" / "sheet1.json").is_file()


@pytest.mark.parametrize(("after", "laid"), [(0, False), (3, True)])
def test_ctrl_c_in_the_first_round_keeps_what_is_laid_or_says_that_nothing_is(
    parts: Path, monkeypatch: pytest.MonkeyPatch, after: int, laid: bool
) -> None:
    put, seen = Room.put, []

    def press(room: Room, key: Key, shift: Floats) -> tuple[Placed, ...]:
        seen.append(key)
        if len(seen) == after + 1:
            signal.raise_signal(signal.SIGINT)
        return put(room, key, shift) if laid else ()

    monkeypatch.setattr(Room, "put", press)
    ended = kerfwise("nest", f"{parts / 'plate.json'}=20", "--sheet", "300x200", "-o", parts / "out")
    assert ended.code == 130
    assert (parts / "out" / "sheet1.json").is_file() == laid
    assert ("did not fit" in ended.out) == laid
    assert ("nothing was written" in ended.err) != laid


def test_an_engine_that_is_not_installed_is_said_before_the_work(parts: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kerfwise.apps.nesting.placement.sparrow.installed", lambda: False)
    ended = kerfwise("nest", parts / "plate.json", "--sheet", "300x200", "--engine", "sparrow", "-o", parts / "out")
    assert ended.code == 2
    assert "pip install 'kerfwise[nest]'" in ended.err


def test_a_drawing_of_a_nest_carries_orders(tmp_path: Path) -> None:
    said = {"A": {"order": "A-17", "due": "2026-12-24", "of": "bracket"}, "B": {"order": "B 4"}}
    nest = read_nest(plate(tmp_path, **said))
    (tmp_path / "again.dxf").write_text(nest_dxf(nest), encoding="utf-8")
    again = read_nest(tmp_path / "again.dxf")
    assert sorted(c.kind for c in again.contours) == ["outer", "outer"]
    found = {part.attributes.get("order"): part.attributes for part in again.parts}
    assert found.keys() == {"A-17", "B 4"}
    assert found["A-17"]["due"] == "2026-12-24"
    assert found["A-17"]["of"] == "bracket"
