"""The largest circle in a closed curve: exact for circles, within 0.001 mm for other shapes."""

from __future__ import annotations

import math

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.measures import largest_circle, middle_of, narrower_than, wider_than
from kerfwise.rules.case import circle, rect
from kerfwise.tests.tools.amount import examples


@pytest.mark.parametrize("pieces", [2, 3, 4, 7])
def test_a_circle_is_measured_exactly_whatever_arcs_it_is_drawn_with(pieces: int) -> None:
    bulge = math.tan(math.tau / pieces / 4)
    turns = [math.tau * k / pieces + 0.3 for k in range(pieces)]
    drawn = Curve.of([(70 + 2.5 * math.cos(a), 30 + 2.5 * math.sin(a), bulge) for a in turns])
    (x, y), across_mm = largest_circle(drawn)
    assert (x, y, across_mm) == pytest.approx((70, 30, 5), abs=1e-6)


def test_a_slot_is_as_wide_as_its_sides_are_apart() -> None:
    slot = Curve.of([(0, 0), (40, 0, 1), (40, 5), (0, 5, 1)])
    assert largest_circle(slot)[1] == pytest.approx(5, abs=1e-3)
    assert middle_of(slot)[0] == pytest.approx((20, 2.5))


def test_the_middle_of_a_crescent_lies_outside_it() -> None:
    assert middle_of(Curve.of([(-20, 0, 1.0), (20, 0), (17, 0, -1.0), (-17, 0)]))[1] == 0


@examples(60)
@given(
    st.lists(st.tuples(st.floats(0, math.tau), st.floats(2, 20)), min_size=3, max_size=9, unique_by=lambda p: p[0]),
    st.floats(0.5, 20),
)
def test_it_agrees_with_a_finer_search_by_other_code(corners: list[tuple[float, float]], mm: float) -> None:
    points = [(r * math.cos(a), r * math.sin(a)) for a, r in sorted(corners)]
    area = shapely.Polygon(points)
    if not area.is_valid or area.area < 1:
        return
    curve = Curve.of(points)
    (x, y), across_mm = largest_circle(curve)
    other_mm = 2 * shapely.maximum_inscribed_circle(area, tolerance=1e-4).length
    assert across_mm == pytest.approx(other_mm, abs=2e-3)
    assert area.covers(shapely.Point(x, y))
    assert not wider_than(curve, mm) or across_mm > mm - 2e-3


def test_a_wide_hole_is_told_at_a_glance() -> None:
    assert wider_than(Curve.of(circle(0, 0, 5)), 10)
    assert not wider_than(Curve.of(rect(0, 0, 100, 9)), 10)


@examples(60)
@given(
    st.lists(st.tuples(st.floats(0, math.tau), st.floats(2, 20)), min_size=3, max_size=9, unique_by=lambda p: p[0]),
    st.floats(0.5, 20),
)
def test_what_is_surely_narrower_is(corners: list[tuple[float, float]], mm: float) -> None:
    ring = Curve.of([(r * math.cos(a), r * math.sin(a)) for a, r in sorted(corners)])
    if ring.polygon().is_valid and ring.polygon().area > 1 and narrower_than(ring, mm):
        assert largest_circle(ring)[1] < mm + 1e-3


def test_circles_slots_and_thin_frames_are_told_apart_from_wide_holes() -> None:
    holes = (circle(5, 5, 1.48), circle(5, 5, 1.5), rect(0, 0, 3, 3), rect(0, 0, 30, 2.9))
    assert [narrower_than(Curve.of(hole), 3.0) for hole in holes] == [True, False, False, True]
    assert not narrower_than(Curve.of(holes[-1]), 2.9)
