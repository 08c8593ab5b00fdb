"""Moves between sites as the search reads them: lengths, links, crossings of parts that are out."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Floats, Int32s, Ints, concat_ranges, unique
from kerfwise.models.engines.tuning import MATRIX_SITES
from kerfwise.models.engines.tuning import TRAVEL_DRAWS as DRAWS
from kerfwise.models.engines.tuning import TRAVEL_NEAREST as NEAREST
from kerfwise.models.problem.crossings import FORBIDDEN, in_order
from kerfwise.models.problem.moves import LAWFUL_MOST, UNLAWFUL
from kerfwise.models.problem.problem import Problem

from .jit_tools import compiled

# Moves between sites: looked up where a matrix fits, else computed, links aside.

NO_LINK = 1 << 58  # more than any move costs, µm


class Legs(NamedTuple):
    """n contours, m sites; home is site m.

    Sites of contour i are `first[i]` … `first[i + 1] - 1`; `contour` of home is n. `travel` (m + 1, m + 1) includes
    what moves cross in any order; it is (0, 0) when legs are computed from `pierce`, `end` and `weight`. `leave[a, c]`
    is the least travel from site a to contour c, `enter[b, c]` that from contour c to site b; where there is no matrix
    the circles round a contour's points bound them.

    Links from site a are the rows `link_from[a]` … `link_from[a + 1] - 1`, sorted by the site `link_to` that they lead
    to; each costs `link_cost`, and the cut there takes `link_ms` more. `link_into[c]` is what the cheapest link to a
    site of contour c costs, `link_at[b]` the cheapest to site b, `NO_LINK` where there is none.

    Where legs are computed, prices of moves from site a are the rows `price_from[r]` … `price_from[r + 1] - 1`, with
    r = `price_row[a]`, sorted by `price_at`, which is `price_column[b]` of the sites b that they lead to. What is not
    lawful costs `UNLAWFUL`, in `travel` as well; `leave` and `enter` leave that out.
    """

    n: int
    m: int
    first: Ints
    contour: Ints
    site_cost: Ints
    travel: Ints
    leave: Ints
    enter: Ints
    pierce: Floats
    end: Floats
    weight: float
    pierce_circle: Floats
    end_circle: Floats
    link_from: Ints
    link_to: Ints
    link_cost: Ints
    link_ms: Ints
    link_into: Ints
    link_at: Ints
    price_row: Ints
    price_column: Ints
    price_from: Ints
    price_at: Ints
    price: Ints


NO_MATRIX = np.zeros((0, 0), dtype=np.int64)


def make_legs(problem: Problem, earlier: tuple[Problem, Legs] | None = None) -> Legs:
    """The legs of a problem; the matrices are those of an `earlier` one where they are the same."""
    legs = _without_matrix(problem)
    if problem.matrix is None and legs.m > MATRIX_SITES:
        return legs
    if earlier is not None and _same_moves(problem, legs, *earlier):
        return legs._replace(travel=earlier[1].travel, leave=earlier[1].leave, enter=earlier[1].enter)
    travel = problem.travel(np.arange(legs.m + 1), np.arange(legs.m + 1))
    from_site, to_site, cost = always_crossed(problem)
    np.add.at(travel, (from_site, to_site), cost)
    barred = travel.max() > LAWFUL_MOST
    lawful = np.where(travel > LAWFUL_MOST, travel - UNLAWFUL, travel) if barred else travel
    leave = _least(lawful[:, : legs.m], problem.first, axis=1)
    enter = _least(lawful[: legs.m], problem.first, axis=0).T
    return legs._replace(travel=travel, leave=np.ascontiguousarray(leave), enter=np.ascontiguousarray(enter))


def _same_moves(problem: Problem, legs: Legs, other: Problem, known: Legs) -> bool:
    """Whether moves cost the same in another problem, as far as that is soon seen: no matrix given, none crosses."""
    if len(problem.crossings) or len(other.crossings) or problem.matrix is not None or other.matrix is not None:
        return False
    fields = (name for name in Legs._fields if name not in ("travel", "leave", "enter", "site_cost"))
    return all(np.array_equal(getattr(legs, name), getattr(known, name)) for name in fields)


def _without_matrix(problem: Problem) -> Legs:
    """The legs of a problem without the matrices of its moves."""
    n, m = problem.n, problem.m
    prices = problem.moves.price
    return Legs(
        n=n,
        m=m,
        first=problem.first,
        contour=np.append(problem.site_contour, n),
        site_cost=problem.site_cost,
        travel=NO_MATRIX,
        leave=NO_MATRIX,
        enter=NO_MATRIX,
        pierce=problem.pierces().astype(np.float64),
        end=problem.ends().astype(np.float64),
        weight=float(problem.travel_weight),
        pierce_circle=_circles(problem.pierce_um, problem.first),
        end_circle=_circles(problem.end_um, problem.first),
        link_from=np.searchsorted(problem.links.leave, np.arange(m + 2)).astype(np.int64),
        link_to=problem.links.reach,
        link_cost=problem.links.cost,
        link_ms=problem.links.ms,
        link_into=_cheapest(problem, np.append(problem.site_contour, n)[problem.links.reach], n),
        link_at=_cheapest(problem, problem.links.reach, m),
        price_row=prices.row,
        price_column=prices.column,
        price_from=np.searchsorted(prices.key, np.arange(int(prices.row.max(initial=-1)) + 2) * prices.width),
        price_at=prices.key % prices.width,
        price=prices.value,
    )


def _cheapest(problem: Problem, to: Ints, home: int) -> Ints:
    """What the cheapest link to each of several places costs, home the last."""
    least = np.full(home + 1, NO_LINK, dtype=np.int64)
    np.minimum.at(least, to, problem.links.cost)
    return least


def _least(travel: Ints, first: Ints, axis: int) -> Ints:
    """Least of each contour's columns, or rows."""
    if len(first) == 1:
        return np.zeros((len(travel), 0) if axis else (0, travel.shape[1]), dtype=np.int64)
    if axis:
        return np.asarray(np.minimum.reduceat(travel, first[:-1], axis=1), dtype=np.int64)
    least = np.empty((len(first) - 1, travel.shape[1]), dtype=np.int64)
    for row, (begin, end) in zip(least, pairwise(first.tolist()), strict=True):  # ten times as fast as `reduceat`
        np.minimum.reduce(travel[begin:end], axis=0, out=row)
    return least


def _circles(points: Ints, first: Ints) -> Floats:
    """Centre and radius of a circle round each contour's points, (n, 3)."""
    if len(first) == 1:
        return np.zeros((0, 3))
    starts = first[:-1]
    centre = (np.minimum.reduceat(points, starts) + np.maximum.reduceat(points, starts)) / 2
    away = np.hypot(*(points - np.repeat(centre, np.diff(first), axis=0)).T)
    return np.column_stack([centre, np.maximum.reduceat(away, starts)])


@compiled
def leg(legs: Legs, a: int, b: int) -> int:
    """The move from the end of site a to the pierce of site b, whole µm, `UNLAWFUL` more where it is not lawful."""
    if legs.travel.shape[0] > 0:
        return int(legs.travel[a, b])
    price = 0
    if len(legs.price) > 0:
        row = legs.price_row[a]
        at = _found(legs.price_at, legs.price_from[row], legs.price_from[row + 1], legs.price_column[b])
        if at >= 0:
            price = legs.price[at]
    link = link_of(legs, a, b)
    if link >= 0:
        return int(legs.link_cost[link] + price)
    dx = legs.end[a, 0] - legs.pierce[b, 0]
    dy = legs.end[a, 1] - legs.pierce[b, 1]
    return int(np.rint(legs.weight * np.sqrt(dx * dx + dy * dy))) + price


@compiled
def fare(legs: Legs, a: int, b: int, unlawful: int) -> int:
    """The same, with that price in place of `UNLAWFUL`."""
    cost = leg(legs, a, b)
    return cost if cost <= LAWFUL_MOST else cost - UNLAWFUL + unlawful


@compiled
def link_of(legs: Legs, a: int, b: int) -> int:
    """The link from site a to site b, -1 if there is none."""
    return _found(legs.link_to, legs.link_from[a], legs.link_from[a + 1], b)


@compiled
def _found(sorted_: Ints, low: int, high: int, wanted: int) -> int:
    """Where between `low` and `high` a number is among those sorted, -1 if it is not."""
    stop = high
    while low < high:
        middle = (low + high) >> 1
        if sorted_[middle] < wanted:
            low = middle + 1
        else:
            high = middle
    return int(low) if low < stop and sorted_[low] == wanted else -1


@compiled
def least_leave(legs: Legs, a: int, c: int) -> int:
    """At most the travel from site a to any site of contour c."""
    if legs.travel.shape[0] > 0:
        return int(legs.leave[a, c])
    dx = legs.end[a, 0] - legs.pierce_circle[c, 0]
    dy = legs.end[a, 1] - legs.pierce_circle[c, 1]
    idle = int(legs.weight * max(0.0, np.sqrt(dx * dx + dy * dy) - legs.pierce_circle[c, 2])) - 1
    return idle if legs.link_from[a] == legs.link_from[a + 1] else min(idle, int(legs.link_into[c]))


@compiled
def least_enter(legs: Legs, c: int, b: int) -> int:
    """At most the travel from any site of contour c to site b."""
    if legs.travel.shape[0] > 0:
        return int(legs.enter[b, c])
    dx = legs.end_circle[c, 0] - legs.pierce[b, 0]
    dy = legs.end_circle[c, 1] - legs.pierce[b, 1]
    idle = int(legs.weight * max(0.0, np.sqrt(dx * dx + dy * dy) - legs.end_circle[c, 2])) - 1
    return min(idle, int(legs.link_at[b]))


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
    cells = unique(move // (m + 1) * (n + 1) + contour[move % (m + 1)])
    bits = max(1, int(2 * len(cells)).bit_length())
    key, at = np.full(1 << bits, -1, dtype=np.int64), np.full(1 << bits, -1, dtype=np.int64)
    first = np.append(problem.first, m + 1)
    leave, reach = np.divmod(cells, n + 1)
    width = first[reach + 1] - first[reach] + 1
    begin = np.cumsum(width) - width
    slot = ((cells.astype(np.uint64) * np.uint64(SPREAD)) >> np.uint64(64 - bits)).astype(np.int64)
    left = np.arange(len(cells))
    while len(left):  # each takes its slot if that is free, else the next; of several for one the first takes it
        takes = np.zeros(len(left), dtype=np.bool_)
        takes[np.unique(slot[left], return_index=True)[1]] = True
        takes &= key[slot[left]] < 0
        key[slot[left[takes]]], at[slot[left[takes]]] = cells[left[takes]], begin[left[takes]]
        left = left[~takes]
        slot[left] = (slot[left] + 1) % (1 << bits)
    start = np.searchsorted(move, np.repeat(leave * (m + 1), width) + concat_ranges(first[reach], width))
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


# Arcs between contours of one site each, as the exchanges read them: small numbers, near to hand.

DEAREST = 1 << 29  # the most that an arc may cost, so that sums of a few stay small numbers


class ArcCosts(NamedTuple):
    """Costs `cost[a, b]` (n + 1, n + 1) from contour to contour, home is n; all empty unless `plain` is 1.

    A problem is plain if every contour has one site, and nothing but orders says who stands where.
    `near[a, :near_count[a]]` are the nearest contours that may directly follow a, `near_in[b, :near_in_count[b]]`
    those that may directly precede b.
    `even` is 1 if most arcs cost the same both ways. `falls` spreads -log(u), u uniform, evenly by chance.
    """

    plain: int
    even: int
    cost: Int32s
    near: Int32s
    near_count: Ints
    near_in: Int32s
    near_in_count: Ints
    falls: NDArray[np.float64]


def make_arcs(problem: Problem, legs: Legs) -> ArcCosts:
    """The arcs of a problem."""
    n = problem.n
    falls = -np.log((np.arange(DRAWS) + 0.5) / DRAWS)
    if not _plain(problem) or not legs.travel.size or legs.travel.max() > DEAREST:
        none, empty = np.zeros((0, 0), dtype=np.int32), np.zeros(0, dtype=np.int64)
        return ArcCosts(0, 0, none, none, empty, none, empty, falls)
    cost = legs.travel.astype(np.int32)
    cost[:, :n] += problem.site_cost.astype(np.int32)
    lawful = problem.successors()
    near, count = nearest_lawful(cost, lawful[:, :n], NEAREST)
    near_in, count_in = nearest_lawful(cost.T, lawful.T[:, :n], NEAREST)
    inner = cost[:n, :n]
    return ArcCosts(1, int((inner == inner.T).mean() > 0.5), cost, near, count, near_in, count_in, falls)


def _plain(problem: Problem) -> bool:
    return (
        problem.n == problem.m > 1
        and len(np.unique(problem.block)) == problem.n
        and not (problem.conditions or problem.soft_groups or problem.lags or problem.general)
        and not len(problem.crossings)
        and bool((problem.site_cost < DEAREST).all())
    )


def nearest_lawful(cost: Ints | Int32s, lawful: Bools, most: int) -> tuple[Int32s, Ints]:
    """The `most` nearest lawful contours of each row, nearest first, and how many there are."""
    masked = np.where(lawful, cost[:, : lawful.shape[1]], np.iinfo(cost.dtype).max)
    near = np.argsort(masked, axis=1, kind="stable")[:, :most].astype(np.int32)
    return np.ascontiguousarray(near), np.minimum(lawful.sum(axis=1), most).astype(np.int64)


@compiled
def gap_cost(arcs: ArcCosts, line: Int32s, p: int) -> int:
    """Cost of the arc into what stands at place p of a line."""
    return int(np.int64(arcs.cost[line[p - 1], line[p]]))
