"""What plans cost from every way into a stretch on, found by a sweep of it from its end to its beginning.

A bound by linear programs says one thing of the stretch and little of where it is come to from: so of each border the
best way in is believed, which the best plan through the stretch before does not end at. Swept backwards, a stretch
tells what is still to come from each way in, and the program of the stretch before ends at that.
"""

from __future__ import annotations

from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.models.engines import bounds
from kerfwise.models.engines.bounds.reduced_costs import ReducedCosts
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals.stretches.stretch_tables import FAR, entrance_of, never, table_of
from kerfwise.models.engines.tuning import BACKWARD_DEARER as DEARER
from kerfwise.models.engines.tuning import BACKWARD_FIRST as FIRST
from kerfwise.models.engines.tuning import BACKWARD_LITTLE as LITTLE
from kerfwise.models.engines.tuning import BACKWARD_MOST_NEIGHBOURS as MOST_NEIGHBOURS
from kerfwise.models.engines.tuning import BACKWARD_WIDER as WIDER
from kerfwise.models.engines.tuning import SPREAD
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.problem import Problem

from .lattice import THREADS, SweptStretch, TooLarge, sweep_layers
from .stretch import RestBound, localise, nothing_over

if TYPE_CHECKING:
    from kerfwise.models.engines.bounds import Completion


def reverse_problem(problem: Problem) -> Problem:
    """A problem whose plans are those of another from their end to their beginning, at the same cost.

    Its moves are in a table, and its conditions ask of sets and last sites.
    """
    assert problem.matrix is not None
    return replace(
        problem,
        before=np.ascontiguousarray(problem.before.T),
        matrix=np.ascontiguousarray(problem.matrix.T),
        conditions=tuple(map(_turned, problem.conditions)),
        orders=b"",
    )


def _turned(condition: Condition) -> Condition:
    """What is out then was not out before, but for the contour that is asked about."""
    pairs = [(c, w) for c, w in zip(condition.members, condition.weights, strict=True) if c != condition.contour]
    weights = tuple(-w for _, w in pairs)
    return replace(condition, members=tuple(c for c, _ in pairs), weights=weights, bound=condition.bound + sum(weights))


@dataclass(frozen=True, eq=False, slots=True)
class Settled:
    """What plans cost from every way into a stretch on at least, `onward` (ways,): exact where that is up to `limit`.

    What moves cost for what is out in some orders alone is not in it.

    `work` is what it took to find that out, in deterministic seconds.
    """

    onward: Ints
    limit: int
    work: float = 0.0


def settle(
    posed: Problem, relaxed: ReducedCosts, entry: Ints, begun: Settled, known: int, deadline: Deadline
) -> Settled:
    """Find out what plans cost from every way into a stretch on, as far as the deadline lets it, from what is known on.

    `posed` is its network, with no cost of sites, `entry` (ways, sites) what it costs to come to each of its sites; a
    plan with all stretches before it is `known`.
    """
    onward, limit, whole = begun.onward, begun.limit, deadline.left
    least, enough, room = relaxed.bound, int(SPREAD * known), max(1, int(FIRST * known))
    try:
        rest = _rest(posed, relaxed, deadline.left)
    except bounds.TooMuch:
        return replace(begun, work=0.0)
    deadline.spend(rest.work * deadline.per_s)
    with ThreadPoolExecutor(THREADS) as threads, suppress(TooLarge):
        backward = Backward(posed, relaxed, entry, rest)
        while limit < min(int(onward.max()), known):
            had = deadline.left
            if least + room > limit:
                wanted = min(least + room, known)
                onward = np.maximum(onward, backward.onward(wanted, deadline, threads))
                limit = wanted
            spread, last = limit - int(onward.min()), room
            room = WIDER * room if spread >= enough or spread < 0 else min(WIDER * room, room + enough - spread)
            ahead = DEARER ** (room / last - 1.0) * (had - deadline.left)
            if ahead > (1.0 if spread < enough else LITTLE) * deadline.left:
                break
    return Settled(onward, limit, whole - max(0.0, deadline.left))


def _rest(posed: Problem, relaxed: ReducedCosts, most: float) -> Completion:
    """What is still to come of what multipliers leave, from the end to the beginning: one round, of less than `most`.

    Raises bounds.TooMuch if it takes as much.
    """
    walked = reverse_problem(replace(posed, matrix=relaxed.dear, conditions=()))
    return bounds.complete(walked, None, Deadline(0.0), MOST_NEIGHBOURS, most)


class Backward:
    """A stretch under its multipliers from its end to its beginning."""

    def __init__(self, posed: Problem, relaxed: ReducedCosts, entry: Ints, rest: Completion) -> None:
        problem = reverse_problem(posed)
        assert problem.matrix is not None
        self._entry, self._rest, self._bound = entry, rest, relaxed.bound
        self._local = localise(problem, tuple(range(problem.n)), frozenset())
        self._moves, self._lows = (np.roll(table, 1, axis=0)[:, :-1] for table in (problem.matrix, relaxed.dear.T))

    def onward(self, limit: int, deadline: Deadline, threads: Executor) -> Ints:
        """What plans cost at least from every way in on, (ways,): exact, but for what is crossed, or more than `limit`.

        Raises TooLarge over the deadline.
        """
        local, nothing = self._local, entrance_of([0], limit)
        tables = (table_of(local, table, limit) for table in (self._moves, self._lows))
        moves, lows = tables
        over = nothing_over(local.orders.needs.shape[1])
        stretch = SweptStretch(local, moves, over, self._rests, limit, never(limit), lows)
        end = sweep_layers(stretch, nothing, deadline, threads, nothing + self._bound)[-1]
        of_site = np.full(len(local.sites), FAR)
        np.minimum.at(of_site, np.searchsorted(local.sites, local.sites_of(end.contour)), end.values)
        found: Ints = np.minimum((self._entry + of_site).min(axis=1), limit + 1)
        return found

    def _rests(self, depth: int) -> RestBound:
        rest = self._rest
        return RestBound(np.ascontiguousarray(rest.to_go[depth]), rest.near, rest.price, 0.0)
