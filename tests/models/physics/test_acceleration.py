"""Acceleration-limited motion: known answers by hand, a slow integration as the judge, and what must always hold."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Segment
from kerfwise.models.physics.motion import Accelerated, ConstantFeed, Feeds, corner_mm_s, trapezoid_s

FEEDS = Feeds(100.0, 50.0, 500.0, 0.5)
A = 1000.0


def line(*points: tuple[float, ...]) -> Curve:
    return Curve.of(points, closed=False)


def run_s(path: Curve, acceleration: float = A, deviation: float = 0.05) -> float:
    return Accelerated(FEEDS, acceleration, deviation).run_s(path, marks=False)


def integrated_s(path: Curve, feed: float = 100.0, steps: int = 40_000) -> float:
    """The same motion by small steps: the highest v(s) that respects every limit and dv²/ds ≤ 2 a both ways."""
    ends = np.cumsum([0.0, *(s.length_mm for s in path.segments)])
    s = np.linspace(0.0, ends[-1], steps + 1)
    of = np.clip(np.searchsorted(ends, s, side="right") - 1, 0, len(path.segments) - 1)
    limit = np.minimum(feed, np.sqrt(A * np.array([g.radius_mm for g in path.segments])[of]))
    for at, (before, after) in zip(ends[1:-1], pairwise(path.segments), strict=True):
        near = int(np.argmin(np.abs(s - at)))
        limit[near] = min(limit[near], limit[near - 1], corner_mm_s(before, after, A, 0.05))
    limit[0] = limit[-1] = 0.0
    squares, step = limit**2, s[1]
    for k in range(1, steps + 1):
        squares[k] = min(squares[k], squares[k - 1] + 2 * A * step)
    for k in range(steps - 1, -1, -1):
        squares[k] = min(squares[k], squares[k + 1] + 2 * A * step)
    v = np.sqrt(squares)
    return float((2 * step / (v[1:] + v[:-1])).sum())


def test_a_line_is_a_trapezoid() -> None:
    """5 mm to reach 100 mm/s in 0.1 s, 5 mm to stop, 90 mm between in 0.9 s."""
    assert run_s(line((0, 0), (100, 0))) == pytest.approx(1.1)


def test_a_short_line_is_a_triangle() -> None:
    assert run_s(line((0, 0), (4, 0))) == pytest.approx(2 * math.sqrt(4 / A))


def test_idle_moves_and_marks_have_their_own_speeds() -> None:
    machine = Accelerated(FEEDS, A, 0.05)
    assert machine.travel_s(1000) == pytest.approx(1000 / 500 + 500 / A)
    assert machine.travel_s(0) == 0.0
    assert machine.run_s(line((0, 0), (100, 0)), marks=True) == pytest.approx(100 / 50 + 50 / A)


def test_a_right_angle_is_taken_slowly() -> None:
    corner = math.sqrt(A * 0.05 * math.cos(math.pi / 4) / (1 - math.cos(math.pi / 4)))
    assert corner == pytest.approx(10.99, abs=0.01)
    leg = trapezoid_s(50, 0, corner, 100, A)
    assert run_s(line((0, 0), (50, 0), (50, 50))) == pytest.approx(2 * leg)
    assert run_s(line((0, 0), (50, 0), (50, 50)), deviation=1e-9) == pytest.approx(
        2 * run_s(line((0, 0), (50, 0))), 1e-3
    )


def test_turning_back_is_a_stop() -> None:
    there, back = Segment((0, 0), (50, 0)), Segment((50, 0), (0, 0))
    assert corner_mm_s(there, back, A, 0.05) == pytest.approx(0.0, abs=1e-6)
    assert run_s(line((0, 0), (50, 0), (0, 0))) == pytest.approx(2 * run_s(line((0, 0), (50, 0))))


def test_a_small_circle_is_bound_by_its_curvature() -> None:
    """2 mm radius: sqrt(1000 · 2) = 44.7 mm/s all the way round, but for the start and the stop."""
    round_2 = line((2, 0, 1), (-2, 0, 1), (2, 0))
    v = math.sqrt(A * 2)
    assert run_s(round_2) == pytest.approx(4 * math.pi / v + v / A, rel=1e-9)


def test_a_circle_in_chords_is_about_as_fast_as_the_circle() -> None:
    angles = np.linspace(0, 2 * math.pi, 73)
    chords = Curve.of([(2 * math.cos(t), 2 * math.sin(t)) for t in angles], closed=False)
    assert run_s(chords) == pytest.approx(run_s(line((2, 0, 1), (-2, 0, 1), (2, 0))), rel=0.02)


def test_a_line_cut_in_two_takes_as_long() -> None:
    assert run_s(line((0, 0), (30, 40), (60, 80))) == pytest.approx(run_s(line((0, 0), (60, 80))))


def test_a_speck_left_by_rounding_stops_nothing() -> None:
    clean = run_s(line((0, 0), (50, 0), (100, 0)))
    assert run_s(line((0, 0), (50, 0), (50, 0.01), (100, 0.01))) == pytest.approx(clean, rel=1e-3)


def test_specks_take_their_time_all_the_same() -> None:
    """A thousand steps of 0.01 mm are 10 mm more to run."""
    ends = [(50 + 0.01 * ((k + 1) // 2), 0.01 * (k // 2)) for k in range(1001)]
    assert run_s(line((0, 0), *ends)) == pytest.approx(run_s(line((0, 0), (50, 0))) + 10 / 100)


def test_a_path_that_goes_nowhere_takes_no_time() -> None:
    assert run_s(line((5, 5), (5, 5))) == 0.0
    assert run_s(line((5, 5), (5, 5.01))) == pytest.approx(2 * math.sqrt(0.01 / A))


POINTS = st.lists(
    st.tuples(st.integers(0, 60), st.integers(0, 60), st.sampled_from([0.0, 0.0, 0.3, -1.0])),
    min_size=3,
    max_size=7,
    unique_by=lambda p: p[:2],
)


@pytest.mark.slow
@given(POINTS)
def test_agrees_with_integration_by_small_steps(points: list[tuple[float, ...]]) -> None:
    path = line(*points)
    assert run_s(path) == pytest.approx(integrated_s(path, steps=4000), rel=0.02)


@given(POINTS, st.floats(50, 5000))
def test_never_faster_than_constant_feed_nor_slower_with_more_acceleration(
    points: list[tuple[float, ...]], acceleration: float
) -> None:
    path = line(*points)
    constant = ConstantFeed(FEEDS).run_s(path, marks=False)
    assert run_s(path, acceleration) >= constant * (1 - 1e-9)
    assert run_s(path, 2 * acceleration) <= run_s(path, acceleration) * (1 + 1e-9)
    assert run_s(path, 1e12) == pytest.approx(constant, rel=1e-3)


@given(POINTS)
def test_the_way_back_takes_as_long(points: list[tuple[float, ...]]) -> None:
    path = line(*points)
    assert run_s(path) == pytest.approx(run_s(path.reversed()))
