"""Where shapes may lie, against overlaps looked at one by one."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from kerfwise.apps.nesting.placement.nofit import allowed, forbidden

ELL = shapely.Polygon([(0, 0), (50, 0), (50, 12), (12, 12), (12, 50), (0, 50)])
RING = shapely.Point(0, 0).buffer(30, quad_segs=4).difference(shapely.Point(0, 0).buffer(20, quad_segs=4))
BAR = shapely.box(-2, -3, 16, 6)
SHAPES = {"ell": ELL, "ring": RING, "bar": BAR}


@pytest.mark.parametrize("lying", SHAPES)
@pytest.mark.parametrize("coming", SHAPES)
def test_a_shift_is_forbidden_exactly_where_shapes_overlap(lying: str, coming: str) -> None:
    a, b = SHAPES[lying], SHAPES[coming]
    found = forbidden(a, b)
    shifts = np.random.default_rng(3).uniform(-80, 80, (150, 2))
    clear = shapely.distance(shapely.points(shifts), found.boundary) > 1e-6
    for shift in shifts[clear]:
        overlaps = a.intersection(shapely.transform(b, lambda points, by=shift: points + by)).area > 0
        assert found.contains(shapely.Point(shift)) == overlaps, shift


def test_a_part_may_lie_in_the_hole_of_another() -> None:
    assert not forbidden(RING, BAR).contains(shapely.Point(-7, -1.5))
    assert forbidden(RING, ELL).contains(shapely.Point(-20, -20)), "there is no room for that one"


@pytest.mark.parametrize("room", [ELL.buffer(30), RING.buffer(5), shapely.box(0, 0, 60, 40)])
def test_a_shift_is_allowed_exactly_where_the_shape_is_in_the_room(room: shapely.Polygon) -> None:
    found = allowed(room, BAR)
    shifts = np.random.default_rng(4).uniform(-60, 90, (200, 2))
    clear = [s for s in shifts if found.is_empty or shapely.distance(shapely.Point(s), found.boundary) > 1e-6]
    for shift in clear:
        within = room.covers(shapely.transform(BAR, lambda points, by=shift: points + by))
        assert found.contains(shapely.Point(shift)) == within, shift


def test_what_is_larger_than_the_room_is_allowed_nowhere() -> None:
    assert allowed(shapely.box(0, 0, 10, 100), shapely.box(0, 0, 11, 1)).is_empty
