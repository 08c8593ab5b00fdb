"""Hand-computed programs: what rs274 prints is read the right way."""

import math

import pytest

from kerfwise.tests.tools import canon

pytestmark = pytest.mark.linuxcnc


def accepted(program: str) -> canon.Run:
    run = canon.run(program)
    assert run.error is None
    return run


def test_square() -> None:
    run = accepted("G21 G90\nG0 X10 Y10\nM3 $0 S1\nF1000\nG1 X110\nY60\nX10\nY10\nM5 $0\nG0 X0 Y0\nM2\n")
    (cut,) = run.cuts
    assert cut.pierce == cut.points[-1] == (10, 10)
    assert cut.length_mm == 300
    assert cut.feeds_mm_min == [1000]
    assert run.idle_mm == pytest.approx(20 * math.sqrt(2))
    assert (run.ended, run.warnings) == ("M2", [])


def test_arcs_of_both_directions_and_full_circles() -> None:
    (cut,) = accepted(
        "G21 F600\nG0 X0 Y0\nM3 $0 S1\nG3 X10 Y10 I0 J10\nG2 X20 Y20 I10 J0\nG3 X20 Y20 I-10 J0\nG2 I5\nM5 $0\nM30\n"
    ).cuts
    assert cut.sweeps_rad == pytest.approx([math.pi / 2, -math.pi / 2, 2 * math.pi, -2 * math.pi])
    assert cut.length_mm == pytest.approx(math.pi * 40)


def test_major_arc_and_inches() -> None:
    (cut,) = accepted("G20 G91\nF20\nG0 X1 Y0\nM3 $0 S1\nG3 X-1 Y-1 I-1 J0\nM5 $0\nM2\n").cuts
    assert cut.length_mm == pytest.approx(1.5 * math.pi * 25.4, abs=0.01)
    assert cut.feeds_mm_min == [pytest.approx(508)]
    assert max(y for _, y in cut.points) == pytest.approx(25.4, abs=0.02)


def test_marks_are_not_cuts_and_dwell_counts() -> None:
    run = accepted("G21 F100\nG0 X5 Y5\nM3 $1 S1\nG1 X15\nM5 $1\nM3 $0 S1\nG4 P0.5\nG1 X35\nM5 $-1\nM2\n")
    assert [b.length_mm for b in run.marks] == [10]
    assert [b.length_mm for b in run.cuts] == [20]
    assert run.dwell_s == 0.5


def test_a_torch_left_on_is_seen_though_the_end_of_program_stops_it() -> None:
    run = accepted("G21 F100\nM3 $0 S1\nG1 X10\nG0 X20\nM2\n")
    assert run.warnings == ["rapid with the torch on, 10.000 mm", "program ends with the torch on"]


@pytest.mark.parametrize(
    ("program", "message"),
    [
        ("G21 F1\nG2 X10 Y0 I4.9 J0\nM2\n", "Radius to end of arc differs"),
        ("G21 F1\nG1 X1\n", "no percent sign or program end"),
        ("G21\nG1 X1\nM2\n", "zero feed rate"),
        ("M190 P1\nM2\n", "Unknown m code used: M190"),
        (f"({'x' * 260})\nM2\n", "Command too long"),
    ],
)
def test_refusals(program: str, message: str) -> None:
    assert message in (canon.run(program).error or "")
