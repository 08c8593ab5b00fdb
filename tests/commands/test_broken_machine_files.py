"""Broken programs, dialects and material charts: each answered by one message with file and line, and exit code 2."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from kerfwise.tests.commands.run_cli import Ended, kerfwise
from kerfwise.tests.postproc.old.programs import REFUSED

NEST = {
    "format": "kerfwise-nest/1",
    "sheet": {"width": 200, "height": 120},
    "parts": [{"id": "A", "outer": [[20, 30], [80, 30], [80, 90, 0.4], [20, 90]]}],
}
CHART = """\
material, thickness [mm], kerf [mm], feed [mm/min], pierce_delay [s], amps, gas
S235, 6, 1.5, 2500, 0.5, 85, O2/air
S235, 10, 1.9, 1500, 0.9, 85, O2/air
S235, 10, 2.1, 1900, 0.8, 130, O2/air
"""
ROWS = "- {material: S235, thickness: 6 mm, kerf: 1.5 mm, feed: 2500 mm/min}\n"
MATERIALS = """\
[MATERIAL_NUMBER_1]
NAME          = S235 6mm
KERF_WIDTH    = 1.5
PIERCE_HEIGHT = 3.8
PIERCE_DELAY  = 0.5
CUT_HEIGHT    = 1.5
CUT_SPEED     = 2500
"""
PROFILE = "material:\n  chart: FILE\n  name: S235\n  thickness: 6 mm\n"


@pytest.fixture(autouse=True)
def there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def answered(ended: Ended, place: str, words: str) -> None:
    """One message, with its place; nothing on standard output."""
    assert (ended.code, ended.out) == (2, "")
    message, *details = ended.err.rstrip("\n").split("\n")
    assert re.match(rf"kerfwise: {place}:\d*:? ?", message), ended.err
    assert re.search(words, message), message
    assert all(detail.startswith("  - ") for detail in details)


def test_the_files_are_sound_before_they_are_broken() -> None:
    for file, text in (("c.csv", CHART), ("c.yaml", ROWS)):
        Path(file).write_text(text)
        Path("p.yaml").write_text(PROFILE.replace("FILE", file))
        assert kerfwise("profile", "check", "p.yaml").code == 0
    Path("m_material.cfg").write_text(MATERIALS)
    Path("p.yaml").write_text(PROFILE.replace("FILE", "m_material.cfg") + "  row: S235 6mm\n")
    assert kerfwise("profile", "check", "p.yaml").code == 0


@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        ("kerf [mm]", "kerv [mm]", r"c\.csv:1", "unknown column 'kerv': did you mean 'kerf'"),
        ("kerf [mm]", "kerf [um]", r"c\.csv:1", "kerf: unknown unit 'um', expected one of mm, cm, m, in"),
        ("kerf [mm]", "kerf", r"c\.csv:2", "'1.5' has no unit: write kerf \\[mm\\] at the head"),
        ("1.9, 1500", "1.9 in, 1500", r"c\.csv:3", "'1.9 in' stands in a column of mm: give one unit"),
        ("kerf [mm]", "kerf [cm]", r"c\.csv:4", "is not likely, expected .*: did you mean 2.1 mm"),
        ("2500", "2500 mm", r"c\.csv:2", "stands in a column of mm/min"),
        ("feed [mm/min]", "feed [m/s]", r"c\.csv:2", "feed: .* is not likely, expected .*: did you mean 2500 mm/min"),
        ("0.5, 85", "500, 85", r"c\.csv:2", "pierce_delay: 500 s is not likely"),
        ("85, O2/air\nS235, 10, 1.9", "85, O2/air\nS235, ten, 1.9", r"c\.csv:3", "thickness: expected a length over 0"),
        ("1.5, 2500", "-1.5, 2500", r"c\.csv:2", "kerf: expected a length of at least 0"),
        ("85, O2/air\n", "85, O2/air, 7\n", r"c\.csv:2", "the row has 8 cells, the head 7 columns"),
        ("pierce_delay [s]", "kerf [mm]", r"c\.csv:1", "the column kerf is there twice"),
        ("S235, 6", '"S235, 6', r"c\.csv:2", 'a " that nothing closes'),
        ("S235, 6, ", "S235, 7, ", r"p\.yaml:4", r"c\.csv has no row of S235 at 6 mm: near are 7 mm \(line 2\), 10 mm"),
        ("S235, 6", "S355, 6", r"p\.yaml:4", "no row of S235 at 6 mm"),
        ("S235, 10, 1.9", "S235, 6, 1.9", r"p\.yaml:4", r"2 rows with material S235, thickness 6 mm \(lines 2, 3\)"),
        (CHART, "", r"c\.csv:1", "the material chart has no rows"),
    ],
)
def test_broken_charts(old: str, new: str, place: str, words: str) -> None:
    assert old in CHART
    Path("c.csv").write_text(CHART.replace(old, new, 1))
    Path("p.yaml").write_text(PROFILE.replace("FILE", "c.csv"))
    answered(kerfwise("profile", "check", "p.yaml"), place, words)


@pytest.mark.parametrize(
    ("file", "text", "old", "new", "place", "words"),
    [
        ("c.yaml", ROWS, "kerf:", "kerv:", r"c\.yaml:1", "unknown column 'kerv': did you mean 'kerf'"),
        ("c.yaml", ROWS, "2500 mm/min", "2500 mm", r"c\.yaml:1", "feed: unknown unit 'mm'"),
        ("c.yaml", ROWS, "1.5 mm", "1,5", r"c\.yaml:1", "unknown column '5'|decimals are written with a point"),
        ("c.yaml", ROWS, "- {", "rows: {", r"c\.yaml:1", "a material chart: expected a list"),
        ("c.yaml", ROWS, "}", "", r"c\.yaml:2", "not YAML"),
        ("m.cfg", MATERIALS, "CUT_SPEED", "CUT_SPED", r"m\.cfg:7", "unknown key 'CUT_SPED': did you mean 'CUT_SPEED'"),
        ("m.cfg", MATERIALS, "= 1.5\nPIERCE", "= 0.06\nPIERCE", r"m\.cfg:3", "say material.chart_units: inch"),
        ("m.cfg", MATERIALS, "= 3.8", "= high", r"m\.cfg:4", "PIERCE_HEIGHT: expected a length"),
        ("m.cfg", MATERIALS, "[MATERIAL_NUMBER_1]", "[MATERIAL_1]", r"m\.cfg:1", "expected a section such as"),
        ("m.cfg", MATERIALS, "CUT_SPEED     = 2500\n", "", r"m\.cfg:1", "material number 1 lacks CUT_SPEED"),
        ("m.cfg", MATERIALS, "NAME          =", "NAME", r"m\.cfg:2", "expected a key and its value"),
    ],
)
def test_broken_charts_of_other_kinds(file: str, text: str, old: str, new: str, place: str, words: str) -> None:
    assert old in text
    Path(file).write_text(text.replace(old, new, 1))
    Path("p.yaml").write_text(PROFILE.replace("FILE", file) + ("  row: S235 6mm\n" if file == "m.cfg" else ""))
    answered(kerfwise("profile", "check", "p.yaml"), place, words)


@pytest.mark.parametrize(
    ("given", "place", "words"),
    [
        ("chart: gone.csv", r"p\.yaml:1", "cannot read the material chart: No such file"),
        ("chart: c.xls", r"p\.yaml:1", r"a material chart is a \.csv"),
        ("row: S235", r"p\.yaml:1", "material.row: there is no chart"),
        ("interpolate: true", r"p\.yaml:1", "material.interpolate: there is no chart"),
        ("chart: c.csv, row: {thicknes: 6 mm}", r"p\.yaml:1", "unknown column 'thicknes': did you mean 'thickness'"),
        ("chart: c.csv, thickness: 8 mm", r"p\.yaml:1", "near are 6 mm .*; say interpolate: true"),
        ("chart: c.csv, thickness: 40 mm, interpolate: true", r"p\.yaml:1", "beyond its ends a chart says nothing"),
        ("chart: c.csv, row: {thickness: 10 mm, amps: 85}, thickness: 6 mm", r"p\.yaml:1", "the row 'S235, 10 mm' of"),
        ("power: 120 %", r"p\.yaml:1", "material.power: expected a share of full power"),
    ],
)
def test_broken_references(given: str, place: str, words: str) -> None:
    Path("c.csv").write_text(CHART)
    Path("c.xls").write_text(CHART)
    Path("p.yaml").write_text(f"material: {{{given}}}\n")
    answered(kerfwise("profile", "check", "p.yaml"), place, words)


@pytest.mark.parametrize(
    ("name", "old", "new", "words"),
    [
        ("eia", "torch_on: M07", "torch_on: M7 7", "torch_on: 'M7 7' cannot be read"),
        ("eia", "torch_off: M08", "torch_off: M09", "torch_off: 'M09' does not stop|starts what marks|torch_off"),
        ("eia", "arc_cw: G02", "arc_cw: G03", "arc_cw: 'G03' makes"),
        (
            "eia",
            "dwell: G04 X{seconds}",
            "dwell: G04 X{milliseconds}",
            "dwell: a wait of 1.5 s is read as one of 1500 s",
        ),
        ("eia", "dwell: G04 X{seconds}", "dwell: G04 P{seconds}", "dwell: 'G04 P1.5' cannot be read"),
        ("grbl", "M4 S{power}", "M4 S{powers}", "torch_on: expected a line of text, with no braces but"),
        ("grbl", "decimals: 4", "decimals: 0", "decimals: they make steps of 1 mm; expected 0.1 mm or less"),
        ("burny", "arc_centre: absolute", "arc_centre: relative", "arc_ccw|arc_cw"),
        ("burny", "  - G71", "  - G70", "header: it leaves the control in inches"),
        ("essi", 'line: "{x}{y}"', 'line: "{y}{x}"', "line: a path of"),
        ("essi", "scale: 10", "scale: 100", "footer|line|rapid|torch_on|read as"),
        ("essi", '  - "81"\n', "", "header: .*how it counts"),
        ("essi", "signed: true", "signed: maybe", "signed: expected true or false, got 'maybe'"),
        ("essi", 'footer:\n  - "0"', 'footer:\n  - "1"', "the program has no end"),
        ("linuxcnc", "pierce_dwell: program", "pierce_dwell: nobody", "pierce_dwell: expected one of machine, program"),
        ("linuxcnc", "suffix: .ngc", "sufix: .ngc", "unknown key 'sufix': did you mean 'suffix'"),
        ("linuxcnc", "max_line: 250", "max_line: 12", "max_line: expected a whole number from 80 to 252"),
    ],
)
def test_broken_dialects(name: str, old: str, new: str, words: str) -> None:
    text = kerfwise("dialects", "show", name).out
    assert old in text
    Path("d.yaml").write_text(text.replace(old, new, 1))
    process = "laser" if name == "grbl" else "plasma"
    Path("p.yaml").write_text(f"machine: {{process: {process}, dialect: d.yaml}}\n")
    answered(kerfwise("profile", "check", "p.yaml"), r"d\.yaml", words)


@cache
def programs() -> dict[str, tuple[str, str]]:
    """Name of a dialect → program and plan of the nest."""
    made = {}
    for name in ("linuxcnc-qtplasmac", "grbl", "eia", "burny", "essi"):
        Path("n.json").write_text(json.dumps(NEST))
        Path("p.yaml").write_text(profile_of(name))
        solved = kerfwise("solve", "n.json", "-p", "p.yaml", "--work", 1, "-o", "n.nc", "--plan", "n.plan.json")
        assert solved.code == 0, solved.err
        made[name] = Path("n.nc").read_text(), Path("n.plan.json").read_text()
    return made


def profile_of(name: str) -> str:
    return f"machine: {{process: {'laser' if name == 'grbl' else 'plasma'}, dialect: {name}}}\n"


Breaks = Callable[[str], str]


@pytest.mark.scrap("of two programs, the one that counts in tenths leaves a burr that the simulation sees")
@pytest.mark.parametrize(
    ("name", "breaks", "words"),
    [
        ("linuxcnc-qtplasmac", lambda text: text.replace("G90 G17", "G90 G18", 1), "G18 is not supported here"),
        ("linuxcnc-qtplasmac", lambda text: text.replace("M2\n", "", 1), "the program has no end"),
        ("linuxcnc-qtplasmac", lambda text: text.replace(" F2500", "", 1), "a line or an arc with no feed"),
        (
            "linuxcnc-qtplasmac",
            lambda text: re.sub(r" J-?[\d.]+", "", text, count=1),
            "the arc's radius|the arc ends so",
        ),
        ("linuxcnc-qtplasmac", lambda text: text.replace("G0 X", "G0 X1 X", 1), "two X words in one block"),
        ("grbl", lambda text: text.replace("G21", "G21 G41", 1), "G41 is not supported here"),
        ("grbl", lambda text: text.replace("G0 X", "G0 Z5 X", 1), "Z5.*the machine keeps its height"),
        ("grbl", lambda text: text.replace("M3 S", "M3 $0 S", 1), r"\$"),
        ("eia", lambda text: text.replace(" M07\n", " M7.5\n", 1), "M7.5 spelt so is not supported"),
        ("eia", lambda text: text.replace("G40", "G42", 1), "the control would shift the path"),
        ("burny", lambda text: text.replace("G71", "(HELLO)\nG71", 1), "a comment, which Burny does not know"),
        ("burny", lambda text: text.replace("M04", "M05", 1), "M05 is not understood"),
        ("essi", lambda text: text.replace("53\n", "53 54\n", 1), "5354 is not understood|cannot read"),
        ("essi", lambda text: text.replace("38\n", "29\n", 1), "29 is not supported here"),
        ("essi", lambda text: re.sub(r"39\+\d+\n", "", text), "a line or an arc with no feed"),
        ("essi", lambda text: text.removesuffix("0\n"), "the program has no end"),
    ],
)
def test_broken_programs(name: str, breaks: Breaks, words: str) -> None:
    text, plan = programs()[name]
    broken = breaks(text)
    assert broken != text
    for file, content in (
        ("n.json", json.dumps(NEST)),
        ("p.yaml", profile_of(name)),
        ("b.nc", broken),
        ("b.json", plan),
    ):
        Path(file).write_text(content)
    answered(kerfwise("check", "n.json", "b.nc", "-p", "p.yaml", "--plan", "b.json"), r"b\.nc", words)


def test_there_are_thirty_broken_programs_and_dialects_and_more() -> None:
    counted = sum(_cases(test) for test in (test_broken_dialects, test_broken_programs))
    assert counted >= 30
    assert counted + sum(map(_cases, (test_broken_charts, test_broken_charts_of_other_kinds))) + len(REFUSED) >= 80


def _cases(test: Callable[..., None]) -> int:
    """How many cases a test is given."""
    return sum(len(mark.args[1]) for mark in test.pytestmark if mark.name == "parametrize")  # type: ignore[attr-defined]
