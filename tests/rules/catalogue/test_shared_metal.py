"""What shared-metal states, what it sees by geometry and what the burns of a program show are the same pairs."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.facts import FactOptions, compute_facts
from kerfwise.encoder.nest import Nest, Part
from kerfwise.postproc.check.gouging import gouges
from kerfwise.postproc.check.plan_runs import runs_from_cuts
from kerfwise.rules.case import circle, cut, nest, part, rect
from kerfwise.rules.catalogue.shared_metal import SharedMetal, SharedMetalOptions
from kerfwise.tests.tools.amount import examples

RULE = SharedMetal()
GAPS_MM = [round(0.1 * k, 1) for k in range(31)]


@st.composite
def rows(draw: st.DrawFn) -> Nest:
    """Parts in a row, some of them rings with a guest, at gaps from 0 to 3 mm, turned by any angle."""
    turn_rad = draw(st.sampled_from([0.0, 0.3, 1.1]))
    x, parts = 10.0, list[Part]()
    for k in range(draw(st.integers(2, 5))):
        shape = draw(st.sampled_from(["plate", "disc", "host", "round host"]))
        gap_mm = draw(st.sampled_from(GAPS_MM))
        guest_mm = draw(st.sampled_from(GAPS_MM))
        match shape:
            case "plate":
                parts.append(part(f"P{k}", rect(x, 0, 20, 40)))
                x += 20
            case "disc":
                parts.append(part(f"P{k}", circle(x + 15, 20, 15)))
                x += 30
            case "host":
                wall_mm = draw(st.sampled_from([0.5, 1.0, 5.0]))
                parts.append(part(f"P{k}", rect(x, 0, 40, 40), [rect(x + wall_mm, 5, 30, 30)]))
                parts.append(part(f"P{k}g", rect(x + wall_mm + guest_mm, 15, 10, 10)))
                x += 40
            case _:
                parts.append(part(f"P{k}", circle(x + 20, 20, 20), [circle(x + 20, 20, 15)]))
                parts.append(part(f"P{k}g", circle(x + 20, 20 + guest_mm / 2, 15 - 1.5 * guest_mm - 0.01)))
                x += 40
        x += gap_mm
    return nest(1000, 1000, *(_turned(p, turn_rad) for p in parts))


def _turned(given: Part, by_rad: float) -> Part:
    def turned(row: list[float]) -> list[float]:
        cos, sin = math.cos(by_rad), math.sin(by_rad)
        return [300 + cos * row[0] - sin * row[1], 300 + sin * row[0] + cos * row[1], *row[2:]]

    outline = [turned(r) for r in given.outer.curve.as_rows()]
    return part(given.id, outline, [[turned(r) for r in hole.curve.as_rows()] for hole in given.holes])


def test_a_kerf_that_reaches_through_a_thin_wall_burns_what_lies_behind_it() -> None:
    """B's kerf burns through the wall of H, 0.4 mm, into G behind it; H's own kerfs do not reach G from outside."""
    sheet = nest(
        200, 100,
        part("B", rect(10, 10, 40, 40)),
        part("H", rect(50.5, 10, 60, 60), [rect(50.9, 20, 40, 40)]),
        part("G", rect(51.4, 30, 20, 20)),
    )  # fmt: skip
    stated = RULE.statements(compute_facts(sheet, FactOptions(), ()), SharedMetalOptions(2.0))
    pairs = [("B.outer", "H.outer"), ("B.outer", "G.outer"), ("H.hole1", "G.outer")]
    assert sorted(s.about.contours for s in stated) == sorted(pairs)
    cuts = CutSequence(tuple(cut(sheet, c.id) for c in sheet.contours))
    assert sorted(v.contours for v in RULE.violations(sheet, cuts, SharedMetalOptions(2.0))) == sorted(pairs)


@pytest.mark.slow
@examples(120)
@given(rows(), st.sampled_from([0.25, 0.75, 1.55, 2.25]))
def test_facts_geometry_and_burns_see_the_same_pairs(sheet: Nest, kerf_mm: float) -> None:
    """Gaps are whole tenths and kerfs are not, so that no gap lies on the line between what holds and what does not."""
    options = SharedMetalOptions(kerf_mm)
    cuts = CutSequence(tuple(cut(sheet, c.id) for c in sheet.contours))
    stated = {s.about.contours for s in RULE.statements(compute_facts(sheet, FactOptions(), ()), options)}
    seen = {v.contours for v in RULE.violations(sheet, cuts, options)}
    part_of = {c.id: c.part for c in sheet.contours}
    assert {frozenset(map(part_of.__getitem__, pair)) for pair in stated} == {
        frozenset(map(part_of.__getitem__, pair)) for pair in seen
    }
    runs, _ = runs_from_cuts(sheet, cuts, kerf_mm)
    loops = [run for run in runs if not run.marks]
    burnt = {frozenset(part_of[name] for name in v.contours) for v in gouges(sheet, loops, kerf_mm).violations}
    assert {pair for pair in burnt if len(pair) == 2} == {frozenset(map(part_of.__getitem__, pair)) for pair in stated}
