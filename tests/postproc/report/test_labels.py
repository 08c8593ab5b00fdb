"""Numbers stand inside the metal or the hole that they belong to, and not on each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pytest
import shapely
from hypothesis import example, given
from hypothesis import strategies as st

from kerfwise import Nest
from kerfwise.postproc.report import labels
from kerfwise.postproc.report.label_fit import Room, TextPlace, find_rooms
from kerfwise.postproc.report.labels import Label, place_labels
from kerfwise.rule_kit import Curve, circle, nest, part, rect
from kerfwise.rules.case import Rows
from kerfwise.tests.tools.amount import examples


def find_room(*given: Any, **more: Any) -> TextPlace | None:
    return find_rooms([Room(*given, **more)])[0]


def numbered(plate: Nest) -> dict[str, Label]:
    return {c.id: Label(str(k), c.curve.point_at(0.0)) for k, c in enumerate(plate.contours, 1)}


def frame_with_guest() -> Nest:
    return nest(
        400,
        300,
        part("frame", rect(10, 10, 200, 200), [rect(40, 40, 140, 140)]),
        part("guest", rect(45, 45, 130, 130), [circle(110, 110, 30)]),
    )


def test_an_outer_number_is_in_the_metal_and_a_hole_number_in_the_hole() -> None:
    plate = nest(300, 300, part("A", rect(0, 0, 200, 200), [circle(100, 100, 60)]))
    places = place_labels(plate, numbered(plate), wanted_mm=10)
    assert plate.parts[0].polygon.contains(places["A.outer"].box())
    assert plate.contour("A.hole1").polygon.contains(places["A.hole1"].box())
    assert places["A.outer"].size_mm == places["A.hole1"].size_mm == 10


def test_numbers_stand_by_the_entry() -> None:
    plate = nest(1000, 1000, part("A", rect(0, 0, 900, 900)))
    place = place_labels(plate, {"A.outer": Label("1", (900, 450))}, wanted_mm=10)["A.outer"]
    assert place.x > 880
    assert abs(place.y - 450) < 1


def test_a_hole_number_keeps_clear_of_its_lead() -> None:
    plate = nest(300, 300, part("A", rect(0, 0, 200, 200), [circle(100, 100, 40)]))
    lead = Curve.of([(100, 100), (60, 100)], closed=False)
    place = place_labels(plate, {"A.hole1": Label("7", (60, 100), (lead,))}, wanted_mm=10)["A.hole1"]
    assert not place.box().intersects(lead.line())


def test_a_number_that_has_no_room_in_its_small_hole_stands_beside_it() -> None:
    plate = nest(300, 300, part("A", rect(0, 0, 200, 200), [circle(100, 100, 3)]))
    place = place_labels(plate, numbered(plate), wanted_mm=10)["A.hole1"]
    assert plate.parts[0].polygon.contains(place.box())
    assert place.size_mm == 10
    assert place.box().distance(plate.contour("A.hole1").polygon) < 5


def test_a_hole_number_is_not_on_the_part_nested_there() -> None:
    plate = frame_with_guest()
    places = place_labels(plate, numbered(plate), wanted_mm=12)
    assert not places["frame.hole1"].box().intersects(plate.part_of["guest"].outer.polygon)


def test_a_mark_number_is_beside_the_mark() -> None:
    plate = nest(300, 300, part("A", rect(0, 0, 200, 200), marks=[[(50, 100), (150, 100)]]))
    place = place_labels(plate, numbered(plate), wanted_mm=10)["A.mark1"]
    assert plate.parts[0].polygon.contains(place.box())
    gap_mm = place.box().distance(plate.contour("A.mark1").line)
    assert 0 < gap_mm < 10


@pytest.mark.parametrize(
    ("size", "hole", "text"),
    [
        ((50, 10), circle(4, 5, 2), "1000"),  # the long number first would take the metal beside the hole
        ((20, 14), circle(4, 7, 4), "10"),  # the hole's number first would split the metal
    ],
)
def test_a_crowded_part_is_filled_in_the_better_order(size: tuple[float, float], hole: Rows, text: str) -> None:
    plate = nest(300, 300, part("A", rect(0, 0, *size), [hole]))
    places = place_labels(plate, {"A.hole1": Label("2"), "A.outer": Label(text)}, wanted_mm=12)
    assert len(places) == 2
    assert min(p.size_mm for p in places.values()) > 6


def test_only_what_lies_in_the_window_is_labelled() -> None:
    plate = nest(900, 300, part("A", rect(0, 0, 200, 200)), part("B", rect(500, 0, 200, 200)))
    window = shapely.box(0, 0, 150, 300)
    places = place_labels(plate, numbered(plate), 10, window)
    assert list(places) == ["A.outer"]
    assert window.contains(places["A.outer"].box())


def overlaps(places: Mapping[str, TextPlace]) -> list[tuple[str, str]]:
    boxes: Sequence[tuple[str, shapely.Polygon]] = [(k, p.box()) for k, p in places.items()]
    return [(a, b) for n, (a, box) in enumerate(boxes) for b, other in boxes[:n] if box.intersection(other).area > 1e-9]


@examples(40)
@example(wide=20.0, high=26.0, radii=[], wanted_mm=23.0)
@given(
    wide=st.floats(20, 300),
    high=st.floats(20, 300),
    radii=st.lists(st.floats(0.5, 9), max_size=3),
    wanted_mm=st.floats(2, 40),
)
def test_every_label_is_inside_and_none_overlap(wide: float, high: float, radii: list[float], wanted_mm: float) -> None:
    holes = [circle(wide * (k + 0.5) / len(radii), high / 2, min(r, wide / 8)) for k, r in enumerate(radii)]
    plate = nest(
        900,
        900,
        part("A", rect(0, 0, wide, high), holes, [[(wide * 0.1, high * 0.05), (wide * 0.9, high * 0.06)]]),
        part("B", [(400, 0), (400 + wide, 0), (400, high)]),
    )
    places = place_labels(plate, numbered(plate), wanted_mm)
    assert set(places) == set(plate.index)
    for contour in plate.contours:
        box = places[contour.id].box()
        metal = plate.part_of[contour.part].polygon
        assert metal.covers(box) or (contour.kind == "hole" and contour.polygon.covers(box))
    assert overlaps(places) == []


def test_a_second_order_is_given_up_only_where_it_is_no_better(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without an end before all labels stand, the better of both orders is the same."""
    plates = [
        nest(900, 900, part("A", rect(0, 0, wide, high), [circle(wide * at, high / 2, high * share)]))
        for wide in (20, 34, 50)
        for high in (10, 16, 24)
        for at, share in ((0.15, 0.1), (0.3, 0.25), (0.5, 0.35))
    ]
    quick = [place_labels(plate, numbered(plate) | {"A.outer": Label("1000")}, 12.0) for plate in plates]
    placed, ended = labels._place_part, list[bool]()

    def to_the_end(
        *given: Any, outer_first: bool, above_mm: float = 0.0
    ) -> labels.BatchedTask[dict[str, TextPlace] | None]:
        ended.append((yield from placed(*given, outer_first=outer_first, above_mm=above_mm)) is None)
        found = (yield from placed(*given, outer_first=outer_first)) or {}
        return found if labels._smallest(found) > above_mm else None

    monkeypatch.setattr(labels, "_place_part", to_the_end)
    assert [place_labels(plate, numbered(plate) | {"A.outer": Label("1000")}, 12.0) for plate in plates] == quick
    assert set(ended) == {True, False}


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
