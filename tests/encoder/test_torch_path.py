"""The torch's path: beside its contour, slower at corners, and each as if it were alone."""

from __future__ import annotations

import json
import math
from itertools import pairwise
from random import Random

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise import InputError
from kerfwise.encoder.geometry.offset import offset_curve
from kerfwise.encoder.narrow_features import paths_keep_distance
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.encoder.torch_path import (
    CRUMB_MM,
    CornerFeed,
    chords,
    compensate_together,
    compensated,
    paced,
    with_corner_times,
)
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.rule_kit import Curve, circle, nest, part, rect
from kerfwise.tests.tools.amount import examples

DRAWN = part("A", rect(0, 0, 40, 40), [circle(20, 20, 5)], [[(2, 2), (9, 2)]])


def test_outside_an_outer_contour_and_inside_a_hole() -> None:
    assert compensated(DRAWN.outer, 2.0).length_mm == pytest.approx(160 + math.tau)
    assert compensated(DRAWN.holes[0], 2.0).length_mm == pytest.approx(math.tau * 4)


def test_a_mark_and_a_kerf_of_nothing_change_nothing() -> None:
    assert compensated(DRAWN.marks[0], 2.0) is DRAWN.marks[0].curve
    assert compensated(DRAWN.outer, 0.0) is DRAWN.outer.curve


def test_answers_are_kept() -> None:
    assert compensated(DRAWN.outer, 2.0) is compensated(DRAWN.outer, 2.0)


def test_a_hole_that_the_kerf_fills_is_named() -> None:
    with pytest.raises(InputError, match=r"A\.hole1 at \(15\.0, 20\.0\) .* kerf of 12 mm: .* nothing is left"):
        compensated(DRAWN.holes[0], 12.0)


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


HALF = 0.75
MOST = HALF * math.sqrt(2) + 0.05
FINE = 1e-4


def farthest_mm(curve: Curve, path: Curve) -> float:
    """How far the farthest of many points of a curve is from a path, by fine chords: a little more than it is."""
    points = shapely.points(shapely.get_coordinates(shapely.segmentize(curve.line(FINE), 0.02)))
    return float(shapely.distance(points, path.line(FINE)).max()) + 2 * FINE


def star(chance: Random, arcs: bool) -> Curve:
    """A closed curve round the origin, of some lines and arcs."""
    count = chance.randrange(3, 9)
    turns = sorted(chance.uniform(0, math.tau) for _ in range(count))
    far = [chance.uniform(3, 15) for _ in range(count)]
    bulges = [round(chance.choice([0.0, 0.0, chance.uniform(-0.9, 0.9)]), 6) if arcs else 0.0 for _ in range(count)]
    return Curve.of([(r * math.cos(t), r * math.sin(t), b) for r, t, b in zip(far, turns, bulges, strict=True)])


def spoilt(path: Curve, chance: Random) -> Curve:
    """A path with a corner moved, an arc bent otherwise, a corner left out, or begun elsewhere; or as it is."""
    rows = path.vertices.copy()
    k = chance.randrange(len(rows))
    kind = chance.choice(["none", "moved", "bent", "turned", "left out", "begun elsewhere"])
    if kind == "moved":
        rows[k, :2] += [chance.uniform(-0.6, 0.6), chance.uniform(-0.6, 0.6)]
    elif kind == "bent":
        rows[k, 2] += chance.choice([-0.2, 0.2, 1.5])
    elif kind == "turned":
        rows[k, 2] = -1 / rows[k, 2] if rows[k, 2] else 0.5
    elif kind == "left out" and len(rows) > 3:
        rows = np.delete(rows, k, axis=0)
    elif kind == "begun elsewhere":
        rows = np.roll(rows, k, axis=0)
    return Curve(rows)


@examples(250)
@given(st.randoms(use_true_random=False), st.booleans(), st.sampled_from([-HALF, HALF]), st.sampled_from([0.8, MOST]))
def test_what_is_surely_near_is_near_everywhere(chance: Random, arcs: bool, by_mm: float, most_mm: float) -> None:
    curve = star(chance, arcs)
    try:
        path = spoilt(offset_curve(curve, by_mm), chance)
    except ValueError:  # it has no area, or nothing is left of it
        return
    if paths_keep_distance([curve], [path], HALF, most_mm)[0]:
        assert farthest_mm(curve, path) <= most_mm + 1e-3


@pytest.mark.parametrize("radius_mm", [0.3, 0.5, 0.8, 2.0])
@pytest.mark.parametrize("turned_rad", [0.0, 1.0, 2.0, 3.0, 3.6, 5.0])
def test_small_arcs_are_near_only_where_their_points_are(radius_mm: float, turned_rad: float) -> None:
    """Of two small circles about one centre that begin elsewhere, halves lie on other sides."""

    def half_moon(r_mm: float, at_rad: float) -> Curve:
        one, other = ((r_mm * math.cos(t), r_mm * math.sin(t)) for t in (at_rad, at_rad + 2.8))
        return Curve.of([(*one, math.tan(2.8 / 4)), (*other, 0.0)])

    curve, path = half_moon(radius_mm, 0.0), half_moon(radius_mm + 0.2, turned_rad)
    for most_mm in (0.3, 0.7, 1.1, 2.0):
        if paths_keep_distance([curve], [path], HALF, most_mm)[0]:
            assert farthest_mm(curve, path) <= most_mm + 1e-3


@pytest.mark.slow
def test_contours_of_plates_are_seen_to_be_near() -> None:
    nest = read_json(json.dumps(make_sheet(1, 300)).encode(), ReadOptions())
    compensate_together(nest.contours, 2 * HALF)
    cut = [c for c in nest.contours if c.encloses]
    paths = [compensated(c, 2 * HALF) for c in cut]
    seen = paths_keep_distance([c.curve for c in cut], paths, HALF, MOST)
    assert seen.mean() > 0.95
    assert not paths_keep_distance([c.curve for c in cut], [p.moved(2.0, 0.0) for p in paths], HALF, MOST).any()
    for contour, path in list(zip(cut, paths, strict=True))[:8]:
        assert farthest_mm(contour.curve, path) <= MOST


def test_a_slot_that_the_path_does_not_enter_is_not_seen_to_be_near() -> None:
    slot = Curve.of([(0, 0), (60, 0), (60, 30), (31, 30), (31, 10), (30, 10), (30, 30), (0, 30)])
    assert not paths_keep_distance([slot], [offset_curve(slot, HALF)], HALF, MOST)[0]


def test_nothing_asked_nothing_told() -> None:
    assert paths_keep_distance([], [], HALF, MOST).tolist() == []
