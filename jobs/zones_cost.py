"""What zones cost a plan: the search goes on from it without the orders of zones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.models.engines.solution import Progress, Solution, SolveOptions
from kerfwise.models.kernels import running_s
from kerfwise.models.plan.excused import excused
from kerfwise.models.plan.plan import RELAXED
from kerfwise.models.plan.zones_cost import ZonesCost
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import EXEMPTION_MM, Statement
from kerfwise.rules.stating.lazy import afterthoughts
from kerfwise.rules.stating.state_rules import Stated

from .ask import Asked
from .zones_limits import MOST_CONTOURS

MOST_MOVES = 150
"""Contours with more of which looking at every single move takes too long."""


@dataclass(frozen=True, eq=False, slots=True)
class Free:
    """The best plan known without zones: what was asked of it, its solution, and how long it was looked for, s.

    `aside` are the rules that it was not asked to keep besides those of zones.
    """

    stated: Stated
    solution: Solution
    seconds: float
    aside: tuple[str, ...] = ()

    def cost_mm(self, asked: Asked, solution: Solution, limits: SolveOptions) -> float:
        """What a plan by zones costs by the same account."""
        if set(self.aside) == {rule for rule, _ in solution.left_out}:
            return solution.objective
        timed = limits.time_s is not None  # the clock left out moves over parts: neither plan is asked for those
        statements = self.stated.statements
        problem = make_problem(asked.facts, statements, limits.home_mm, limits.feeds, going=lambda share: not timed)
        return route_cost(problem, problem.candidate_site[list(solution.route)].tolist()) / UM_PER_MM


def zoned_by(asked: Asked, profile: Profile) -> frozenset[str]:
    """The rules that have the nest cut in several zones; none where there is one zone alone, or too many contours."""
    facts, book = asked.facts, profile.rulebook()
    if facts.zone.max(initial=0) < 2 or facts.n > MOST_CONTOURS:
        return frozenset()
    settings = profile.settings().items()
    return frozenset(name for name, setting in settings if book[name].makes_zones and setting.weight is None)


def without_zones(
    asked: Asked,
    further: Sequence[Statement],
    profile: Profile,
    solution: Solution,
    limits: SolveOptions,
    progress: Progress | None = None,
    instead: Sequence[Statement] = (),
) -> Free | None:
    """The best plan that is found without zones, from a planned one on.

    Parameters
    ----------
    asked
        What was asked of the plan.
    further
        What geometry has found missing of it.
    solution
        The plan's route.
    limits
        How long to look: `work`, or `time_s` where that is given.
    progress
        Asked now and then whether to go on.
    instead
        What is asked in place of zones.

    Returns
    -------
    Free or None
        None where there is none: no rule makes zones, hard statements were relaxed, or it was interrupted.
    """
    from kerfwise.models.engines.rounds import solve

    facts, names = asked.facts, zoned_by(asked, profile)
    relaxed = any(dropped.why.startswith(RELAXED) for dropped in asked.stated.dropped)
    if not names or not solution.route or relaxed or (progress is not None and not progress("zones", None, None)):
        return None
    moves_too = facts.n <= MOST_MOVES
    left = [s for s in (*asked.stated.statements, *further) if s.about.rule not in names] + list(instead)
    kept, unasked = (left, frozenset[str]()) if moves_too else without_moves(left)
    stated = Stated(tuple(kept), (), asked.stated.exempt)
    began_s = running_s()
    limits = replace(limits, member="search", gap=None, no_improvement_s=None)
    try:
        found = solve(facts, stated.statements, limits, progress, afterthoughts(facts, profile), start=solution.route)
    except RulesConflict:
        return None
    aside = unasked | {r for r, _ in found.left_out}
    spent_s = found.seconds if limits.time_s is None else running_s() - began_s
    return Free(stated, found, spent_s, tuple(sorted(aside)))


def zones_cost(asked: Asked, solution: Solution, free: Free, limits: SolveOptions) -> ZonesCost:
    """What a plan by zones costs more than the best one known without."""
    gained_mm = free.cost_mm(asked, solution, limits) - free.solution.objective
    excuses = round(gained_mm / EXEMPTION_MM)
    if excuses < 0 or gained_mm <= 0:
        return ZonesCost(0.0, 0, (), free.seconds, free.aside)
    had, has = (excused(asked.facts, free.stated, route) for route in (solution.route, free.solution.route))
    avoided = [(name, rule) for name, rules in had.items() for rule in rules if rule not in has.get(name, ())]
    named = tuple(avoided if excuses else ())
    return ZonesCost(gained_mm - excuses * EXEMPTION_MM, excuses, named, free.seconds, free.aside)


def without_moves(statements: Sequence[Statement]) -> tuple[list[Statement], frozenset[str]]:
    """The statements but for those on moves over areas, and the rules that these come from."""
    moves = by_kind(statements).crossing
    unasked = {id(s) for s in moves}
    return [s for s in statements if id(s) not in unasked], frozenset(s.about.rule for s in moves)
