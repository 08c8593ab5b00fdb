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

    By blocking flows in layers (Dinitz 1970). Arc a leads from node `leave[a]` to `reach[a]` and has `room[a]`; arcs
    of node k are `arcs[first[k]:first[k + 1]]`, a where it leaves and ~a where it arrives. Where the most is no more
    than enough, `side` says on return which nodes are on the starts' side of a least cut.
    """
    nodes = len(start)
    left, back = room.copy(), np.zeros_like(room)
    layer, queue, at = np.empty(nodes, np.int64), np.empty(nodes, np.int64), np.empty(nodes, np.int64)
    path = np.empty(nodes, np.int64)
    total = 0
    while True:
        side[:] = False
        last, found = 0, -1
        for k in range(nodes):
            if start[k] and open_[k]:
                side[k], queue[last], layer[k] = True, k, 0
                last += 1
        starts, looked = last, 0
        while looked < last:
            k = queue[looked]
            looked += 1
            if layer[k] == found:
                break
            for e in range(first[k], first[k + 1]):
                arc = arcs[e]
                to = reach[arc] if arc >= 0 else leave[~arc]
                some = left[arc] if arc >= 0 else back[~arc]
                if some > 0 and open_[to] and not side[to]:
                    side[to], layer[to] = True, layer[k] + 1
                    queue[last] = to
                    last += 1
                    if end[to] and found < 0:
                        found = layer[to]
        if found < 0:
            return total
        for x in range(last):
            at[queue[x]] = first[queue[x]]
        for x in range(starts):
            k, depth = queue[x], 0
            while True:
                if end[k]:
                    most = enough + 1
                    for d in range(depth):
                        arc = path[d]
                        most = min(most, left[arc] if arc >= 0 else back[~arc])
                    cut = depth
                    for d in range(depth - 1, -1, -1):
                        arc = path[d]
                        if arc >= 0:
                            left[arc] -= most
                            back[arc] += most
                            full = left[arc] == 0
                        else:
                            back[~arc] -= most
                            left[~arc] += most
                            full = back[~arc] == 0
                        if full:
                            cut = d
                    total += most
                    if total > enough:
                        return total
                    depth = cut
                    arc = path[depth]
                    k = leave[arc] if arc >= 0 else reach[~arc]
                    continue
                went = False
                while at[k] < first[k + 1]:
                    arc = arcs[at[k]]
                    to = reach[arc] if arc >= 0 else leave[~arc]
                    some = left[arc] if arc >= 0 else back[~arc]
                    if some > 0 and side[to] and layer[to] == layer[k] + 1 and (end[to] or layer[to] < found):
                        path[depth] = arc
                        depth += 1
                        k, went = to, True
                        break
                    at[k] += 1
                if went:
                    continue
                if depth == 0:
                    break
                depth -= 1
                arc = path[depth]
                k = leave[arc] if arc >= 0 else reach[~arc]
                at[k] += 1
