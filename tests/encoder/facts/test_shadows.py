from __future__ import annotations

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.cut import Side
from kerfwise.encoder.facts.facts import SIDES
from kerfwise.encoder.facts.outlines import outlines_of
from kerfwise.encoder.facts.relations import level_ahead, parents_of
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import nest, part, rect
from kerfwise.tests.encoder.facts.random_nests import nests
from kerfwise.tests.tools.amount import examples

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
