"""ESSI: the published samples as known figures, what would cut wrong silently, and no error that adds up."""

from __future__ import annotations

import dataclasses
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.postproc.check.reader.controls import CONTROLS, Setup
from kerfwise.postproc.check.reader.program import NcProgram
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.postproc.check.torch_run import in_steps_of, tolerance_mm
from kerfwise.postproc.dialects import Dialect, load_dialect
from kerfwise.postproc.nc.gcode import GcodeWriter
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.tests.postproc.dialects import reading
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile

HEAD = "71\n81\n38\n5\n"
SQUARE = "++1000\n+1000+\n+-1000\n-1000+"
"""Thermal Dynamics 0-5399, p. 5-41: a square of 100 mm."""


def essi(body: str, control: str = "essi") -> NcProgram:
    return read_nc(f"{HEAD}{body}\n0\n", control=CONTROLS[control])


def cut(moves: str, control: str = "essi") -> Curve:
    (burn,) = essi(f"+50+50\n6\n53\n39+600\n{moves}\n54\n5", control).burns
    return burn.path


def test_the_published_square() -> None:
    path = cut(SQUARE)
    assert path.length_mm == pytest.approx(400)
    assert path.end == path.start


def test_the_published_hook_bulges_upward_going_right() -> None:
    """Plasmatic's Precision Layout: the arc of the sample is clockwise, and its picture shows it above its chord."""
    path = cut("+1200+200+640-+", "essi-radius")
    half = math.hypot(120, 20) / 2
    assert path.length_mm == pytest.approx(2 * 64 * math.asin(half / 64))
    x, y = path.point_at(path.length_mm / 2)
    assert y - 5 > 10 + (x - 5) / 6


def test_the_published_circle_of_two_halves_closes() -> None:
    path = cut("++600+300+-\n+-600+300+-", "essi-radius")
    assert path.length_mm == pytest.approx(2 * math.pi * 30)
    assert math.dist(path.vertices[0, :2], path.vertices[-1, :2]) < 1e-9


def test_the_long_way_round() -> None:
    short, long = (cut(f"+400++400{way}+", "essi-radius").length_mm for way in "-+")
    assert short + long == pytest.approx(2 * math.pi * 40)


def test_the_same_digits_turn_opposite_ways_on_the_two_controls() -> None:
    by_centre, by_radius = cut("+1000+0+500++"), cut("+1000+0+500++", "essi-radius")
    assert by_centre.length_mm == pytest.approx(by_radius.length_mm)
    assert by_centre.point_at(50)[1] < 5 < by_radius.point_at(50)[1]


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("6\n29\n53\n39+600\n+1000+\n54", r"6: 29 is not supported here: the control would shift the path by its own"),
        ("40+15", r"5: 40 is not supported here: the control would shift the path"),
        ("70", "5: 70 is not supported here: inches"),
        ("82", "5: 82 is not supported here: moves that count from the origin"),
        ("83", "5: 83 is not supported here: it moves the origin"),
        ("+7", "5: a move of 1 numbers: expected 2 for a line, 5 for an arc"),
        ("6\n53\n39+600\n+10+10+5+5+5", r"an arc that ends in \+5: expected a sign alone"),
        ("+100-", None),
        ("+100+200+300", "5: a move of 3 numbers: expected 2 for a line, 5 for an arc"),
        ("+1000.5+10", r"cannot read '\+1000\.5\+10'"),
        ("X10Y10", "cannot read 'X10Y10'"),
        ("53+5", r"53\+5 is not understood"),
        ("77", "77 is not understood"),
        ("39", r"39 without a value: expected such as 39\+2500"),
        ("39+99999999", "a feed of 99999999 mm/min is not supported"),
        ("41+99999999", "a wait of 99999999 ms"),
        ("6\n53\n+100+\n54", "a line or an arc with no feed"),
        ("3\nunclosed", "5: the comment is not closed"),
        ("6\n53\n39+600\n+1000+1000+100+100+\n54", "the arc's radius is"),
        ("6\n53\n39+600\n+1000+1000+100-+\n54", "the arc's radius is|no radius"),
        ("64\n+10+10", "words behind the program's end"),
        ("0\n+10+10", "words behind the program's end"),
        ("6\n53\n39+600\n+100+\n8", "8 does not stop what 53 has started"),
        ("6\n9\n39+600\n+100+\n14", "14 does not stop what 9 has started"),
        ("6\n53\n39+600\n+100+\n54\n7\n+100+\n8", "7 where 53 has started before"),
    ],
)
def test_what_is_not_understood_is_refused_with_its_line(body: str, said: str | None) -> None:
    if said is None:
        assert essi(body).end == (10.0, 0.0)
        return
    with pytest.raises(InputError, match=said) as caught:
        essi(body)
    assert caught.value.line is not None


def test_a_program_without_its_end() -> None:
    with pytest.raises(InputError, match="no end: expected 0, 63, 64, 90 or 99"):
        read_nc("71\n81\n+10+10\n", control=CONTROLS["essi"])


@pytest.mark.parametrize(
    ("body", "rule"),
    [
        ("6\n53\n39+600\n+100+\n5\n+50+50\n54", None),  # a rapid with the torch on
        ("6\n53\n39+600\n+100+\n0\n54", "torch-off-travel"),
        ("6\n53\n39+600\n48\n+100+\n54\n53\n+100+\n54", "program-state"),
        ("6\n53\n39+600\n+100+", "torch-off-travel"),
        ("6\n53\n53\n39+600\n+100+\n54", "torch-off-travel"),
    ],
)
def test_a_torch_left_on_is_told(body: str, rule: str | None) -> None:
    program = read_nc(f"{HEAD}{body}\n64\n", control=CONTROLS["essi"])
    assert program.hot_rapids if rule is None else [fault.rule for fault in program.faults] == [rule]


def test_moves_before_units_and_counting_are_told() -> None:
    (fault,) = read_nc("5\n+10+10\n0\n", control=CONTROLS["essi"]).faults
    assert (fault.rule, fault.line) == ("program-state", 2)


def test_travel_with_the_rapid_off_is_slow() -> None:
    assert [s.length_mm for s in essi("39+600\n6\n+100+").slow_travel] == [10.0]


def test_comments_and_heights_change_nothing() -> None:
    assert cut("3\nG1 X5\n+9+9\n4\n47\n+100+\n48").length_mm == 10.0
    assert essi("6\n53\n39+600\n67\n+100+\n54\n68\n53\n+100+\n54").faults == ()


points = st.lists(st.tuples(st.floats(0, 500), st.floats(0, 500)), min_size=2, max_size=60)


@given(points, st.tuples(st.floats(-50, 50), st.floats(-50, 50)))
def test_no_rounding_adds_up(path: list[tuple[float, float]], home: tuple[float, float]) -> None:
    pen = GcodeWriter(load_dialect("essi"), home)
    blocks = [pen.rapid(point) for point in path] + [pen.rapid(home)]
    program = read_nc("\n".join(["71", "81", "5", *blocks, "0", ""]), setup=Setup(home=home), control=CONTROLS["essi"])
    for (x, y), (_, at) in zip(path, program.rapids, strict=False):
        assert math.dist((x, y), at) <= 0.05 * math.sqrt(2) + 1e-9
    assert program.end == pytest.approx(home, abs=1e-9)


def spelt(**changes: object) -> Dialect:
    return dataclasses.replace(load_dialect("essi"), **changes)  # type: ignore[arg-type]


BY_RADIUS = {
    "control": "essi-radius", "arc_centre": "radius", "arc_cw": "{x}{y}{r}-+", "arc_ccw": "{x}{y}{r}--"
}  # fmt: skip


@pytest.mark.parametrize("changes", [{}, {"arc_centre": "relative"}, BY_RADIUS], ids=["chords", "centres", "radii"])
def test_every_way_to_tell_arcs_is_within_a_step_of_the_plan(changes: dict[str, object]) -> None:
    from kerfwise.postproc.nc.program import write_program
    from kerfwise.tests.tools.outside.heard import Heard

    plant, nest = reading.with_dialect(profile(), "essi"), plate()
    plan = plan_of(nest, good_cuts(nest), plant)
    dialect = spelt(**changes)
    program = read_nc(write_program(plan, nest, plant, dialect), control=CONTROLS[dialect.control])
    assert program.faults == program.hot_rapids == program.slow_travel == ()
    flat = [[(x, y) for x, y in burn.path.flatten(0.0005).tolist()] for burn in program.burns]
    heard = Heard(flat, [burn.path.length_mm for burn in program.burns], program.idle_mm)
    assert reading.differences(plan, nest, plant, heard).within(0.1, length_mm=2.0)


def test_paths_are_judged_by_the_steps_of_the_control_and_no_more() -> None:
    from kerfwise.postproc.nc.program import write_program

    plant, nest = reading.with_dialect(profile(), "essi"), plate()
    plan = plan_of(nest, good_cuts(nest), plant)
    text = write_program(plan, nest, plant)
    verdict = check_program(nest, text, plant, plan=plan)
    assert verdict.ok, verdict
    assert "the control counts in steps of 0.1 mm: paths are judged within 0.1 mm" in verdict.warnings
    rows = text.split("\n")
    at = next(k for k, row in enumerate(rows) if row.startswith("39+")) + 2
    x, y = (int(one) for one in rows[at].replace("-", " -").replace("+", " ").split())
    damaged = "\n".join([*rows[:at], f"{x + 3:+d}{y:+d}", *rows[at + 1 :]])  # all that follows lies 0.3 mm beside
    assert not check_program(nest, damaged, plant, plan=plan).ok
    assert tolerance_mm(1.5) == 0.05
    with in_steps_of(0.0001):
        assert tolerance_mm(1.5) == 0.05
