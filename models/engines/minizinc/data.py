"""The data of the model: the facts as every engine sees them, what moves cost, and what single rules need."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts import facts_dzn
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.microns import cost_um, points_um
from kerfwise.encoder.geometry.segment import Point
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.problem.pace import Pace
from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.flat.model_rule import ModelRule
from kerfwise.rules.minizinc.dzn import Fields, assignments, numbers, table_from_0
from kerfwise.rules.minizinc.twin import TwinCase, twin_of
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import Rule
from kerfwise.rules.statements import Link
from kerfwise.rules.stating.state_rules import Stated

from .asked import drops_orders, rules_in_files


def data_text(facts: Facts, profile: Profile, stated: Stated, options: SolveOptions, *, clock: bool) -> str:
    """MiniZinc data for `sequence.mzn`, for `clock.mzn` if that is included, and for the rules of the profile.

    Raises
    ------
    InputError
        If a rule counts seconds and `options` have no feeds.
    """
    home_mm = options.home_mm
    kinds = by_kind(stated.statements)
    if clock and kinds.link:
        raise InputError(
            "a rule counts seconds, and links change when cuts begin, which the model for MiniZinc does not know: "
            "set cuts.links.longest to 0 mm, or take another engine, such as portfolio"
        )
    price = sum(s.weight for s in kinds.idle_travel)
    idle = travel_um(facts, price, home_mm)
    travel = _linked(idle, kinds.link)
    fields: Fields = [("travel", table_from_0(travel))]
    if clock:
        fields += _clock(facts, options)
    linked = tuple((a, b) for a, b in np.argwhere(travel < idle).tolist())
    case, book = TwinCase(facts, home_mm, linked), profile.rulebook()
    words: dict[str, None] = {}
    for rule, setting in rules_in_files(profile, stated).items():
        own = book[rule]
        if isinstance(own, ModelRule):
            fields += own.data(facts, setting.options)
            words |= dict.fromkeys(own.words(facts.nest).splitlines())
        else:
            fields += twin_of(rule).data(case, setting.options)
    return facts_dzn(without_dropped(facts, stated, book)) + assignments(fields) + "\n".join(words)


def without_dropped(facts: Facts, stated: Stated, book: Mapping[str, Rule[Any]]) -> Facts:
    """The facts without the pairs whose orders were dropped because they closed a cycle."""
    for rule in dict.fromkeys(d.rule for d in stated.dropped):
        orders = by_kind([d.statement for d in stated.dropped if d.rule == rule]).precede
        if drops_orders(book[rule]):
            facts = twin_of(rule).without(facts, {(s.before, s.after) for s in orders})
    return facts


def travel_um(facts: Facts, price: float, home_mm: Point) -> Ints:
    """Cost of idle travel, µm, from the end of each candidate (row) to the pierce of each (column); home is number 0.

    Rounded as `Problem.travel` rounds, so that every engine finds the same optimum to the digit.
    """
    ends, pierces = _points_um(facts, home_mm)
    gap = ends[:, None, :] - pierces[None, :, :]
    return np.asarray(np.rint(price * np.sqrt((gap**2).sum(axis=2))), dtype=np.int64)


def _linked(idle: Ints, links: Sequence[Link]) -> Ints:
    """The same with links, where they cost less."""
    travel = idle.copy()
    for link in links:
        moves = np.ix_(np.array(link.leave) + 1, np.array(link.reach) + 1)
        travel[moves] = np.minimum(travel[moves], cost_um(link.weight))
    return travel


def _clock(facts: Facts, options: SolveOptions) -> Fields:
    if options.feeds is None:
        raise InputError("a rule counts seconds: the feeds of the machine are needed to solve")
    pace = Pace.of(facts, range(len(facts.candidates)), options.feeds)
    ends, pierces = _points_um(facts, options.home_mm)
    moves = pace.move_ms(ends[:, None, :].astype(np.int64), pierces[None, :, :].astype(np.int64))
    return [("cut_ms", numbers(pace.cut_ms.tolist())), ("move_ms", table_from_0(moves))]


def _points_um(facts: Facts, home_mm: Point) -> tuple[Floats, Floats]:
    """Where idle travel leaves from, and where it arrives: home, then the candidates."""
    ends = points_um([home_mm, *(c.end for c in facts.candidates)], home_mm)
    pierces = points_um([home_mm, *(c.pierce for c in facts.candidates)], home_mm)
    return ends.astype(np.float64), pierces.astype(np.float64)
