from __future__ import annotations

import pytest

from kerfwise.encoder.facts.outlines import outlines_of
from kerfwise.encoder.facts.relations import closure_of, outermost_of, parents_of
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import circle, nest, part, rect

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
