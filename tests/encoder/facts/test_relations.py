"""What lies in what, in whose shadow, in whose hull; and where heat, offcuts and long parts are."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise import Nest
from kerfwise.encoder.facts.facts import SIDES
from kerfwise.encoder.facts.outlines import outlines_of
from kerfwise.encoder.facts.relations import (
    closure_of,
    edge_gaps,
    heat,
    level_ahead,
    long_parts,
    offcuts,
    outermost_of,
    parents_of,
)
from kerfwise.encoder.facts.relations import hull_pairs as hull_pairs_hulls
from kerfwise.rule_kit import Side, circle, nest, part, rect
from kerfwise.rules.case import Rows
from kerfwise.tests.encoder.facts.random_nests import nests
from kerfwise.tests.tools.amount import examples

FRAME = part("A", rect(0, 0, 300, 300), [rect(50, 50, 200, 200)])


def parents(given: Nest) -> dict[str, str | None]:
    ids = [c.id for c in given.contours]
    parent = parents_of(outlines_of(given)).tolist()
    return {c: ids[p] if p >= 0 else None for c, p in zip(ids, parent, strict=True)}


def test_holes_and_marks_lie_in_their_own_outer_contour() -> None:
    given = nest(400, 400, part("A", rect(0, 0, 100, 100), [circle(50, 50, 10)], [[(5, 5), (90, 5)]]))
    assert parents(given) == {"A.mark1": "A.outer", "A.hole1": "A.outer", "A.outer": None}


def test_a_part_in_a_hole_lies_in_that_hole() -> None:
    assert parents(nest(400, 400, FRAME, part("B", rect(100, 100, 50, 50))))["B.outer"] == "A.hole1"


@pytest.mark.parametrize("x", [50, 49.99], ids=["touches the hole", "reaches a hair over it"])
def test_a_part_that_touches_the_hole_still_lies_in_it(x: float) -> None:
    assert parents(nest(400, 400, FRAME, part("B", rect(x, 100, 50, 50))))["B.outer"] == "A.hole1"


def test_a_part_beside_a_hole_or_around_it_does_not_lie_in_it() -> None:
    around = part("B", rect(-50, -50, 400, 400), [rect(-10, -10, 320, 320)])
    given = parents(nest(400, 400, FRAME, around, part("C", rect(360, 0, 20, 20))))
    assert (given["B.outer"], given["C.outer"], given["A.outer"]) == (None, None, "B.hole1")


def test_the_smallest_of_nested_holes_is_the_parent() -> None:
    middle = part("B", rect(60, 60, 180, 180), [rect(80, 80, 140, 140)])
    given = nest(400, 400, part("C", rect(100, 100, 60, 60)), middle, FRAME)
    assert parents(given)["C.outer"] == "B.hole1"
    parent = parents_of(outlines_of(given))
    ids = [c.id for c in given.contours]
    inside_a = {ids[b] for a, b in closure_of(parent).tolist() if ids[a] == "A.outer"}
    assert inside_a == {"A.hole1", "B.outer", "B.hole1", "C.outer"}
    assert {ids[t] for t in outermost_of(parent).tolist()} == {"A.outer"}


def test_a_hole_contains_no_part_of_a_wider_host_that_shares_its_middle() -> None:
    """A small ring in the hole of a large one: a point of the large one may lie in the small hole."""
    ring = part("B", circle(150, 150, 60), [circle(150, 150, 40)])
    assert parents(nest(400, 400, FRAME, ring))["A.outer"] is None


def test_holes_larger_than_their_parts_do_not_lead_in_circles() -> None:
    """No reader lets such a nest pass; it must not hang all the same."""
    wrong = (
        part("A", rect(0, 0, 100, 100), [rect(-50, -50, 300, 300)]),
        part("B", rect(0, 0, 99, 99), [rect(-50, -50, 300, 300)]),
    )
    assert set(parents(nest(400, 400, *wrong)).values()) == {"A.outer", "B.outer", "A.hole1", None}


DIRECTION = {"left": (1, 0), "right": (-1, 0), "bottom": (0, 1), "top": (0, -1)}


def ahead(given_nest: Nest, side: Side) -> set[tuple[str, str]]:
    """The (j, i) pairs by part id."""
    outlines = outlines_of(given_nest)
    parts = [c.part for c in given_nest.contours]
    return {(parts[j], parts[i]) for j, i in level_ahead(outlines, parents_of(outlines), side).tolist()}


@pytest.mark.parametrize(
    ("side", "expected"),
    [
        ("left", {("A", "B")}),
        ("right", {("B", "A")}),
        ("bottom", {("A", "C")}),
        ("top", {("C", "A")}),
    ],
)
def test_each_start_side(side: Side, expected: set[tuple[str, str]]) -> None:
    parts = part("A", rect(0, 0, 50, 50)), part("B", rect(100, 0, 50, 50)), part("C", rect(0, 100, 50, 50))
    assert ahead(nest(200, 200, *parts), side) == expected


@pytest.mark.parametrize(
    ("y", "height", "holds"),
    [(124.9, 100, True), (125, 100, True), (125.1, 100, False), (25.1, 100, True), (25, 100, True), (24.9, 100, False)],
)
def test_the_centroid_decides_and_the_rim_of_the_shadow_belongs_to_it(y: float, height: float, holds: bool) -> None:
    # The centroid of A is at y = 125; B reaches from just below it upwards, then from just above it downwards.
    parts = part("A", rect(0, 100, 50, 50)), part("B", rect(100, y, 50, height))
    assert (("A", "B") in ahead(nest(200, 300, *parts), "left")) == holds


def test_a_part_in_a_mouth_lies_ahead_of_what_closes_it_but_not_of_a_mouth_that_opens_away() -> None:
    channel = [(0, 0), (100, 0), (100, 20), (20, 20), (20, 80), (100, 80), (100, 100), (0, 100)]
    parts = part("channel", channel), part("guest", rect(40, 30, 60, 40))
    assert ("guest", "channel") not in ahead(nest(200, 200, *parts), "left")
    assert ("guest", "channel") in ahead(nest(200, 200, *parts), "right")


def test_only_parts_in_the_same_place_have_levels() -> None:
    frame = part("frame", rect(100, 0, 300, 300), [rect(120, 20, 260, 260)])
    guests = part("G", rect(130, 100, 50, 50)), part("H", rect(300, 100, 50, 50))
    outside = part("out", rect(0, 100, 50, 50))
    assert ahead(nest(500, 300, frame, *guests, outside), "left") == {("G", "H"), ("out", "frame")}


@given(given_nest=nests(), side=st.sampled_from(SIDES))
@examples(60)
def test_agrees_with_rays_cast_one_by_one(given_nest: Nest, side: Side) -> None:
    dx, dy = DIRECTION[side]
    outers = [p.outer for p in given_nest.parts]
    holes = [(h, h.polygon) for p in given_nest.parts for h in p.holes]

    def place(part_index: int) -> str:
        inside = [h.id for h, area in holes if area.contains(outers[part_index].polygon)]
        assert len(inside) <= 1
        return inside[0] if inside else ""

    expected = set()
    for j, a in enumerate(outers):
        centre = a.polygon.centroid
        ray = shapely.LineString([centre, (centre.x + 9999 * dx, centre.y + 9999 * dy)])
        for i, b in enumerate(outers):
            inside = b.polygon.contains(centre)
            if i != j and place(i) == place(j) and not inside and ray.distance(b.polygon) < 1e-6:
                expected.add((a.part, b.part))
    assert ahead(given_nest, side) == expected


BRACKET = part("L", [(0, 0), (200, 0), (200, 40), (40, 40), (40, 200), (0, 200)])


def hull_pairs(given: Nest) -> set[tuple[str, str]]:
    outlines = outlines_of(given)
    parts = [c.part for c in given.contours]
    return {(parts[j], parts[i]) for j, i in hull_pairs_hulls(outlines, parents_of(outlines)).tolist()}


@pytest.mark.parametrize(
    ("corner", "holds"), [((50, 50), True), ((100, 100), True), ((101, 101), False)], ids=["inside", "on it", "out"]
)
def test_the_centroid_decides(corner: tuple[float, float], holds: bool) -> None:
    # The hull of the bracket ends on the line from (200, 40) to (40, 200), through (120, 120).
    guest = part("G", rect(*corner, 40, 40))
    assert (hull_pairs(nest(300, 300, BRACKET, guest)) == {("G", "L")}) == holds


def test_a_part_around_another_is_not_in_its_concavity() -> None:
    """The centroid of the trough lies in the dented plate it holds: the plate goes first, and no cycle comes of it."""
    trough = [(0, 0), (200, 0), (200, 200), (140, 200), (140, 60), (60, 60), (60, 200), (0, 200)]
    plate = [(70, 70), (130, 70), (130, 130), (100, 120), (70, 130)]
    assert hull_pairs(nest(300, 300, part("plate", plate), part("trough", trough))) == {("plate", "trough")}


@pytest.mark.parametrize(("bulge", "expected"), [(1.0, set()), (-1.0, {("guest", "plate")})])
def test_an_arc_inwards_makes_a_concavity_and_one_outwards_does_not(
    bulge: float, expected: set[tuple[str, str]]
) -> None:
    plate = part("plate", [(200, 0), (400, 0), (400, 200), (200, 200, bulge)])
    guest = part("guest", circle(225 if bulge < 0 else 50, 100, 10))
    assert hull_pairs(nest(500, 300, plate, guest)) == expected


def test_what_lies_in_a_hole_is_not_in_the_hull_of_its_host() -> None:
    host = part("H", [(0, 0), (300, 0), (300, 300), (280, 300), (280, 20), (0, 20)], [circle(290, 150, 8)])
    assert hull_pairs(nest(500, 500, host, part("G", circle(290, 150, 4)))) == set()


def heat_of(given: Nest) -> tuple[list[float], list[int]]:
    cut_mm, parts = heat(outlines_of(given), given.sheet.bounds)
    return cut_mm.tolist(), parts.tolist()


def test_cut_length_is_split_exactly_at_the_middle() -> None:
    # 500 | 500: 100 of each long side lie to the left, 50 of them to the right.
    cut_mm, _ = heat_of(nest(1000, 400, part("A", rect(400, 10, 150, 80))))
    assert cut_mm == [100 * 2 + 80, 50 * 2 + 80, 460, 0]


def test_holes_count_and_marks_do_not() -> None:
    hole = circle(100, 100, 10)
    plate = part("A", rect(50, 50, 100, 100), [hole], [[(60, 60), (140, 60)]])
    cut_mm, _ = heat_of(nest(1000, 400, plate))
    assert cut_mm == pytest.approx([400 + 62.83, 0, 400 + 62.83, 0], abs=0.05)


def test_a_line_on_the_middle_counts_half_on_each_side() -> None:
    cut_mm, _ = heat_of(nest(1000, 400, part("A", rect(500, 10, 100, 80))))
    assert cut_mm[:2] == [40, 320]


def test_small_parts_are_counted_by_centroid() -> None:
    parts = part("A", rect(10, 10, 50, 50)), part("B", rect(10, 100, 60, 60)), part("C", rect(600, 10, 300, 300))
    assert heat_of(nest(1000, 400, *parts))[1] == [2, 0, 2, 0]
    assert heat_of(nest(1000, 400, part("A", rect(475, 10, 50, 50))))[1][:2] == [0, 0]


def test_gaps_are_to_left_right_bottom_top() -> None:
    given = nest(1000, 500, part("A", rect(10, 20, 300, 400), [rect(100, 100, 50, 50)]))
    gaps = edge_gaps(outlines_of(given), given.sheet.bounds)
    assert gaps.tolist() == [[100, 850, 100, 350], [10, 690, 20, 80]]


@pytest.mark.parametrize(("gap", "large"), [(149, False), (150, False), (151, True)])
def test_an_offcut_is_large_over_its_share_of_the_extent_that_way(gap: float, large: bool) -> None:
    depth, is_large = offcuts(np.array([[gap, 10.0, 10.0, 10.0], [400.0, 500.0, 10.0, 10.0]]), (0, 0, 1000, 500), 0.15)
    assert depth.tolist() == [gap, 10, 10, 10]
    assert is_large.tolist() == [large, False, False, False]


def test_an_empty_sheet_is_all_offcut() -> None:
    depth, large = offcuts(np.empty((0, 4)), (0, 0, 1000, 500), 0.15)
    assert depth.tolist() == [1000, 1000, 500, 500]
    assert large.all()


def turned(rows: Rows, degrees: float) -> Rows:
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return [(300 + x * c - y * s, 300 + x * s + y * c) for x, y in rows]


@pytest.mark.parametrize("degrees", [0, 30, 90, 137])
@pytest.mark.parametrize(("length", "is_long"), [(199, False), (200, True), (201, True)])
def test_four_to_one_at_any_angle(degrees: float, length: float, is_long: bool) -> None:
    strip = part("A", turned(rect(0, 0, length, 50), degrees), [turned(rect(10, 10, 40, 2), degrees)])
    assert long_parts(outlines_of(nest(900, 900, strip)), 4.0).tolist() == [False, is_long]
