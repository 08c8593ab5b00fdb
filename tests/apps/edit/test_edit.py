"""kerfwise edit: the nest as a file, its job file with it, collisions named, and what is cut stays."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.nest_file import nest_file


@pytest.fixture
def plate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A nest of three squares with a job file, in the folder that is worked in."""
    monkeypatch.chdir(tmp_path)
    squares = [
        {"id": f"P{k}", "outer": [[x, 20], [x + 60, 20], [x + 60, 80], [x, 80]]}
        for k, x in ((1, 20), (2, 120), (3, 220))
    ]
    Path("plate.job.yaml").write_text("order: '4711'\nlocks: [P3 first]\n")
    return nest_file(tmp_path / "plate.json", squares, (320, 140))


def edit(*words: object) -> tuple[int, str, str]:
    """How `kerfwise edit plate.json WORDS -o new.json` ends."""
    ended = kerfwise("edit", "plate.json", *words, "-o", "new.json")
    return ended.code, ended.out, ended.err


def parts() -> dict[str, list[list[float]]]:
    """The outlines of the new nest."""
    return {one["id"]: one["outer"] for one in json.loads(Path("new.json").read_text())["parts"]}


def test_changes_of_all_kinds(plate: Path) -> None:
    code, out, err = edit("--drop", "P1", "--move", "P2", "-50", "10", "--turn", "P3", "90", "--add", "plate.json")
    assert code == 2, out  # three more squares do not fit
    assert "no room" in err
    code, out, err = edit("--drop", "P1", "--move", "P2", "-50", "10", "--turn", "P3", "90")
    assert code == 0, err
    assert "2 parts of 3 before, on a sheet of 320 × 140 mm" in out
    assert parts()["P2"][0] == [70, 30]
    assert Path("new.job.yaml").read_bytes() == Path("plate.job.yaml").read_bytes()
    assert kerfwise("solve", "new.json", "--work", 0.2).code == 0


def test_a_lock_on_a_scrap_line_is_not_put_on_another(plate: Path) -> None:
    nest = json.loads(plate.read_text()) | {"scrap": [[[100, 0], [100, 140]], [[200, 0], [200, 140]]]}
    plate.write_text(json.dumps(nest))
    Path("plate.job.yaml").write_text("locks: [scrap2 first, P3 first]\n")
    code, out, err = edit("--drop", "P1", "--move", "P2", "-50", "0")
    assert (code, json.loads(Path("new.json").read_text())["scrap"]) == (1, [[[200, 0], [200, 140]]])
    assert "scrap line left out: scrap1 runs through part P2 at (100.0, 50.0)" in out
    assert "copied without a lock" in err
    assert "scrap" not in Path("new.job.yaml").read_text()


def test_a_collision_is_named_and_nothing_is_written(plate: Path) -> None:
    code, _, err = edit("--move", "P1", "37", "0")
    assert code == 2
    assert "P1 lies 3.0 mm from P2: 7.5 mm are kept" in err
    assert not Path("new.json").exists()
    assert edit("--move", "P1", "37", "0", "--gap", "3")[0] == 0
    assert edit("--move", "P1", "-15", "0")[0] == 2
    assert edit("--drop", "P9")[0] == 2
    assert edit()[0] == 2
    assert edit("--fix", "P1", "--drop", "P2")[0] == 2


@pytest.mark.parametrize(
    "words",
    [("--move", "P1", "nan", "0"), ("--move", "P1", "0", "1e7"), ("--turn", "P1", "inf"), ("--turn", "P1", "-1e400")],
)
def test_what_is_no_length_and_no_angle_is_refused(plate: Path, words: tuple[str, ...]) -> None:
    code, _, err = edit(*words)
    assert (code, "expected numbers from -1e+06 to 1e+06" in err) == (2, True), err


def test_python_shows_a_line_and_refuses_cuts_that_were_not_made(plate: Path) -> None:
    changed = package.edit("plate.json", None, "drop P3", job=False)
    assert str(changed) == repr(changed) == "2 parts of 3 before, on a sheet of 320 × 140 mm"
    with pytest.raises(package.InputError, match="expected numbers"):
        changed.do("turn P1 nan")
    package.solve("plate.json", work=0.2).save("plans")
    with pytest.raises(package.InputError, match="has 3 cuts only"):
        package.edit("plate.json", None, "drop P3", cut_by="plans/plate.plan.json", upto=9)


@pytest.mark.parametrize(
    ("job", "left"),
    [
        ("order: '4711'\nlocks: [P3 first]\n", "order: '4711'\n"),
        ("locks: [P1 first, P3 last]\nquantity: 2\n", "locks: [P1 first]\nquantity: 2\n"),
        ("locks:\n  - part: P3\n    zone: 1\n  - P1 first  # cold\n", "locks:\n  - P1 first  # cold\n"),
        ("# of Monday\nlocks:\n- P1 before P3\n- P2 before P3\n", "# of Monday\n"),
    ],
)
def test_a_job_file_is_copied_without_the_locks_of_what_is_left_out(plate: Path, job: str, left: str) -> None:
    Path("plate.job.yaml").write_text(job)
    code, _, err = edit("--drop", "P3")
    assert code == 0, err
    assert err.count("the job file plate.job.yaml is copied without a lock: lock 'P") == job.count("P3"), err
    assert Path("new.job.yaml").read_text() == left
    assert kerfwise("job", "check", "new.job.yaml").code == 0


def test_another_sheet_leaves_out_what_is_off(plate: Path) -> None:
    code, out, _ = edit("--sheet", "250x140", "--no-job")
    assert (code, "off the sheet, left out: P3" in out) == (1, True)
    assert json.loads(Path("new.json").read_text())["sheet"] == {"width": 250, "height": 140}


def test_one_part_is_cut_again_where_it_lay(plate: Path) -> None:
    assert kerfwise("solve", "plate.json", "--work", 0.2, "--plan", "plate.plan.json").code == 0
    assert "P3 is cut already" in edit("--move", "P3", "1", "0", "--lock-from", "plate.plan.json", "--upto", 1)[2]
    assert edit("--move", "P1", "1", "0", "--lock-from", "plate.plan.json", "--upto", 1)[0] == 0
    assert edit("--upto", 1, "--drop", "P1")[0] == 2
    assert "has 3 cuts only" in edit("--keep", "P1", "--lock-from", "plate.plan.json", "--upto", 9)[2]
    code, _, err = edit("--keep", "P2", "--lock-from", "plate.plan.json", "--no-job")
    assert code == 0, err
    assert len(json.loads(Path("new.json").read_text())["sheet"]["holes"]) == 2
    again = kerfwise("solve", "new.json", "--no-job", "--work", 0.2, "--plan", "new.plan.json")
    assert again.code == 0, again.err
    cut = json.loads(Path("new.plan.json").read_text())["cuts"]
    assert [one["contour"] for one in cut] == ["P2.outer"]


def test_an_option_may_have_several_parts_behind_it(plate: Path) -> None:
    assert edit("--keep", "P1", "P3", "--no-job")[0] == 0
    assert sorted(parts()) == ["P1", "P3"]
    last = kerfwise("edit", "-o", "new.json", "--no-job", "--drop", "P1", "P3", "plate.json")
    assert last.code == 0, last.err
    assert sorted(parts()) == ["P2"]
    assert edit("--turn", "P1", "90", "P2")[0] == 2


def test_a_job_file_in_another_folder_names_profile_and_chart_from_there(plate: Path) -> None:
    Path("out").mkdir()
    Path("shop.csv").write_text("material,thickness [mm],kerf [mm]\nS235,10,2.5\n")
    Path("plant.yaml").write_text("based_on: plasma-carbon-steel\n")
    Path("plate.job.yaml").write_text(
        "profile: plant.yaml  # ours\nset:\n  material.chart: shop.csv\n  material.thickness: 10 mm\n"
    )
    ended = kerfwise("edit", "plate.json", "--drop", "P1", "-o", "out/new.json")
    assert ended.code == 0, ended.err
    assert Path("out/new.job.yaml").read_text() == (
        'profile: "../plant.yaml"  # ours\nset:\n  material.chart: "../shop.csv"\n  material.thickness: 10 mm\n'
    )
    solved = kerfwise("solve", "out/new.json", "--work", 0.2, "-o", "out/new.nc")
    assert solved.code == 0, solved.err
    assert "KERF 2.5 MM" in Path("out/new.nc").read_text()
