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
from kerfwise.models.physics.timing.choose import feeds_of
from kerfwise.models.plan.plan import Plan
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.profile.for_one_nest import changed_since
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import Precede
from kerfwise.rules.stating.state_rules import Stated

NEAR_MM = 1e-3
"""A cut is a candidate's if it is pierced this near to it, the same way round."""

_SHA_DIGITS = 12


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
    notes: list[str] = []
    if plan.nest.get("sha256") != facts.nest.sha256:
        notes.append("the nest is not the one the plan was made with (its sha256 differs)")
    if told := made_with_another(plan, profile):
        notes.append(told)
    notes += changed_since(plan.made_with, profile.for_one_nest)
    candidates = [_candidate_of(facts, problem, planned.cut, notes) for planned in plan.cuts]
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
        tuple(notes),
    )


def made_with_another(plan: Plan, profile: Profile) -> str:
    """That a plan was made with another profile than this, with which, and what to do; "" where it was not."""
    own, sha256 = plan.profile.get("name", ""), plan.profile.get("sha256", "")
    if sha256 == profile.sha256:
        return ""
    told = f"the profile is not the one the plan was made with (its sha256 differs): this is '{profile.name}', "
    if not own:
        return f"{told}the plan does not say which that was"
    begins = f", whose sha256 begins {sha256[:_SHA_DIGITS]}" if sha256 else ""
    return f"{told}that was '{own}'{begins}: give it with -p (in Python profile=)"


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


def _candidate_of(facts: Facts, problem: Problem, cut: Cut, notes: list[str]) -> int:
    """The candidate that a planned cut uses, or the lawful one nearest to it, with a note.

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
    if nearest is not None and away_mm(nearest)[0] <= NEAR_MM:
        if problem.candidate_site[nearest] >= 0:
            return nearest
        notes.append(f"{cut.contour} is entered in a way that a hard rule forbids now")
    else:
        notes.append(f"{cut.contour} is cut in a way that no candidate of this profile is")
    lawful = [c for c in span if problem.candidate_site[c] >= 0]
    stand_in = min(lawful, key=lambda c: (facts.candidates[c].direction != cut.direction, away_mm(c)))
    notes[-1] += "; the nearest lawful one stands in for it"
    return stand_in
