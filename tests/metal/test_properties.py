"""What must hold of the simulation whatever it is given."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.tests.encoder.facts.random_nests import moved
from kerfwise.tests.metal.arcs import Point
from kerfwise.tests.metal.findings import Finding
from kerfwise.tests.metal.hand_made import CUTS, HALF, KERF_MM, Blocks, around, inside, program, sheet, with_cut
from kerfwise.tests.metal.simulate import simulate
from kerfwise.tests.tools.amount import examples

BY_CUT = ("part-eroded", "pierce-over-void", "lead-over-void", "pierce-in-part", "off-sheet", "loose-part-burnt")
"""Kinds that a cut is charged with when it is made: what comes after changes nothing."""


@st.composite
def cuts(draw: st.DrawFn) -> list[tuple[str, Blocks]]:
    """The cuts of the hand-made sheet in any order, rings pierced anywhere near and up to 1 mm off."""

    def near(x: float, y: float) -> tuple[float, float]:
        return x + draw(st.integers(-60, 60)) / 10, y + draw(st.integers(-60, 60)) / 10

    off = draw(st.sampled_from([0.3, 0.9, HALF, 1.04, 1.6]))
    rings: list[tuple[str, Blocks]] = [
        ("A.outer", around(20, 20, 50, 50, near(14, 45), off)),
        ("B.outer", around(90, 20, 50, 50, near(80, 45), off)),
        ("A.hole1", inside(45, 45, 8, near(45, 45))),
    ]
    return [CUTS[0], *draw(st.permutations(rings))]


def judged(made: list[tuple[str, Blocks]], **more: float) -> list[Finding]:
    return simulate(sheet(), program(made), KERF_MM, **more)  # type: ignore[arg-type]


@pytest.mark.slow
@given(cuts(), st.integers(1, 3))
@examples(30)
def test_what_comes_later_changes_nothing_of_what_was_burnt(made: list[tuple[str, Blocks]], count: int) -> None:
    whole = [f for f in judged(made) if f.kind in BY_CUT and f.cut <= count]
    assert [f for f in judged(made[:count]) if f.kind in BY_CUT] == whole


@pytest.mark.slow
@given(cuts())
@examples(30)
def test_more_cuts_leave_no_more_uncut(made: list[tuple[str, Blocks]]) -> None:
    before = {f.contours for f in judged(made[:-1]) if f.kind == "left-uncut"}
    assert {f.contours for f in judged(made) if f.kind == "left-uncut"} <= before


@pytest.mark.slow
@given(cuts(), st.floats(0, 3), st.floats(0, 3))
@examples(30)
def test_a_wider_splash_finds_no_less(made: list[tuple[str, Blocks]], one: float, other: float) -> None:
    def found(splash_mm: float) -> set[tuple[int, Point]]:
        return {(f.cut, f.place) for f in judged(made, splash_mm=splash_mm) if f.kind == "pierce-over-void"}

    assert found(min(one, other)) <= found(max(one, other))


@pytest.mark.slow
@given(cuts(), st.integers(-5000, 5000), st.integers(-5000, 5000))
@examples(20)
def test_the_place_of_a_sheet_does_not_matter(made: list[tuple[str, Blocks]], dx: int, dy: int) -> None:
    here = judged(made)
    text = program(made)
    there = simulate(moved(sheet(), dx, dy), _shifted(text, dx, dy), KERF_MM)
    assert [(f.kind, f.cut, f.contours) for f in there] == [(f.kind, f.cut, f.contours) for f in here]
    assert [f.size for f in there] == pytest.approx([f.size for f in here], abs=0.02)


def _shifted(text: str, dx: int, dy: int) -> str:
    def word(said: str) -> str:
        if said[:1] in "XY" and said[1:2] in "-0123456789":
            return f"{said[0]}{float(said[1:]) + (dx if said[0] == 'X' else dy):.6f}"
        return said

    return "\n".join(line if line.startswith("(") else " ".join(map(word, line.split())) for line in text.splitlines())


@given(st.floats(0.08, 0.9))
@examples(20)
def test_the_depth_that_is_told_is_the_depth_that_was_burnt(depth_mm: float) -> None:
    found = simulate(sheet(), with_cut("A.outer", around(20, 20, 50, 50, (14, 45), HALF - round(depth_mm, 4))), KERF_MM)
    (eroded,) = [f for f in found if f.kind == "part-eroded"]
    assert eroded.size == pytest.approx(depth_mm, abs=0.01)
    area = float(eroded.text.split()[0])
    assert area == pytest.approx(200 * depth_mm - 4 * depth_mm**2, rel=0.02, abs=0.1)
    assert not math.isnan(area)
