"""A finished plan as the engines would see it, and the best entries along a given order."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.display import join_names
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.engines.solution import Incumbent, Solution
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import source_changes
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.moves import LAWFUL_MOST
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.profile.technique import Technique
from kerfwise.rules.statements import EXEMPTION_MM, About, Precede, by_kind
from kerfwise.rules.stating.state_rules import Stated

# A finished plan as the engines would see it: statements, problem, and the route read back from the plan's cuts.

NEAR_MM = 1e-3
"""A cut is a candidate's if it is pierced this near to it, the same way round."""

MOST_NAMED = 8
"""So many contours are named in a note."""


@dataclass(frozen=True, eq=False, slots=True)
class PlanContext:
    """Everything that an explanation is made from.

    `route` are sites in cutting order, `order` their contours, and `cost` what they cost, µm; `candidates` are those
    that the plan uses.
    `conditions` by contour; `orders` are the hard orders, `pairs` (k, 2) their contours. `over_parts` are the rules
    that forbid moves over parts that are out. `notes` say where the plan and what is stated now do not meet.
    """

    facts: Facts
    profile: Technique
    stated: Stated
    problem: Problem
    route: tuple[int, ...]
    order: tuple[int, ...]
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

    def name(self, contour: int) -> str:
        """Id of a contour."""
        return self.problem.ids[contour]


def make_context(facts: Facts, profile: Technique, stated: Stated, plan: Plan) -> PlanContext:
    """The setting of a plan, under the facts and statements of today.

    Raises InputError if the plan is not one of this nest: it names contours that the nest does not have, or misses
    some.
    """
    _same_contours(facts, plan)
    problem = make_problem(facts, stated.statements, profile.home_on(facts.nest), feeds_of(profile))
    candidates, stand_ins = _candidates_of(facts, problem, plan)
    notes = (*source_changes(plan, facts.nest, profile), *stand_ins)
    return context_along(facts, profile, stated, problem, candidates, notes)


def context_along(
    facts: Facts,
    profile: Technique,
    stated: Stated,
    problem: Problem,
    candidates: Sequence[int],
    notes: tuple[str, ...] = (),
) -> PlanContext:
    """The setting of a route (candidates in cutting order) of a problem that is made of what is stated."""
    route = tuple(int(problem.candidate_site[c]) for c in candidates)
    conditions: dict[int, list[Condition]] = defaultdict(list)
    for condition in problem.conditions:
        conditions[condition.contour].append(condition)
    kinds = by_kind(stated.statements)
    orders = tuple(s for s in kinds.precede if s.weight is None)
    return PlanContext(
        facts,
        profile,
        stated,
        problem,
        route,
        tuple(problem.site_contour[list(route)].tolist()),
        tuple(candidates),
        route_cost(problem, route),
        {contour: tuple(of) for contour, of in conditions.items()},
        orders,
        np.array([(s.before, s.after) for s in orders], dtype=np.int64).reshape(-1, 2),
        tuple(dict.fromkeys(s.about.rule for s in kinds.crossing if s.weight is None)),
        notes,
    )


def solved_context(facts: Facts, profile: Technique, stated: Stated, solution: Solution) -> PlanContext:
    """The setting of a plan that was just found: by the problem that was solved, where the engine has kept it."""
    problem = solution.problem
    if problem is None:
        problem = make_problem(facts, stated.statements, profile.home_on(facts.nest), feeds_of(profile))
    else:
        stated = replace(stated, statements=problem.told.statements)
    return context_along(facts, profile, stated, problem, solution.route)


def _same_contours(facts: Facts, plan: Plan) -> None:
    index = facts.nest.index
    planned = [p.cut.contour for p in plan.items]
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
    for planned in plan.items:
        candidate, how = _candidate_of(facts, problem, planned.cut)
        used.append(candidate)
        if how:
            otherwise[how].append(planned.cut.contour)
    return used, [_stood_in(names, how) for how, names in otherwise.items()]


def _stood_in(names: list[str], how: str) -> str:
    """That other cuts stand in for those of some contours, in a sentence."""
    if len(names) == 1:
        return f"{names[0]} is {how}; the nearest lawful one stands in for it"
    return f"{join_names(names, MOST_NAMED)} are {how}; the nearest lawful ones stand in for them"


def _candidate_of(facts: Facts, problem: Problem, cut: Cut) -> tuple[int, str]:
    """The candidate that a planned cut uses, or the lawful one nearest to it, and how it is cut where that is so.

    A cut that is linked is told by where it joins.
    """
    link = cut.lead_in if cut.linked else None
    begins = cut.pierce if link is None else link.segments[-1].end

    def away_mm(c: int) -> tuple[float, float]:
        begin = facts.candidates[c].pierce if link is None else facts.candidates[c].join
        return math.dist(begin, begins), math.dist(facts.candidates[c].end, cut.end)

    span = facts.candidates_of(facts.nest.index[cut.contour])
    same_way = [c for c in span if facts.candidates[c].direction == cut.direction or cut.way]
    nearest = min(same_way, key=away_mm, default=None)
    how = "cut in a way that no candidate of this profile is"
    if nearest is not None and away_mm(nearest)[0] <= NEAR_MM:
        if problem.candidate_site[nearest] >= 0:
            return nearest, ""
        how = "entered in a way that a hard rule forbids now"
    lawful = [c for c in span if problem.candidate_site[c] >= 0]
    return min(lawful, key=lambda c: (facts.candidates[c].direction != cut.direction, away_mm(c))), how


# The best entries along a given order, exactly: a shortest path through layers of sites, one a contour.


@dataclass(frozen=True, slots=True)
class Stuck:
    """No lawful entry is left for a contour in this order, and what forbids them."""

    contour: int
    abouts: tuple[About, ...]


UNLIKED_UM = EXEMPTION_MM * UM_PER_MM / 2
"""What keeps an entry that is liked: no travel and no soft rule weighs as much, an excuse does."""


def resite(
    setting: PlanContext,
    order: Sequence[int],
    pinned: Mapping[int, int] | None = None,
    liked: Mapping[int, int] | None = None,
) -> Incumbent | Stuck:
    """The cheapest route that visits the contours in this order; `pinned` fixes the site of a contour.

    A contour has the site that is `liked` wherever that is lawful, whatever it costs.
    With x the contour at place k and S those before it: best(k, s) = least over the sites r of the contour before of
    best(k - 1, r) + travel(r, s) + what soft statements make of s after S; sites that a hard condition forbids after
    S are left out. What a move crosses is known from the order. Exact but for statements that tie entries of several
    contours together and for cooling in seconds: those only enter into the cost that is answered.
    """
    problem, pinned, liked = setting.problem, pinned or {}, liked or {}
    over = _crossed(problem, order)
    layers: list[list[int]] = []
    came_from: list[NDArray[np.int64]] = []
    best, leave = np.zeros(1), [problem.m]
    already: set[int] = set()
    for k, contour in enumerate(order):
        sites = [pinned[contour]] if contour in pinned else list(problem.sites(contour))
        here, against = costs_here(setting, contour, sites, already)
        if contour in liked:
            here = here + UNLIKED_UM * (np.array(sites) != liked[contour])
        step = best[:, None] + lawful_travel(problem, leave, sites) + here[None, :]
        _add_crossed(step, over.get(k, ()), layers[-1] if layers else [problem.m], sites)
        choice = step.argmin(axis=0)
        best = step[choice, np.arange(len(sites))]
        if not np.isfinite(best).any():
            before = order[k - 1] if k else None
            return Stuck(contour, tuple(dict.fromkeys(against)) or _no_way(setting, before, contour))
        layers.append(sites)
        came_from.append(choice)
        leave = sites
        already.add(contour)
    last = best[:, None] + lawful_travel(problem, leave, [problem.m])
    _add_crossed(last, over.get(len(order), ()), layers[-1] if layers else [problem.m], [problem.m])
    if not np.isfinite(last).any():
        return Stuck(order[-1], _no_way(setting, None, order[-1]))
    route: list[int] = []
    at = int(last[:, 0].argmin())
    for sites, choice in zip(reversed(layers), reversed(came_from), strict=True):
        route.append(sites[at])
        at = int(choice[at])
    found = tuple(reversed(route))
    return Incumbent(found, route_cost(problem, found))


def lawful_travel(problem: Problem, leave: Sequence[int], reach: Sequence[int]) -> Floats:
    """`Problem.travel`, infinite where a move is not lawful."""
    table = problem.travel(leave, reach).astype(np.float64)
    table[table > LAWFUL_MOST] = np.inf
    return table


def _no_way(setting: PlanContext, before: int | None, contour: int) -> tuple[About, ...]:
    """What forbids sites which are lawful by themselves: moves from the contour before, or over parts that are out."""
    moves = () if before is None else setting.problem.moves.statements
    banned = [s.about for s in moves if s.weight is None and before in s.leave and contour in s.reach]
    if banned:
        return tuple(dict.fromkeys(banned))
    name = setting.name(contour)
    sentence = f"every idle move to or from {name} would cross a part that is already out"
    return (About(" or ".join(setting.over_parts), (name,), sentence),)


def costs_here(
    setting: PlanContext, contour: int, sites: Sequence[int], already: set[int]
) -> tuple[Floats, list[About]]:
    """What each site costs by itself after the contours of `already`, inf where unlawful; and what makes it so."""
    here = setting.problem.site_cost[list(sites)].astype(np.float64)
    against: list[About] = []
    for condition in setting.conditions.get(contour, ()):
        of = [k for k, site in enumerate(sites) if condition.when in (None, site)]
        if of and not condition.met(already):
            if condition.cost is None:
                against.append(condition.about)
            here[of] += np.inf if condition.cost is None else float(condition.cost)
    return here, against


def _crossed(problem: Problem, order: Sequence[int]) -> dict[int, list[tuple[int, int, float]]]:
    """Step → (site left, site reached, cost) of its moves over parts that are already out; step n leads home."""
    rows = problem.crossings
    found: dict[int, list[tuple[int, int, float]]] = defaultdict(list)
    if not len(rows):
        return found
    place = np.full(problem.n + 1, -1)
    place[list(order)] = np.arange(len(order))
    contour = np.append(problem.site_contour, problem.n)
    step = place[contour[rows.leave]] + 1
    reached = np.where(rows.reach == problem.m, len(order), place[contour[rows.reach]])
    for k in np.flatnonzero((step == reached) & (place[rows.over] < step)).tolist():
        cost = np.inf if rows.cost[k] == FORBIDDEN else float(rows.cost[k])
        found[int(step[k])].append((int(rows.leave[k]), int(rows.reach[k]), cost))
    return found


def _add_crossed(
    step: Floats, moves: Sequence[tuple[int, int, float]], rows: Sequence[int], columns: Sequence[int]
) -> None:
    row, column = ({site: k for k, site in enumerate(sites)} for sites in (rows, columns))
    for leave, reach, cost in moves:
        if leave in row and reach in column:
            step[row[leave], column[reach]] += cost
