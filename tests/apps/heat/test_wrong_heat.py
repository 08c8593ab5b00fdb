"""time, heat and pareto of what does not fit: one message, exit code 2, nothing written."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.tests.commands.run_cli import kerfwise

NESTS = Path(package.__file__).parent / "examples" / "nests"
NEST, OTHER = NESTS / "e1x_6.json", NESTS / "plate40.json"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, made: tuple[str, str]) -> Path:
    """Where the commands run, with a plan and a program of NEST."""
    monkeypatch.chdir(tmp_path)
    plan, program = made
    Path("cut.json").write_text(plan)
    Path("cut.nc").write_text(program)
    Path("bare.nc").write_text(re.sub(r"\(NEST .*\)\n", "", program))
    Path("empty.nc").write_text("")
    Path("idle.nc").write_text("G21 G90\nG0 X5 Y5\nM2\n")
    return tmp_path


@pytest.fixture(scope="module")
def made() -> tuple[str, str]:
    found = package.solve(NEST, work=2)
    return found.plan.to_json(), found.program


def refused(expected: str, verb: str, *argv: object) -> None:
    before = sorted(path.name for path in Path.cwd().iterdir())
    ended = kerfwise(verb, *argv)
    assert (ended.code, ended.out) == (2, ""), ended.err
    assert expected in ended.err
    assert "Traceback" not in ended.err
    assert sorted(path.name for path in Path.cwd().iterdir()) == before


@pytest.mark.parametrize("verb", ["time", "heat"])
@pytest.mark.parametrize(
    ("nest", "made_of_it", "expected"),
    [
        (OTHER, "cut.json", "the plan was made from another nest"),
        (OTHER, "cut.nc", "cut.nc: the program was made from another nest: it names e1x_6.json with sha256"),
        (OTHER, "bare.nc", "bare.nc: only 1 of the 16 cuts of the program run along contours of"),
        (NEST, "empty.nc", "empty.nc: the program has no end"),
        (NEST, "idle.nc", "idle.nc: the program cuts nothing: the torch is never on"),
        (NEST, "none.nc", "none.nc: cannot read the program: No such file"),
        (NEST, "none.json", "none.json: cannot read the plan: No such file"),
        (NEST, NEST, 'not a plan: expected "format"'),
    ],
)
def test_what_was_not_made_from_the_nest(folder: Path, verb: str, nest: Path, made_of_it: str, expected: str) -> None:
    refused(expected, verb, nest, made_of_it)


def test_the_check_notes_a_program_of_another_nest_and_judges_it(folder: Path) -> None:
    own = kerfwise("check", NEST, "cut.nc")
    assert (own.code, "another nest" in own.err) == (0, False), own.err
    other = kerfwise("check", OTHER, "cut.nc")
    assert other.code == 1
    assert "note: the program was made from another nest: it names e1x_6.json with sha256" in other.err


def test_cuts_that_are_not_the_nests_are_noted(folder: Path) -> None:
    Path("more.nc").write_text(
        Path("bare.nc").read_text().replace("(HOME)", "G0 X50 Y2\nM3 $0 S1\nG4 P0.5\nG1 X600 F2500\nM5 $0")
    )
    for verb in ("time", "heat"):
        ended = kerfwise(verb, NEST, "more.nc")
        assert ended.code == 0, ended.err
        assert "note: 1 of 17 cuts of the program run along no contour of the nest\n" in ended.err


@pytest.mark.parametrize(
    ("profile", "expected"),
    [
        ("heat: {material: carbon-stel}", "did you mean 'carbon-steel'?"),
        ("heat: {absorbed_power_w: -5}", "expected a number from 0 to 1e+06"),
        ("heat: {limit_c: 20}", "heat.limit_c: 20 °C is not above ambient_c"),
        ("heat: {grid: 0}", "expected a length over 0"),
        ("heat: {grid: 0.01 mm}", "0.01 mm is not likely, expected 0.05 mm to 1000 mm"),
        ("heat: {grid: 0.05 mm}", "14001 x 6001 points of this sheet"),
        ("heat: {grid: 1 m}", "no point of the grid counts: all lie within 1500 mm of a cut"),
    ],
)
def test_profiles_that_cannot_be_simulated(folder: Path, profile: str, expected: str) -> None:
    Path("plant.yaml").write_text(f"based_on: plasma-carbon-steel\n{profile}\n")
    refused(expected, "heat", NEST, "cut.nc", "-p", "plant.yaml", "-o", "map.png", "--frames", "frames")


def test_a_fine_grid_is_told_what_it_costs(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kerfwise.apps.heat.simulation._POINT_STEPS_PER_SECOND", 2e4)
    ended = kerfwise("heat", NEST, "cut.nc")
    assert ended.code == 0
    assert re.match(r"note: a grid of 5 mm takes up to about 3 min \d+ s here, one of [\d.]+ mm a minute", ended.err)


@pytest.mark.parametrize(
    ("expected", "argv"),
    [
        ("give a name ending in .png", ("heat", NEST, "cut.nc", "-o", "map.svg")),
        ("cannot write: there is no folder 'nowhere'", ("heat", NEST, "cut.nc", "-o", "nowhere/map.png")),
        ("cannot write: there is no folder 'nowhere'", ("heat", NEST, "cut.nc", "--frames", "nowhere/frames")),
        ("cannot make a folder there: it is a file", ("heat", NEST, "cut.nc", "--frames", "cut.nc")),
        ("cannot write: there is no folder 'nowhere'", ("pareto", NEST, "-o", "nowhere/front.png")),
        ("cannot make a folder there: it is a file", ("pareto", NEST, "--plans", "cut.nc")),
        ("nan is not an amount", ("pareto", NEST, "--price", "nan")),
        ("inf is not an amount", ("pareto", NEST, "--work", "inf")),
        ("-3.0 is not in the range", ("pareto", NEST, "--price", "-3")),
        ("nan is not an amount", ("solve", NEST, "--time-limit", "nan")),
        ("nan is not an amount", ("solve", NEST, "--gap", "nan")),
    ],
)
def test_wrong_usage(folder: Path, expected: str, argv: tuple[object, ...]) -> None:
    verb, *rest = argv
    refused(expected, str(verb), *rest)
