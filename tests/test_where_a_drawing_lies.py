"""Where a drawing lies decides nothing: the plan is the same after a shift, and its own check never refuses a tie."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from kerfwise.encoder.cut import CutSequence, Side
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.facts import FactOptions, Facts
from kerfwise.encoder.facts.outlines import OPPOSITE
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest, Part, Sheet
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.pipeline import solve_and_verify
from kerfwise.postproc.check import report
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.catalogue.hull_before import HullBefore
from kerfwise.rules.catalogue.level_ahead import LevelAhead
from kerfwise.rules.catalogue.start_side import StartSideOptions, expected_side
from kerfwise.rules.options.option import NoOptions
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.encoder.facts.random_nests import mirrored, moved, nests
from kerfwise.tests.tools.amount import examples


def flange(x: float, y: float, bolts: int) -> Part:
    """A ring with holes on a circle, which rounding puts here and there."""
    around = ((x + 70 * math.cos(math.tau * k / bolts), y + 70 * math.sin(math.tau * k / bolts)) for k in range(bolts))
    return part("F", circle(x, y, 100), [circle(x, y, 25), *(circle(*at, 8) for at in around)])


def on_a_round_sheet(radius: float, *parts: Part) -> Nest:
    return Nest(Sheet(Curve.of(circle(radius, radius, radius)), ()), parts)


def grid(columns: int, rows: int, size: float, gap: float) -> Nest:
    pitch = size + gap
    at = [(gap + pitch * column, gap + pitch * row) for column in range(columns) for row in range(rows)]
    squares = (part(f"P{k}", rect(x, y, size, size)) for k, (x, y) in enumerate(at))
    return nest(gap + pitch * columns, gap + pitch * rows, *squares)


SYMMETRIC = {
    "a disc in the middle": nest(300, 300, part("D", circle(150, 150, 60))),
    "a disc in the middle of a wide sheet": nest(400, 300, part("D", circle(200, 150, 60))),
    "a flange of eight bolts": nest(300, 300, flange(150, 150, 8)),
    "a flange of seven bolts": nest(400, 250, flange(200, 125, 7)),
    "a disc on a round sheet": on_a_round_sheet(200, part("D", circle(200, 200, 80))),
    "a flange on a round sheet": on_a_round_sheet(200, flange(200, 200, 6)),
    "two discs": nest(500, 300, part("A", circle(120, 150, 50)), part("B", circle(380, 150, 50))),
    "edges on the middle": nest(400, 300, part("A", rect(100, 40, 100, 60)), part("B", rect(200, 200, 100, 60))),
    "squares in thirds": grid(3, 2, 50, 100 / 3),
    "offcuts on the threshold": nest(1000, 300, part("A", rect(150, 50, 100, 100)), part("B", rect(750, 50, 100, 100))),
}
"""Nests whose sides are tied, or on a threshold, so that the last bit of a coordinate used to decide."""
SHIFTS = st.one_of(st.floats(-1e5, 1e5), st.floats(-10, 10), st.integers(-9999, 9999).map(lambda tenths: tenths / 10))


def facts_of_place(facts: Facts) -> tuple[object, ...]:
    """What a profile's rules are stated of, without a coordinate."""
    lists = (facts.level_ahead, facts.in_hull, facts.zone, facts.neighbours.row, facts.neighbours.neighbour)
    flags = (facts.long, facts.offcut_large, facts.heat_parts)
    return facts.start_side, facts.start_side_because, *(a.tolist() for a in (*lists, *flags))


def sequence(given_nest: Nest, profile: Profile, home: tuple[float, float]) -> tuple[Side, list[tuple[object, ...]]]:
    """The start side and the cuts of the plan, each by contour, direction, zone and its entry as seen from home."""
    there = replace(profile, machine=replace(profile.machine, home=home))
    asked = make_request(facts_of(given_nest, there), there)
    made = solve_and_verify(asked, there, options_for(given_nest, there, work=1))
    assert made.verdict.ok, report(made.verdict)
    cuts = [c.cut for c in made.plan.cuts]
    entries = np.round(np.array([c.entry for c in cuts]) - home, 3) + 0.0
    return made.plan.start_side, [
        (c.contour, c.direction, c.zone, *entry) for c, entry in zip(cuts, entries.tolist(), strict=True)
    ]


@pytest.mark.slow
@pytest.mark.parametrize("name", SYMMETRIC)
@given(dx=SHIFTS, dy=SHIFTS)
@example(dx=0.0, dy=0.0)
@examples(6)
def test_a_symmetric_nest_has_one_plan_wherever_it_lies(name: str, dx: float, dy: float) -> None:
    assert sequence(moved(SYMMETRIC[name], dx, dy), load_profile(), (dx, dy)) == as_drawn(name)


@cache
def as_drawn(name: str) -> tuple[Side, list[tuple[object, ...]]]:
    return sequence(SYMMETRIC[name], load_profile(), (0, 0))


@pytest.mark.parametrize("name", SYMMETRIC)
def test_ties_go_left_then_bottom(name: str) -> None:
    turned = _turned(SYMMETRIC[name])
    assert compute_facts(SYMMETRIC[name], FactOptions()).start_side == "left"
    narrow_first = turned.sheet.bounds[2] < turned.sheet.bounds[3] * (1 - 1e-6)
    assert compute_facts(turned, FactOptions()).start_side == ("bottom" if narrow_first else "left")


def _turned(given_nest: Nest) -> Nest:
    """x and y exchanged, which turns every curve round."""
    swap = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]])
    turn = lambda curve: Curve(curve.vertices @ swap, curve.closed)  # noqa: E731
    parts = tuple(
        replace(
            p,
            outer=replace(p.outer, curve=turn(p.outer.curve)),
            holes=tuple(replace(h, curve=turn(h.curve)) for h in p.holes),
        )
        for p in given_nest.parts
    )
    return Nest(Sheet(turn(given_nest.sheet.outline), ()), parts)


@pytest.mark.slow
@given(given_nest=nests(), dx=SHIFTS, dy=SHIFTS)
@examples(20)
def test_plan_is_the_same_after_a_shift(given_nest: Nest, dx: float, dy: float) -> None:
    assume(given_nest.parts)
    profile = load_profile()
    try:
        one = sequence(given_nest, profile, (0, 0))
    except InputError:
        assume(False)
    assert sequence(moved(given_nest, dx, dy), profile, (dx, dy)) == one


@pytest.mark.slow
@given(given_nest=nests(), dx=SHIFTS, dy=SHIFTS)
@examples(100)
def test_planner_and_check_find_the_same_after_a_shift(given_nest: Nest, dx: float, dy: float) -> None:
    one = compute_facts(given_nest, FactOptions())
    shifted = moved(given_nest, dx, dy)
    other = compute_facts(shifted, FactOptions())
    assert facts_of_place(one) == facts_of_place(other)
    assert expected_side(shifted, StartSideOptions())[0] == other.start_side
    for rule, pairs in ((LevelAhead(), other.level_ahead), (HullBefore(), other.in_hull)):
        seen = rule.pairs(shifted, CutSequence((), other.start_side), NoOptions())
        assert set(seen) == {(shifted.contours[a].id, shifted.contours[b].id) for a, b in pairs.tolist()}


@pytest.mark.slow
@given(given_nest=nests(), dx=SHIFTS, dy=SHIFTS)
@examples(100)
def test_the_side_is_mirrored_with_the_nest(given_nest: Nest, dx: float, dy: float) -> None:
    one, glass = compute_facts(given_nest, FactOptions()), moved(mirrored(given_nest), dx, dy)
    other = compute_facts(glass, FactOptions())
    assert other.start_side_because == one.start_side_because
    assert expected_side(glass, StartSideOptions())[0] == other.start_side
    if one.start_side_because == "narrow-side":  # a tie: the order of the sides decides
        assert other.start_side == one.start_side
    elif one.start_side in ("left", "right"):
        assert other.start_side == OPPOSITE[one.start_side]
    else:
        assert other.start_side == one.start_side
