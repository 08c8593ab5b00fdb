import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.readers.sheet import surrounding


def test_depth_and_the_ring_around() -> None:
    areas = [
        shapely.box(20, 20, 30, 30),
        shapely.box(0, 0, 100, 100),
        shapely.box(10, 10, 40, 40),
        shapely.box(60, 60, 70, 70),
    ]
    depth, parent = surrounding(areas)
    assert depth.tolist() == [2, 0, 1, 1]
    assert parent.tolist() == [2, -1, 1, 1]


def test_areas_that_touch_lie_beside_each_other() -> None:
    depth, _ = surrounding([shapely.box(0, 0, 10, 10), shapely.box(10, 0, 20, 10)])
    assert depth.tolist() == [0, 0]


def test_a_hole_that_touches_its_outline_lies_in_it() -> None:
    depth, _ = surrounding([shapely.box(0, 0, 10, 10), shapely.box(0, 0, 5, 5)])
    assert depth.tolist() == [0, 1]


def test_an_empty_area_lies_nowhere() -> None:
    depth, parent = surrounding([shapely.box(0, 0, 10, 10), shapely.Polygon()])
    assert (depth.tolist(), parent.tolist()) == ([0, 0], [-1, -1])


@given(st.permutations(range(6)))
def test_rings_in_rings_in_any_order(order: list[int]) -> None:
    depth, parent = surrounding([shapely.box(k, k, 20 - k, 20 - k) for k in order])
    assert depth.tolist() == order
    assert [order[p] if p >= 0 else -1 for p in parent.tolist()] == [k - 1 for k in order]
