"""Contours that surely lie near their paths do so at every point of them, whatever the paths; on plates most do."""

from __future__ import annotations

import json
import math
from random import Random

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.offset import offset_curve
from kerfwise.encoder.narrow_features import paths_keep_distance
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.encoder.torch_path import compensate_together, compensated
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.tests.tools.amount import examples

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
