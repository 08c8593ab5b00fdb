"""What zones cost a plan: the search goes on from it without the orders of zones, for a short while."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.models.engines.solution import Progress, Solution, SolveOptions
from kerfwise.models.kernels import running_s
from kerfwise.models.plan.excused import excused
from kerfwise.models.plan.plan import RELAXED
from kerfwise.models.plan.zones_cost import ZonesCost
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import EXEMPTION_MM, Statement
from kerfwise.rules.stating.lazy import afterthoughts
from kerfwise.rules.stating.state_rules import Stated

from .ask import Asked

SHARE = 0.1
"""Share of a limit in which a plan without zones is looked for: of one in seconds, of which it is left so much, or of
the work, beside it."""
LEAST, AS_LONG = 1.0, 4.0
"""Work that it takes at the least, and how many times as long as the plan itself took it does not exceed."""
MOST_CONTOURS = 2500
"""With more, a plan without zones takes too long to get anywhere."""


def zoned_by(asked: Asked, profile: Profile) -> frozenset[str]:
    """The rules that have the nest cut in several zones; none where there is one zone alone, or too many contours."""
    facts, book = asked.facts, profile.rulebook()
    if facts.zone.max(initial=0) < 2 or facts.n > MOST_CONTOURS:
        return frozenset()
    settings = profile.settings().items()
    return frozenset(name for name, setting in settings if book[name].makes_zones and setting.weight is None)


def zones_cost(
    asked: Asked,
    further: Sequence[Statement],
    profile: Profile,
    solution: Solution,
    limits: SolveOptions,
    progress: Progress | None = None,
) -> ZonesCost | None:
    """What the best plan costs less that is found without zones, from a planned one on.

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

    Returns
    -------
    ZonesCost or None
        None where nothing can be said: no rule makes zones, hard statements were relaxed, or it was interrupted.
    """
    from kerfwise.models.engines.rounds import solve

    facts, names = asked.facts, zoned_by(asked, profile)
    relaxed = any(dropped.why.startswith(RELAXED) for dropped in asked.stated.dropped)
    if not names or not solution.route or relaxed or (progress is not None and not progress("zones", None, None)):
        return None
    free = tuple(s for s in asked.stated.statements if s.about.rule not in names)
    statements = (*free, *further)
    began_s = running_s()
    limits = replace(limits, member="search", gap=None, no_improvement_s=None)
    try:
        found = solve(facts, statements, limits, progress, afterthoughts(facts, profile), start=solution.route)
    except RulesConflict:
        return None
    before_mm = solution.objective
    if found.left_out != solution.left_out:  # without zones some of it is more than can be priced
        timed = limits.time_s is not None  # the clock left out moves over parts: neither plan is asked for those
        problem = make_problem(facts, statements, limits.home_mm, limits.feeds, going=lambda share: not timed)
        before_mm = route_cost(problem, problem.candidate_site[list(solution.route)].tolist()) / UM_PER_MM
    gained_mm = before_mm - found.objective
    excuses = round(gained_mm / EXEMPTION_MM)
    seconds = found.seconds if limits.time_s is None else running_s() - began_s
    if excuses < 0 or gained_mm <= 0:
        return ZonesCost(0.0, 0, (), seconds)
    stated = Stated(statements, (), asked.stated.exempt)
    had, has = (excused(facts, stated, route) for route in (solution.route, found.route))
    avoided = [(name, rule) for name, rules in had.items() for rule in rules if rule not in has.get(name, ())]
    return ZonesCost(gained_mm - excuses * EXEMPTION_MM, excuses, tuple(avoided if excuses else ()), seconds)
