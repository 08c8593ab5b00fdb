"""The check's own reader: hand-made programs, and the same reading as LinuxCNC's interpreter gives."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.postproc.check.reader.controls import Setup
from kerfwise.postproc.check.reader.program import NcProgram, at_holes
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.tests.tools import canon
from kerfwise.tests.tools.amount import examples


def test_a_square_with_times() -> None:
    program = read_nc(
        "%\nN10 G21 G90\nG0 X30 Y40\n(CUT 1)\nM3 $0 S1\nG4 P0.5\nG1 X130 F600\nM5 $0\nG0 X0 Y0\n%\n(G1 X)\n",
        Setup(50.0),
    )
    (burn,) = program.burns
    assert (burn.tool, burn.line, burn.comment) == (0, 5, "CUT 1")
    assert (burn.start_s, burn.end_s) == (1.0, 11.5)
    assert burn.path.as_rows() == [[30, 40], [130, 40]]
    assert program.idle_mm == pytest.approx(50 + math.hypot(130, 40))


def test_modal_words_inches_and_incremental_arcs() -> None:
    inch = read_nc("G17\nG20 G91\nF20\ng0x1y0\nM3\nG3 X-1 Y1 I-1\nX-1Y-1J-1\nM5\nM30\n").burns[0]
    assert inch.path.length_mm == pytest.approx(math.pi * 25.4)
    assert inch.end_s - inch.start_s == pytest.approx(math.pi / 20 * 60)


def test_full_circles_radius_arcs_and_absolute_centres() -> None:
    burns = read_nc(
        "G21 F60\nG0 X10 Y0\nM3\nG2 I-10\nM5\nM3\nG3 X-10 Y0 R10\nM5\nM3\nG2 X0 Y-10 R-10\nM5\n"
        "G90.1\nM3\nG3 X10 Y0 I0 J0\nM5\nM2\n"
    ).burns
    assert [round(b.path.length_mm / math.pi, 9) for b in burns] == [20, 10, 15, 5]
    assert [round(sum(s.sweep_rad for s in b.path.segments) / math.pi, 9) for b in burns] == [-2, 1, -1.5, 0.5]


@pytest.mark.parametrize(("off_mm", "step_mm", "found"), [(0.04, 0, True), (0.09, 0, False), (0.09, 0.1, True)])
def test_a_cut_begins_at_a_hole_as_near_as_paths_are_judged(off_mm: float, step_mm: float, found: bool) -> None:
    """A control that counts in coarse steps puts both where it can; the rule on pierce passes allows the same."""
    text = f"G21 F600\nG0 X10\nM3\nG4 P0.5\nM5\nG0 X50\nG0 X{10 + off_mm}\nM3\nG1 X90\nM5\nM2\n"
    program = replace(read_nc(text), step_mm=step_mm)
    assert at_holes(program) == [False, found]


def torch_faults(program: NcProgram) -> list[tuple[int, str]]:
    return [(fault.line, fault.text) for fault in program.faults if fault.rule == "torch-off-travel"]


def test_a_torch_left_on_during_a_rapid_makes_two_burns() -> None:
    program = read_nc("G21 F600\nM3 $0\nG1 X10\nG0 X20\nM3 $0\nG1 X30\nM5 $0\nM2\n")
    assert [b.path.as_rows() for b in program.burns] == [[[0, 0], [10, 0]], [[20, 0], [30, 0]]]
    assert [(hot.line, hot.length_mm) for hot in program.hot_rapids] == [(4, 10)]
    assert torch_faults(program) == [(5, "tool $0 is started while $0 is on")]
    assert program.idle_mm == 0


def test_waits_feeds_and_slow_travel() -> None:
    program = read_nc("G21 F600\nG1 X5\nM3 $0 S1\nG4 P0.5\nG1 X10\nG4 P2\nG1 X20 F300\nM5 $0\nG4 P9\nM2\n")
    (burn,) = program.burns
    assert (burn.pierce_s, burn.paused_s, burn.feeds_mm_s) == (0.5, 2.0, (5.0, 10.0))
    assert [(slow.line, slow.length_mm) for slow in program.slow_travel] == [(2, 5.0)]
    assert program.end == (20.0, 0.0)


def test_a_torch_on_at_the_end_and_tools() -> None:
    program = read_nc("G21 F600\nM3 $1\nG1 X10\nM5 $-1\nM3 $0\nG1 X20\nM2\n")
    assert [b.tool for b in program.burns] == [1, 0]
    assert torch_faults(program) == [(7, "the program ends with the torch on")]


coordinate = st.integers(-2000, 2000).map(lambda v: v / 10)


@st.composite
def programs(draw: st.DrawFn) -> str:
    """Random moves with the torch on and off, lines and arcs, absolute and incremental, in mm and inches."""
    lines = [draw(st.sampled_from(["G21 G90", "G20 G90", "G21 G91"])), "F1000"]
    on = False
    for _ in range(draw(st.integers(1, 12))):
        word = draw(st.sampled_from(["rapid", "line", "arc", "circle", "torch", "mark"]))
        if word in ("torch", "mark"):
            tool = 0 if word == "torch" else 1
            lines += ["M5 $-1"] if on else [f"M3 ${tool} S1"]
            on = not on
        elif word == "rapid" and not on:
            lines.append(f"G0 X{draw(coordinate)} Y{draw(coordinate)}")
        elif word == "arc":
            # a quarter turn, whose end is known in incremental words
            r, turn = draw(st.integers(1, 500)) / 10, draw(st.sampled_from(["G2", "G3"]))
            sign = 1 if turn == "G3" else -1
            lines += ["G91", f"{turn} X{r} Y{sign * r} I0 J{sign * r}", lines[0].split()[1]]
        elif word == "circle":
            lines.append(f"{draw(st.sampled_from(['G2', 'G3']))} I{draw(st.integers(1, 500)) / 10}")
        else:
            lines.append(f"G1 X{draw(coordinate)} Y{draw(coordinate)}")
    return "\n".join(["G17", *lines, "M5 $-1", "M2", ""])


@pytest.mark.linuxcnc
@examples(25)
@given(programs())
def test_reads_as_linuxcnc_does(text: str) -> None:
    ours, theirs = read_nc(text), canon.run(text)
    assert theirs.error is None
    assert [b.tool for b in ours.burns] == [b.tool for b in theirs.burns]
    for mine, other in zip(ours.burns, theirs.burns, strict=True):
        assert mine.path.length_mm == pytest.approx(other.length_mm, abs=0.01, rel=1e-4)
        if mine.path.segments:
            line = mine.path.line(0.002)
            far = shapely.distance(line, shapely.points(np.array(other.points)))
            assert far.max() < 0.02
            back = shapely.distance(shapely.LineString(other.points), shapely.points(shapely.get_coordinates(line)))
            assert back.max() < 0.02
    idle = theirs.idle_mm + sum(math.dist(a, b) for a, b in theirs.dry_feeds if a != b)
    if "G2" not in text and "G3" not in text:
        assert ours.idle_mm == pytest.approx(idle, abs=0.01)
