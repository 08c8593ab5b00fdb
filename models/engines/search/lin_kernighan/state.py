"""The state of a search by chains: the route it stands on and the one it tries, and room to work in."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Int32s, Ints
from kerfwise.models.engines.search.state import BEST, NUMBERS

from .tables import ChainTables

BREADTH = (5, 3, 1, 1, 1, 1)
"""Steps that are tried at each place of a chain; it is as long as this list at the most."""
WIDEST = max(BREADTH)
DEPTH = len(BREADTH)

# What `ChainState.number` holds beside what `search.state` names.
QUEUED = NUMBERS  # contours in the queue
FRONT = NUMBERS + 1  # where in the ring the first of them is
LOW = NUMBERS + 2  # the places where the trial differs from the route we stand on are LOW …
HIGH = NUMBERS + 3  # … HIGH - 1


class ChainState(NamedTuple):
    """Arrays that kernels write to.

    `line` lists the contours of the trial between home and home, `place` says where each stands, `stood` is the route
    we stand on in the same form. `queue` is a ring of the contours that arcs may be broken after, `waits` says who is
    in it. Step k at depth d swaps places `swap[d, k, 0]` … `swap[d, k, 1] - 1` and … `swap[d, k, 2] - 1`; then
    `freed[d, k]` has been saved, without the last arc that closes the line, which costs `closing[d, k]`.
    `tail[d]` are the contours after which the step taken at depth d made arcs, `trying[d]` is that step, one of
    `known[d]`. `best` lists sites in order.
    """

    line: Int32s
    place: Int32s
    spare: Int32s
    stood: Int32s
    queue: Ints
    waits: Bools
    swap: Ints
    freed: Ints
    closing: Ints
    tail: Ints
    trying: Ints
    known: Ints
    best: Ints
    number: Ints
    random: NDArray[np.uint64]


def new_chain_state(tables: ChainTables, seed: tuple[int, ...]) -> ChainState:
    """An empty state; equal seeds walk equal ways."""
    n = tables.n
    number = np.zeros(HIGH + 1, dtype=np.int64)
    number[BEST] = -1
    return ChainState(
        line=np.full(n + 2, n, dtype=np.int32),
        place=np.zeros(n + 1, dtype=np.int32),
        spare=np.zeros(n + 2, dtype=np.int32),
        stood=np.full(n + 2, n, dtype=np.int32),
        queue=np.zeros(n + 1, dtype=np.int64),
        waits=np.zeros(n + 1, dtype=np.bool_),
        swap=np.zeros((DEPTH, WIDEST, 3), dtype=np.int64),
        freed=np.zeros((DEPTH, WIDEST), dtype=np.int64),
        closing=np.zeros((DEPTH, WIDEST), dtype=np.int64),
        tail=np.zeros((DEPTH, 3), dtype=np.int64),
        trying=np.zeros(DEPTH, dtype=np.int64),
        known=np.zeros(DEPTH, dtype=np.int64),
        best=np.full(n, -1, dtype=np.int64),
        number=number,
        random=np.random.SeedSequence(seed).generate_state(1, np.uint64) | np.uint64(1),
    )
