"""A finished plan as the engines would see it: statements, problem, and the route read back from the plan's cuts."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kerfwise.encoder.cut import Cut
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.facts.links import join_of
from kerfwise.encoder.listed import listed
from kerfwise.models.physics.timing.choose import feeds_of
from kerfwise.models.plan.made_from import made_from_others
from kerfwise.models.plan.plan import Plan
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import Precede
from kerfwise.rules.stating.state_rules import Stated

NEAR_MM = 1e-3
"""A cut is a candidate's if it is pierced this near to it, the same way round."""

MOST_NAMED = 8
"""So many contours are named in a note."""


@dataclass(frozen=True, eq=False, slots=True)
class Setting:
    """Everything that an explanation is made from.

    `route` are sites in cutting order and `cost` what they cost, µm; `candidates` the candidates that the plan uses.
    `conditions` by contour; `orders` are the hard orders, `pairs` (k, 2) their contours. `over_parts` are the rules
    that forbid moves over parts that are out. `notes` say where the plan and what is stated now do not meet.
    """

    facts: Facts
    profile: Profile
    stated: Stated
    problem: Problem
    route: tuple[int, ...]
    candidates: tuple[int, ...]
    cost: int
    conditions: dict[int, tuple[Condition, ...]]
    orders: tuple[Precede, ...]
    pairs: NDArray[np.int64]
    over_parts: tuple[str, ...]
    notes: tuple[str, ...] = field(default=())

    @property
    def made(self) -> int:
        """How many cuts a stopped program had made before the first of the order."""
        return len(self.facts.already_cut)

    @property
    def order(self) -> tuple[int, ...]:
        """Contour numbers in cutting order."""
        return tuple(self.problem.site_contour[list(self.route)].tolist())

    def name(self, contour: int) -> str:
        """Id of a contour."""
        return self.problem.ids[contour]


def make_setting(facts: Facts, profile: Profile, stated: Stated, plan: Plan) -> Setting:
    """The setting of a plan, under the facts and statements of today.

    Raises
    ------
    InputError
        If the plan is not one of this nest: it names contours that the nest does not have, or misses some.
    """
    _same_contours(facts, plan)
    problem = make_problem(facts, stated.statements, profile.home_on(facts.nest), feeds_of(profile))
    candidates, stand_ins = _candidates_of(facts, problem, plan)
    route = tuple(int(problem.candidate_site[c]) for c in candidates)
    conditions: dict[int, list[Condition]] = defaultdict(list)
    for condition in problem.conditions:
        conditions[condition.contour].append(condition)
    kinds = by_kind(stated.statements)
    orders = tuple(s for s in kinds.precede if s.weight is None)
    return Setting(
        facts,
        profile,
        stated,
        problem,
        route,
        tuple(candidates),
        route_cost(problem, route),
        {contour: tuple(of) for contour, of in conditions.items()},
        orders,
        np.array([(s.before, s.after) for s in orders], dtype=np.int64).reshape(-1, 2),
        tuple(dict.fromkeys(s.about.rule for s in kinds.crossing if s.weight is None)),
        (*made_from_others(plan, facts.nest, profile), *stand_ins),
    )


def _same_contours(facts: Facts, plan: Plan) -> None:
    index = facts.nest.index
    planned = [p.cut.contour for p in plan.cuts]
    unknown = [name for name in planned if name not in index]
    missing = sorted(index.keys() - set(planned))
    if unknown or missing or len(planned) != len(index):
        detail = [f"the nest has no {name}" for name in unknown] + [f"the plan does not cut {name}" for name in missing]
        raise InputError(
            f"the plan is not one of {facts.nest.file or 'this nest'}: every contour must be cut once",
            details=tuple(detail[:10]),
        )


def _candidates_of(facts: Facts, problem: Problem, plan: Plan) -> tuple[list[int], list[str]]:
    """The candidates that the planned cuts use, or the lawful ones nearest to them, and notes of these."""
    used = []
    otherwise: dict[str, list[str]] = defaultdict(list)
    for planned in plan.cuts:
        candidate, how = _candidate_of(facts, problem, planned.cut)
        used.append(candidate)
        if how:
            otherwise[how].append(planned.cut.contour)
    return used, [_stood_in(names, how) for how, names in otherwise.items()]


def _stood_in(names: list[str], how: str) -> str:
    """That other cuts stand in for those of some contours, in a sentence."""
    if len(names) == 1:
        return f"{names[0]} is {how}; the nearest lawful one stands in for it"
    return f"{listed(names, MOST_NAMED)} are {how}; the nearest lawful ones stand in for them"


def _candidate_of(facts: Facts, problem: Problem, cut: Cut) -> tuple[int, str]:
    """The candidate that a planned cut uses, or the lawful one nearest to it, and how it is cut where that is so.

    A cut that is linked is told by where it joins.
    """
    link = cut.lead_in if cut.linked else None
    begins = cut.pierce if link is None else link.segments[-1].end

    def away_mm(c: int) -> tuple[float, float]:
        begin = facts.candidates[c].pierce if link is None else join_of(facts.candidates[c])
        return math.dist(begin, begins), math.dist(facts.candidates[c].end, cut.end)

    span = facts.candidates_of(facts.nest.index[cut.contour])
    same_way = [c for c in span if facts.candidates[c].direction == cut.direction]
    nearest = min(same_way, key=away_mm, default=None)
    how = "cut in a way that no candidate of this profile is"
    if nearest is not None and away_mm(nearest)[0] <= NEAR_MM:
        if problem.candidate_site[nearest] >= 0:
            return nearest, ""
        how = "entered in a way that a hard rule forbids now"
    lawful = [c for c in span if problem.candidate_site[c] >= 0]
    return min(lawful, key=lambda c: (facts.candidates[c].direction != cut.direction, away_mm(c))), how
