"""Whatever is wrong with what a person gives: one message, exit code 2, nothing written."""

from __future__ import annotations

from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.tests.commands.run_cli import Ended, kerfwise

EXAMPLES = Path(package.__file__).parent / "examples"
NEST = EXAMPLES / "nests" / "e1x_6.json"


def refused(ended: Ended, *expected: str) -> None:
    assert ended.code == 2
    assert ended.out == ""
    assert "Traceback" not in ended.err
    for words in expected:
        assert words in ended.err


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("cut.dxf", (EXAMPLES / "nests" / "e1x_6.dxf").read_bytes()[:6000], "cut.dxf"),
        ("noise.dxf", bytes(range(256)) * 9, "noise.dxf"),
        ("empty.json", b"", "empty.json"),
        ("wrong.json", b'{"format": "kerfwise-nest/1", "parts": []}', "sheet"),
        ("comma.json", b'{"format": "kerfwise-nest/1",\n "parts": [}', "comma.json:2:"),
        ("nest.step", b"ISO-10303-21;", ".dxf"),
    ],
)
def test_broken_nests(name: str, content: bytes, expected: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(content)
    refused(kerfwise("solve", tmp_path / name, "-o", tmp_path / "out.nc"), expected)
    assert not (tmp_path / "out.nc").exists()


def test_a_missing_nest() -> None:
    refused(kerfwise("solve", "nowhere.json"), "nowhere.json")


def test_a_folder_or_half_a_name_in_place_of_a_nest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "plate.json").write_bytes(NEST.read_bytes())
    (tmp_path / "l.yaml").write_text("name: l\n")
    monkeypatch.chdir(tmp_path)
    for given in (".", ""):
        refused(kerfwise("solve", given), "kerfwise: .: this is a folder; expected a nest file")
    for given in ("plate", "plate.jsn"):
        refused(kerfwise("solve", given), f"cannot tell the format of '{given}'", "did you mean 'plate.json'?")
    refused(kerfwise("solve", "plate.json", "-p", "nope.yaml"), "nope.yaml: cannot read the profile")
    assert "did you mean" not in kerfwise("solve", "plate.json", "-p", "nope.yaml").err


def test_a_typo_in_a_profile_is_placed_and_the_nearest_name_given(tmp_path: Path) -> None:
    profile = tmp_path / "plant.yaml"
    profile.write_text("name: plant\nrules:\n  levelahead: hard\n")
    refused(
        kerfwise("solve", NEST, "-p", profile, "-o", tmp_path / "out.nc"), "plant.yaml:3:3", "levelahead", "level-ahead"
    )
    assert not (tmp_path / "out.nc").exists()
    refused(kerfwise("profile", "check", profile), "plant.yaml:3:3")
    refused(kerfwise("profile", "show", "plasma-carbon-steal"), "plasma-carbon-steel")


CLASHES = """\
machine:
  torches: {count: 2, spacing: 300 mm}
cuts:
  links: {longest: 10 mm}
  pierce_pass: zone
objective: {heat: 5}
leads: {edge_start: true}
"""
PLACES = (
    "5:16: cuts.pierce_pass: under",
    "7:21: leads.edge_start",
    "2:12: machine.torches: the dialect",
    "4:10: machine.torches: links",
    "5:16: machine.torches: a pierce pass",
    "6:19: machine.torches: the price",
)


def test_everything_that_clashes_in_a_profile_is_said_at_once_with_its_place(tmp_path: Path) -> None:
    """What the dialect has no words for, and what does not go together with several torches."""
    profile = tmp_path / "plant.yaml"
    profile.write_text(CLASHES)
    for words in (("solve", NEST, "-p", profile, "-o", tmp_path / "out.nc"), ("profile", "check", profile)):
        refused(ended := kerfwise(*words), *(f"plant.yaml:{place}" for place in PLACES))
        assert ended.err.count("plant.yaml:") == len(PLACES), ended.err
    assert not (tmp_path / "out.nc").exists()


def test_an_output_that_cannot_be_written(tmp_path: Path) -> None:
    """Said before the work is done, not after."""
    refused(
        kerfwise("solve", NEST, "-o", tmp_path / "nowhere" / "out.nc", "--plan", tmp_path / "plan.json"),
        "cannot write: there is no folder",
    )
    assert list(tmp_path.iterdir()) == []


def test_an_output_in_the_place_of_another_or_of_what_is_read(tmp_path: Path) -> None:
    nest = tmp_path / "nest.json"
    nest.write_bytes(NEST.read_bytes())
    plan = tmp_path / "plan.json"
    same = tmp_path / "here" / ".." / "plan.json"
    (tmp_path / "here").mkdir()
    for verb in (("solve", nest, "-o", nest), ("facts", nest, "-o", nest)):
        refused(kerfwise(*verb), "nest.json: would be written over, and is read from")
    refused(kerfwise("solve", nest, "-o", plan, "--plan", same), "plan.json: two outputs have this name")
    refused(kerfwise("solve", nest, "--lock-from", plan, "--upto", "1", "--plan", plan), "is read from")
    refused(kerfwise("solve", nest, "-o", tmp_path), "this is a folder")
    refused(kerfwise("solve", nest, "-o", "-"), "nothing goes to standard output")
    drawn = EXAMPLES / "nests" / "marked.svg"
    refused(kerfwise("plot", drawn, "-o", drawn), "marked.svg: would be written over")
    assert nest.read_bytes() == NEST.read_bytes()
    assert not plan.exists()


def test_a_picture_of_no_known_type_is_refused_before_the_work(tmp_path: Path) -> None:
    for option in ("--picture", "--conflict-picture"):
        ended = kerfwise("solve", NEST, "-o", tmp_path / "cut.nc", option, "cut.jpg")
        refused(ended, "cannot draw a picture of type '.jpg'", ".svg, .png, .pdf, .html")
        assert ended.out == ""
    assert list(tmp_path.iterdir()) == []


def test_a_program_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    (tmp_path / "cut.nc").write_text("G21\nG0 X\n")
    refused(kerfwise("check", NEST, tmp_path / "cut.nc"), "cut.nc:2:4: cannot read 'X'")


def test_a_program_where_a_plan_is_expected(tmp_path: Path) -> None:
    (tmp_path / "cut.nc").write_text("N10 G21\n")
    refused(kerfwise("plot", NEST, tmp_path / "cut.nc", "-o", "cut.svg"), "cut.nc:1:1: not a plan: expected JSON")


def test_wrong_usage() -> None:
    refused(kerfwise("solve"), "NEST")
    refused(kerfwise("solv", NEST), "solv", "did you mean 'solve'?")
    refused(kerfwise("plot", NEST, "cut.nc", "-o", "cut.svg"), "cannot read the plan")
    refused(kerfwise("solve", NEST, "--sheet", "big"), "3000x1500")
    refused(kerfwise("facts", NEST, "-o", "facts.txt"), ".dzn")
    refused(kerfwise("plot", NEST, "-o", "nest.bmp"), ".svg")
    refused(kerfwise("rules", "levelahead"), "level-ahead")
    refused(kerfwise("rules", "level-ahead", "--picture", "cases.gif"), ".svg")


@pytest.mark.slow
def test_rules_that_clash_are_named_and_drawn_and_give_way_only_when_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    profile = tmp_path / "plant.yaml"
    profile.write_text("name: plant\nlocks:\n  - {contour: NC20-14#2.outer, position: 1}\n")
    ended = kerfwise("solve", NEST, "-p", profile, "-o", "out.nc")
    assert ended.code == 1
    assert "NC20-14#2.outer" in ended.err
    assert "inner-before-outer: NC20-14#2.hole1 is cut before NC20-14#2.outer" in ended.err
    assert sorted(p.name for p in tmp_path.iterdir()) == ["e1x_6.conflict.svg", "plant.yaml"]

    given_way = kerfwise("solve", NEST, "-p", profile, "-o", "out.nc", "--relax")
    assert given_way.code == 0
    assert "relaxed: " in given_way.out
    assert "(RELAXED " in (tmp_path / "out.nc").read_text()
    assert kerfwise("check", NEST, "out.nc", "-p", profile).code == 0


def test_a_dialect_file_of_the_plants_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    shipped = (Path(package.__file__).parent / "postproc/dialects/linuxcnc-qtplasmac.yaml").read_text()
    Path("plant.yaml").write_text("machine: {dialect: shop.yaml}\n")
    for verb in (("solve", NEST, "-p"), ("profile", "check")):
        refused(kerfwise(*verb, "plant.yaml"), "shop.yaml: cannot read the dialect")
    Path("shop.yaml").write_text(shipped.replace("pierce_dwell: machine", "pierce_dwell: program"))
    ended = kerfwise("solve", NEST, "-p", "plant.yaml", "--work", "0.5", "-o", "cut.nc")
    assert ended.code == 0, ended.err
    assert "G4 P" in Path("cut.nc").read_text()
    assert kerfwise("check", NEST, "cut.nc", "-p", "plant.yaml").code == 0
    assert kerfwise("check", NEST, "cut.nc").code == 1  # the material's own delay would come on top


def test_a_profile_for_another_process_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("plant.yaml").write_text("machine: {process: oxyfuel}\n")
    for verb in (("solve", NEST, "-p"), ("profile", "check")):
        refused(kerfwise(*verb, "plant.yaml"), "plant.yaml:1:20: machine.dialect: 'linuxcnc-qtplasmac' is for plasma")
    assert not Path("e1x_6.nc").exists()
