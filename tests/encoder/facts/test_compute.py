"""Properties of the facts as a whole."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.cut import Side
from kerfwise.encoder.facts import FactOptions, Facts, compute_facts
from kerfwise.encoder.facts.outlines import OPPOSITE, ROUNDING_MM
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest, Sheet
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.tests.encoder.facts.random_nests import mirrored, moved, nests
from kerfwise.tests.tools.amount import examples

SWAPPED = [1, 0, 2, 3]
"""SIDES with left and right exchanged."""
CELL_MM = 5.0
"""What rounding can change about a facing length: one cell."""


def assert_same(one: Facts, other: Facts, sides: list[int]) -> None:
    """The facts agree when the sides of `one` are read in that order."""
    assert one.parent.tolist() == other.parent.tolist()
    assert one.contains.tolist() == other.contains.tolist()
    assert one.level_ahead.tolist() == other.level_ahead.tolist()
    assert one.in_hull.tolist() == other.in_hull.tolist()
    assert one.long.tolist() == other.long.tolist()
    assert one.zone.tolist() == other.zone.tolist()
    assert one.edge_gap_mm[:, sides] == pytest.approx(other.edge_gap_mm, abs=1e-6)
    assert one.edge_length_mm[:, sides] == pytest.approx(other.edge_length_mm, abs=CELL_MM)
    assert one.solid_mm == pytest.approx(other.solid_mm, abs=2 * CELL_MM)
    assert one.offcut_mm[sides] == pytest.approx(other.offcut_mm)
    assert one.offcut_large[sides].tolist() == other.offcut_large.tolist()
    assert one.heat_mm[sides] == pytest.approx(other.heat_mm, abs=1e-6)
    assert one.heat_parts[sides].tolist() == other.heat_parts.tolist()
    facing, other_facing = (
        {(i, j): s for i, j, s in zip(f.row, f.neighbour, f.length_mm, strict=True)}
        for f in (one.neighbours, other.neighbours)
    )
    for pair in facing.keys() | other_facing.keys():
        assert facing.get(pair, 0.0) == pytest.approx(other_facing.get(pair, 0.0), abs=CELL_MM)


@given(given_nest=nests(), side=st.sampled_from(["left", "right"]))
@examples(40)
def test_the_mirror_image_swaps_left_and_right(given_nest: Nest, side: Side) -> None:
    one = compute_facts(given_nest, FactOptions(start_side=side, zone_contours=3))
    other = compute_facts(mirrored(given_nest), FactOptions(start_side=OPPOSITE[side], zone_contours=3))
    assert_same(one, other, SWAPPED)


@given(given_nest=nests())
@examples(25)
def test_the_mirror_image_starts_at_the_other_side(given_nest: Nest) -> None:
    one, other = (compute_facts(n, FactOptions()) for n in (given_nest, mirrored(given_nest)))
    assert one.start_side_because == other.start_side_because
    expected = one.start_side
    if one.start_side in ("left", "right") and one.start_side_because != "narrow-side":
        expected = OPPOSITE[one.start_side]
    assert other.start_side == expected


@given(given_nest=nests(), dx=st.floats(-5000, 5000), dy=st.floats(-5000, 5000))
@examples(40)
def test_moving_the_sheet_changes_nothing(given_nest: Nest, dx: float, dy: float) -> None:
    options = FactOptions(zone_contours=3)
    one, other = compute_facts(given_nest, options), compute_facts(moved(given_nest, dx, dy), options)
    assert (one.start_side, one.start_side_because) == (other.start_side, other.start_side_because)
    assert_same(one, other, [0, 1, 2, 3])


@given(nests())
@examples(25)
def test_what_a_contour_faces_adds_up_to_its_length(given_nest: Nest) -> None:
    facts = compute_facts(given_nest, FactOptions())
    near = np.bincount(facts.neighbours.row, weights=facts.neighbours.length_mm, minlength=facts.n)
    total = facts.edge_length_mm.sum(axis=1) + facts.solid_mm + near
    assert total == pytest.approx([c.curve.length_mm for c in given_nest.contours])
    assert (facts.neighbours.gap_mm <= facts.options.web_mm + ROUNDING_MM).all()


def test_without_parts() -> None:
    facts = compute_facts(nest(300, 200), FactOptions())
    assert (facts.n, facts.first.tolist(), facts.level_ahead.shape) == (0, [0], (0, 2))


def test_without_candidates() -> None:
    facts = compute_facts(nest(300, 200, part("A", rect(10, 10, 50, 50))), FactOptions())
    assert facts.first.tolist() == [0, 0]
    assert facts.head.total_mm.shape == facts.tail.edge_mm.shape == (0,)


def test_with_marks_only_beside_one_part_and_a_sheet_of_any_shape() -> None:
    sheet = Sheet(Curve.of([(0, 0), (300, 0), (300, 100), (150, 200), (0, 200)]), (Curve.of(circle(60, 150, 20)),))
    marked = part("A", rect(10, 10, 50, 50), [], [[(20, 20), (30, 30)], [(20, 30), (30, 20), (40, 40)]])
    facts = compute_facts(Nest(sheet, (marked,)), FactOptions())
    assert facts.parent.tolist() == [2, 2, -1]
    assert facts.zone.tolist() == [1, 1, 1]


def test_a_ring_that_touches_itself_is_a_contour_like_any_other() -> None:
    """Drawings have such rings; shapely calls them invalid."""
    pinched = part("A", [(10, 10), (110, 10), (110, 110), (60, 60), (60, 110), (60, 60), (10, 110)])
    beside = part("B", rect(120, 20, 60, 60))
    facts = compute_facts(nest(300, 200, pinched, beside), FactOptions(start_side="left"))
    assert facts.level_ahead.tolist() == [[0, 1]]
    assert {(0, 1), (1, 0)} == set(zip(facts.neighbours.row.tolist(), facts.neighbours.neighbour.tolist(), strict=True))
