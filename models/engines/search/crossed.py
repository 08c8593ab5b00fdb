"""Idle moves over parts that are out, as the search reads them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.encoder.distinct import distinct
from kerfwise.models.problem.crossings import FORBIDDEN, in_order
from kerfwise.models.problem.problem import Problem

from .compiled import compiled

SPREAD = 0x9E3779B97F4A7C15  # 2^64 over the golden ratio: its multiples spread evenly (Knuth, vol. 3, 6.4)


class Crossed(NamedTuple):
    """Moves from a site to the sites of a contour are one cell; a hash table finds it.

    The cell of site a and contour c has the number a (n + 1) + c, where c is n for home. Slot h of the table holds
    cell `key[h]`, or -1; a cell's slot is the top of its product with `SPREAD`, without the last `shift` bits, or the
    next free one. Rows of moves to the contour's k-th site are `start[at[h] + k]` … `start[at[h] + k + 1] - 1`. Such
    a move costs `cost` (unlawful if negative) once contour `over` is cut. `is_over[i]` says that it depends on the
    order whether some move costs for crossing contour i.
    """

    key: Ints
    at: Ints
    shift: int
    start: Ints
    over: Ints
    cost: Ints
    is_over: Bools


def always_crossed(problem: Problem) -> tuple[Ints, Ints, Ints]:
    """Moves (from site, to site, cost) that cost in every order: the contour crossed is cut before."""
    rows, sure = problem.crossings, _surely_out(problem)
    return rows.leave[sure].astype(np.int64), rows.reach[sure].astype(np.int64), rows.cost[sure]


def make_crossed(problem: Problem, priced: bool) -> Crossed:
    """The crossings of a problem that depend on the order; with those that do not, unless they are priced in travel."""
    rows, n = problem.crossings, problem.n
    contour = np.append(problem.site_contour, n)
    sure = _surely_out(problem)
    maybe = ~sure & ~_surely_in(problem)
    is_over = np.zeros(n, dtype=np.bool_)
    is_over[rows.over[maybe]] = True
    move = rows.moves(problem.m)
    columns = [(move[maybe], rows.over[maybe].astype(np.int64), rows.cost[maybe])]
    if not priced:  # one row for all that a move crosses for sure: what it leaves is cut before it
        moves, which = np.unique(move[sure], return_inverse=True)
        total = np.zeros(len(moves), dtype=np.int64)
        np.add.at(total, which, rows.cost[sure])
        columns.append((moves, contour[moves // (problem.m + 1)], total))
    if len(columns) == 1:
        move, over, cost = columns.pop()
    else:
        move, over, cost = (np.concatenate(parts) for parts in zip(*columns, strict=True))
    if (by_move := in_order(move)) is not None:
        move, over, cost = move[by_move], over[by_move], cost[by_move]
    return Crossed(*_table(problem, contour, move), over, cost, is_over)


def _table(problem: Problem, contour: Ints, move: Ints) -> tuple[Ints, Ints, int, Ints]:
    """The hash table of the cells of rows sorted by move: keys, what they hold, the shift, and `Crossed.start`."""
    n, m = problem.n, problem.m
    cells = distinct(move // (m + 1) * (n + 1) + contour[move % (m + 1)])
    bits = max(1, int(2 * len(cells)).bit_length())
    key, at = np.full(1 << bits, -1, dtype=np.int64), np.full(1 << bits, -1, dtype=np.int64)
    first = np.append(problem.first, m + 1)
    size = 0
    wanted: list[Ints] = []
    for cell in cells.tolist():
        h = (cell * SPREAD % (1 << 64)) >> (64 - bits)
        while key[h] >= 0:
            h = (h + 1) % (1 << bits)
        a, c = divmod(cell, n + 1)
        key[h], at[h] = cell, size
        size += int(first[c + 1] - first[c]) + 1
        wanted.append(a * (m + 1) + np.arange(first[c], first[c + 1] + 1))
    start = np.searchsorted(move, np.concatenate(wanted)) if wanted else np.zeros(0)
    return key, at, 64 - bits, start.astype(np.int64)


def _surely_out(problem: Problem) -> Bools:
    """Rows that cost and whose contour is cut before the one that the move leaves, or is it; or the move leads home."""
    rows, n, m = problem.crossings, problem.n, problem.m
    leave = np.append(problem.site_contour, n)[rows.leave]
    before = problem.before[rows.over, np.minimum(leave, n - 1)] & (leave < n)
    out = before | (rows.over == leave) | (rows.reach == m)
    return np.asarray(out & (rows.leave < m) & (rows.cost != FORBIDDEN))


def _surely_in(problem: Problem) -> Bools:
    """Rows whose contour is cut after the one that the move leads to, or is it."""
    rows, n = problem.crossings, problem.n
    reach = np.append(problem.site_contour, n)[rows.reach]
    after = problem.before[np.minimum(reach, n - 1), rows.over] & (reach < n)
    return np.asarray(after | (rows.over == reach))


@compiled
def cell_of(crossed: Crossed, number: int) -> int:
    """Where in `start` a cell's numbers begin, or -1 if its moves cross nothing."""
    h = int(np.int64((np.uint64(number) * np.uint64(SPREAD)) >> np.uint64(crossed.shift)))
    while crossed.key[h] >= 0 and crossed.key[h] != number:
        h = (h + 1) & (len(crossed.key) - 1)
    return int(crossed.at[h])


@compiled
def crossing(crossed: Crossed, start: int, position: Ints, at: int) -> tuple[int, int]:
    """Cost, and number of unlawful crossings, of the move with place `start` in `start`, made before position `at`."""
    cost, broken = 0, 0
    for e in range(crossed.start[start], crossed.start[start + 1]):
        if 0 <= position[crossed.over[e]] < at:
            if crossed.cost[e] < 0:
                broken += 1
            else:
                cost += crossed.cost[e]
    return cost, broken
