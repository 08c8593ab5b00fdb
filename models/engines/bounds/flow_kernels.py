"""The inner loop of the search for broken inequalities, compiled by numba."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.models.kernels import kept


@kept(nogil=True)
def flow_up_to(  # pragma: no cover - compiled
    enough: int, start: Bools, end: Bools, open_: Bools, leave: Ints, reach: Ints, room: Ints, first: Ints,
    arcs: Ints, side: Bools
) -> int:  # fmt: skip
    """The most that flows from the `start` nodes to the `end` nodes over `open_` nodes, or more than `enough` of it.

    By shortest paths (Edmonds and Karp 1972). Arc a leads from node `leave[a]` to `reach[a]` and has `room[a]`; arcs
    of node k are `arcs[first[k]:first[k + 1]]`, a where it leaves and ~a where it arrives. Where the most is no more
    than enough, `side` says on return which nodes are on the starts' side of a least cut.
    """
    nodes = len(start)
    left, back = room.copy(), np.zeros_like(room)
    came, queue = np.empty(nodes, np.int64), np.empty(nodes, np.int64)
    total = 0
    while True:
        side[:] = False
        last, reached = 0, -1
        for k in range(nodes):
            if start[k] and open_[k]:
                side[k], queue[last] = True, k
                last += 1
        looked = 0
        while looked < last and reached < 0:
            k = queue[looked]
            looked += 1
            for at in range(first[k], first[k + 1]):
                arc = arcs[at]
                to = reach[arc] if arc >= 0 else leave[~arc]
                some = left[arc] if arc >= 0 else back[~arc]
                if some > 0 and open_[to] and not side[to]:
                    side[to], came[to] = True, arc
                    if end[to]:
                        reached = to
                        break
                    queue[last] = to
                    last += 1
        if reached < 0:
            return total
        most, k = enough + 1, reached
        while not start[k]:
            arc = came[k]
            most = min(most, left[arc] if arc >= 0 else back[~arc])
            k = leave[arc] if arc >= 0 else reach[~arc]
        k = reached
        while not start[k]:
            arc = came[k]
            if arc >= 0:
                left[arc] -= most
                back[arc] += most
                k = leave[arc]
            else:
                back[~arc] -= most
                left[~arc] += most
                k = reach[~arc]
        total += most
        if total > enough:
            return total
