"""General statements, as the search reads them: sums over literals of any kind."""

from __future__ import annotations

from typing import NamedTuple

from kerfwise.arrays import Ints
from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import Literal, Pick

from .compiled import compiled
from .demands import HARD
from .lists import flatten, ints

NO_SITE = -2  # stands for a candidate that no site stands for: it is never picked


class Literals(NamedTuple):
    """Statement g sums `weight` over its literals `first[g]` …: `a` before `b`, or with a = -1 site b picked.

    `when` is the site that it is about, or -1.
    """

    when: Ints
    bound: Ints
    cost: Ints
    first: Ints
    a: Ints
    b: Ints
    weight: Ints


def make_literals(problem: Problem) -> Literals:
    """The general statements of a problem."""
    general = problem.general
    pairs = [_pair(problem, literal) for s in general for literal in s.literals]
    return Literals(
        when=ints([-1 if s.when is None else _site(problem, s.when) for s in general]),
        bound=ints([s.bound for s in general]),
        cost=ints([HARD if s.weight is None else round(s.weight * UM_PER_MM) for s in general]),
        first=flatten([[0] * len(s.literals) for s in general])[0],
        a=ints([a for a, _ in pairs]),
        b=ints([b for _, b in pairs]),
        weight=ints([w for s in general for w in s.weights]),
    )


def _pair(problem: Problem, literal: Literal) -> tuple[int, int]:
    return (-1, _site(problem, literal.c)) if isinstance(literal, Pick) else (literal.i, literal.j)


def _site(problem: Problem, candidate: int) -> int:
    found = int(problem.candidate_site[candidate])
    return found if found >= 0 else NO_SITE


@compiled
def literals_unmet(literals: Literals, contour: Ints, position: Ints, site: Ints) -> tuple[int, int]:
    """Cost, and number of hard ones, of the statements that a route does not meet; `contour` of every site."""
    cost, broken = 0, 0
    for g in range(len(literals.bound)):
        when = literals.when[g]
        if when == NO_SITE or (when >= 0 and site[contour[when]] != when):
            continue
        if _missing(literals, g, contour, position, site) > 0:
            if literals.cost[g] < 0:
                broken += 1
            else:
                cost += literals.cost[g]
    return cost, broken


@compiled
def _missing(literals: Literals, g: int, contour: Ints, position: Ints, site: Ints) -> int:
    """By how much a statement falls short of its bound."""
    missing = literals.bound[g]
    for e in range(literals.first[g], literals.first[g + 1]):
        a, b = literals.a[e], literals.b[e]
        if (position[a] < position[b]) if a >= 0 else (b >= 0 and site[contour[b]] == b):
            missing -= literals.weight[e]
    return int(missing)


@compiled
def lean_on_sites(literals: Literals, contour: Ints, position: Ints, site: Ints, price: int, lean: Ints) -> None:
    """Write to `lean` what each site would cost for these statements' sake, all else in the route staying."""
    lean[:] = 0
    for g in range(len(literals.bound)):
        when = literals.when[g]
        if when == NO_SITE:
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
            if literals.a[e] >= 0 or b < 0:
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
        if literals.a[e] < 0 and literals.b[e] == site:
            total += literals.weight[e]
    return total
