"""What is told of many lines at once is what shapely tells of each."""

from __future__ import annotations

import math
from random import Random
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.postproc.check import contour_following
from kerfwise.postproc.check.contour_following import surely_cover
from kerfwise.tests.tools.amount import examples

WITHIN_MM = 0.05


def ring(chance: Random, corners: int) -> Any:
    """A star-shaped ring, either way round."""
    angles = sorted(chance.uniform(0, 2 * math.pi) for _ in range(corners))
    radii = [chance.uniform(5, 60) for _ in angles]
    made = shapely.LinearRing([(r * math.cos(a), r * math.sin(a)) for a, r in zip(angles, radii, strict=True)])
    return made.reverse() if chance.random() < 0.5 else made


def path_round(chance: Random, around: Any, off_mm: float) -> Any:
    """A path that goes round a ring from anywhere on, with leads; one vertex may be off."""
    points = shapely.get_coordinates(shapely.segmentize(around, chance.uniform(2, 30)))[:-1]
    points = np.roll(points, -chance.randrange(len(points)), axis=0)[:: chance.choice([1, -1])]
    loop = np.concatenate([points, points[:1]])
    k = chance.randrange(len(loop))
    loop[k] += off_mm * np.array([math.cos(k), math.sin(k)])
    over = loop[1 : 1 + chance.randrange(3)]
    lead = loop[0] + np.array([[chance.uniform(-9, 9), chance.uniform(-9, 9)]])
    return shapely.LineString(np.concatenate([lead, loop, over]))


def all_near(line: Any, of: Any) -> bool:
    return bool((shapely.distance(line, shapely.points(shapely.get_coordinates(of))) <= WITHIN_MM).all())


@examples(60)
@given(st.integers(0, 10**6), st.integers(4, 30), st.sampled_from([0.0, 0.04, 0.06, 3.0]))
def test_what_is_said_to_be_near_is_near(seed: int, corners: int, off_mm: float) -> None:
    chance = Random(seed)
    rings = [ring(chance, corners) for _ in range(5)]
    paths = [path_round(chance, around, off_mm) for around in rings]
    for told, path, around in zip(surely_cover(paths, rings, WITHIN_MM).tolist(), paths, rings, strict=True):
        assert not told or all_near(path, around)


def test_some_at_a_time_tell_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    chance = Random(1)
    rings = [ring(chance, 40) for _ in range(7)]
    paths = [path_round(chance, around, chance.choice([0.0, 3.0])) for around in rings]
    told = surely_cover(paths, rings, WITHIN_MM).tolist()
    assert set(told) == {True, False}
    monkeypatch.setattr(contour_following, "RINGS_AT_ONCE", 3)
    assert surely_cover(paths, rings, WITHIN_MM).tolist() == told


def test_of_nothing_nothing_is_told() -> None:
    assert surely_cover([], [], WITHIN_MM).tolist() == []
