"""A first lawful plan at once, and a plan that goes on from one that is at hand: before an edit, or of yesterday."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.facts.zones_along_route import movable
from kerfwise.models.engines.deadline import Progress
from kerfwise.models.engines.lawful_walk import route_like
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.plan.plan import Plan
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import broken
from kerfwise.rules.profile.profile import Profile

from .adaptive_zones import ZonedPlan
from .plan_without_zones import bans_crossings, is_relaxed, restated, searched, zoned_by
from .request import Request

WORK, WORK_A_CONTOUR = 0.03, 1e-4
"""Work of the search that makes a first plan, and for every contour."""
UNPRICED = "a first plan is not asked what its single moves cross"


@dataclass(frozen=True, eq=False, slots=True)
class AtHand:
    """A plan that is at hand, under what is asked now: by its own zones, if it may be, and as candidates in order."""

    asked: Request
    route: tuple[int, ...]


def first_plan(
    asked: Request,
    profile: Profile,
    limits: SolveOptions,
    at_hand: AtHand | None = None,
    progress: Progress | None = None,
    *,
    moves: bool = False,
) -> ZonedPlan | None:
    """The first lawful plan that a short search finds, from a plan at hand or from nothing.

    Where geometry alone makes zones, the whole sheet is one: to draw them takes longer than all of this. Soft rules on
    what single moves cross are not priced but with `moves`.

    Returns
    -------
    ZonedPlan or None
        None where the search finds none.
    """
    if at_hand is not None:
        asked = at_hand.asked
    elif movable(asked.facts) and zoned_by(asked, profile) and not is_relaxed(asked):
        one = replace(asked.facts, zone=asked.facts.zone.clip(max=1))
        if (stated := restated(one, profile, asked.stated)) is not None:
            asked = Request(one, stated, asked.seconds)
    work = min(limits.work, WORK + WORK_A_CONTOUR * asked.facts.n)
    limits = replace(limits, work=work, time_s=None)  # so little takes less time than a look at the clock is worth
    moves = moves or bans_crossings(asked.stated.statements)
    route = () if at_hand is None else at_hand.route
    found = searched(asked.facts, asked.stated, profile, route, limits, progress, moves=moves)
    if found is None:
        return None
    left_out = found.solution.left_out or tuple((rule, UNPRICED) for rule in found.aside)
    return ZonedPlan(asked, replace(found.solution, left_out=left_out), None)


def plan_at_hand(asked: Request, profile: Profile, limits: SolveOptions, plan: Plan) -> AtHand | None:
    """A plan that was made before, of a nest or under rules that may have changed since.

    Its order, entries and directions stay as far as hard rules allow, contours that it does not have come after the
    ones that they lie nearest to, and its zones are kept where geometry may choose them.

    Returns
    -------
    AtHand or None
        None where the plan has no contour of the nest, several torches cut, or no lawful order is like it.
    """
    facts = asked.facts
    cuts = [row.cut for row in plan.cuts if row.cut.contour in facts.nest.index]
    if not cuts or facts.copies is not None:
        return None
    if movable(facts) and zoned_by(asked, profile) and not is_relaxed(asked):
        facts = replace(facts, zone=zones_of(facts, cuts))
        if (stated := restated(facts, profile, asked.stated)) is None:
            return None
        asked = Request(facts, stated, asked.seconds)
    problem = make_problem(facts, asked.stated.statements, limits.home_mm, limits.feeds, going=lambda share: False)
    sites = problem.candidate_site[[_nearest(facts, cut) for cut in cuts]]
    route = route_like(problem, _known(sites, problem.site_contour))
    if route is None or broken(problem, route):
        return None
    return AtHand(asked, tuple(problem.site_candidate[list(route)].tolist()))


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


def _nearest(facts: Facts, cut: Cut) -> int:
    """The candidate that is most like a cut: the same way round, and as near as there is."""
    contour = facts.nest.index[cut.contour]
    numbers = range(int(facts.first[contour]), int(facts.first[contour + 1]))

    def unlike(number: int) -> tuple[bool, float]:
        way: Candidate = facts.candidates[number]
        return way.direction != cut.direction, math.dist(way.pierce, cut.pierce) + math.dist(way.entry, cut.entry)

    return min(numbers, key=unlike)
