"""The best entries along a given order, exactly: a shortest path through layers of sites, one a contour."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import About

from .setting import Setting


@dataclass(frozen=True, slots=True)
class Stuck:
    """No lawful entry is left for a contour in this order, and what forbids them."""

    contour: int
    abouts: tuple[About, ...]


def resite(setting: Setting, order: Sequence[int], pinned: Mapping[int, int] | None = None) -> Incumbent | Stuck:
    """The cheapest route that visits the contours in this order; `pinned` fixes the site of a contour.

    With x the contour at place k and S those before it: best(k, s) = least over the sites r of the contour before of
    best(k - 1, r) + travel(r, s) + what soft statements make of s after S; sites that a hard condition forbids after
    S are left out. What a move crosses is known from the order. Exact but for statements that tie entries of several
    contours together and for cooling in seconds: those only enter into the cost that is answered.
    """
    problem, pinned = setting.problem, pinned or {}
    over = _crossed(problem, order)
    layers: list[list[int]] = []
    came_from: list[NDArray[np.int64]] = []
    best, leave = np.zeros(1), [problem.m]
    already: set[int] = set()
    for k, contour in enumerate(order):
        sites = [pinned[contour]] if contour in pinned else list(problem.sites(contour))
        here, against = costs_here(setting, contour, sites, already)
        step = best[:, None] + problem.travel(leave, sites) + here[None, :]
        _add_crossed(step, over.get(k, ()), layers[-1] if layers else [problem.m], sites)
        choice = step.argmin(axis=0)
        best = step[choice, np.arange(len(sites))]
        if not np.isfinite(best).any():
            return Stuck(contour, tuple(dict.fromkeys(against)) or (_no_way(setting, contour),))
        layers.append(sites)
        came_from.append(choice)
        leave = sites
        already.add(contour)
    last = best[:, None] + problem.travel(leave, [problem.m])
    _add_crossed(last, over.get(len(order), ()), layers[-1] if layers else [problem.m], [problem.m])
    if not np.isfinite(last).any():
        return Stuck(order[-1], (_no_way(setting, order[-1]),))
    route: list[int] = []
    at = int(last[:, 0].argmin())
    for sites, choice in zip(reversed(layers), reversed(came_from), strict=True):
        route.append(sites[at])
        at = int(choice[at])
    found = tuple(reversed(route))
    return Incumbent(found, route_cost(problem, found))


def _no_way(setting: Setting, contour: int) -> About:
    """Moves over parts that are out: all that can forbid sites which are lawful by themselves."""
    name = setting.name(contour)
    sentence = f"every idle move to or from {name} would cross a part that is already out"
    return About(" or ".join(setting.over_parts), (name,), sentence)


def costs_here(setting: Setting, contour: int, sites: Sequence[int], already: set[int]) -> tuple[Floats, list[About]]:
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
