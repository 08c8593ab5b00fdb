"""Texts fit where they are put."""

from __future__ import annotations

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.postproc.report.label_fit import Room, find_room, find_rooms


def test_a_text_with_room_has_the_wanted_size_and_stands_near_its_target() -> None:
    place = find_room(shapely.box(0, 0, 100, 100), "12", 5.0, near=shapely.Point(0, 50))
    assert place is not None
    assert place.size_mm == 5.0
    assert place.x < 6
    assert abs(place.y - 50) < 0.01


def test_without_a_target_it_stands_in_the_middle() -> None:
    place = find_room(shapely.box(0, 0, 100, 40), "12", 5.0)
    assert place is not None
    assert (place.x, place.y) == (pytest.approx(50, abs=1), pytest.approx(20, abs=1))


def test_too_narrow_for_the_wanted_size_it_fills_the_width() -> None:
    place = find_room(shapely.box(0, 0, 10, 10), "8", 100.0)
    assert place is not None
    x0, y0, x1, y1 = place.box().bounds
    assert not place.turned
    assert y1 - y0 > 7.5 or x1 - x0 > 7.5


def test_in_an_upright_strip_it_is_turned() -> None:
    place = find_room(shapely.box(0, 0, 10, 200), "115", 20.0, bold=True)
    assert place is not None
    assert place.turned
    x0, y0, x1, y1 = place.box().bounds
    assert y1 - y0 > x1 - x0


@pytest.mark.parametrize("flat", ["POINT (0 1)", "LINESTRING (0 0, 0 2)", "MULTILINESTRING ((0 0, 0 2), (1 0, 1 2))"])
def test_what_is_drawn_flat_has_no_place(flat: str) -> None:
    line = shapely.from_wkt(flat)
    assert find_room(line, "12", 5.0) is None
    place = find_room(shapely.GeometryCollection([line, shapely.box(9, 9, 12, 12)]), "12", 1.0)
    assert place is not None
    assert place.x > 9


def test_no_area_no_place() -> None:
    assert find_room(shapely.Polygon(), "1", 5.0) is None
    assert find_room(shapely.GeometryCollection([shapely.Point(1, 1)]), "1", 5.0) is None


@given(
    points=st.lists(
        st.tuples(st.floats(0, 100, width=32), st.floats(0, 100, width=32)), min_size=3, max_size=9, unique=True
    ),
    number=st.integers(1, 9999),
    wanted_mm=st.floats(0.5, 50),
    near=st.none() | st.builds(shapely.Point, st.floats(-50, 150), st.floats(-50, 150)),
    bold=st.booleans(),
)
def test_the_box_lies_in_the_area(
    points: list[tuple[float, float]], number: int, wanted_mm: float, near: shapely.Point | None, bold: bool
) -> None:
    area = shapely.MultiPoint(points).buffer(6).difference(shapely.Point(points[0]).buffer(3))
    place = find_room(area, str(number), wanted_mm, near, bold)
    assert place is not None
    assert 0 < place.size_mm <= wanted_mm
    assert area.covers(place.box())


@pytest.mark.parametrize("size", [(100, 10), (10, 100), (30, 30), (80, 40)])
def test_where_no_larger_text_fits_than_is_known_there_is_none(size: tuple[float, float]) -> None:
    area = shapely.box(0, 0, *size)
    place = find_room(area, "123", 30.0)
    assert place is not None
    assert find_room(area, "123", 30.0, above_mm=0.8 * place.size_mm) == place
    assert find_room(area, "123", 30.0, above_mm=3 * place.size_mm) is None


def test_many_texts_are_each_placed_as_if_alone() -> None:
    corner = shapely.Polygon([(0, 0), (80, 0), (80, 15), (15, 15), (15, 90), (0, 90)])
    areas = [shapely.box(0, 0, 100, 10), corner, shapely.Polygon(), shapely.box(0, 0, 4, 60)]
    near = [None, shapely.Point(70, 5), shapely.LineString([(0, 80), (9, 80)])]
    rooms = [
        Room(area, text, wanted_mm, target, bold, above_mm)
        for area in areas
        for text, bold in (("7", False), ("1234", True))
        for wanted_mm, above_mm in ((5.0, 0.0), (30.0, 3.0))
        for target in near
    ]
    together = find_rooms(rooms)
    assert together == [find_rooms([room])[0] for room in rooms]
    assert {True, False} == {place.turned for place in together if place is not None}
    assert None in together
