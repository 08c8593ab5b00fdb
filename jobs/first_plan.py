"""A first lawful plan at once: along a plan that is at hand, before an edit or of yesterday, or by a short search."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence, Set
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
import shapely

from kerfwise.arrays import Bools, Ints
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.facts.zones_along_route import movable
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.engines.deadline import Progress
from kerfwise.models.engines.lawful_walk import route_like
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.engines.tuning import FIRST_PLAN_WORK as WORK
from kerfwise.models.engines.tuning import UNZONED_MOST_MOVES as MOST_MOVES
from kerfwise.models.engines.tuning import WORK_A_CONTOUR
from kerfwise.models.plan.explain.alternatives import TriedOrder, try_order
from kerfwise.models.plan.explain.context import context_along
from kerfwise.models.plan.plan import Plan
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import About, Forbid, Statement
from kerfwise.rules.stating.lazy_statements import lazy_statements

from .adaptive_zones import ZonedPlan
from .inputs import of_first_torch
from .plan_without_zones import (
    bans_crossings,
    is_relaxed,
    paying_for_crossings,
    restated,
    searched,
    without_moves,
    without_pay_for,
    zoned_by,
)
from .request import Request, make_request

STAYED_MM = 5.0
"""A contour that lies farther than this from where it was entered has been moved."""


@dataclass(frozen=True, eq=False, slots=True)
class AtHand:
    """A plan that is at hand, under what is asked now: by its own zones, if it may be, and as a lawful route.

    `kept` are the candidates by which the route enters contours as the plan did.
    """

    asked: Request
    solution: Solution
    kept: frozenset[int] = frozenset()


def first_plan(
    asked: Request,
    profile: Profile,
    limits: SolveOptions,
    at_hand: AtHand | None = None,
    progress: Progress | None = None,
    *,
    moves: bool | None = False,
    work: float | None = None,
) -> ZonedPlan | None:
    """The first lawful plan that a short search finds, from a plan at hand or from nothing.

    Entries that a plan at hand has `kept` stay, and so does its order where all are kept.
    Where geometry alone makes zones, the whole sheet is one: to draw them takes longer than all of this. Soft rules on
    what single moves cross are priced with `moves` alone; None leaves that to the number of contours. The search takes
    so much `work`, or as little as it takes.

    Returns
    -------
    ZonedPlan or None
        None where the search finds none.
    """
    if at_hand is not None:
        asked = at_hand.asked
        if len(at_hand.kept) == asked.facts.n:
            return ZonedPlan(asked, at_hand.solution, None)
    elif movable(asked.facts) and zoned_by(asked.facts, profile) and not is_relaxed(asked):
        one = replace(asked.facts, zone=asked.facts.zone.clip(max=1))
        if (stated := restated(one, profile, asked.stated)) is not None:
            asked = Request(one, stated, asked.seconds)
    work = min(limits.work, WORK + WORK_A_CONTOUR * asked.facts.n if work is None else work)
    limits = replace(limits, work=work, time_s=None)  # so little takes less time than a look at the clock is worth
    moves = True if bans_crossings(asked.stated.statements) else moves
    route, stated = () if at_hand is None else at_hand.solution.route, asked.stated
    if at_hand is not None and at_hand.kept:
        stated = replace(stated, statements=(*stated.statements, *_entered_as(asked.facts, at_hand.kept)))
    found = searched(asked.facts, stated, profile, route, limits, progress, moves=moves)
    if found is None:
        return None
    solution = without_pay_for(found.solution, found.aside)
    return ZonedPlan(asked, solution if stated is asked.stated else replace(solution, problem=None), None)


def _entered_as(facts: Facts, kept: Set[int]) -> Iterator[Statement]:
    """That contours are entered by these candidates and no others."""
    for number in sorted(kept):
        contour = facts.candidates[number].contour
        about = About("start", (facts.nest.contours[contour].id,), "it is entered as in the plan at hand")
        others = range(int(facts.first[contour]), int(facts.first[contour + 1]))
        yield from (Forbid(other, about) for other in others if other != number)


def plan_at_hand(
    facts: Facts,
    profile: Profile,
    limits: SolveOptions,
    plan: Plan,
    request: Request | None = None,
    *,
    keep: bool = False,
) -> AtHand | None:
    """A plan that was made before, of a nest or under rules that may have changed since.

    Its order stays as far as locked places and hard rules allow, with the best entries along it but for those that are
    to be kept. Contours that it does not have come after the ones that they lie nearest to, and its zones are kept
    where geometry may choose them.

    Parameters
    ----------
    request
        What is asked by the zones of `facts`, where that is known.
    keep
        Whether contours are entered as the plan has it, the same way round, wherever that is lawful and they have not
        been moved since.

    Returns
    -------
    AtHand or None
        None where the plan has no contour of the nest, or no lawful order is like it.

    Raises RulesConflict if hard orders contradict each other.
    """
    cuts = [row.cut for row in of_first_torch(plan).cuts if row.cut.contour in facts.nest.index]
    if not cuts:
        return None
    asked = _by_zones_of(cuts, facts, profile, request)
    facts = asked.facts
    stated, aside = asked.stated, frozenset[str]()
    if facts.n > MOST_MOVES and not bans_crossings(stated.statements):  # a look at all moves takes longer than all else
        kept, aside = without_moves(stated.statements)
        stated = replace(stated, statements=tuple(kept))
    problem = make_problem(facts, stated.statements, limits.home_mm, limits.feeds)
    ways = [nearest_way(facts, cut, problem.candidate_site >= 0) for cut in cuts]
    wanted, places = _known(problem.candidate_site[ways], problem.site_contour), _places(profile, facts)
    like = dict[int, int]()
    if keep or aside:  # the best entries need not be so at the price of moves that is left out
        stayed = [way for way, cut in zip(ways, cuts, strict=True) if has_stayed(facts, cut)]
        like = dict(zip(problem.candidate_site[stayed].tolist(), stayed, strict=True))
    liked = {int(problem.site_contour[site]): site for site in wanted if site in like}
    setting = context_along(facts, profile, stated, problem, ())

    def at_hand(judged: TriedOrder, seen_mm: float) -> AtHand:
        route = tuple(like.get(site, int(problem.site_candidate[site])) for site in judged.route)
        cost_mm = (judged.cost or 0) / UM_PER_MM + seen_mm
        found = Solution(route, cost_mm, None, "feasible", "search", "", 0.0, left_out=problem.left_out)
        found = replace(without_pay_for(found, aside), problem=problem)
        return AtHand(asked, paying_for_crossings(asked, found), frozenset(route) & frozenset(like.values()))

    for order in _orders(problem, wanted, places):
        tried = (try_order(setting, order, look=False, liked=by) for by in ((liked, {}) if liked else ({},)))
        lawful = list(islice((judged for judged in tried if judged.cost is not None), 1 if keep else None))
        if lawful and (seen_mm := paid_for(lazy_statements(facts, profile)(order))) is not None:
            return min((at_hand(judged, seen_mm) for judged in lawful), key=lambda one: one.solution.objective)
    return None


def paid_for(seen: Iterable[Statement]) -> float | None:
    """What is paid for what geometry finds in a whole order, mm; None where a hard rule forbids it."""
    weights = [statement.weight for statement in seen]
    return None if None in weights else math.fsum(weight for weight in weights if weight is not None)


def _by_zones_of(cuts: Sequence[Cut], facts: Facts, profile: Profile, request: Request | None) -> Request:
    """What is asked by the zones of a plan, where geometry may choose them; else by those of the facts."""
    if movable(facts) and (request is None or not is_relaxed(request)) and zoned_by(facts, profile):
        by_plan = replace(facts, zone=zones_of(facts, cuts))
        if request is not None and (stated := restated(by_plan, profile, request.stated)) is not None:
            return Request(by_plan, stated, request.seconds)
        if request is None:
            try:
                return make_request(by_plan, profile)
            except RulesConflict:
                pass
    return make_request(facts, profile) if request is None else request


def _orders(problem: Problem, wanted: Sequence[int], places: dict[int, int]) -> Iterator[Sequence[int]]:
    """Orders near to one at hand: locked contours at their places; then with all moved that has to come before, too."""
    order = [int(problem.site_contour[site]) for site in wanted]
    at = {place: contour for contour, place in places.items()}
    if len(at) < len(places):
        return
    if len(order) == problem.n:
        others = iter([contour for contour in order if contour not in places])
        yield [at[k] if k in at else next(others) for k in range(problem.n)]
    if (route := route_like(problem, wanted, places)) is not None:
        yield problem.site_contour[list(route)].tolist()


def _places(profile: Profile, facts: Facts) -> dict[int, int]:
    """Contour → its place in the order, from 0, by the locks."""
    done, index = len(facts.already_cut), facts.nest.index
    ends = {"first": done + 1, "last": done + facts.n}
    found = {}
    for lock in profile.locks:
        if lock.contour in index and lock.position is not None:
            at = lock.position if isinstance(lock.position, int) else ends[lock.position]
            found[index[lock.contour]] = at - 1 - done
    return {contour: at for contour, at in found.items() if 0 <= at < facts.n}


def _known(sites: Ints, contour: Ints) -> list[int]:
    """The sites that there still are, each contour once."""
    known = dict[int, int]()
    for site in sites[sites >= 0].tolist():
        known.setdefault(int(contour[site]), site)
    return list(known.values())


def zones_of(facts: Facts, cuts: Sequence[Cut]) -> Ints:
    """The zones of a plan, (n,) from 1; one alone where a contour has none in it."""
    zone = np.zeros(facts.n, dtype=np.int64)
    for cut in cuts:
        zone[facts.nest.index[cut.contour]] = cut.zone
    marks = np.array([contour.kind == "mark" for contour in facts.nest.contours])
    if (zone[~marks] < 1).any():
        return np.ones(facts.n, dtype=np.int64)
    zone[marks] = 1
    return np.unique(zone, return_inverse=True)[1].ravel().astype(np.int64) + 1


def nearest_way(facts: Facts, cut: Cut, lawful: Bools) -> int:
    """The candidate, of those `lawful` (m,), that is most like a cut: the same way round, and as near as there is."""
    contour = facts.nest.index[cut.contour]
    numbers = range(int(facts.first[contour]), int(facts.first[contour + 1]))

    def unlike(number: int) -> tuple[bool, float]:
        way: Candidate = facts.candidates[number]
        away_mm = 0.0 if cut.linked else math.dist(way.pierce, cut.pierce)  # a link begins where the last cut ended
        return way.direction != cut.direction, away_mm + math.dist(way.entry, cut.entry)

    return min((number for number in numbers if lawful[number]), key=unlike)


def has_stayed(facts: Facts, cut: Cut) -> bool:
    """Whether a contour is still where a cut of before enters it; one that was compensated since has hardly moved."""
    return bool(facts.nest.contour(cut.contour).line.distance(shapely.Point(cut.entry)) <= STAYED_MM)
