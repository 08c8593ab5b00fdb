from __future__ import annotations

import pytest

from kerfwise.encoder.facts.outlines import outlines_of
from kerfwise.encoder.facts.relations import hull_pairs as hull_pairs_hulls
from kerfwise.encoder.facts.relations import parents_of
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import circle, nest, part, rect

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
