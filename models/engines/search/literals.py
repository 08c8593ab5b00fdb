"""General statements, as the search reads them: sums over literals of any kind."""

from __future__ import annotations

from typing import NamedTuple

from kerfwise.arrays import Ints
from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import AtLeast, Before, Enough, Pick

from .compiled import compiled
from .demands import HARD
from .lists import flatten, ints

NO_SITE = -2  # stands for a candidate that no site stands for: it is never picked


class Literals(NamedTuple):
    """Statement g sums `weight` over its literals `first[g]` …: `a` before `b`; with a = -1 site b picked; with a = -2
    what statement b says, which is one of the conditions `within` others, and stands before them.

    `when` is the site that it is about, or -1.
    """

    when: Ints
    bound: Ints
    cost: Ints
    first: Ints
    a: Ints
    b: Ints
    weight: Ints
    within: Ints


def make_literals(problem: Problem) -> Literals:
    """The general statements of a problem, each after the conditions that stand in it."""
    rows: list[AtLeast | Enough] = []
    pairs: list[list[tuple[int, int]]] = []

    def numbered(row: AtLeast | Enough) -> int:
        own = [(-2, numbered(lit)) if isinstance(lit, Enough) else _pair(problem, lit) for lit in row.literals]
        rows.append(row)
        pairs.append(own)
        return len(rows) - 1

    for s in problem.general:
        numbered(s)
    stated = [None if isinstance(row, Enough) else row for row in rows]
    flat = [pair for own in pairs for pair in own]
    return Literals(
        when=ints([-1 if s is None or s.when is None else _site(problem, s.when) for s in stated]),
        bound=ints([row.bound for row in rows]),
        cost=ints([HARD if s is None or s.weight is None else round(s.weight * UM_PER_MM) for s in stated]),
        first=flatten([[0] * len(row.literals) for row in rows])[0],
        a=ints([a for a, _ in flat]),
        b=ints([b for _, b in flat]),
        weight=ints([w for row in rows for w in row.weights]),
        within=ints([int(s is None) for s in stated]),
    )


def _pair(problem: Problem, literal: Before | Pick) -> tuple[int, int]:
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
        if literals.within[g] or when == NO_SITE or (when >= 0 and site[contour[when]] != when):
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
        if a == -2:
            if _missing(literals, b, contour, position, site) <= 0:
                missing -= literals.weight[e]
        elif (position[a] < position[b]) if a >= 0 else (b >= 0 and site[contour[b]] == b):
            missing -= literals.weight[e]
    return int(missing)


@compiled
def lean_on_sites(literals: Literals, contour: Ints, position: Ints, site: Ints, price: int, lean: Ints) -> None:
    """Write to `lean` what each site would cost for these statements' sake, all else in the route staying."""
    lean[:] = 0
    for g in range(len(literals.bound)):
        when = literals.when[g]
        if when == NO_SITE or literals.within[g]:
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
