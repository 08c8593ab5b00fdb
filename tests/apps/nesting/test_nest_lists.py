"""Lists of several materials: groups with their profiles or rows, what cannot be cut, and what stays of the stock."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest
import yaml

import kerfwise as package
from kerfwise.apps.nesting import programs
from kerfwise.apps.nesting.nests import Nested
from kerfwise.apps.nesting.placement.layout import nest_dxf
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.readers.json_nest import nest_json
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.tests.commands.run_cli import kerfwise

CHART = (
    "material, thickness [mm], kerf [mm], feed [mm/min], pierce_delay [s]\n"
    "S235, 6, 1.5, 2900, 0.5\nS235, 10, 1.8, 1700, 0.8\n"
)
PROFILE = "based_on: plasma-carbon-steel\nmaterial: {chart: shop.csv, name: S235, thickness: 6 mm}\n"


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with two parts, one that cannot be cut, one that cannot be read, and a profile with a chart."""
    monkeypatch.chdir(tmp_path)
    for name, made in (
        ("plate", part("plate", rect(10, 10, 80, 40))),
        ("strip", part("strip", rect(10, 10, 120, 20))),
        ("pinhole", part("pinhole", rect(10, 10, 60, 60), [circle(30, 30, 1)])),
    ):
        Path(f"{name}.json").write_text(nest_json(nest(200, 200, made)))
    Path("broken.dxf").write_text("nothing")
    Path("shop.csv").write_text(CHART)
    Path("plant.yaml").write_text(PROFILE)
    return tmp_path


def nested(*words: object) -> tuple[int, str, str]:
    """How `kerfwise nest WORDS -o out --rounds 1` ends."""
    ended = kerfwise("nest", *words, "-o", "out", "--rounds", 1)
    return ended.code, ended.out, ended.err


def test_groups_have_the_row_of_their_thickness(shop: Path) -> None:
    Path("list.csv").write_text("file;qty;mat;t;order;due\nplate;2;S235;6;A;2026-12-24\nstrip;3;S235;10;B;\n")
    code, out, err = nested("list.csv", "--sheet", "400x300", "-p", "plant.yaml")
    assert code == 0, err
    assert "S235-6mm: S235, 6 mm, profile plant" in out
    gaps = [json.loads(Path(f"out/S235-{t}mm/nests.json").read_text())["gap_mm"] for t in (6, 10)]
    assert gaps == [1.5 + 6, 1.8 + 10]
    table = json.loads(Path("out/nests.json").read_text())
    assert table["groups"] == ["S235-6mm", "S235-10mm"]
    assert yaml.safe_load(Path("out/S235-6mm/sheet1.job.yaml").read_text()) == {
        "profile": "../../plant.yaml", "order": "A", "due": yaml.safe_load("2026-12-24"),
    }  # fmt: skip
    assert kerfwise("job", "check", "out/S235-10mm/sheet1.job.yaml").code == 0
    # once more, with one material only: what the groups had is removed
    Path("list.csv").write_text("file;qty\nplate;2\n")
    code, out, err = nested("list.csv", "--sheet", "400x300", "-p", "plant.yaml")
    assert code == 0, err
    assert sorted(path.name for path in Path("out").iterdir()) == [
        "nests.csv", "nests.json", "sheet1.json", "sheet1.svg",
    ]  # fmt: skip


@pytest.mark.parametrize("listed", [True, False])
def test_what_is_set_on_the_command_line_stands_in_the_job_files(shop: Path, listed: bool) -> None:
    """The check of a sheet, without these words, read the program under other feeds."""
    Path("list.csv").write_text("file;qty;mat;t\nplate;1;S235;10\n")
    words = ("list.csv", "-p", "plasma-carbon-steel", "--set", "material.chart=shop.csv") if listed else ("plate.json",)
    made = kerfwise(
        "make", *words, "--sheet", "400x300", "-o", "out", "--rounds", 1, "--work", 0.1,
        "--set", "machine.cut_feed=1234 mm/min", "--set", "machine.pierce_time=0.7 s",
    )  # fmt: skip
    assert made.code == 0, made.err
    job = yaml.safe_load(Path("out/sheet1.job.yaml").read_text())
    assert job["set"]["machine.cut_feed"] == "1234 mm/min"
    assert job["set"].get("material.chart") == ("../shop.csv" if listed else None)
    checked = kerfwise("check", "out/sheet1.json", "out/sheet1.nc")
    assert checked.code == 0, checked.out + checked.err
    assert "F1234" in Path("out/sheet1.nc").read_text()
    again = kerfwise("solve", "out/sheet1.json", "--work", 0.1, "-o", "again.nc", "--plan", "again.json")
    assert again.code == 0, again.err
    assert Path("again.nc").read_bytes() == Path("out/sheet1.nc").read_bytes()


def test_what_a_terminal_would_obey_in_a_list_is_written_out(shop: Path) -> None:
    Path("list.csv").write_text("file;qty;mat;t;order\nplate;1;S235;6;47\u200b11\n", encoding="utf-8")
    code, _, err = nested("list.csv", "--sheet", "400x300", "-p", "plant.yaml")
    assert code == 0, err
    written = {file.name: file.read_text(encoding="utf-8") for file in Path("out").rglob("*.*") if file.is_file()}
    assert {"nests.json", "sheet1.json"} <= written.keys()
    assert [name for name, text in written.items() if "\u200b" in text] == []
    assert r"47\\u200b11" in written["sheet1.json"]


def test_a_profile_on_another_drive_is_named_by_its_whole_path(shop: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def no_way(path: object, start: object = None) -> str:
        raise ValueError("path is on mount 'D:', start on mount 'C:'")

    Path("list.csv").write_text("file;qty;mat;t\nplate;2;S235;6\n")
    monkeypatch.setattr(os.path, "relpath", no_way)
    code, _, err = nested("list.csv", "--sheet", "400x300", "-p", "plant.yaml")
    assert code == 0, err
    (job,) = Path("out").rglob("sheet1.job.yaml")
    assert yaml.safe_load(job.read_text())["profile"] == (shop / "plant.yaml").resolve().as_posix()
    assert kerfwise("job", "check", job).code == 0


def test_a_thickness_without_a_row_is_a_question(shop: Path) -> None:
    Path("list.csv").write_text("file;qty;mat;t\nplate;2;S235;8\nstrip;1;S235;6\n")
    code, _, err = nested("list.csv", "--sheet", "400x300", "-p", "plant.yaml")
    assert code == 3
    assert "row:S235-8mm: how are 2 parts of S235, 8 mm cut?" in err
    for answer, kerf in (("interpolate", 1.65), ("10mm", 1.8), ("6mm", 1.5)):
        given = ("--answer", f"row:S235-8mm={answer}")
        code, _, err = nested("list.csv", "--sheet", "400x300", "-p", "plant.yaml", *given)
        assert code == 0, err
        assert json.loads(Path("out/S235-8mm/nests.json").read_text())["gap_mm"] == pytest.approx(kerf + 8)
        assert kerfwise("job", "check", "out/S235-8mm/sheet1.job.yaml").code == 0
    code, out, _ = nested("list.csv", "--sheet", "400x300", "-p", "plant.yaml", "--answer", "row:S235-8mm=skip")
    assert (code, "left out: plate: left out with S235, 8 mm" in out) == (1, True)
    assert nested("list.csv", "--sheet", "9x9", "-p", "plant.yaml", "--answer", "row:S235-8mm=thick")[0] == 2


def test_a_profile_of_the_material_goes_before_a_chart(shop: Path) -> None:
    Path("thin.yaml").write_text("based_on: plasma-carbon-steel\nmaterial: {name: S355, thickness: 8 mm, kerf: 2 mm}\n")
    Path("list.csv").write_text("file;qty;mat;t\nplate;2;S 355;8\nstrip;1;S235;6\n")
    code, out, err = nested("list.csv", "--sheet", "400x300", "-p", "plant.yaml", "-p", "thin.yaml")
    assert code == 0, err
    assert "profile thin" in out
    laid = package.nest("list.csv", ["plant.yaml", "thin.yaml"], sheets="400x300", rounds=1)
    assert (len(laid.nests), laid.folders) == (2, ("S-355-8mm", "S235-6mm"))


def test_what_cannot_be_read_or_cut_is_found_before_anything_is_laid(shop: Path) -> None:
    Path("list.csv").write_text("file;qty\nplate;2\nbroken.dxf;1\nmissing;1\npinhole;3\nplate;0\n")
    code, _, err = nested("list.csv", "--sheet", "400x300", "-p", "plant.yaml")
    assert code == 2
    assert "list.csv:6:2: quantity: expected a whole number" in err
    code, out, err = nested("list.csv", "--sheet", "400x300", "-p", "plant.yaml", "--skip-bad")
    assert code == 1, err
    for said in ("broken.dxf", "missing", "pinhole: ", "list.csv:6:2: plate: quantity"):
        assert any(said in line for line in out.splitlines() if line.startswith("left out: ")), said
    table = json.loads(Path("out/nests.json").read_text())
    assert [row["part"] for row in table["left_out"]] == ["plate", "broken.dxf", "missing", "pinhole"]
    Path("list.csv").write_text("file;qty\nplate;2\nbroken.dxf;1\nmissing;1\n")
    code, _, err = nested("list.csv", "--sheet", "400x300", "-p", "plant.yaml")
    assert (code, "list.csv: 2 of 3 parts cannot be used (--skip-bad nests the others)" in err) == (2, True)
    code, _, err = nested("pinhole.json", "--sheet", "400x300")
    assert (code, "1 of 1 parts cannot be nested or cut" in err) == (2, True)


def test_stock_serves_its_material_and_is_there_once(shop: Path) -> None:
    Path("stock.csv").write_text(
        "size;stock;price;remnant;material;thickness\n300x200;1;50;;S235;6\n300x200;1;10;yes;S235;10\n400x300;2;90;;;\n"
    )
    Path("list.csv").write_text("file;qty;mat;t\nplate;8;S235;6\nstrip;3;S235;10\n")
    code, _, err = nested("list.csv", "--sheet", "stock.csv", "-p", "plant.yaml")
    assert code == 0, err
    used = {t: json.loads(Path(f"out/S235-{t}mm/nests.json").read_text())["sheets"] for t in (6, 10)}
    assert [row["price"] for row in used[10]] == [10.0]
    Path("stock.csv").write_text("size;stock;thickness\n400x300;1;\n")
    code, _, err = nested("list.csv", "--sheet", "stock.csv", "-p", "plant.yaml")
    assert (code, "no sheet is left for S235, 10 mm" in err) == (2, True)
    Path("stock.csv").write_text("size;stock;thickness\n400x300;1;6\n")
    code, _, err = nested("list.csv", "--sheet", "stock.csv", "-p", "plant.yaml")
    assert (code, "strip: there is no sheet of S235, 10 mm" in err) == (2, True)


def test_a_folder_and_names_with_quantities(shop: Path) -> None:
    Path("in").mkdir()
    Path("plate.json").rename("in/A7_plate_2x.json")
    Path("strip.json").rename("in/A8_strip_3x.json")
    words = ("in", "--sheet", "400x300", "-p", "plant.yaml")
    code, out, err = nested(*words, "--name-pattern", "{order}_{part}_{quantity}x")
    assert code == 0, err
    assert "5 of 5 parts" in out
    assert [row["order"] for row in json.loads(Path("out/nests.json").read_text())["parts"]] == ["A7", "A8"]
    code, _, err = nested(*words, "--name-pattern", "{part}-{quantity}")
    assert (code, "is not like --name-pattern" in err) == (2, True)


def test_the_price_of_a_sheet_counts_in_the_costs_of_make(shop: Path) -> None:
    Path("plant.yaml").write_text(PROFILE + "prices: {machine_hour: 60, sheet_kg: 1}\n")
    costs = []
    for price in (5, 105):
        Path("list.yaml").write_text(f"parts: [{{part: plate.json}}]\nsheets: [{{size: 300x200, price: {price}}}]\n")
        ended = kerfwise("make", "list.yaml", "-p", "plant.yaml", "-o", "out", "--rounds", 1, "--work", 0.2, "--sheets")
        assert ended.code == 0, ended.err
        line = next(row for row in ended.out.splitlines() if row.startswith("sheet1.nc"))
        costs.append(float(line.rsplit(",", 1)[1].split()[0]))
    assert costs[1] - costs[0] == pytest.approx(100)
    assert Path("out/sheets.pdf").read_bytes().startswith(b"%PDF")


def test_every_program_says_the_day(shop: Path) -> None:
    words = ("plate.json=2", "--sheet", "400x300", "-p", "plant.yaml", "--rounds", 1, "-o", "out")
    ended = kerfwise("make", *words, "--work", 0.2, "--date", "2026-12-01")
    assert ended.code == 0, ended.err
    made = Path("out/sheet1.nc").read_bytes()
    assert b"2026-12-01" in made
    assert "date: 2026-12-01" in Path("out/sheet1.job.yaml").read_text()
    assert kerfwise("solve", "out/sheet1.json", "--work", 0.2, "-o", "again.nc").code == 0
    assert Path("again.nc").read_bytes() == made
    ended = kerfwise("make", *words, "--date", "tomorrow")
    assert (ended.code, "expected a day such as 2026-12-24" in ended.err) == (2, True)


def test_every_program_says_the_day_from_python_too(shop: Path) -> None:
    made = package.make("plate.json=2", "plant.yaml", sheets="400x300", rounds=1, work=0.2, date="2026-12-01")
    made.save("out")
    assert "(DATE 2026-12-01)" in Path("out/sheet1.nc").read_text()
    assert "date: 2026-12-01" in Path("out/sheet1.job.yaml").read_text()
    with pytest.raises(InputError, match="expected a day such as 2026-12-24"):
        package.make("plate.json=2", "plant.yaml", sheets="400x300", rounds=1, date="tomorrow")
    solved = package.solve("out/sheet1.json", work=0.2, date="2026-12-02")
    assert "(DATE 2026-12-02)" in solved.program


def test_settings_of_a_list_from_python(shop: Path) -> None:
    laid = package.nest("plate.json=2", sheets="400x300", rounds=1, settings={"nesting.web": "20 mm"})
    plain = package.nest("plate.json=2", sheets="400x300", rounds=1)
    gaps = [one._found[0].nested.layout.spacing.gap_mm for one in (laid, plain)]
    assert gaps[0] > gaps[1]


def test_a_thickness_between_the_rows_of_a_shipped_chart_is_asked_with_its_rows(shop: Path) -> None:
    Path("list.csv").write_text("file;qty;mat;t\nplate;1;S235;30\n")
    words = ("list.csv", "--sheet", "400x300", "-p", "oxyfuel-thick-plate")
    code, _, err = nested(*words)
    assert code == 3
    assert [word for word in ("=interpolate", "=50mm", "=25mm", "=as-it-is", "=skip") if word not in err] == []
    code, _, err = nested(*words, "--answer", "row:S235-30mm=interpolate")
    assert code == 0, err
    assert "starting values of Carvill" in err
    assert "chart: oxyfuel" in (job := Path("out/sheet1.job.yaml").read_text())
    assert "interpolate: true" in job


def test_a_shipped_profile_takes_the_shipped_row_of_the_thickness(shop: Path) -> None:
    Path("list.csv").write_text("file;qty;mat;t\nplate;2;S235;6\nplate;1;S355;8\n")
    code, _, err = nested("list.csv", "--sheet", "400x300")
    assert code == 0, err
    assert "starting values of Hypertherm" in err
    assert json.loads(Path("out/S355-8mm/nests.json").read_text())["gap_mm"] == pytest.approx(1.7 + 8)
    assert kerfwise("solve", "out/S355-8mm/sheet1.json", "--work", 0.2).code == 0
    Path("list.csv").write_text("file;qty;mat;t\nplate;2;S235;40\n")
    assert nested("list.csv", "--sheet", "400x300")[0] == 3


def test_a_name_says_how_many_unless_somebody_does(shop: Path) -> None:
    Path("plate.dxf").write_text(nest_dxf(nest(200, 200, part("plate", rect(10, 10, 80, 40)))))
    Path("plate.dxf").rename("plate_4x.dxf")
    code, out, err = nested("plate_4x.dxf", "--sheet", "400x300")
    assert code == 0, err
    assert "4 of 4 parts" in out
    assert "4 copies of plate_4x, as the drawing or its name says" in err
    assert "2 of 2 parts" in nested("plate_4x.dxf=2", "--sheet", "400x300")[1]
    Path("list.csv").write_text("file;qty\nplate_4x.dxf;\nplate_4x.dxf;1\n")
    assert "5 of 5 parts" in nested("list.csv", "--sheet", "400x300")[1]


@pytest.mark.parametrize("name", ["PLATE.JSON", "Plate", r"C:\orders\plate.json", r"in\strip", "in/strip.json"])
def test_files_are_found_as_other_systems_write_them(shop: Path, name: str) -> None:
    Path("in").mkdir()
    Path("strip.json").rename("in/strip.json")
    Path("list.csv").write_text(f"file;qty\n{name};2\n")
    code, out, err = nested("list.csv", "--sheet", "400x300")
    assert (code, "2 of 2 parts" in out) == (0, True), err


@pytest.mark.parametrize("name", ["/", ".", "a" * 300 + "/b", "<g>" * 200 + r"\b"])
def test_names_that_no_file_can_have_are_refused_with_their_line(shop: Path, name: str) -> None:
    Path("odd.csv").write_text(f"file,quantity\n{name},2\n", encoding="utf-8")
    code, _, err = nested("odd.csv", "--sheet", "400x300")
    assert code == 2
    assert "odd.csv:2" in err


def test_qualities_of_a_grade_are_cut_alike(shop: Path) -> None:
    Path("list.csv").write_text("file;qty;mat;t\nplate;2;S235JR;6\nstrip;2;S 235 J2+N;6\n")
    code, out, err = nested("list.csv", "--sheet", "400x300")
    assert (code, "4 of 4 parts" in out) == (0, True), err


def test_a_sheet_without_a_plan_stops_no_other(shop: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = programs.plan_or_repair

    def stuck(nested: Nested, number: int, *rest: Any) -> Any:
        if number == 0:
            raise RulesConflict("these hard rules cannot all hold", ("A before B",))
        return whole(nested, number, *rest)

    monkeypatch.setattr(programs, "plan_or_repair", stuck)
    words = ("make", "plate.json=6", "--sheet", "200x150", "--rounds", 1, "--work", 0.2, "-o", "out")
    assert kerfwise(*words).code == 1
    assert not Path("out").exists()
    ended = kerfwise(*words, "--skip-bad", "--sheets")
    assert ended.code == 1, ended.err
    assert "sheet1: no program: these hard rules cannot all hold - A before B" in ended.out
    assert Path("out/sheet2.nc").exists()
    assert not Path("out/sheet1.nc").exists()
    assert Path("out/sheet1.json").exists()
