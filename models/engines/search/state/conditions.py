"""Conditions as the search reads them, in flat arrays: on what is cut, on groups, lags, and sums of literals."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.geometry.tolerances import UM_PER_MM, cost_um
from kerfwise.models.engines.tuning import STEPS
from kerfwise.models.problem.conditions import ConditionRows
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import AtLeast, Before, Enough, Lag, Pick, Steps

from .chains import HARD, is_chain
from .jit_tools import compiled, flatten, ints
from .travel import Legs, link_of

# Conditions on the set already cut, as the search reads them: in flat arrays, judged by position.


class Demands(NamedTuple):
    """Conditions numbered so that those of a contour, then those of a site, are consecutive.

    Contour i has `of_contour[i]` … `of_contour[i + 1] - 1`, site s those of `of_site`. `touch` lists the conditions
    that a contour is a member of.
    """

    of_contour: Ints
    of_site: Ints
    contour: Ints
    site: Ints
    bound: Ints
    cost: Ints
    member_first: Ints
    member: Ints
    weight: Ints
    touch_first: Ints
    touch: Ints
    touch_weight: Ints


def make_demands(problem: Problem) -> Demands:
    """The conditions of a problem."""
    whole = sorted((c for c in problem.conditions if c.when is None), key=lambda c: c.contour)
    sited = sorted((c for c in problem.conditions if c.when is not None), key=lambda c: c.when or 0)
    conditions = [*whole, *sited]
    rows = ConditionRows.of(conditions)
    touch_first, touch, touch_weight = rows.by_member(problem.n)
    return Demands(
        of_contour=ints(np.searchsorted([c.contour for c in whole], range(problem.n + 1)).tolist()),
        of_site=ints((len(whole) + np.searchsorted([c.when or 0 for c in sited], range(problem.m + 1))).tolist()),
        contour=rows.contour,
        site=rows.site,
        bound=rows.bound,
        cost=ints([HARD if c.cost is None else c.cost for c in conditions]),
        member_first=np.searchsorted(rows.row, np.arange(len(conditions) + 1)),
        member=rows.member,
        weight=rows.weight,
        touch_first=touch_first,
        touch=touch,
        touch_weight=touch_weight,
    )


@compiled
def met_at(demands: Demands, k: int, position: Ints, at: int, more: int) -> bool:
    """Whether condition k is met when its contour is cut just before position `at`, with `more` on its left side."""
    total = more
    for e in range(demands.member_first[k], demands.member_first[k + 1]):
        where = position[demands.member[e]]
        if 0 <= where < at:
            total += demands.weight[e]
    return bool(total >= demands.bound[k])


@compiled
def unmet(demands: Demands, start: int, stop: int, position: Ints, at: int) -> tuple[int, int]:
    """Cost, and number of hard ones, of the conditions `start` … `stop - 1` not met at a position."""
    cost, broken = 0, 0
    for k in range(start, stop):
        if not met_at(demands, k, position, at, 0):
            if demands.cost[k] < 0:
                broken += 1
            else:
                cost += demands.cost[k]
    return cost, broken


# Soft groups, as the search reads them: every piece of a group beyond the first costs.


class Groups(NamedTuple):
    """`of` lists the groups of every contour, `within[g, i]` says that contour i is in group g."""

    first: Ints
    of: Ints
    cost: Ints
    within: Bools


def make_groups(problem: Problem) -> Groups:
    """The soft groups of a problem."""
    within = np.zeros((len(problem.soft_groups), problem.n), dtype=np.bool_)
    for g, soft in enumerate(problem.soft_groups):
        within[g, list(soft.contours)] = True
    first, of = flatten([np.flatnonzero(within[:, i]).tolist() for i in range(problem.n)])
    return Groups(first, of, ints([g.cost for g in problem.soft_groups]), within)


@compiled
def pieces_begun(groups: Groups, contour: int, previous: int) -> int:
    """What it costs that pieces of groups begin at a contour; `previous` is -1 at the start of the route."""
    cost = 0
    for e in range(groups.first[contour], groups.first[contour + 1]):
        g = groups.of[e]
        if previous < 0 or not groups.within[g, previous]:
            cost += groups.cost[g]
    return cost


# Lags, as the search reads them: contours that must keep some cuts, or some seconds, apart.


class Lags(NamedTuple):
    """Contour i keeps `cuts` from the contours `other[first[i]:first[i + 1]]`; a cut that is missing costs `cost`.

    `guide_*` are the same with lags in seconds turned into cuts, for choosing a place. Lags in seconds are between
    `a` and `b`; a missing ms costs `per_ms` µm, HARD if it may not be. `cut_ms` is empty where cuts take no time.
    """

    first: Ints
    other: Ints
    cuts: Ints
    cost: Ints
    guide_first: Ints
    guide_other: Ints
    guide_cuts: Ints
    guide_cost: Ints
    a: Ints
    b: Ints
    wait_ms: Ints
    per_ms: Floats
    cut_ms: Ints
    ms_per_um: float


def make_lags(problem: Problem) -> Lags:
    """The lags of a problem."""
    in_cuts = [(lag, lag.cuts, _per_cut(lag, UM_PER_MM)) for lag in problem.lags if lag.cuts > 0]
    waits = [lag for lag in problem.lags if lag.seconds > 0]
    pace = problem.pace
    guide = list(in_cuts)
    if len(pace.cut_ms) and pace.cut_ms.any():
        cut_ms = float(pace.cut_ms.mean())
        guide += [(lag, int(np.ceil(lag.seconds * 1000 / cut_ms)), _per_cut(lag, cut_ms)) for lag in waits]
    return Lags(
        *_both_ways(problem.n, in_cuts),
        *_both_ways(problem.n, guide),
        a=ints([lag.first for lag in waits]),
        b=ints([lag.second for lag in waits]),
        wait_ms=ints([round(lag.seconds * 1000) for lag in waits]),
        per_ms=np.array([HARD if lag.weight is None else lag.weight for lag in waits], dtype=np.float64),
        cut_ms=pace.cut_ms,
        ms_per_um=float(pace.ms_per_um),
    )


def _per_cut(lag: Lag, worth: float) -> int:
    return HARD if lag.weight is None else round(lag.weight * worth)


def _both_ways(n: int, lags: list[tuple[Lag, int, int]]) -> tuple[Ints, Ints, Ints, Ints]:
    rows: list[list[tuple[int, int, int]]] = [[] for _ in range(n)]
    for lag, cuts, cost in lags:
        rows[lag.first].append((lag.second, cuts, cost))
        rows[lag.second].append((lag.first, cuts, cost))
    first, other = flatten([[other for other, _, _ in row] for row in rows])
    return first, other, ints([c for row in rows for _, c, _ in row]), ints([c for row in rows for _, _, c in row])


@compiled
def too_close(lags: Lags, contour: int, position: Ints, at: int) -> tuple[int, int]:
    """Cost, and cuts missing for hard lags, if a contour is put in just before position `at`: a guess for seconds."""
    cost, broken = 0, 0
    for e in range(lags.guide_first[contour], lags.guide_first[contour + 1]):
        where = position[lags.guide_other[e]]
        if where < 0:
            continue
        between = at - where - 1 if where < at else where - at
        missing = lags.guide_cuts[e] - between
        if missing > 0:
            if lags.guide_cost[e] < 0:
                broken += missing
            else:
                cost += missing * lags.guide_cost[e]
    return cost, broken


@compiled
def too_close_within(lags: Lags, contour: int, position: Ints, hi: int) -> tuple[int, int]:
    """Cost, and cuts missing for hard lags, of a contour and those that stand before it or from position `hi` on."""
    cost, broken = 0, 0
    at = position[contour]
    for e in range(lags.first[contour], lags.first[contour + 1]):
        where = position[lags.other[e]]
        if at < where < hi:
            continue
        missing = lags.cuts[e] - (abs(at - where) - 1)
        if missing > 0:
            if lags.cost[e] < 0:
                broken += missing
            else:
                cost += missing * lags.cost[e]
    return cost, broken


@compiled
def too_soon(lags: Lags, legs: Legs, order: Ints, position: Ints, site: Ints, time_ms: Ints) -> tuple[int, int]:
    """Cost, and number of hard ones broken, of the lags in seconds; `time_ms` is room for one number a contour."""
    if len(lags.cut_ms) > 0:
        now, last = 0, legs.m
        for c in order:
            s = site[c]
            link = link_of(legs, last, s)
            if link < 0:
                dx, dy = legs.end[last, 0] - legs.pierce[s, 0], legs.end[last, 1] - legs.pierce[s, 1]
                now += int(np.rint(np.sqrt(dx * dx + dy * dy) * lags.ms_per_um))
            time_ms[c] = now
            now += lags.cut_ms[s]
            if link >= 0:
                now += legs.link_ms[link]
            last = s
    cost, broken = 0, 0
    for k in range(len(lags.a)):
        first, second = lags.a[k], lags.b[k]
        if position[first] > position[second]:
            first, second = second, first
        between = 0
        if len(lags.cut_ms) > 0:
            between = time_ms[second] - time_ms[first] - lags.cut_ms[site[first]]
            if position[first] > 0:
                link = link_of(legs, site[order[position[first] - 1]], site[first])
                if link >= 0:
                    between -= legs.link_ms[link]
        missing = lags.wait_ms[k] - between
        if missing > 0:
            if lags.per_ms[k] < 0:
                broken += 1 + STEPS * missing // lags.wait_ms[k]
            else:
                cost += int(np.rint(lags.per_ms[k] * missing))
    return cost, broken


# General statements, as the search reads them: sums over literals of any kind.

WITHIN = -1
NO_SITE = -2  # stands for a candidate that no site stands for: it is never picked


class Literals(NamedTuple):
    """Statement g sums `weight` over its literals `first[g]` …: `a` before `b`; with a = -1 site b picked; with a = -2
    what statement b says, which is one of the conditions `within` others, and stands before them; with a = -3 how many
    contours come before contour b; with a = -4 that row b of `steps` holds: contours, and the least and most cuts from
    one to the other. Weights over 0 come last, the plain ones first.

    `when` is the site that it is about, or -1. `within` is `WITHIN` for one within others, else whether it names sites.
    """

    when: Ints
    bound: Ints
    cost: Ints
    first: Ints
    a: Ints
    b: Ints
    weight: Ints
    within: Ints
    steps: Ints


def make_literals(problem: Problem) -> Literals:
    """The general statements of a problem but for `Chains`, each after the conditions that stand in it."""
    rows: list[AtLeast | Enough] = []
    bounds: list[int] = []
    terms: list[list[tuple[int, int, int]]] = []
    known: dict[int, int] = {}
    steps: dict[Steps, int] = {}

    def numbered(row: AtLeast | Enough) -> int:
        if id(row) in known:
            return known[id(row)]
        orders, bound = _by_position(row, problem.n)
        own = [(a, b, weight) for (a, b), weight in orders.items()]
        for lit, weight in zip(row.literals, row.weights, strict=True):
            match lit:
                case Enough():
                    own.append((-2, numbered(lit), weight))
                case Pick(c):
                    own.append((-1, _site(problem, c), weight))
                case Steps():
                    own.append((-4, steps.setdefault(lit, len(steps)), weight))
        rows.append(row)
        bounds.append(bound)
        terms.append(sorted(own, key=lambda term: (term[2] > 0, term[0] == -2)))
        known[id(row)] = len(rows) - 1
        return known[id(row)]

    for s in problem.general:
        if not is_chain(s):
            numbered(s)
    stated = [None if isinstance(row, Enough) else row for row in rows]
    flat = [term for own in terms for term in own]
    return Literals(
        when=ints([-1 if s is None or s.when is None else _site(problem, s.when) for s in stated]),
        bound=ints(bounds),
        cost=ints([HARD if s is None or s.weight is None else cost_um(s.weight) for s in stated]),
        first=flatten([[0] * len(own) for own in terms])[0],
        a=ints([a for a, _, _ in flat]),
        b=ints([b for _, b, _ in flat]),
        weight=ints([weight for _, _, weight in flat]),
        within=ints([WITHIN if s is None else int(_of_sites(s, own)) for s, own in zip(stated, terms, strict=True)]),
        steps=ints([number for s in steps for number in (s.i, s.j, s.least, s.most)]).reshape(-1, 4),
    )


def _of_sites(s: AtLeast, terms: Sequence[tuple[int, int, int]]) -> bool:
    """Whether it names sites, not counting what stands within it."""
    return s.when is not None or any(a == -1 for a, _, _ in terms)


def _by_position(row: AtLeast | Enough, n: int) -> tuple[dict[tuple[int, int], int], int]:
    """The weights of orders in a sum over n contours, and its bound; all orders of one contour are its position."""
    weights: dict[tuple[int, int], int] = defaultdict(int)
    for literal, weight in zip(row.literals, row.weights, strict=True):
        if isinstance(literal, Before):
            weights[literal.i, literal.j] += weight
    bound = row.bound
    for end in (1, 0) if len(weights) >= n - 1 else ():
        of: dict[int, list[tuple[int, int]]] = defaultdict(list)
        for pair in weights:
            of[pair[end]].append(pair)
        for contour, pairs in of.items():
            least = min(weights[pair] for pair in pairs)
            if contour >= 0 and len(pairs) == n - 1 and least > 0:
                weights |= {pair: weights[pair] - least for pair in pairs}
                weights[-3, contour] += least if end else -least
                bound -= 0 if end else least * (n - 1)
    return {pair: weight for pair, weight in weights.items() if weight}, bound


def _site(problem: Problem, candidate: int) -> int:
    found = int(problem.candidate_site[candidate])
    return found if found >= 0 else NO_SITE


@compiled
def literals_unmet(literals: Literals, contour: Ints, position: Ints, site: Ints) -> tuple[int, int]:
    """Cost, and number of hard ones, of the statements that a route does not meet; `contour` of every site."""
    cost, broken = 0, 0
    for g in range(len(literals.bound)):
        when = literals.when[g]
        if literals.within[g] == WITHIN or when == NO_SITE or (when >= 0 and site[contour[when]] != when):
            continue
        if not _holds(literals, g, contour, position, site):
            if literals.cost[g] < 0:
                broken += 1
            else:
                cost += literals.cost[g]
    return cost, broken


@compiled
def _holds(literals: Literals, g: int, contour: Ints, position: Ints, site: Ints) -> bool:
    """Whether a statement reaches its bound."""
    missing = literals.bound[g]
    for e in range(literals.first[g], literals.first[g + 1]):
        if missing <= 0 and literals.weight[e] > 0:
            return True
        if literals.a[e] != -2:
            missing -= _plain(literals, e, contour, position, site)
        elif _holds(literals, literals.b[e], contour, position, site):
            missing -= literals.weight[e]
    return bool(missing <= 0)


@compiled
def _plain(literals: Literals, e: int, contour: Ints, position: Ints, site: Ints) -> int:
    """What a literal that is no condition adds to its sum."""
    a, b, weight = literals.a[e], literals.b[e], literals.weight[e]
    if a == -3:
        return int(weight * position[b])
    if a == -4:
        ahead = position[literals.steps[b, 1]] - position[literals.steps[b, 0]]
        return int(weight) if literals.steps[b, 2] <= ahead <= literals.steps[b, 3] else 0
    true = (position[a] < position[b]) if a >= 0 else (b >= 0 and site[contour[b]] == b)
    return int(weight) if true else 0


@compiled
def _missing(literals: Literals, g: int, contour: Ints, position: Ints, site: Ints) -> int:
    """By how much a statement falls short of its bound."""
    missing = literals.bound[g]
    for e in range(literals.first[g], literals.first[g + 1]):
        if literals.a[e] != -2:
            missing -= _plain(literals, e, contour, position, site)
        elif _holds(literals, literals.b[e], contour, position, site):
            missing -= literals.weight[e]
    return int(missing)


@compiled
def lean_on_sites(literals: Literals, contour: Ints, position: Ints, site: Ints, price: int, lean: Ints) -> None:
    """Write to `lean` what each site would cost for these statements' sake, all else in the route staying."""
    lean[:] = 0
    for g in range(len(literals.bound)):
        when = literals.when[g]
        if when == NO_SITE or literals.within[g] != 1:
            continue
        cost = price if literals.cost[g] < 0 else literals.cost[g]
        missing = _missing(literals, g, contour, position, site)
        if when >= 0:
            if missing > 0:
                lean[when] += cost
            if site[contour[when]] != when:
                continue
        for e in range(literals.first[g], literals.first[g + 1]):
            b = literals.b[e]
            if literals.a[e] != -1 or b < 0:
                continue
            without = missing + _picked_weight(literals, g, site[contour[b]])
            within = without - _picked_weight(literals, g, b)
            if without > 0 and within <= 0:
                lean[b] = min(lean[b], -cost)
            elif without <= 0 and within > 0:
                lean[b] = max(lean[b], cost)


@compiled
def _picked_weight(literals: Literals, g: int, site: int) -> int:
    """The weight that picking a site has in a statement."""
    total = 0
    for e in range(literals.first[g], literals.first[g + 1]):
        if literals.a[e] == -1 and literals.b[e] == site:
            total += literals.weight[e]
    return total
