from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.cut import Direction
from kerfwise.encoder.facts import FactOptions, Facts, compute_facts
from kerfwise.encoder.facts.facts import Stretch
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import nest, part, rect
from kerfwise.tests.encoder.facts.random_nests import nests
from kerfwise.tests.tools.amount import examples


def bare(given_nest: Nest, contour: int, entry_mm: float, direction: Direction) -> Candidate:
    """A candidate without leads."""
    curve = given_nest.contours[contour].curve
    at = curve.point_at(entry_mm)
    return Candidate(contour, entry_mm, at, direction, at, None, None, at, curve.length_mm)


def faced(stretch: Stretch, row: int, facts: Facts) -> dict[str, float]:
    """What one candidate's head or tail faces, rounded, nothing left out but zeros."""
    near = stretch.neighbours
    lengths = {"edge": stretch.edge_mm[row], "solid": stretch.solid_mm[row]}
    for r, j, s in zip(near.row, near.neighbour, near.length_mm, strict=True):
        if r == row:
            lengths[facts.nest.contours[j].part] = s
    return {k: round(float(v), 3) for k, v in lengths.items() if v > 1e-9}


# The square A, 80 mm a side, has the edge below and to the left, B to the right, solid metal above. It is drawn
# counter-clockwise from its lower left corner: 0–80 edge, 80–160 B, 160–240 solid, 240–320 edge.
SQUARE = nest(400, 400, part("A", rect(10, 10, 80, 80)), part("B", rect(100, 10, 80, 80)))


@pytest.mark.parametrize(
    ("entry_mm", "direction", "head", "tail"),
    [
        (0, "ccw", {"edge": 80}, {"edge": 80}),
        (80, "ccw", {"B": 80}, {"edge": 80}),
        (80, "cw", {"edge": 80}, {"B": 80}),
        (240, "ccw", {"edge": 80}, {"solid": 80}),
        (200, "ccw", {"solid": 40, "edge": 40}, {"B": 40, "solid": 40}),
        (200, "cw", {"B": 40, "solid": 40}, {"solid": 40, "edge": 40}),
        (40, "cw", {"edge": 80}, {"edge": 40, "B": 40}),
        (300, "ccw", {"edge": 80}, {"solid": 20, "edge": 60}),
    ],
)
def test_a_square(entry_mm: float, direction: Direction, head: dict[str, float], tail: dict[str, float]) -> None:
    facts = compute_facts(SQUARE, FactOptions(), (bare(SQUARE, 0, entry_mm, direction),))
    assert faced(facts.head, 0, facts) == head
    assert faced(facts.tail, 0, facts) == tail


def test_the_shares_are_options() -> None:
    candidate = bare(SQUARE, 0, 80, "ccw")
    facts = compute_facts(SQUARE, FactOptions(head_share=0.5, tail_share=1.0), (candidate,))
    assert faced(facts.head, 0, facts) == {"B": 80, "solid": 80}
    assert faced(facts.tail, 0, facts) == {"edge": 160, "B": 80, "solid": 80}


def test_a_contour_drawn_clockwise_is_followed_the_other_way() -> None:
    drawn = nest(400, 400, part("A", rect(10, 10, 80, 80)[::-1]), part("B", rect(100, 10, 80, 80)))
    # Drawn from the upper left corner: 0–80 to the upper right (solid), 80–160 down (B).
    facts = compute_facts(drawn, FactOptions(), (bare(drawn, 0, 80, "cw"), bare(drawn, 0, 80, "ccw")))
    assert faced(facts.head, 0, facts) == {"B": 80} == faced(facts.tail, 1, facts)
    assert faced(facts.tail, 0, facts) == {"solid": 80} == faced(facts.head, 1, facts)


def test_holes_and_marks_face_solid_metal_only() -> None:
    given_nest = nest(400, 400, part("A", rect(10, 10, 80, 80), [rect(20, 20, 60, 60)], [[(12, 12), (32, 12)]]))
    candidates = (bare(given_nest, 0, 0, "ccw"), bare(given_nest, 1, 30, "ccw"))
    facts = compute_facts(given_nest, FactOptions(), candidates)
    assert [faced(facts.tail, k, facts) for k in (0, 1)] == [{"solid": 5}, {"solid": 60}]


def test_candidates_are_found_by_contour() -> None:
    candidates = (bare(SQUARE, 0, 0, "ccw"), bare(SQUARE, 1, 0, "ccw"), bare(SQUARE, 1, 9, "cw"))
    facts = compute_facts(SQUARE, FactOptions(), candidates)
    assert [list(facts.candidates_of(i)) for i in range(facts.n)] == [[0], [1, 2]]


@given(given_nest=nests(), share=st.floats(0, 1), entry=st.floats(0, 1))
@examples(30)
def test_lengths_add_up_and_the_tail_one_way_is_the_head_the_other_way(
    given_nest: Nest, share: float, entry: float
) -> None:
    candidates = tuple(
        bare(given_nest, i, c.curve.length_mm * entry, direction)
        for i, c in enumerate(given_nest.contours)
        if c.kind != "mark"
        for direction in ("cw", "ccw")
    )
    options = FactOptions(head_share=share, tail_share=share)
    facts = compute_facts(given_nest, options, candidates)
    for k in range(0, len(candidates), 2):
        length_mm = candidates[k].cut_mm
        head, tail = faced(facts.head, k, facts), faced(facts.tail, k + 1, facts)
        assert head == pytest.approx(tail, abs=0.002)
        assert sum(head.values()) == pytest.approx(share * length_mm, abs=0.01)

    whole = compute_facts(given_nest, FactOptions(head_share=1.0), candidates)
    for k, candidate in enumerate(candidates):
        assert whole.head.edge_mm[k] == pytest.approx(facts.edge_length_mm[candidate.contour].sum())
        assert whole.head.solid_mm[k] == pytest.approx(facts.solid_mm[candidate.contour], abs=1e-6)
