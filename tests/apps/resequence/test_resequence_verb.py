"""kerfwise resequence: one program or a folder; and time, heat, check and plot of a program that stands alone."""

import json
from pathlib import Path

import pytest

from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.postproc.old.programs import FEED, HEAD, READ, REFUSED


@pytest.mark.parametrize("name", REFUSED)
def test_a_program_that_nobody_can_be_sure_of_is_refused_with_its_line(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    text, line, said = REFUSED[name]
    Path("old.nc").write_text(text)
    ended = kerfwise("resequence", "old.nc", "--work", 1)
    assert ended.code == 2
    told = [row for row in ended.err.splitlines() if not row.startswith("note: ")]
    assert told[0].startswith(f"kerfwise: old.nc:{line}:" if line else "kerfwise: old.nc: ")
    assert said in told[0]
    assert not any(row.startswith("Traceback") for row in told)
    assert not Path("old.resequenced.nc").exists()


def test_both_orders_side_by_side(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("old.nc").write_text(READ["squares with holes"])
    ended = kerfwise("resequence", "old.nc", "--work", 2, "--picture", "both.svg", "--plan", "plan.json")
    assert ended.code == 0
    rows = {row.split("  ")[0]: row for row in ended.out.splitlines()}
    assert rows["idle travel"].split()[-1].startswith("-")
    assert "hard inner-before-outer" in rows
    assert ended.out.splitlines()[-1] == "written: old.resequenced.nc, both.svg, plan.json"
    assert Path("both.svg").read_text().count(">before<") == 1
    assert len(json.loads(Path("plan.json").read_text())["cuts"]) == 6


def test_a_picture_and_an_output_that_cannot_be(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("old.nc").write_text(READ["squares"])
    for options, said in (
        (["--picture", "both.html"], "give a name ending in .svg or .png"),
        (["-o", "old.nc"], "is read from"),
        (["--sheet", "1"], "is not a size"),
        (["--sheet", "50x50"], "beyond that sheet"),
        (["--paths", "old"], "'old' is not one of"),
        (["-p", "no-such"], "no-such"),
    ):
        ended = kerfwise("resequence", "old.nc", *options)
        assert (ended.code, said in ended.err) == (2, True)
    assert kerfwise("resequence", "gone.nc").code == 2
    assert sorted(p.name for p in Path().iterdir()) == ["old.nc"]


def archive(folder: Path) -> list[str]:
    """A folder of programs, some of which cannot be read."""
    (folder / "old" / "more").mkdir(parents=True)
    names = ["squares", "rows", "more/slow holes"]
    for name in names:
        (folder / "old" / f"{name}.nc").write_text(READ[Path(name).name])
    (folder / "old" / "loop.ngc").write_text(REFUSED["a loop"][0])
    (folder / "old" / "letter.txt").write_text("not a program")
    return [f"{name}.nc" for name in names]


@pytest.mark.parametrize("jobs", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_a_folder(jobs: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    names = archive(tmp_path)
    monkeypatch.chdir(tmp_path)
    ended = kerfwise("resequence", "old", "-o", "new", "--without-rules", "--work", 1, "--jobs", jobs)
    assert ended.code == 2
    rows = ended.out.splitlines()
    assert any(row.startswith("loop.ngc") and row.endswith("refused") for row in rows)
    assert any(row.startswith("refused: old/loop.ngc:5: ") for row in rows)
    assert rows[-1] == "3 of 4 programs read, 3 changed"
    assert sorted(str(p.relative_to("new")) for p in Path("new").rglob("*.nc")) == sorted(names)
    total = next(row.split() for row in rows if row.startswith("in all"))
    parts = [row.split() for row in rows if row.split()[0].endswith(".nc") or row.startswith("more/")]
    assert float(total[2]) == pytest.approx(sum(float(row[-6]) for row in parts), abs=0.003)
    assert Path("new/rows.nc").read_text() == READ["rows"] or float(parts[1][-6]) > float(parts[1][-5])


def test_nobody_cuts_by_what_an_older_program_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    archive(tmp_path)
    monkeypatch.chdir(tmp_path)
    Path("new").mkdir()
    Path("new/loop.ngc").write_text("written by hand")
    asked = ("resequence", "old", "-o", "new", "--without-rules", "--work", 1)
    kerfwise(*asked)
    assert Path("new/rows.nc").is_file()
    Path("old/rows.nc").write_text(REFUSED["a loop"][0])
    ended = kerfwise(*asked)
    assert ended.code == 2
    assert "refused: old/rows.nc:5: " in ended.out
    written = sorted(str(path.relative_to("new")) for path in Path("new").rglob("*") if path.is_file())
    assert written == [
        "loop.ngc",
        "more/slow holes.nc",
        "resequence.json",
        "squares.nc",
    ]  # what is not its own it leaves
    assert [row["name"] for row in json.loads(Path("new/resequence.json").read_text())["programs"]] == [
        "more/slow holes.nc",
        "squares.nc",
    ]
    Path("old/rows.nc").write_text(READ["rows"])
    assert "3 of 4 programs read, 3 changed, 2 finished before" in kerfwise(*asked).out


def test_originals_of_another_folder_are_not_written_over(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("old/6 mm").mkdir(parents=True)
    for place in ("old", "old/6 mm"):
        Path(place, "a.nc").write_text(READ["squares"])
    ended = kerfwise("resequence", "old/6 mm", "-o", "old", "--work", 0.2)
    assert ended.code == 2
    assert f"refused: {Path('old', 'a.nc')}: is in the place of the new program" in ended.out
    assert sorted(path.name for path in Path("old").rglob("*")) == ["6 mm", "a.nc", "a.nc"]
    assert Path("old/a.nc").read_text() == READ["squares"]


def test_folders_that_cannot_be(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    archive(tmp_path)
    monkeypatch.chdir(tmp_path)
    Path("empty").mkdir()
    for argv, said in (
        (["old"], "give it with -o"),
        (["empty", "-o", "new"], "holds no program"),
        (["old", "-o", "old"], "is read from"),
        (["old", "-o", "new", "--picture", "p.svg"], "--picture is of one program"),
    ):
        ended = kerfwise("resequence", *argv)
        assert (ended.code, said in ended.err) == (2, True)


def test_time_heat_check_and_plot_of_a_program_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    text = READ["squares with holes"].replace("F2500\n", FEED)
    Path("old.nc").write_text(text)
    timed = json.loads(kerfwise("time", "old.nc", "--json", "--feed", 1250).out)
    assert timed["cut_s"] == pytest.approx(2 * json.loads(kerfwise("time", "old.nc", "--json").out)["cut_s"])
    checked = kerfwise("check", "old.nc", "--feed", 2500)
    assert checked.code == 1  # it says neither G90 nor G40
    assert "program-state" in checked.out.splitlines()[-1]
    heat = kerfwise("heat", "old.nc", "--model", "logical", "-o", "map.png")
    assert heat.code == 0
    assert heat.out.startswith("model      logical")
    assert kerfwise("plot", "old.nc", "-o", "old.svg").code == 0
    assert '<g id="program-1">' in Path("old.svg").read_text()
    assert Path("map.png").read_bytes().startswith(b"\x89PNG")


def test_a_program_that_makes_no_nest_can_be_timed_and_drawn_but_not_judged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("rows.nc").write_text(READ["rows"])
    assert kerfwise("time", "rows.nc", "--feed", 2500).code == 0
    assert kerfwise("plot", "rows.nc", "-o", "rows.png").code == 0
    for verb in ("check", "heat"):
        ended = kerfwise(verb, "rows.nc", "--feed", 2500)
        assert ended.code == 2
        assert "kerfwise: rows.nc:6: no nest can be told from the program" in ended.err


def test_a_nest_alone_is_still_not_enough(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.json").write_text("{}")
    for verb in ("time", "heat", "check"):
        ended = kerfwise(verb, "a.json")
        assert (ended.code, "Missing argument 'PLAN.json|OUT.nc'" in ended.err) == (2, True)


def test_feeds_of_materials_are_taken_where_one_is_given(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside a nest, too."""
    monkeypatch.chdir(tmp_path)
    square = {"id": "A", "outer": [[20, 20], [60, 20], [60, 60], [20, 60]]}
    nest = {"format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": 200, "height": 100}, "parts": [square]}
    Path("nest.json").write_text(json.dumps(nest))
    rows = "G0 X15 Y30\nM3 $0 S1\nG1 X19.25\nG1 Y19.25\nG1 X60.75\nG1 Y60.75\nG1 X19.25\nG1 Y30\nM5 $0\nG0 X0 Y0\nM2\n"
    Path("old.nc").write_text(f"{HEAD}G90\n{FEED}{rows}")
    assert kerfwise("check", "nest.json", "old.nc").code == 2
    told = kerfwise("check", "nest.json", "old.nc", "--feed", 2500)
    assert told.code == 1
    assert "holds      hard feeds" in told.out
    assert kerfwise("time", "nest.json", "old.nc", "--feed", 2500).code == 0
