"""Where a path is cut more slowly: its corners, as many as there are, and no further than the law says."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.torch_path import CRUMB_MM, CornerFeed, chords, paced, with_corner_times
from kerfwise.rules.case import circle, nest, part, rect

LAW = CornerFeed(0.5, 45.0, 3.0)


def slow_mm(path: Curve, law: CornerFeed = LAW) -> float:
    return sum(segment.length_mm for segment, share in law.stretches(path) if share < 1)


def test_a_closed_ring_is_slow_at_every_corner_the_first_among_them() -> None:
    ring = Curve.of([(0, 0), (40, 0), (40, 30), (0, 30)])
    assert slow_mm(ring) == pytest.approx(4 * 6)
    assert LAW.more_mm(ring) == pytest.approx(24)


def test_an_open_path_is_slow_at_no_end() -> None:
    assert slow_mm(Curve.of([(0, 0), (40, 0), (40, 30), (0, 30)], closed=False)) == pytest.approx(12)


def test_circles_smooth_joints_and_small_turns_are_no_corners() -> None:
    smooth = Curve.of([(0, 0), (20, 0, math.tan(math.pi / 8)), (30, 10), (30, 40)], closed=False)
    assert slow_mm(smooth) == slow_mm(Curve.of([(-10, 0, 1), (10, 0, 1)])) == 0
    turn = [(0, 0), (20, 0), (20 + 20 * math.cos(math.radians(44)), 20 * math.sin(math.radians(44)))]
    assert slow_mm(Curve.of(turn, closed=False)) == 0


def test_corners_nearer_than_the_reach_make_one_stretch() -> None:
    path = Curve.of([(0, 0), (20, 0), (20, 4), (40, 4)], closed=False)
    assert [share for _, share in LAW.stretches(path)] == [1.0, 0.5, 0.5, 0.5, 1.0]
    assert slow_mm(path) == pytest.approx(3 + 4 + 3)


def test_specks_that_rounding_leaves_make_no_corner() -> None:
    path = Curve.of([(0, 0), (20, 0), (20, 0.004), (40, 0.004)], closed=False)
    assert slow_mm(path) == 0


@given(st.lists(st.tuples(st.integers(-40, 40), st.integers(-40, 40)), min_size=3, max_size=7, unique=True))
def test_the_stretches_are_the_path(points: list[tuple[int, int]]) -> None:
    path = Curve.of(points, closed=False)
    pieces = LAW.stretches(path)
    assert sum(segment.length_mm for segment, _ in pieces) == pytest.approx(path.length_mm)
    assert all(one.end == pytest.approx(other.start) for (one, _), (other, _) in pairwise(pieces))
    corners = LAW.corners_mm(path)
    assert slow_mm(path) <= 2 * LAW.reach_mm * len(corners) + 1e-9 + 2 * CRUMB_MM * len(path.segments)
    flat, slowness = chords(path, pieces, 0.01)
    assert slowness is None or len(slowness) == len(flat) - 1


def test_without_a_law_a_path_is_one_feed() -> None:
    path = Curve.of([(0, 0), (20, 0), (20, 20)], closed=False)
    assert [share for _, share in paced(path, None)] == [1.0, 1.0]


def test_contours_know_what_their_corners_take_but_for_the_one_they_may_be_entered_at() -> None:
    plate = nest(300, 200, part("A", rect(20, 20, 100, 100), [circle(70, 70, 20)]))
    made = with_corner_times(plate, LAW, 0.0)
    assert (made.contour("A.outer").corner_mm, made.contour("A.hole1").corner_mm) == (18.0, 0.0)
    assert made.drawn is plate
