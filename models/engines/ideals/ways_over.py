"""The ways of the moves of a network that lead over what may be out: how much longer each is, and what it crosses."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.models.engines.bounds.moves import Moves, open_crossings
from kerfwise.models.engines.bounds.network import Network
from kerfwise.models.engines.bounds.passages import passages_of, stand_for
from kerfwise.models.problem.bits import Masks, words
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.problem import Problem

from .crossed import add_settled, crossing_price
from .over import Over, nothing_over

_Ways = tuple[Ints, Ints, Masks]


def crossing_within(
    problem: Problem, group: tuple[int, ...], own: Ints, earlier: frozenset[int], apart: Problem
) -> Problem:
    """A stretch as a problem `apart`, with sites `own` of the whole one, and what its moves cross.

    What is over contours of `earlier`, which are out, and over the one that is left, its table of moves has.
    """
    if not len(problem.crossings):
        return apart
    assert apart.matrix is not None
    matrix = apart.matrix.copy()
    add_settled(problem, earlier, own, own, matrix[:-1, :-1])
    site, number = np.full(problem.m + 1, -1, dtype=np.int64), np.full(problem.n, -1, dtype=np.int64)
    site[own], number[list(group)] = np.arange(len(own)), np.arange(len(group))
    rows = problem.crossings.renumbered(site)
    rows = replace(rows, over=number[rows.over])
    rows = rows.only((rows.over >= 0) & (rows.over != apart.site_contour[rows.leave]))
    return replace(apart, matrix=matrix, crossings=rows)


def ways_over(apart: Problem, network: Network, useful: Bools) -> Over:
    """What the moves of a network of a problem cost more for what is out; `useful` (m, m) are those that plans have.

    What is out in all orders that have a move, the network's costs have.
    """
    width = words(network.problem.n)
    rows = apart.crossings.only(open_crossings(apart))
    if not len(rows):
        return nothing_over(width)
    passages = passages_of(apart)
    _, number, last_of = stand_for(apart, passages)
    masks = _Masks(apart.m, rows, number[last_of[rows.over]], width)
    last = np.isin(network.contours, [passage.last for passage in passages])
    direct = useful & ~last[network.problem.site_contour][None]
    found = [_straight(network, masks, direct), *_through(apart, network, masks, useful, crossing_price(apart))]
    move, extra, mask = (np.concatenate(column) for column in zip(*found, strict=True))
    order = np.argsort(move, kind="stable")
    begin = np.searchsorted(move[order], np.arange(network.problem.m**2 + 1)).astype(np.int64)
    return Over(begin, extra[order], mask[order], network.problem.m, crossing_price(apart))


class _Masks:
    """What the moves between sites of a problem cross: contours of its network, numbered `over` (rows,), as sets."""

    def __init__(self, m: int, rows: Crossings, over: Ints, width: int) -> None:
        self._m = m
        self._moves, at = np.unique(rows.leave.astype(np.int64) * m + rows.reach, return_inverse=True)
        self._masks = np.zeros((len(self._moves) + 1, width), dtype=np.uint64)  # the last is that of nothing
        bit = np.uint64(1) << (over % 64).astype(np.uint64)
        np.bitwise_or.at(self._masks, (at, over // 64), bit)

    def of(self, leave: Ints, reach: Ints) -> Masks:
        """The sets that some moves cross, (moves, words)."""
        wanted = leave * self._m + reach
        at = np.minimum(np.searchsorted(self._moves, wanted), len(self._moves) - 1)
        found: Masks = self._masks[np.where(self._moves[at] == wanted, at, len(self._moves))]
        return found


def _straight(network: Network, masks: _Masks, direct: Bools) -> _Ways:
    """The one way of every move to a contour that stands for itself alone, where it crosses something."""
    leave, reach = np.nonzero(direct)
    mask = masks.of(network.sites[leave], network.sites[reach])
    there = mask.any(axis=1)
    move = (leave * network.problem.m + reach)[there]
    return move, np.zeros(len(move), dtype=np.int64), mask[there]


def _through(apart: Problem, network: Network, masks: _Masks, useful: Bools, price: int) -> Iterator[_Ways]:
    """The ways through every block: by the site that it is entered with."""
    moves = Moves(apart)
    for some, here, way in network.inside.ways:
        inner = network.inside.inner[some]
        leave = np.flatnonzero(useful[:, here].any(axis=1))
        entered = moves.between(network.sites[leave], inner)
        at, to = np.nonzero(useful[np.ix_(leave, here)])
        cost = entered[at] + way[:, to].T  # (moves, ways)
        of_all = masks.of(np.repeat(network.sites[leave], len(inner)), np.tile(inner, len(leave)))
        mask = of_all.reshape(len(leave), len(inner), of_all.shape[1])
        order = np.argsort(cost, axis=1, kind="stable")
        ranked, crossed = np.take_along_axis(cost, order, axis=1), mask[at[:, None], order]
        kept = _undominated(ranked, crossed, price)
        kept[~crossed[:, 0].any(axis=1)] = False  # the cheapest way crosses nothing
        move, rank = np.nonzero(kept)
        extra = (ranked[move, rank] - ranked[move, 0]).astype(np.int64)
        yield leave[at[move]] * network.problem.m + here[to[move]], extra, crossed[move, rank]


def _undominated(cost: Floats, mask: Masks, price: int) -> Bools:
    """Which ways, (moves, ways), cheapest first, may be the best: no cheaper one costs less whatever is out."""
    kept = np.isfinite(cost)
    for k in range(1, cost.shape[1]):
        for j in range(k):
            worse = np.bitwise_count(mask[:, j] & ~mask[:, k]).sum(axis=1, dtype=np.int64) * price
            kept[:, k] &= ~(kept[:, j] & (cost[:, j] + worse <= cost[:, k]))
    return kept
