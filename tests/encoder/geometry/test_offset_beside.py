"""Offsets of many curves at a time are those that areas give, and narrow necks are left to areas."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from kerfwise.encoder.geometry import offset
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.offset import offset_curve, offset_together
from kerfwise.encoder.geometry.offset_batch import offset_curves
from kerfwise.tests.encoder.geometry.rings import hausdorff_mm, true_offset

DISTANCES_MM = (0.75, -0.75, 2.0, -2.0)


def angular(seed: int) -> Curve:
    """The largest of what some rectangles cover together, turned."""
    rng = np.random.default_rng(seed)
    at, size = rng.uniform(0, 30, (4, 2)), rng.uniform(4, 30, (4, 2))
    covered = shapely.union_all(shapely.box(*at.T, *(at + size).T))
    ring = max(shapely.get_parts(covered), key=lambda p: float(p.area)).exterior
    (x, y), turn = shapely.get_coordinates(ring)[:-1].T, rng.uniform(0, math.tau)
    turned = x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn)
    return Curve(np.column_stack([*turned, 0 * x]))


def comb(mouth_mm: float) -> Curve:
    wide_mm = 20 + mouth_mm
    walls = [(wide_mm, 0), (wide_mm, 30), (10 + mouth_mm, 30), (10 + mouth_mm, 10), (10, 10), (10, 30)]
    return Curve.of([(0, 0), *walls, (0, 30)])


def made(curve: Curve, distance_mm: float) -> bytes | str:
    try:
        return offset_curve(curve, distance_mm).vertices.tobytes()
    except ValueError as error:
        return str(error)


@pytest.mark.slow
def test_what_neighbours_tell_is_what_areas_give(monkeypatch: pytest.MonkeyPatch) -> None:
    told = 0
    for seed in range(30):
        curve = angular(seed)
        for distance_mm in DISTANCES_MM:
            beside = offset_curves([curve], [distance_mm])[0]
            if beside is None or len(curve.vertices) < 6:  # of convex curves areas may begin elsewhere
                continue
            told += 1
            with monkeypatch.context() as areas:
                areas.setattr(offset, "offset_curves", lambda curves, _: [None] * len(curves))
                assert made(Curve(curve.vertices), distance_mm) == beside.vertices.tobytes()
            wanted = max(shapely.get_parts(true_offset(curve, distance_mm)), key=lambda p: float(p.area)).exterior
            assert hausdorff_mm(beside.line(0.0005), wanted) < 0.01
    assert told > 20


def test_many_together_are_as_one_by_one() -> None:
    curves = [angular(seed) for seed in range(30)] + [Curve.of([(-9, 0, 1), (9, 0, 1)]), comb(1.0)]
    distances_mm = [DISTANCES_MM[k % 4] for k in range(len(curves))]
    alone = [made(Curve(c.vertices), mm) for c, mm in zip(curves, distances_mm, strict=True)]
    offset_together(curves, distances_mm)
    assert sum(curve.beside[mm] is not None for curve, mm in zip(curves, distances_mm, strict=True)) > 10
    assert [made(c, mm) for c, mm in zip(curves, distances_mm, strict=True)] == alone


@pytest.mark.parametrize(("mouth_mm", "told"), [(1.0, False), (1.4999, False), (1.5001, False), (1.6, True)])
def test_a_neck_about_as_wide_as_the_kerf_is_left_to_areas(mouth_mm: float, told: bool) -> None:
    assert (offset_curves([comb(mouth_mm)], [0.75])[0] is not None) == told


def test_curves_without_area_or_offset_are_passed_over() -> None:
    flat, square = Curve.of([(0, 0), (9, 0)]), Curve.of([(0, 0), (9, 0), (9, 9), (0, 9)])
    offset_together([flat, square], [1.0, 0.0])
    assert not flat.beside
    assert not square.beside
    assert offset_curves([], []) == []
