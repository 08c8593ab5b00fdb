"""The tables of a stretch: what moves cost in and into it, in integers as narrow as will do."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.geometry.microns import cost_um
from kerfwise.models.problem.problem import Problem

from .crossed import HOME, UNLAWFUL, add_settled, cross
from .kernels import Costs, MoveTable
from .local import Local
from .over import Over

NARROW = 1 << 29
"""Twice as much fits in 32 bits."""
WIDE = 1 << 60
LANES = 8
"""Numbers of 32 bits that are added at once: blocks of moves are padded to as many, but for contours of one site."""


def dearest(problem: Problem) -> int:
    """What no lawful plan costs more than; what is less than unlawful where that takes many words."""
    if len(problem.crossings) or problem.soft_groups or any(lag.weight is not None for lag in problem.lags):
        return UNLAWFUL - 1
    everywhere = np.arange(problem.m + 1)
    blocks = (problem.travel(everywhere[at : at + 256], everywhere).max() for at in range(0, problem.m + 1, 256))
    total = (problem.n + 1) * int(max(blocks)) + problem.n * int(problem.site_cost.max(initial=0))
    return total + sum(condition.cost or 0 for condition in problem.conditions)


def never(limit: int) -> int:
    """A number for all costs over the limit."""
    return NARROW if limit < NARROW else WIDE


def entrance_of(costs: Costs | list[int], limit: int) -> Costs:
    """Costs so far, in the integers that fit."""
    return np.array(costs, dtype=np.int32 if limit < NARROW else np.int64)


def make_moves(
    problem: Problem, local: Local, earlier: frozenset[int], ways: Ints, limit: int
) -> tuple[MoveTable, Over]:
    """The moves of a stretch that is entered from the sites `ways` once `earlier` is cut, and what they cross."""
    rows = np.concatenate([ways, local.sites])
    travel = travel_between(problem, rows, local.sites)
    over = cross(problem, local, earlier, rows, travel)
    return table_of(local, travel, limit), over


def table_of(local: Local, travel: Ints, limit: int) -> MoveTable:
    """What moves cost, (rows, columns), as a table: rows are ways in, then sites of a stretch, columns its sites."""
    ways = len(travel) - len(local.sites)
    travel = np.where(travel > limit, never(limit), travel)
    size = local.orders.size
    pad = np.where(size > 1, -(-size // LANES) * LANES, size)
    narrowest = entrance_of([], limit).dtype
    base = np.append(0, np.cumsum(pad))[:-1]
    flat = []
    for i in range(len(size)):
        block = np.full((len(travel), int(pad[i])), never(limit), dtype=narrowest)
        block[:, : int(size[i])] = travel[:, local.first[i] : local.first[i + 1]]
        flat.append(block.ravel())
    row_of = np.append(ways + local.first[:-1], 0)
    return MoveTable(np.concatenate(flat), base * len(travel), pad, row_of)


def travel_between(problem: Problem, rows: Ints, columns: Ints) -> Ints:
    """Cost of going from the end of each row's site to the pierce of each column's, `HOME` for the machine's home."""
    travel = problem.travel(*(np.where(sites == HOME, problem.m, sites) for sites in (rows, columns)))
    left, right = _contours(problem, rows), _contours(problem, columns)
    here, there = set(left.tolist()), set(right.tolist())
    for lag in problem.lags:
        cost = UNLAWFUL if lag.weight is None else cost_um(lag.weight)
        for i, j in ((lag.first, lag.second), (lag.second, lag.first)):
            if lag.cuts == 1 and i in here and j in there:
                travel[np.ix_(left == i, right == j)] += cost
    return travel


def _contours(problem: Problem, sites: Ints) -> Ints:
    """The contour of every site, `HOME` for home."""
    return np.where(sites == HOME, HOME, problem.site_contour[sites])


def home_from(problem: Problem, ways: Ints) -> Ints:
    """Cost of the last move, with all parts out."""
    home = travel_between(problem, ways, np.array([HOME]))
    add_settled(problem, frozenset(range(problem.n)), ways, np.array([HOME]), home)
    return home[:, 0]
