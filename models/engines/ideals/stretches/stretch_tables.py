"""The tables of a stretch: what moves cost in and into it, and the stretch as a problem of its own."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Ints
from kerfwise.models.engines.ideals.kernels import Costs, MoveTable
from kerfwise.models.engines.ideals.stretch import CrossingAlternatives, Local, nothing_over
from kerfwise.models.problem.bitsets import words
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.crossings import FORBIDDEN, Crossings
from kerfwise.models.problem.moves import LAWFUL_MOST, UNLAWFUL, MovePrices
from kerfwise.models.problem.problem import Links, Problem

NARROW = 1 << 29
"""Twice as much fits in 32 bits."""
WIDE = 1 << 60
LANES = 8
"""Numbers of 32 bits that are added at once: blocks of moves are padded to as many, but for contours of one site."""


def dearest(problem: Problem) -> int:
    """What no lawful plan costs more than; what is less than unlawful where that takes many words."""
    if len(problem.crossings) or problem.soft_groups:
        return LAWFUL_MOST
    everywhere = np.arange(problem.m + 1)
    tables = (problem.travel(everywhere[at : at + 256], everywhere) for at in range(0, problem.m + 1, 256))
    blocks = (table[table <= LAWFUL_MOST].max(initial=0) for table in tables)
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
) -> tuple[MoveTable, CrossingAlternatives]:
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
    return problem.travel(*(np.where(sites == HOME, problem.m, sites) for sites in (rows, columns)))


def home_from(problem: Problem, ways: Ints) -> Ints:
    """Cost of the last move, with all parts out."""
    home = travel_between(problem, ways, np.array([HOME]))
    add_settled(problem, frozenset(range(problem.n)), ways, np.array([HOME]), home)
    return home[:, 0]


# Moves over parts that may be out, as the sweep needs them.

HOME = -1


def cross(problem: Problem, local: Local, earlier: frozenset[int], rows: Ints, travel: Ints) -> CrossingAlternatives:
    """What moves of a stretch cost for those of its contours that are out and that they cross.

    What parts cut `earlier` cost, and the contour that a move leaves, is settled, and added to `travel` at once. `rows`
    are the sites of the rows of `travel` (`HOME` for home), its columns the sites of the stretch.
    """
    crossings, width = problem.crossings, words(len(local.contours))
    if not len(crossings):
        return nothing_over(width)
    add_settled(problem, earlier, rows, local.sites, travel)
    number = np.full(problem.n, -1, dtype=np.int64)
    number[list(local.contours)] = np.arange(len(local.contours))
    row, column, chosen = _places(problem, rows, local.sites)
    place = number[crossings.over[chosen]]
    inside = (place >= 0) & ~_left_from(problem, chosen)
    move, cost = row[inside] * travel.shape[1] + column[inside], _costs(problem)[chosen[inside]]
    pairs, which = np.unique(move * len(local.contours) + place[inside], return_inverse=True)
    summed = np.zeros(len(pairs), dtype=np.int64)
    np.add.at(summed, which, cost)
    move, place = np.divmod(pairs, len(local.contours))
    moves, at = np.unique(move, return_inverse=True)
    prices, number = np.unique(summed, return_inverse=True)
    mask = np.zeros((len(moves), len(prices) * width), dtype=np.uint64)
    np.bitwise_or.at(mask, (at, number * width + place // 64), np.uint64(1) << (place % 64).astype(np.uint64))
    begin = np.searchsorted(moves, np.arange(travel.size + 1)).astype(np.int64)
    return CrossingAlternatives(begin, np.zeros(len(moves), dtype=np.int64), mask, travel.shape[1], prices)


def add_settled(problem: Problem, out: frozenset[int], rows: Ints, columns: Ints, travel: Ints) -> None:
    """Add to `travel` what moves cost for the contours of `out`, cut before all of them, and those that they leave."""
    if not len(problem.crossings):
        return
    is_out = np.zeros(problem.n, dtype=np.bool_)
    is_out[list(out)] = True
    row, column, chosen = _places(problem, rows, columns)
    settled = is_out[problem.crossings.over[chosen]] | _left_from(problem, chosen)
    np.add.at(travel, (row[settled], column[settled]), _costs(problem)[chosen[settled]])


def one_price(problem: Problem) -> bool:
    """Whether a move pays the same for every contour that it crosses: not twice where two statements are of one."""
    rows = problem.crossings
    if not len(rows):
        return True
    if not (rows.cost == rows.cost[0]).all():
        return False
    if rows.cost[0] == FORBIDDEN:
        return True
    chosen = np.flatnonzero(~_left_from(problem, np.arange(len(rows))))
    over, statement = rows.over[chosen], rows.statement[chosen]
    of_contour = np.full(problem.n, -1, dtype=np.int64)
    of_contour[over] = statement
    return bool((of_contour[over] == statement).all())


def _left_from(problem: Problem, chosen: Ints) -> NDArray[np.bool_]:
    """Which crossings are over a contour that the move itself leaves, as what was out from the start is said."""
    rows = problem.crossings
    owner = np.append(problem.site_contour, problem.n)
    return np.asarray(owner[rows.leave[chosen]] == rows.over[chosen])


def _costs(problem: Problem) -> Ints:
    """What every crossing costs."""
    cost = problem.crossings.cost
    return np.where(cost == FORBIDDEN, UNLAWFUL, cost)


def crossing_price(problem: Problem) -> int:
    """What crossing one contour costs, where it is the same for all (`one_price`)."""
    if not len(problem.crossings):
        return 0
    cost = int(problem.crossings.cost[0])
    return UNLAWFUL if cost == FORBIDDEN else cost


def _places(problem: Problem, rows: Ints, columns: Ints) -> tuple[Ints, Ints, Ints]:
    """Row, column and number of every crossing between sites that are there."""
    row_of = np.full(problem.m + 1, -1, dtype=np.int64)
    column_of = row_of.copy()
    row_of[np.where(rows == HOME, problem.m, rows)] = np.arange(len(rows))
    column_of[np.where(columns == HOME, problem.m, columns)] = np.arange(len(columns))
    row, column = row_of[problem.crossings.leave], column_of[problem.crossings.reach]
    chosen = np.flatnonzero((row >= 0) & (column >= 0))
    return row[chosen], column[chosen], chosen


# A stretch as a problem of its own, between homes that stand for what comes before it and after it.

FAR = 1 << 38
"""µm: what an unlawful way out of a stretch costs in a bound, more than any plan; sums stay exact in doubles."""


def ends_of(problem: Problem, group: tuple[int, ...]) -> tuple[Ints, Ints]:
    """Sites of the contours that a group may begin with, and of those that it may end with."""
    within = problem.before[np.ix_(group, group)]
    chosen = np.array(group)
    into, out_of = (problem.sites_of(chosen[~within.any(axis=axis)]) for axis in (0, 1))
    return into, out_of


def stretch_problem(
    problem: Problem, group: tuple[int, ...], sites: Ints, enter: Ints, leave: Ints, onward: Ints
) -> Problem:
    """A stretch as a problem without conditions, entered from home at `enter` (sites,), left at `onward`."""
    size = np.diff(problem.first)[list(group)]
    matrix = np.full((len(sites) + 1, len(sites) + 1), FAR, dtype=np.int64)
    matrix[:-1, :-1] = problem.travel(sites, sites)
    matrix[-1, :-1] = np.minimum(enter, FAR)
    matrix[:-1, -1][np.searchsorted(sites, leave)] = onward
    home = np.append(group, problem.n)
    return replace(
        problem,
        n=len(group),
        first=np.append(0, np.cumsum(size)),
        site_contour=np.repeat(np.arange(len(group)), size),
        site_candidate=problem.site_candidate[sites],
        candidate_site=np.arange(len(sites)),
        pierce_um=problem.pierce_um[sites],
        end_um=problem.end_um[sites],
        site_cost=problem.site_cost[sites],
        before=np.ascontiguousarray(problem.before[np.ix_(group, group)]),
        block=np.unique(problem.block[list(group)], return_inverse=True)[1],
        conditions=(),
        soft_groups=(),
        lags=(),
        general=(),
        ids=tuple(problem.ids[c] for c in group),
        crossings=Crossings(),
        links=Links(),
        moves=MovePrices(barred=problem.moves.barred.only(home)),
        matrix=matrix,
        orders=b"",
    )


def conditions_within(
    problem: Problem, group: tuple[int, ...], sites: Ints, earlier: frozenset[int]
) -> Iterator[Condition]:
    """The conditions of a stretch in its own numbers, once all contours of `earlier` are out, and none that follow."""
    number = {c: k for k, c in enumerate(group)}
    for condition in problem.conditions:
        if condition.contour in number:
            pairs = list(zip(condition.members, condition.weights, strict=True))
            inside = [(number[c], weight) for c, weight in pairs if c in number]
            yield replace(
                condition,
                contour=number[condition.contour],
                members=tuple(c for c, _ in inside),
                weights=tuple(weight for _, weight in inside),
                bound=condition.bound - sum(weight for c, weight in pairs if c in earlier),
                when=None if condition.when is None else int(np.searchsorted(sites, condition.when)),
            )
