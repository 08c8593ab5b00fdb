"""That a round runs beside its contour is told of many at once only where buffers made by shapely show it too."""

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
from kerfwise.postproc.check.contour_following import surely_beside, surely_cover
from kerfwise.tests.tools.amount import examples

HALF_MM = 0.75
REACH_MM = math.sqrt(2) * HALF_MM + 0.05
STRETCHED_MM = 1e-6


def round_of(chance: Random, contour: Any, off_mm: float) -> Any:
    """A torch's round beside a contour, outside or inside, from anywhere on; a point may be off, or a piece missing."""
    area = shapely.Polygon(contour)
    made = shapely.buffer(area, chance.choice([-1, 1]) * HALF_MM, quad_segs=chance.choice([4, 16]))
    parts = [part for part in shapely.get_parts(made) if part.area > 0]
    if not parts:
        return contour
    points = shapely.get_coordinates(max(parts, key=lambda part: part.area).exterior)[:-1]
    points = np.roll(points, -chance.randrange(len(points)), axis=0)[:: chance.choice([1, -1])]
    points[chance.randrange(len(points))] += off_mm * np.array([math.cos(len(points)), math.sin(len(points))])
    if off_mm and chance.random() < 0.3:
        points = np.delete(points, chance.randrange(len(points)), axis=0)
    closed = chance.random() < 0.8
    return shapely.LineString(np.concatenate([points, points[:1]]) if closed else points)


def beside(contour: Any, around: Any) -> bool:
    """Whether a round passes all points of a contour, densely taken."""
    points = shapely.points(shapely.get_coordinates(shapely.segmentize(contour, 0.02)))
    return bool((shapely.distance(around, points) <= REACH_MM + STRETCHED_MM).all())


@examples(60)
@given(st.integers(0, 10**6), st.integers(3, 30), st.sampled_from([0.0, 0.2, 0.5, 3.0]))
def test_what_is_said_to_be_beside_is(seed: int, corners: int, off_mm: float) -> None:
    chance = Random(seed)
    contours = [star(chance, corners) for _ in range(4)]
    rounds = [round_of(chance, contour, off_mm) for contour in contours]
    for told, contour, around in zip(surely_beside(contours, rounds, HALF_MM, REACH_MM), contours, rounds, strict=True):
        assert not told or beside(contour, around)


@pytest.mark.parametrize("outside", [True, False])
@pytest.mark.parametrize("kerf_mm", [0.2, 1.5, 6.0])
def test_ordinary_contours_are_told_of(outside: bool, kerf_mm: float) -> None:
    shapes = [
        shapely.box(0, 0, 90, 40),
        shapely.Point(0, 0).buffer(30, quad_segs=40),
        shapely.union(shapely.box(0, 0, 60, 25), shapely.box(0, 0, 25, 80)),
        shapely.box(0, 0, 70, 50).buffer(12, quad_segs=20),
    ]
    half_mm = kerf_mm / 2
    rounds = [shapely.buffer(area, half_mm if outside else -half_mm).exterior for area in shapes]
    contours = [area.exterior for area in shapes]
    for turned in (contours, [contour.reverse() for contour in contours]):
        assert surely_beside(turned, rounds, half_mm, math.sqrt(2) * half_mm + 0.05).all()
    assert not surely_beside(contours, rounds, half_mm, 0.95 * half_mm).any()


def test_some_at_a_time_tell_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    chance = Random(3)
    contours = [star(chance, 12) for _ in range(9)]
    rounds = [round_of(chance, contour, chance.choice([0.0, 3.0])) for contour in contours]
    told = surely_beside(contours, rounds, HALF_MM, REACH_MM).tolist()
    monkeypatch.setattr(contour_following, "AT_ONCE", 2)
    assert surely_beside(contours, rounds, HALF_MM, REACH_MM).tolist() == told


def test_what_goes_nowhere_is_not_told_of() -> None:
    dot, square = shapely.LineString([(1, 1), (1, 1)]), shapely.box(0, 0, 9, 9).exterior
    assert surely_beside([dot, square, dot], [square, dot, dot], HALF_MM, REACH_MM).tolist() == [False] * 3
    assert surely_beside([], [], HALF_MM, REACH_MM).tolist() == []


WITHIN_MM = 0.05


def star(chance: Random, corners: int) -> Any:
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
    rings = [star(chance, corners) for _ in range(5)]
    paths = [path_round(chance, around, off_mm) for around in rings]
    for told, path, around in zip(surely_cover(paths, rings, WITHIN_MM).tolist(), paths, rings, strict=True):
        assert not told or all_near(path, around)


def test_some_rings_at_a_time_tell_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    chance = Random(1)
    rings = [star(chance, 40) for _ in range(7)]
    paths = [path_round(chance, around, chance.choice([0.0, 3.0])) for around in rings]
    told = surely_cover(paths, rings, WITHIN_MM).tolist()
    assert set(told) == {True, False}
    monkeypatch.setattr(contour_following, "RINGS_AT_ONCE", 3)
    assert surely_cover(paths, rings, WITHIN_MM).tolist() == told


def test_of_nothing_nothing_is_told() -> None:
    assert surely_cover([], [], WITHIN_MM).tolist() == []
