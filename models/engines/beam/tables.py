"""A problem as the flat arrays that the kernels read; sets of contours are rows of 64-bit words."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.geometry.microns import cost_um
from kerfwise.models.problem.bits import Masks, masks_of
from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.problem import Problem

Shorts = NDArray[np.int32]

NEVER = int(np.iinfo(np.int32).max)
"""The cost of a move that is not lawful; others cost less."""
HARD = FORBIDDEN


class Tables(NamedTuple):
    """n contours, m sites, sets in w words; contour i has bit i % 64 of word i // 64.

    `travel` (m + 1, m + 1) has what a move costs whatever is out, home last. `needs` (n, w) must be out before a
    contour, `opens[open_from[i]:open_from[i + 1]]` are the contours that may only just become possible once i is out.
    `block` (n) is the contiguous block of a contour, `block_size` (n) how many contours share it.
    Conditions of contour i are `cond_from[i]` … `cond_from[i + 1] - 1`, `cond_site` -1 where all sites are meant,
    `cond_cost` `HARD` where it must hold; the members of condition q are `member_from[q]` … `member_from[q + 1] - 1`.
    `soft_mask` (g, w) are groups that cost `soft_cost` when left before they are whole, `soft_has` (g, n) says who is
    in them.
    The crossings of a move are `cross_from[k]` … `cross_from[k + 1] - 1` with k = `cross_at[leave, reach]` (-1: none);
    `cross_at` is (0, 0) where nothing is crossed.
    `noise` (n) are random words whose exclusive or over a set is its hash.
    """

    first: Ints
    site_contour: Ints
    site_cost: Ints
    travel: Shorts
    needs: Masks
    open_from: Ints
    opens: Ints
    block: Ints
    block_size: Ints
    cond_from: Ints
    cond_site: Ints
    cond_bound: Ints
    cond_cost: Ints
    member_from: Ints
    member: Ints
    weight: Ints
    soft_mask: Masks
    soft_cost: Ints
    soft_has: NDArray[np.bool_]
    cross_at: Shorts
    cross_from: Ints
    cross_over: Ints
    cross_cost: Ints
    noise: Masks


def make_tables(problem: Problem, travel: Ints) -> Tables:
    """The arrays of a problem, with its `travel_table`."""
    n = problem.n
    sized = np.bincount(problem.block, minlength=n)
    conditions = sorted(problem.conditions, key=lambda c: c.contour)
    open_from, opens = _opens(problem)
    cross_at, cross_from, order = _crossings(problem)
    groups = problem.soft_groups
    return Tables(
        first=problem.first,
        site_contour=problem.site_contour,
        site_cost=problem.site_cost,
        travel=travel.astype(np.int32),
        needs=masks_of([np.flatnonzero(problem.before[:, i]).tolist() for i in range(n)], n),
        open_from=open_from,
        opens=opens,
        block=problem.block,
        block_size=sized[problem.block],
        cond_from=np.searchsorted([c.contour for c in conditions], np.arange(n + 1)).astype(np.int64),
        cond_site=_ints(-1 if c.when is None else c.when for c in conditions),
        cond_bound=_ints(c.bound for c in conditions),
        cond_cost=_ints(HARD if c.cost is None else c.cost for c in conditions),
        member_from=np.cumsum([0, *(len(c.members) for c in conditions)], dtype=np.int64),
        member=_ints(k for c in conditions for k in c.members),
        weight=_ints(w for c in conditions for w in c.weights),
        soft_mask=masks_of([g.contours for g in groups], n),
        soft_cost=_ints(g.cost for g in groups),
        soft_has=np.array([np.isin(np.arange(n), g.contours) for g in groups], dtype=np.bool_).reshape(-1, n),
        cross_at=cross_at,
        cross_from=cross_from,
        cross_over=problem.crossings.over[order],
        cross_cost=problem.crossings.cost[order],
        noise=np.random.default_rng(0).integers(0, 2**64, n, dtype=np.uint64),
    )


def travel_table(problem: Problem) -> Ints:
    """What every move costs before anything is out, (m + 1, m + 1); `NEVER` for those that no lawful order has."""
    everywhere = np.arange(problem.m + 1)
    travel = problem.travel(everywhere, everywhere)
    owner = np.append(problem.site_contour, problem.n)
    for lag in problem.lags:
        if lag.weight is not None and lag.cuts == 1:
            cost = cost_um(lag.weight)
            for i, j in ((lag.first, lag.second), (lag.second, lag.first)):
                travel[np.ix_(owner == i, owner == j)] += cost
    travel[~problem.successors()[np.ix_(owner, owner)]] = NEVER
    return travel


def way_home(problem: Problem, travel: Ints) -> Floats:
    """What the last move of a plan costs from every site (m,), infinite where it is not lawful: everything is out."""
    cost = travel[: problem.m, problem.m].astype(np.float64)
    cost[cost == NEVER] = np.inf
    rows = problem.crossings
    last = (rows.reach == problem.m) & (rows.leave < problem.m)
    np.add.at(cost, rows.leave[last], np.where(rows.cost[last] == FORBIDDEN, np.inf, rows.cost[last]))
    return cost


def _opens(problem: Problem) -> tuple[Ints, Ints]:
    """For every contour those that must follow it with nothing that must come between."""
    steps = problem.before.astype(np.float32)
    direct = problem.before & ~((steps @ steps) > 0)
    sooner, later = np.nonzero(direct)
    return np.searchsorted(sooner, np.arange(problem.n + 1)).astype(np.int64), later.astype(np.int64)


def _crossings(problem: Problem) -> tuple[Shorts, Ints, Ints]:
    """Where the crossings of every move are, and the rows of `problem.crossings` in that order."""
    rows, m = problem.crossings, problem.m
    if not len(rows):
        return np.zeros((0, 0), dtype=np.int32), np.zeros(1, dtype=np.int64), np.zeros(0, dtype=np.int64)
    move = rows.leave * (m + 1) + rows.reach
    order = np.argsort(move, kind="stable")
    moves, start = np.unique(move[order], return_index=True)
    at = np.full((m + 1) * (m + 1), -1, dtype=np.int32)
    at[moves] = np.arange(len(moves))
    return at.reshape(m + 1, m + 1), np.append(start, len(move)).astype(np.int64), order


def _ints(values: object) -> Ints:
    return np.array(list(values), dtype=np.int64)  # type: ignore[call-overload]


assert FORBIDDEN == HARD
