"""A control that nobody has built, with a dozen quirks: its dialect is written from its description, without Python.

The two pages that its maker would hand out:

    UMBRA 7 cutting control. A program is text with line ends CR LF. Its first row is %, its second `:` and the number
    of the program, four digits; the last is M99. Comments are rows that begin with a star. Blocks have numbers N5,
    N10 …; behind N995 they start again. There are no blanks between words, and a block has at most 90 characters.

    Lengths are millimetres with three decimals, zeros included, and a comma. There is no word for that, nor for the
    plane, nor for how it counts: places count from zero always. A word that is in force need not be said again, motion
    words and feeds among them. F is in metres a minute. G4 K waits, in milliseconds. G2 and G3 give the radius by CR=,
    and turn a third of a circle at most.

    M70 opens the plasma, M71 closes it. Before M70 the gas must flow (M60 Q, litres), and behind M71 the head needs
    0,3 s to lift. M72 and M73 are the scribe's. Small holes want M61 before them and M62 behind. Words of the cut chart
    (T, with a number) come at the top.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
import yaml

from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.tools import canon

DIALECT = """\
name: umbra
title: Umbra 7
control: eia
processes: [plasma]
assumes: {}
suffix: .umb
newline: crlf
header: ["%", ":{program}", "T{process}"]
program: {number: 42, digits: 4}
footer: M99
torch_on: [M60 Q35, M70, "{dwell}"]
torch_off: [M71, "G4 K300"]
mark_on: M72
mark_off: M73
around: {small_hole: {before: M61, after: M62}}
rapid: G0
line: G1
arc_cw: G2X{x}Y{y}CR={r}
arc_ccw: G3X{x}Y{y}CR={r}
arc_centre: radius
greatest_sweep_deg: 120
feed: F{m_min}
feed_decimals: 4
dwell: G4 K{milliseconds}
pierce_dwell: program
comment: "* {text}"
line_numbers: {start: 5, step: 5, highest: 995}
modal: [motion, feed]
blanks: false
decimals: 3
trailing_zeros: true
decimal: ","
max_line: 90
also:
  - {words: "T{n}", where: header}
  - {words: "M60 Q{n}", where: off}
  - {words: M61, where: off}
  - {words: M62, where: off}
reads:
  title: Umbra 7
  means: {M70: M07, M71: M08, M72: M09, M73: M10, CR=: R, M99: M02}
  fixed: [G21, G90, G40]
  dwell: {letter: K, unit: ms}
  feed: m_min
  longest: 90
"""
PROFILE = """\
based_on: plasma-carbon-steel
machine: {dialect: umbra.yaml, pierce_time: 700 ms}
material: {process: 118}
small_holes: {full_feed_hole: 60 mm, small_hole_feed: 0.6}
"""
MARK = [[40, 40], [60, 40]]
HOLE = [[90, 75, 1], [60, 75, 1]]
NEST = {
    "format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": 400, "height": 200},
    "parts": [
        {"id": "A", "outer": [[30, 30], [150, 30], [150, 120], [30, 120]], "holes": [HOLE], "marks": [MARK]},
        {"id": "B", "outer": [[200, 30], [320, 30, 0.2], [320, 120], [200, 120]]},
    ],
}  # fmt: skip


def in_linuxcnc(text: str) -> str:
    """The program by its maker's two pages, in words of LinuxCNC."""
    made, motion = ["G21 G90 G17 G40 G91.1"], ""
    for row in text.split("\r\n"):
        row = re.sub(r"^N\d+", "", re.sub(r"^\*.*", "", row)).replace(",", ".")
        row = re.sub(r"F([\d.]+)", lambda m: f" F{float(m[1]) * 1000:g}", row).replace("CR=", "R")
        if found := re.match(r"G4K(\d+)", row):
            row = f"G4 P{int(found[1]) / 1000}"
        elif found := re.match(r"G[0-3](?=X)", row):
            motion = found[0]
        elif row.startswith("X"):
            row = motion + row
        words = {"M70": "M3 $0 S1", "M71": "M5 $0", "M72": "M3 $1 S1", "M73": "M5 $1", "M99": "M2"}
        made.append(words.get(row, "" if re.match(r"[%:T]|M6[012]", row) else row))
    return "\n".join([*made, ""])


@pytest.fixture(autouse=True)
def described(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("umbra.yaml").write_text(DIALECT)
    Path("plant.yaml").write_text(PROFILE)
    Path("nest.json").write_text(json.dumps(NEST))


@pytest.mark.linuxcnc
@pytest.mark.scrap("the simulation of the metal reads words of LinuxCNC only")
def test_it_is_planned_read_back_and_checked() -> None:
    assert kerfwise("profile", "check", "plant.yaml").code == 0
    made = kerfwise("solve", "nest.json", "-p", "plant.yaml", "-o", "a.umb", "--plan", "a.json", "--work", 1)
    assert made.code == 0, made.err
    text = Path("a.umb").read_bytes().decode()
    assert text.startswith("%\r\n:0042\r\n* KERFWISE FOR UMBRA 7\r\n")
    blocks = [re.sub(r"^N\d+", "", row) for row in text.split("\r\n") if row and row[0] != "*"]
    assert "T118" in blocks[2]
    assert blocks[-2] == "G0X0,000Y0,000"
    assert blocks[-1] == "M99"
    assert (blocks.count("M61"), blocks.count("M62"), blocks.count("M60Q35")) == (1, 1, 3)
    assert "G4K700" in blocks
    assert any(re.fullmatch(r"G1X\S+F2,5000", block) for block in blocks)
    assert not any(" " in block or len(block) > 90 for block in blocks)
    checked = kerfwise("check", "nest.json", "a.umb", "-p", "plant.yaml", "--plan", "a.json")
    assert checked.code == 0, checked.out
    theirs = canon.run(in_linuxcnc(text))
    totals = json.loads(Path("a.json").read_text())["totals"]
    assert (theirs.error, len(theirs.cuts), len(theirs.marks)) == (None, 3, 1)
    assert sum(burn.length_mm for burn in theirs.cuts) == pytest.approx(
        totals["cut_mm"] - sum(burn.length_mm for burn in theirs.marks), abs=0.1
    )
    assert theirs.idle_mm == pytest.approx(totals["idle_mm"], abs=0.1)


QUIRKS = {
    "torch_on": ("M08", "torch_on"),
    "torch_off": ("M72", "torch_off"),
    "dwell": ("G4 X{seconds}", "dwell"),
    "feed": ("F{mm_min}", "feed"),
    "decimal": (".", ""),
    "arc_cw": ("G3X{x}Y{y}CR={r}", "arc_cw"),
    "comment": ("({text})", ""),
    "mark_on": ("M70", "mark_on"),
    "footer": ("M98", "footer"),
    "header": (["G20", "T{process}"], "header"),
    "also": ([{"words": "T{n}"}], "torch_on"),
    "decimals": (0, ""),
}


@pytest.mark.parametrize("key", QUIRKS)
def test_a_quirk_that_is_got_wrong_is_told_or_harmless(key: str) -> None:
    value, told = QUIRKS[key]
    dialect = yaml.safe_load(DIALECT) | {key: value}
    Path("umbra.yaml").write_text(yaml.safe_dump(dialect, sort_keys=False))
    ended = kerfwise("profile", "check", "plant.yaml")
    assert ended.code == (2 if told else ended.code)
    assert told in ended.err
    if key == "decimal":  # points are read as commas are
        assert ended.code == 0
