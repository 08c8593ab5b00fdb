"""One stretch of the order, translated to sets of bits: what the sweep over its ideals works on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Int16s, Ints
from kerfwise.encoder.ranges import laid_out
from kerfwise.models.problem.bits import Masks, masks_of
from kerfwise.models.problem.closure import immediate
from kerfwise.models.problem.problem import Problem


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
        return self.sites[laid_out(self.first[chosen], self.first[chosen + 1] - self.first[chosen])]


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


def in_line(orders: OrderSets) -> OrderSets:
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
