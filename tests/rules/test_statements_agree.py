"""The two halves of each rule agree: an order satisfies the statements exactly when it breaks nothing by geometry."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import permutations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.facts import FactOptions, Facts, compute_facts
from kerfwise.encoder.nest import Nest, Part
from kerfwise.rules.case import circle, cut, nest, part, rect
from kerfwise.rules.catalogue.heat_lag import HeatLagOptions
from kerfwise.rules.catalogue.marks_first import MarksFirstOptions
from kerfwise.rules.catalogue.part_contiguous import PartContiguousOptions
from kerfwise.rules.catalogue.shared_metal import SharedMetalOptions
from kerfwise.rules.registry import RULES
from kerfwise.rules.statements import AtLeast, Before, Contiguous, Lag, Precede, Statement

HOST = part("H", rect(10, 10, 150, 150), [rect(30, 30, 110, 110), circle(22, 22, 5)])
SHEETS = {
    "host and guest": nest(400, 200, HOST, part("G", rect(50, 50, 40, 40)), part("B", rect(200, 40, 60, 60))),
    "two with marks": nest(
        400, 200,
        part("A", rect(10, 10, 80, 80), [circle(50, 50, 9)], [[(20, 20), (40, 20)], [(20, 80), (40, 80)]]),
        part("B", rect(110, 10, 80, 80), [], [[(120, 20), (140, 20)]]),
    ),
    "channel and disc": nest(
        400, 200,
        part("C", [(10, 10), (210, 10), (210, 40), (40, 40), (40, 160), (210, 160), (210, 190), (10, 190)]),
        part("D", circle(150, 100, 40)), part("E", rect(240, 20, 50, 50)), part("F", rect(240, 100, 50, 50)),
    ),
}  # fmt: skip
OPTIONS = {
    "marks-first": [MarksFirstOptions(scope="sheet"), MarksFirstOptions(scope="part")],
    "heat-lag": [HeatLagOptions(heat_radius_mm=25.0)],
    "shared-metal": [SharedMetalOptions(kerf_mm=1.5)],
    "part-contiguous": [PartContiguousOptions(marks="apart"), PartContiguousOptions(marks="together")],
}
CHOICES = [(rule, options) for rule in RULES for options in OPTIONS.get(rule, [RULES[rule].Options()])]


def facts_of(sheet: Nest) -> Facts:
    return compute_facts(sheet, FactOptions(zone_contours=2), ())


def hold(statements: Iterable[Statement], order: tuple[int, ...]) -> bool:
    """Whether an order of contour numbers satisfies the statements that are about order only."""
    at = {contour: k for k, contour in enumerate(order)}
    for s in statements:
        if isinstance(s, Precede) and at[s.before] > at[s.after]:
            return False
        if isinstance(s, Contiguous):
            places = [at[c] for c in s.contours]
            if max(places) - min(places) >= len(places):
                return False
        if isinstance(s, Lag) and abs(at[s.first] - at[s.second]) <= s.cuts:
            return False
        if isinstance(s, AtLeast):
            true = [
                w
                for lit, w in zip(s.literals, s.weights, strict=True)
                if isinstance(lit, Before) and at[lit.i] < at[lit.j]
            ]
            if sum(true) < s.bound:
                return False
    return True


@pytest.mark.parametrize("sheet", SHEETS)
@pytest.mark.parametrize(("rule", "options"), CHOICES, ids=str)
def test_every_order_is_judged_alike(rule: str, options: object, sheet: str) -> None:
    drawn = SHEETS[sheet]
    facts = facts_of(drawn)
    statements = list(RULES[rule].statements(facts, options))
    if rule in (
        "cut-direction",
        "pierce",
        "locks",
        "start-side",
        "part-rigidity",
        "no-narrow-strips",
        "t-max",
        "hold-small-parts",
    ):
        assert statements == []
        return
    if rule == "no-tip-travel":
        assert [s.about.contours[0] for s in statements] == [p.outer.id for p in drawn.parts]
        return
    cuts = [cut(drawn, c.id, zone=int(facts.zone[k])) for k, c in enumerate(drawn.contours)]
    admitted = 0
    for order in permutations(range(facts.n)):
        sequence = CutSequence(tuple(cuts[k] for k in order), facts.start_side)
        holds = hold(statements, order)
        assert holds == (not RULES[rule].violations(drawn, sequence, options)), order
        admitted += holds
    assert admitted > 0


@pytest.mark.parametrize("sheet", SHEETS)
@pytest.mark.parametrize(("rule", "options"), CHOICES, ids=str)
def test_the_check_knows_every_order_that_is_stated(rule: str, options: object, sheet: str) -> None:
    drawn = SHEETS[sheet]
    facts = facts_of(drawn)
    stated = [s for s in RULES[rule].statements(facts, options) if isinstance(s, Precede | Contiguous)]
    cuts = [cut(drawn, c.id, zone=int(facts.zone[k])) for k, c in enumerate(drawn.contours)]
    pairs = RULES[rule].pairs(drawn, CutSequence(tuple(cuts), facts.start_side), options)
    runs = RULES[rule].together(drawn, options)
    names = [c.id for c in drawn.contours]
    for order in permutations(range(facts.n)):
        at = {names[c]: k for k, c in enumerate(order)}
        spans = [sorted(at[name] for name in run) for run in runs]
        kept = all(at[a] < at[b] for a, b in pairs) and all(s[-1] - s[0] == len(s) - 1 for s in spans)
        assert kept == hold(stated, order), order


@st.composite
def sheets(draw: st.DrawFn) -> Nest:
    """Sheets of cells, each with a plate, a plate with a hole that may host a guest, or a channel with a guest."""
    columns, rows = draw(st.integers(1, 4)), draw(st.integers(1, 3))
    parts: list[Part] = []
    for x in range(columns):
        for y in range(rows):
            shape = draw(st.sampled_from(["none", "plate", "ring", "host", "right", "left", "up", "long"]))
            w, h = draw(st.sampled_from([60, 80, 90])), draw(st.sampled_from([60, 80, 90]))
            parts += _cell(shape, f"P{x}{y}", 100 * x + 5, 100 * y + 5, w, h)
    if not parts:
        parts = _cell("plate", "P", 5, 5, 60, 60)
    width = draw(st.sampled_from([0, 5, 100, 300])) + 100 * columns
    return nest(width, draw(st.sampled_from([0, 5, 150, 700])) + 100 * rows, *parts)


def _cell(shape: str, name: str, x: float, y: float, w: float, h: float) -> list[Part]:
    guest = part(f"{name}g", rect(x + 20, y + 20, 20, 20))
    u = [(0, 0), (w, 0), (w, 8), (8, 8), (8, h - 8), (w, h - 8), (w, h), (0, h)]
    match shape:
        case "none":
            return []
        case "plate":
            return [part(name, rect(x, y, w, h))]
        case "long":
            return [part(name, rect(x, y, 80, 20))]
        case "ring" | "host":
            ring = part(name, rect(x, y, w, h), [rect(x + 10, y + 10, 40, 40)])
            return [ring, guest] if shape == "host" else [ring]
        case "right":
            return [part(name, [(x + a, y + b) for a, b in u]), guest]
        case "left":
            return [part(name, [(x + w - a, y + b) for a, b in u][::-1]), guest]
        case _:
            return [part(name, [(x + b, y + a) for a, b in u][::-1]), guest]


@given(sheets(), st.sampled_from(["auto", "left", "right", "bottom", "top"]))
def test_orders_on_the_sheet_agree(sheet: Nest, side: str) -> None:
    facts = compute_facts(sheet, FactOptions(start_side=side), ())  # type: ignore[arg-type]
    names = [c.id for c in sheet.contours]
    cuts = CutSequence(tuple(cut(sheet, name) for name in names), facts.start_side)
    for rule in ("inner-before-outer", "nested-before-host-holes", "level-ahead", "hull-before"):
        options = RULES[rule].Options()
        stated = sorted(s.about.contours for s in RULES[rule].statements(facts, options))
        assert stated == sorted(RULES[rule].pairs(sheet, cuts, options)), rule
    if side == "auto":
        assert RULES["start-side"].violations(sheet, cuts, RULES["start-side"].Options()) == []
