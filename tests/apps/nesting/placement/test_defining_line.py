"""Pavlov's method: known answers, and no turn in between is better than those that it tries."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from kerfwise.apps.nesting.placement.blocks import places_beside, turns_to_try, usable_area_mm2

HALF = shapely.Polygon([(0, 0), (40, 0), (0, 30)])
ELL = shapely.Polygon([(0, 0), (30, 0), (30, 10), (10, 10), (10, 30), (0, 30)])
SLAB = shapely.Polygon([(0, 0), (40, 0), (52, 20), (12, 20)])


def test_the_usable_area_is_that_of_the_paper() -> None:
    assert usable_area_mm2(100.0, 50.0, (10.0, 5.0), 0.5) == (100 - 20 + 0.5) * (50 - 10 + 0.5)


@pytest.mark.parametrize(
    ("one", "other", "area"),
    [
        (HALF, HALF, 1200.0),  # two triangles with a right angle make a rectangle
        (shapely.box(0, 0, 40, 20), shapely.box(0, 0, 20, 10), 1000.0),  # 50 × 20
        (shapely.box(0, 0, 40, 20), shapely.box(0, 0, 20, 40), 1600.0),  # turned, long side to long side
        (ELL, shapely.box(0, 0, 20, 20), 900.0),  # a square in the corner of an angle
        (SLAB, SLAB, 1840.0),  # slanted side to slanted side: 92 × 20
    ],
)
def test_the_least_rectangle_around_a_pair_is_exact(one: shapely.Polygon, other: shapely.Polygon, area: float) -> None:
    found = places_beside(one, other)[0]
    assert found.area_mm2 == pytest.approx(area, abs=1e-6)


def test_there_are_finitely_many_turns_and_none_twice() -> None:
    turns = turns_to_try(HALF, HALF)
    assert len(turns) == len(set(turns)) <= 3 * 3 + 4 * 3
    assert 180.0 in turns


@pytest.mark.parametrize("one", [HALF, ELL, SLAB])
@pytest.mark.parametrize("other", [HALF, ELL, SLAB])
def test_no_turn_in_between_gives_a_smaller_rectangle(one: shapely.Polygon, other: shapely.Polygon) -> None:
    best = places_beside(one, other)[0].area_mm2
    others = np.random.default_rng(5).uniform(0, 360, 40).tolist()
    assert places_beside(one, other, others)[0].area_mm2 >= best - 1e-6


def test_the_pair_touches_and_does_not_overlap() -> None:
    found = places_beside(ELL, SLAB)[0]
    c, s = np.cos(np.radians(found.turn_deg)), np.sin(np.radians(found.turn_deg))
    laid = shapely.transform(SLAB, lambda points: points @ np.array([[c, s], [-s, c]]) + found.shift)
    assert shapely.distance(ELL, laid) < 1e-6
    assert ELL.intersection(laid).area < 1e-3
    x0, y0, x1, y1 = shapely.union(ELL, laid).bounds
    assert (x1 - x0, y1 - y0) == pytest.approx((found.width_mm, found.height_mm), abs=1e-6)
