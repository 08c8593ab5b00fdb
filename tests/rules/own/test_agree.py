"""The two halves of own rules agree: facts with what is measured, and statements with what is judged."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations
from typing import Any

import pytest
from hypothesis import given

from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.candidates.candidate import LeadOptions
from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.facts import FactOptions, Facts, compute_facts
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import circle, cut, nest, part, rect
from kerfwise.rules.own import Thresholds, as_rule
from kerfwise.rules.own.known_nest import NAMED_FACTS, MeasuredNest, PlannedNest
from kerfwise.rules.statements import AtLeast, Before, Contiguous, Forbid, Lag, Move, NoGood, Precede, Statement
from kerfwise.tests.rules.own.made import rules_of
from kerfwise.tests.rules.test_statements_agree import sheets

RANKED = {
    name: replace(found, attributes={"rank": rank})
    for rank, (name, found) in enumerate(
        {
            "H": part("H", rect(10, 10, 150, 150), [rect(30, 30, 110, 110)], [[(12, 12), (20, 12)]]),
            "G": part("G", rect(50, 50, 40, 40)),
            "B": part("B", rect(200, 40, 160, 30), [circle(215, 55, 4)]),
            "C": part("C", rect(200, 90, 20, 20)),
        }.items(),
        1,
    )
}
SHEET = nest(400, 200, *RANKED.values())

RULES = [
    "- {name: r, select: {kind: hole, part: H}, before: {kind: hole, not: {part: H}}}",
    "- {name: r, select: {hosted: true}, after: {part: C}}",
    "- {name: r, select: {attribute.rank: 2..3, kind: outer}, first: true}",
    "- {name: r, select: {kind: mark}, last: true, scope: part}",
    "- {name: r, select: {long: true}, not_last: true}",
    "- {name: r, select: {area_mm2: '< 500'}, not_first: true, scope: zone}",
    "- {name: r, select: {edge_gap_mm: '>= 40', depth: [0, 2]}, together: true}",
    "- {name: r, select: {kind: outer}, apart: {cuts: 1, within: 40}}",
    "- {name: r, select: {kind: outer}, apart: {cuts: 2, from: {kind: hole}}, scope: attribute.rank}",
    "- {name: r, select: {id: ['C.*', 'G.*']}, one_stays_while: {kind: hole}}",
    "- {name: r, next: {same: part}, select: {kind: [hole, outer]}, scope: zone}",
    "- {name: r, select: {kind: outer}, next: {differs: attribute.rank, within: 1 mm}}",
    "- {name: r, select: {kind: outer}, next: {same: y_mm, within: 30}}",
    "- {name: r, select: {kind: hole}, next: {to: {kind: outer}}}",
    "- {name: r, select: {part: [B, C]}, next: {never: {hosted: true}}}",
    "- {name: r, select: {part: C}, within_time: 40 %}",
    "- {name: r, select: {part: [B, C]}, within_time: 20 s}",
    "- {name: r, select: {weight_kg: '> 0.2', kind: outer}, last: true}",
    "- {name: r, select: {cut_s: '< 5', x_mm: '> 150'}, first: true}",
]


def facts_of(sheet: Nest, candidates: Any = ()) -> Facts:
    return compute_facts(sheet, FactOptions(zone_contours=3), candidates)


@pytest.mark.slow
@given(sheets())
def test_facts_are_as_measured(sheet: Nest) -> None:
    facts = facts_of(sheet)
    cuts = CutSequence(tuple(cut(sheet, c.id, zone=int(facts.zone[k])) for k, c in enumerate(sheet.contours)))
    planned, judged = PlannedNest(facts), MeasuredNest(sheet, cuts, long_ratio=4.0, web_mm=25.0)
    for name in NAMED_FACTS:
        assert list(planned.values(name)) == list(judged.values(name)), name


def test_facts_of_a_small_sheet() -> None:
    known = MeasuredNest(SHEET, None, long_ratio=4.0, web_mm=25.0)
    ids = [c.id for c in SHEET.contours]

    def value(name: str, contour: str) -> object:
        return known.values(name)[ids.index(contour)]

    assert (value("depth", "G.outer"), value("depth", "H.hole1"), value("depth", "H.outer")) == (2, 1, 0)
    assert (value("host", "G.outer"), value("hosted", "H.hole1")) == ("H", False)
    assert (value("long", "B.outer"), value("long", "C.outer")) == (True, False)
    assert (value("short_side_mm", "B.outer"), value("long_side_mm", "B.outer")) == (30.0, 160.0)
    assert (value("width_mm", "H.mark1"), value("height_mm", "H.mark1"), value("area_mm2", "H.mark1")) == (
        8.0,
        0.0,
        0.0,
    )
    assert (value("right_gap_mm", "B.outer"), value("edge_gap_mm", "H.outer")) == (40.0, 10.0)
    assert [value("neighbours_count", f"{p}.outer") for p in "HGBC"] == [0, 0, 1, 1]
    assert (value("attribute.rank", "B.hole1"), value("attribute.none", "B.hole1")) == (3, None)
    assert value("zone", "B.hole1") is None


def holds(s: Statement, at: dict[int, int]) -> bool:
    """Whether a statement about order holds of contour → position."""
    match s:
        case Precede():
            return at[s.before] < at[s.after]
        case AtLeast():
            true = (isinstance(b, Before) and at[b.i] < at[b.j] for b in s.literals)
            return sum(w for w, t in zip(s.weights, true, strict=True) if t) >= s.bound
        case Contiguous():
            places = [at[c] for c in s.contours]
            return max(places) - min(places) < len(places)
        case Lag():
            return abs(at[s.first] - at[s.second]) > s.cuts
        case NoGood():
            return max(at[c] for c in s.out) > min(at[c] for c in s.left)
        case Move():
            return not any(at[j] == at[i] + 1 for i in s.leave for j in s.reach)
    raise AssertionError(s)


@pytest.mark.parametrize("text", RULES)
def test_every_order_is_judged_alike(text: str) -> None:
    (own,) = rules_of(text)
    rule, facts = as_rule(own), facts_of(SHEET)
    statements = list(rule.statements(facts, Thresholds()))
    cuts = [cut(SHEET, c.id, zone=int(facts.zone[k])) for k, c in enumerate(SHEET.contours)]
    admitted = refused = 0
    for order in list(permutations(range(facts.n)))[::7]:
        at = {contour: position for position, contour in enumerate(order)}
        kept = all(holds(s, at) for s in statements)
        broken = rule.violations(SHEET, CutSequence(tuple(cuts[k] for k in order)), Thresholds())
        assert kept == (not broken), order
        admitted, refused = admitted + kept, refused + (not kept)
    assert admitted > 0
    assert refused > 0


WAYS = [
    "- {name: r, select: {kind: [outer, hole]}, direction: cw}",
    "- {name: r, no_pierce: {left_gap_mm: '< 100'}, select: {kind: outer}}",
    "- {name: r, pierce: {y_mm: '> 60', x_mm: 0..300}, select: {kind: outer}}",
    "- {name: r, entry: {edge_gap_mm: '< 45'}}",
    "- {name: r, no_entry: {top_gap_mm: '> 100'}}",
]


@pytest.mark.parametrize("text", WAYS)
def test_every_candidate_is_judged_alike(text: str) -> None:
    (own,) = rules_of(text)
    rule = as_rule(own)
    facts = facts_of(SHEET, build_candidates(SHEET, LeadOptions()))
    forbidden = {s.candidate for s in rule.statements(facts, Thresholds()) if isinstance(s, Forbid)}
    assert 0 < len(forbidden) < len(facts.candidates)
    for number, c in enumerate(facts.candidates):
        one = cut(SHEET, SHEET.contours[c.contour].id, entry=c.entry, pierce=c.pierce, direction=c.direction)
        broken = rule.violations(SHEET, CutSequence((one,)), Thresholds())
        assert bool(broken) == (number in forbidden), (one, broken)
