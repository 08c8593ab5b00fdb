"""The clauses of Petunin 2009, fig. 2, each decided by a nest of its own."""

from __future__ import annotations

import pytest

from kerfwise.encoder.cut import Side
from kerfwise.encoder.facts import FactOptions, compute_facts
from kerfwise.encoder.nest import Nest, Part
from kerfwise.rules.case import nest, part, rect
from kerfwise.tests.encoder.facts.random_nests import mirrored

EVEN = part("E1", rect(30, 30, 200, 200)), part("E2", rect(770, 30, 200, 200))
"""The same on both sides, next to the edges."""


def decided(given: Nest, **options: object) -> tuple[Side, str]:
    facts = compute_facts(given, FactOptions(**options))  # type: ignore[arg-type]
    return facts.start_side, facts.start_side_because


def test_the_profile_fixes_the_side() -> None:
    assert decided(nest(1000, 400, *EVEN), start_side="top") == ("top", "profile")


def test_an_even_sheet_starts_at_its_first_narrow_side() -> None:
    assert decided(nest(1000, 400, *EVEN)) == ("left", "narrow-side")
    assert decided(nest(400, 1000, part("A", rect(30, 30, 340, 940)))) == ("bottom", "narrow-side")
    assert decided(nest(400, 400, part("A", rect(30, 30, 340, 340)))) == ("left", "narrow-side")


def test_long_parts_at_a_narrow_side() -> None:
    strip = part("strip", rect(925, 10, 50, 380))
    # More heat to the left and an offcut there speak for other sides; long parts come first.
    others = part("A", rect(300, 10, 190, 380)), part("B", rect(500, 10, 190, 380))
    assert decided(nest(1000, 400, *others, strip)) == ("right", "long-parts")


def test_the_side_with_more_long_parts() -> None:
    left = part("a", rect(10, 10, 40, 200))
    right = part("b", rect(950, 10, 40, 180)), part("c", rect(950, 210, 40, 180))
    assert decided(nest(1000, 400, left, *right)) == ("right", "long-parts")
    assert decided(nest(1000, 400, left, right[0]))[1] != "long-parts"


@pytest.mark.parametrize(("gap", "because"), [(24, "long-parts"), (25, "long-parts"), (26, "heat")])
def test_how_near_the_side_a_long_part_must_be(gap: float, because: str) -> None:
    assert decided(nest(1000, 400, *EVEN, part("s", rect(1000 - gap - 20, 240, 20, 120))))[1] == because


def test_a_large_offcut_at_one_end_starts_at_the_other() -> None:
    # The heat is in the left half, next to the offcut.
    parts = part("A", rect(200, 30, 250, 300)), part("B", rect(870, 30, 100, 100))
    assert decided(nest(1000, 400, *parts)) == ("right", "offcut")


def test_offcuts_at_both_ends_decide_nothing() -> None:
    parts = part("A", rect(200, 30, 100, 100)), part("B", rect(600, 30, 200, 200))
    assert decided(nest(1000, 400, *parts)) == ("right", "heat")


def test_more_small_parts_decide_when_the_cut_length_is_even() -> None:
    # 800 mm of cut on either side: one large square, or two small ones.
    two = part("A", rect(30, 30, 100, 100)), part("B", rect(30, 200, 100, 100))
    assert decided(nest(1000, 400, *two, part("C", rect(770, 30, 200, 200)))) == ("left", "heat")


@pytest.mark.parametrize(
    "parts",
    [
        (part("strip", rect(10, 10, 50, 380)),),
        (part("A", rect(30, 30, 300, 300)),),
        (*EVEN, part("C", rect(600, 250, 100, 100))),
    ],
)
def test_the_mirror_image_starts_at_the_other_side(parts: tuple[Part, ...]) -> None:
    given = nest(1000, 400, *parts)
    (side, because), (other, other_because) = decided(given), decided(mirrored(given))
    assert because == other_because != "narrow-side"
    assert {side, other} == {"left", "right"}
