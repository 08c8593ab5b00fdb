"""The best plan known without zones: what zones cost a plan, and how long such a plan is looked for."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Self

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.engines.deadline import Progress
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.engines.tuning import (
    A_CONTOUR,
    HELD_GB,
    LEAST_LOOK_S,
    LEAST_SHARE,
    LEAST_WORK,
    MOST_CONTOURS,
    PROVEN_S,
)
from kerfwise.models.engines.tuning import LARGE_NEST as FEW
from kerfwise.models.engines.tuning import UNZONED_DEARER as DEARER
from kerfwise.models.engines.tuning import UNZONED_LEAST as LEAST
from kerfwise.models.engines.tuning import UNZONED_MOST_MOVES as MOST_MOVES
from kerfwise.models.engines.tuning import UNZONED_PROOF as PROOF
from kerfwise.models.engines.tuning import UNZONED_SHARE as SHARE
from kerfwise.models.engines.tuning import UNZONED_STATED as STATED
from kerfwise.models.jit import running_s
from kerfwise.models.plan.make_plan import excuses as excused
from kerfwise.models.plan.plan import RELAXED
from kerfwise.models.plan.zones_cost import ZonesCost
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import route_cost, unpriced_crossings
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import EXEMPTION_MM, Statement, by_kind
from kerfwise.rules.stating.lazy_statements import lazy_statements, measured_beside
from kerfwise.rules.stating.state_rules import Stated, state_rules

from .request import Found, Request

UNPRICED = "a first plan is not asked what its single moves cross"


@dataclass(frozen=True, eq=False, slots=True)
class Free:
    """The best plan known without zones: what was asked of it, its solution, and how long it was looked for, s.

    `aside` are the rules that it was not asked to keep besides those of zones.
    """

    stated: Stated
    solution: Solution
    seconds: float
    aside: tuple[str, ...] = ()

    def cost_mm(self, asked: Request, solution: Solution, limits: SolveOptions) -> float:
        """What a plan by zones costs by the same account."""
        if set(self.aside) == {rule for rule, _ in solution.left_out}:
            return solution.objective
        timed = limits.time_s is not None  # the clock left out moves over parts: neither plan is asked for those
        statements = self.stated.statements
        problem = make_problem(asked.facts, statements, limits.home_mm, limits.feeds, going=lambda share: not timed)
        return route_cost(problem, problem.candidate_site[list(solution.route)].tolist()) / UM_PER_MM

    def or_better(self, newer: Self) -> Self:
        """The cheaper one, with the time that both took."""
        best = newer if newer.solution.objective < self.solution.objective else self
        return replace(best, seconds=self.seconds + newer.seconds)

    def dearer(self, asked: Request, solution: Solution, limits: SolveOptions) -> bool:
        """Whether a plan by zones is dearer, or much dearer where it pays for moves that this one does not pay for."""
        bearable_mm = DEARER * (self.solution.objective % EXEMPTION_MM) if self.aside else 0.0
        return self.cost_mm(asked, solution, limits) > self.solution.objective + bearable_mm


def zoned_by(facts: Facts, profile: Profile) -> frozenset[str]:
    """The rules that have the nest cut in several zones; none where there is one zone alone, or too many contours."""
    book = profile.rulebook()
    if facts.zone.max(initial=0) < 2 or facts.n > MOST_CONTOURS:
        return frozenset()
    settings = profile.settings().items()
    return frozenset(name for name, setting in settings if book[name].makes_zones and setting.weight is None)


def without_zones(
    asked: Request,
    further: Sequence[Statement],
    profile: Profile,
    start: Sequence[int],
    limits: SolveOptions,
    progress: Progress | None = None,
) -> Free | None:
    """The best plan that is found without zones, from a planned one on, or from nothing.

    Parameters
    ----------
    asked
        What was asked of the plan.
    further
        What geometry has found missing of it.
    start
        The plan's route, if there is one.
    limits
        How long to look: `work`, or `time_s` where that is given.
    progress
        Asked now and then whether to go on.

    Returns
    -------
    Free or None
        None where there is none: no rule makes zones, hard statements were relaxed, or it was interrupted.
    """
    names = zoned_by(asked.facts, profile)
    if not names or is_relaxed(asked):
        return None
    left = [s for s in (*asked.stated.statements, *further) if s.about.rule not in names]
    return searched(asked.facts, Stated(tuple(left), (), asked.stated.exempt), profile, start, limits, progress)


def restated(facts: Facts, profile: Profile, known: Stated) -> Stated | None:
    """What is asked by other zones, which these facts have; None where hard orders contradict each other.

    What is `known` to be asked, nothing relaxed, is stated anew by rules that mind zones, or whose orders gave way.
    """
    try:
        return state_rules(facts, profile, known)
    except RulesConflict:
        return None


def is_relaxed(asked: Request) -> bool:
    """Whether hard statements gave way."""
    return any(dropped.why.startswith(RELAXED) for dropped in asked.stated.dropped)


def searched(
    facts: Facts,
    asked: Stated,
    profile: Profile,
    start: Sequence[int],
    limits: SolveOptions,
    progress: Progress | None = None,
    *,
    moves: bool | None = None,
    found: Found | None = None,
) -> Free | None:
    """The best plan that a search finds; None where it finds none, or was interrupted before.

    With `moves` it is asked what single moves cross, without it is not; None leaves that to the number of contours.
    `found` is told each better plan meanwhile, of all that is asked: a rule that it does not pay for is `left_out`.
    """
    from kerfwise.models.engines.solve import solve

    if not facts.n or (progress is not None and not progress("zones", None, None)):
        return None
    moves_too, left = facts.n <= MOST_MOVES if moves is None else moves, list(asked.statements)
    kept, unasked = (left, frozenset[str]()) if moves_too else without_moves(left)
    stated = Stated(tuple(kept), asked.dropped, asked.exempt)
    began_s = running_s()
    limits = replace(limits, member="search", gap=None, no_improvement_s=None)
    try:
        hear = None if found is None else partial(_hear, found, Request(facts, asked), unasked)
        with measured_beside(lambda: lazy_statements(facts, profile), facts.n) as looks:
            best = solve(facts, stated.statements, limits, progress, looks, start=start, found=hear)
    except RulesConflict:
        return None
    aside = unasked | {r for r, _ in best.left_out}
    spent_s = best.seconds if limits.time_s is None else running_s() - began_s
    return Free(stated, best, spent_s, tuple(sorted(aside)))


def _hear(found: Found, request: Request, unasked: frozenset[str], solution: Solution) -> None:
    """Tell of a plan, and which rules it does not pay for."""
    found(request, without_pay_for(solution, unasked))


def without_pay_for(solution: Solution, rules: Iterable[str]) -> Solution:
    """The solution, saying which rules on single moves it was not asked about; an engine's own reasons go before."""
    return replace(solution, left_out=solution.left_out or tuple((rule, UNPRICED) for rule in sorted(rules)))


def zones_cost(asked: Request, solution: Solution, free: Free, limits: SolveOptions) -> ZonesCost:
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


def paying_for_crossings(request: Request, solution: Solution) -> Solution:
    """The same route at the price of all that is asked, where it does not pay for what its single moves cross."""
    if not solution.left_out or (problem := solution.problem) is None:
        return solution
    sites, crossing = problem.candidate_site[list(solution.route)].tolist(), by_kind(request.stated.statements).crossing
    objective = solution.objective + unpriced_crossings(problem, crossing, sites) / UM_PER_MM
    proven = solution.bound is not None and solution.bound >= objective
    return replace(solution, objective=objective, left_out=(), status="optimal" if proven else "feasible")


def sorted_mm(request: Request, free: Free, zone: Ints) -> float:
    """What a plan that does not pay for what its moves cross costs, moves included, with zones (n,) one by one, mm.

    Each zone keeps the order that it has in the plan. What else is asked costs as much as there; excuses do not count.
    """
    problem = free.solution.problem
    assert problem is not None
    route = problem.candidate_site[list(free.solution.route)]
    sites = route[np.argsort(zone[problem.site_contour[route]], kind="stable")]
    before, now = (problem.legs(np.append(problem.m, on), np.append(on, problem.m)).sum() for on in (route, sites))
    crossed = unpriced_crossings(problem, by_kind(request.stated.statements).crossing, sites.tolist())
    return free.solution.objective % EXEMPTION_MM + float(now - before + crossed) / UM_PER_MM


def prices_crossings(statements: Sequence[Statement]) -> bool:
    """Whether a rule prices or bans moves over areas."""
    return bool(by_kind(statements).crossing)


def bans_crossings(statements: Sequence[Statement]) -> bool:
    """Whether a hard rule bans moves over areas."""
    return any(s.weight is None for s in by_kind(statements).crossing)


# How long plans without zones, and by other zones, are looked for, and whether that is begun at all.
#
# Up to `FEW` contours a look has a share of the limit, always. In larger nests a plan by the zones of geometry is
# proven within a small part of the work, and other zones are proven about as fast: a look has what these two leave.
# It is not begun where it would have so little that all goes into its tables.


def is_look_worthwhile(contours: int, limits: SolveOptions) -> bool:
    """Whether a plan without zones is looked for at all, as far as can be told before the first plan.

    Examples
    --------
    >>> (
    ...     [is_look_worthwhile(10_000, SolveOptions(work=work)) for work in (0.1, 10.0)],
    ...     is_look_worthwhile(2_000, SolveOptions(work=0.1)),
    ... )
    ([False, True], True)
    """
    if contours <= FEW:
        return True
    if contours > MOST_CONTOURS:
        return False
    if limits.time_s is None:
        return limits.work / 2 >= LEAST_WORK * contours
    return SHARE * limits.time_s >= LEAST_LOOK_S * contours


def look_for(
    contours: int, limits: SolveOptions, ends_s: float | None, first: Solution, stated_s: float = 0.0
) -> SolveOptions | None:
    """How long a plan without zones is looked for; None for not at all.

    `ends_s`: when a limit in seconds ends, by `running_s`. `first`: the plan by the zones of geometry. `stated_s`: how
    long it took to state the rules.
    """
    if contours <= FEW:
        return _share(contours, limits, ends_s)
    if not is_look_worthwhile(contours, limits):
        return None
    if limits.time_s is None or ends_s is None:
        left = limits.work - first.seconds
        work = max(left - min(PROOF * first.seconds, left / 2), SHARE * limits.work)
        return replace(limits, work=work) if work >= LEAST_WORK * contours else None
    left_s = ends_s - running_s()
    kept_s = min(PROOF * first.seconds, left_s / 2)
    all_s = max(kept_s, STATED * stated_s + PROVEN_S * contours)
    times_s = [left_s - all_s, left_s - kept_s]  # where zones have no time to move, what they cost is looked for alone
    time_s = next((time_s for time_s in times_s if time_s >= LEAST_LOOK_S * contours), None)
    return None if time_s is None else replace(limits, time_s=time_s)


def _share(contours: int, limits: SolveOptions, ends_s: float | None) -> SolveOptions:
    if limits.time_s is None or ends_s is None:
        return replace(limits, work=min(SHARE * limits.work, max(LEAST, A_CONTOUR * contours)))
    left_s = (ends_s - running_s()) / 2
    return replace(limits, time_s=max(min(SHARE * limits.time_s, left_s), SHARE * LEAST))


def next_look_limit_s(contours: int, limits: SolveOptions, ends_s: float | None, spent: float) -> SolveOptions:
    """How long a plan by other zones may take: as long as the limit leaves, where so much work of it is spent."""
    if contours > FEW:
        limits = replace(limits, memory_gb=max(limits.memory_gb - HELD_GB * contours, LEAST_SHARE * limits.memory_gb))
    if limits.time_s is None or ends_s is None:
        return replace(limits, work=max(limits.work - spent, SHARE * limits.work))
    return replace(limits, time_s=max(ends_s - running_s(), SHARE * LEAST))
