"""The compiled look at moves and areas, held against shapely."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.models.problem.crossings import IdleMoves, crossed_areas

RING = shapely.box(10, 10, 20, 20).difference(shapely.box(13, 13, 17, 17))
TWO = shapely.union_all([shapely.box(0, 0, 2, 2), shapely.box(5, 0, 7, 2)])


def crossed(leave: list[list[float]], reach: list[list[float]], areas: list[shapely.Geometry]) -> list[tuple[int, ...]]:
    moves = IdleMoves(
        np.array(leave, dtype=float),
        np.array(reach, dtype=float),
        np.zeros(len(reach), dtype=np.int64),
        np.arange(len(areas)),
    )
    ((one, other, area),) = crossed_areas([moves], areas, np.zeros((1, len(areas)), dtype=np.bool_))
    return sorted(zip(one.tolist(), other.tolist(), area.tolist(), strict=True))


@pytest.mark.parametrize(
    ("leave", "reach", "meets"),
    [
        ([5, 15], [25, 15], True),
        ([14, 14], [16, 16], False),  # within the hole
        ([14, 14], [25, 14], True),
        ([11, 11], [12, 12], True),  # within the area, no edge is cut
        ([11, 11], [11, 11], True),
        ([15, 15], [15, 15], False),
        ([5, 21], [25, 21], False),
        ([5, 5], [9, 20], False),
    ],
)
def test_a_ring_is_met_where_it_has_metal(leave: list[float], reach: list[float], meets: bool) -> None:
    assert bool(crossed([leave], [reach], [RING])) is meets


def test_areas_in_pieces_and_empty_ones() -> None:
    areas = [shapely.Polygon(), TWO, shapely.Polygon()]
    assert crossed([[3, -1]], [[3, 3], [6, 1]], areas) == [(0, 1, 1)]


def test_areas_of_no_account_are_left_out() -> None:
    moves = IdleMoves(np.array([[5.0, 15.0]]), np.array([[25.0, 15.0]] * 2), np.array([0, 1]), np.array([0]))
    late = np.array([[True], [False]])
    assert [rows.tolist() for rows in crossed_areas([moves], [RING], late)[0]] == [[0], [1], [0]]


@st.composite
def scenes(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray, list[shapely.Geometry]]:
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    points = rng.uniform(0, 100, (2, draw(st.integers(1, 40)), 2))
    blobs = [shapely.Point(*rng.uniform(0, 100, 2)).buffer(rng.uniform(1, 40), quad_segs=3) for _ in range(6)]
    return points[0], points[1], [blobs[0].difference(blobs[1]), blobs[2].union(blobs[3]), blobs[4], blobs[5]]


@given(scenes())
def test_what_is_crossed_is_what_shapely_says(scene: tuple[np.ndarray, np.ndarray, list[shapely.Geometry]]) -> None:
    leave, reach, areas = scene
    found = crossed(leave.tolist(), reach.tolist(), areas)
    lines = shapely.linestrings(
        [[a, b] for a in leave for b in reach],
    )
    meets = shapely.intersects(lines[:, None], np.array(areas, dtype=object)[None, :])
    lines_met, areas_met = np.nonzero(meets)
    k = len(reach)
    assert found == sorted(zip((lines_met // k).tolist(), (lines_met % k).tolist(), areas_met.tolist(), strict=True))


@given(scenes())
def test_by_arrays_the_same_is_crossed_in_the_same_order(
    scene: tuple[np.ndarray, np.ndarray, list[shapely.Geometry]],
) -> None:
    leave, reach, areas = scene
    asked, late = np.append(reach, leave[:1], axis=0), np.arange(2 * len(areas)).reshape(2, -1) % 5 == 0
    moves = IdleMoves(leave, asked, np.arange(len(asked)) % 2, np.arange(len(areas))[::-1].copy())
    ((*compiled,),) = crossed_areas([moves], areas, late)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("kerfwise.models.problem.crossings.AT_ONCE", 50)
        patch.setattr("kerfwise.models.problem.crossings.suited", lambda kernel, steps, by_arrays: by_arrays)
        ((*by_arrays,),) = crossed_areas([moves], areas, late)
    for one, other in zip(compiled, by_arrays, strict=True):
        assert one.dtype == other.dtype
        np.testing.assert_array_equal(one, other)
