"""One stretch of the order, translated to sets of bits: what the sweep over its ideals works on."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Int16s, Ints, concat_ranges
from kerfwise.models.jit import KERNEL, inner
from kerfwise.models.problem.bitsets import ROWS_AT_ONCE, LastAnswer, Masks, digest, has, masks_of
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.precedence import immediate
from kerfwise.models.problem.problem import Problem, SoftGroup


class OrderSets(NamedTuple):
    """What may be cut when, of k contours with local numbers; sets in w words (see `bits`).

    `needs` (k, w) must be out before a contour; `opens[open_from[i]:open_from[i + 1]]` are the contours that may only
    just become possible once i is out. `block` (k) is the contiguous block of a contour, -1 where it stands alone,
    `block_mask` (b, w) who is in a block. `size` (k) is the number of sites, `noise` (k) random words whose exclusive
    or over a set is its hash.
    """

    needs: Masks
    open_from: Ints
    opens: Ints
    block: Ints
    block_mask: Masks
    size: Ints
    noise: Masks


class StepTerms(NamedTuple):
    """What a step costs beside its move, for given sets; costs are whole, those of hard conditions `HARD`.

    Condition q of contour i (`cond_of[i]` ≤ q < `cond_of[i+1]`) concerns site column `cond_site[q]` (-1: all) and asks
    `cond_weight` over `cond_member` to reach `cond_bound`. `soft_mask`, `soft_cost` are groups that cost when they are
    left before they are whole, `soft_has` (g, k) says who is in them.
    """

    site_cost: Ints
    cond_of: Ints
    cond_site: Ints
    cond_from: Ints
    cond_member: Ints
    cond_weight: Ints
    cond_bound: Ints
    cond_cost: Ints
    soft_mask: Masks
    soft_cost: Ints
    soft_has: NDArray[np.bool_]


HARD = 1 << 60


@dataclass(frozen=True, eq=False, slots=True)
class Local:
    """A group of k contours; sites of contour i are the columns `first[i]` … `first[i+1] - 1`, `sites` says which."""

    contours: tuple[int, ...]
    sites: Ints
    first: Ints
    orders: OrderSets
    terms: StepTerms

    def sites_of(self, contours: Ints | Int16s) -> Ints:
        """The sites of some of its contours, by their numbers in the group, one contour after the other."""
        chosen = contours.astype(np.int64)
        return self.sites[concat_ranges(self.first[chosen], self.first[chosen + 1] - self.first[chosen])]


def orders_of(problem: Problem, contours: tuple[int, ...]) -> OrderSets:
    """The orders within a group of contours."""
    k = len(contours)
    chosen = list(contours)
    before = problem.before[np.ix_(chosen, chosen)]
    sooner, later = np.nonzero(immediate(before))
    numbers, block, sized = np.unique(problem.block[chosen], return_inverse=True, return_counts=True)
    shared = np.flatnonzero(sized > 1)
    renumbered = np.full(len(numbers), -1, dtype=np.int64)
    renumbered[shared] = np.arange(len(shared))
    return OrderSets(
        needs=masks_of([np.flatnonzero(before[:, i]).tolist() for i in range(k)], k),
        open_from=np.searchsorted(sooner, np.arange(k + 1)).astype(np.int64),
        opens=later.astype(np.int64),
        block=renumbered[block],
        block_mask=masks_of([np.flatnonzero(block == b).tolist() for b in shared], k),
        size=(problem.first[1:] - problem.first[:-1])[chosen],
        noise=np.random.default_rng(0).integers(0, 2**64, k, dtype=np.uint64),
    )


def chain_orders(orders: OrderSets) -> OrderSets:
    """The same contours, one after the other as they are numbered."""
    k = len(orders.size)
    return orders._replace(
        needs=masks_of([range(i) for i in range(k)], k),
        open_from=np.minimum(np.arange(k + 1), k - 1),
        opens=np.arange(1, k),
        block=np.full(k, -1, dtype=np.int64),
    )


def localise(problem: Problem, contours: tuple[int, ...], earlier: frozenset[int]) -> Local:
    """Translate the group `contours`, of which all of `earlier` are cut before and all others after."""
    k = len(contours)
    number = {c: i for i, c in enumerate(contours)}
    sites = problem.sites_of(contours)
    column = {int(s): i for i, s in enumerate(sites)}
    rows = []
    for condition in problem.conditions:
        if condition.contour not in number:
            continue
        pairs = list(zip(condition.members, condition.weights, strict=True))
        rows.append(
            (
                number[condition.contour],
                -1 if condition.when is None else column[condition.when],
                [(number[c], w) for c, w in pairs if c in number],
                condition.bound - sum(w for c, w in pairs if c in earlier),
                HARD if condition.cost is None else condition.cost,
            )
        )
    rows.sort(key=lambda row: row[0])
    groups = [[number[c] for c in g.contours] for g in problem.soft_groups if g.contours[0] in number]
    terms = StepTerms(
        site_cost=problem.site_cost[sites],
        cond_of=np.searchsorted([r[0] for r in rows], np.arange(k + 1)).astype(np.int64),
        cond_site=np.array([r[1] for r in rows], dtype=np.int64),
        cond_from=np.cumsum([0, *(len(r[2]) for r in rows)]).astype(np.int64),
        cond_member=np.array([m for r in rows for m, _ in r[2]], dtype=np.int64),
        cond_weight=np.array([w for r in rows for _, w in r[2]], dtype=np.int64),
        cond_bound=np.array([r[3] for r in rows], dtype=np.int64),
        cond_cost=np.array([r[4] for r in rows], dtype=np.int64),
        soft_mask=masks_of(groups, k),
        soft_cost=np.array([g.cost for g in problem.soft_groups if g.contours[0] in number], dtype=np.int64),
        soft_has=np.array([np.isin(np.arange(k), g) for g in groups], dtype=np.bool_).reshape(-1, k),
    )
    first = np.cumsum([0, *(len(problem.sites(c)) for c in contours)]).astype(np.int64)
    return Local(contours, sites, first, orders_of(problem, contours), terms)


# Where a problem falls apart: stretches of the order that must follow each other, such as zones.

_last = LastAnswer[list[tuple[int, ...]]]()


def series(problem: Problem) -> list[tuple[int, ...]]:
    """Contours in as many groups as possible, such that every member of a group precedes all later groups.

    Soft groups are never split, so that what they cost is known within one group. The last answer is kept: a proof
    asks for it a few times.

    Examples
    --------
    Two zones of one contour each come back as `[(0,), (1,)]` when 0 must precede 1.
    """
    key = digest(*(np.array(group.contours, dtype=np.int64) for group in problem.soft_groups))
    found = _last.known(problem.before, key)
    if found is None:
        found = _apart(problem)
        _last.keep(problem.before, key, found)
    return list(found)


def _apart(problem: Problem) -> list[tuple[int, ...]]:
    order = np.argsort(problem.before.sum(axis=0), kind="stable")
    n = problem.n
    settled = np.empty(n, dtype=np.int64)  # from this place on, every contour is known to follow the i-th
    for k in range(0, n, ROWS_AT_ONCE):
        some = slice(k, k + ROWS_AT_ONCE)
        follows = problem.before[order[some]].take(order[::-1], axis=1)
        settled[some] = n - np.argmin(follows, axis=1)  # behind the last that does not follow, perhaps itself
    reach = np.maximum.accumulate(settled) if n else settled
    breaks = {k for k in range(1, n) if reach[k - 1] <= k}
    place = {int(c): k for k, c in enumerate(order)}
    for group in problem.soft_groups:
        places = [place[c] for c in group.contours]
        breaks -= set(range(min(places) + 1, max(places) + 1))
    edges = [0, *sorted(breaks), n]
    return [tuple(sorted(order[a:b].tolist())) for a, b in pairwise(edges) if b > a]


# What is asked of some of the contours alone, so that a stretch need not look through what is asked of all.


class ConditionsByContour:
    """The statements of a problem by contour."""

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._conditions: defaultdict[int, list[Condition]] = defaultdict(list)
        self._groups: defaultdict[int, list[SoftGroup]] = defaultdict(list)
        rows = problem.crossings
        reached = np.append(problem.site_contour, problem.n)[rows.reach]
        self._rows = np.argsort(reached, kind="stable")
        self._row_from = np.searchsorted(reached[self._rows], np.arange(problem.n + 1))
        for condition in problem.conditions:
            self._conditions[condition.contour].append(condition)
        for group in problem.soft_groups:
            self._groups[group.contours[0]].append(group)

    def of(self, contours: Iterable[int]) -> Problem:
        """The problem with those conditions and soft groups alone that are about some of these contours.

        Of soft groups those whose contours are all among them, of crossings those on the way to them.
        """
        chosen = dict.fromkeys(contours)
        kept = np.concatenate([self._rows[self._row_from[c] : self._row_from[c + 1]] for c in chosen])
        return replace(
            self._problem,
            conditions=tuple(condition for c in chosen for condition in self._conditions[c]),
            soft_groups=tuple(g for c in chosen for g in self._groups[c] if chosen.keys() >= set(g.contours)),
            crossings=self._problem.crossings.only(kept),
        )


# What moves cost for what is out, as the inner loops of a sweep read it.
#
# A move crosses parts. In a network one to the last contour of a block has several ways through the block, too: which
# is the cheapest depends on what is out.

ALL = 1 << 62


class CrossingAlternatives(NamedTuple):
    """Ways of the move from row r to column c of a table: those from `begin[r * columns + c]` to the next beginning.

    A way costs `extra` µm more than the move, and for each contour of its masks that is out what this mask says: of
    `mask` (ways, p · w), w words are those with the first of p `prices`, and so on. A move without ways costs nothing
    more.
    """

    begin: Ints
    extra: Ints
    mask: Masks
    columns: int
    prices: Ints


def nothing_over(words: int) -> CrossingAlternatives:
    """Where no move crosses anything."""
    none = np.zeros(0, dtype=np.int64)
    return CrossingAlternatives(none, none, np.zeros((0, words), dtype=np.uint64), 0, none)


@inner(**KERNEL)
def crossing_extra_cost(  # pragma: no cover - compiled
    over: CrossingAlternatives, mask: Masks, row: int, column: int
) -> int:
    """What the cheapest way of a move costs more than the move when `mask` is out; nothing where there is none."""
    move = row * over.columns + column
    begin, end = over.begin[move], over.begin[move + 1]
    if begin == end:
        return 0
    least = ALL
    for k in range(begin, end):
        cost = over.extra[k]
        for p in range(len(over.prices)):
            for w in range(len(mask)):
                bits = over.mask[k, p * len(mask) + w] & mask[w]
                while bits:
                    bits &= bits - np.uint64(1)
                    cost += over.prices[p]
        least = min(least, cost)
    return least


# What a plan still costs at least after a state of a sweep, as its inner loops read it.


class RestBound(NamedTuple):
    """What a plan still costs after a state at least: `to_go[A, c]` at column c, and `price` for contours not out.

    Bit b of A says that neighbour b of the last contour is not out; `near[i, b]` is that neighbour of contour i, -1
    where it is out already or there is none, -2 where it comes after the stretch. `later` is added to all.
    """

    to_go: Floats
    near: Ints
    price: Floats
    later: float


@inner(**KERNEL)
def still_to_come(rest: RestBound, mask: Masks) -> float:  # pragma: no cover - compiled
    """What contours that are not out still cost by their prices."""
    to_come = rest.later
    for i in range(len(rest.price)):
        if not has(mask, i):
            to_come += rest.price[i]
    return to_come


@inner(**KERNEL)
def near_left(rest: RestBound, mask: Masks, i: int) -> int:  # pragma: no cover - compiled
    """Which neighbours of contour i are not out once it is, as bits."""
    free = 0
    for b in range(rest.near.shape[1]):
        other = rest.near[i, b]
        if other == -2 or (other >= 0 and other != i and not has(mask, other)):
            free |= 1 << b
    return free
