"""The inner loops of the bound by walks, compiled by numba."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Int16s, Ints
from kerfwise.models.kernels import kept


@kept(nogil=True)
def look_back(  # pragma: no cover - compiled
    k: int, part: int, parts: int, back: Floats, lawful: NDArray[np.bool_], price: Floats, first: Ints,
    earliest: Ints, latest: Ints, carried: Int16s, to_go: Floats, least: Floats
) -> None:  # fmt: skip
    """Fill `to_go[k, M, s]` for every `parts`-th contour from `part` on, `to_go[k + 1]` given.

    It is the least of all walks that go on from site s, the k-th, to the end and remember M.

    `back[t, s]` is what coming to t from s costs (home last), `price[c]` what is paid out at contour c, which may be
    the k-th for `earliest[c]` ≤ k ≤ `latest[c]`. Where remembering less costs no more, `to_go` is infinite.
    `least[k, A, s]` is the least over all memories M within A.
    """
    n, m, memories = len(first) - 1, len(back) - 1, carried.shape[2]
    for a in range(part, n, parts):
        if k < earliest[a] or k > latest[a]:
            to_go[k, :, first[a] : first[a + 1]] = np.inf
            least[k, :, first[a] : first[a + 1]] = np.inf
            continue
        to_go[k, :, first[a] : first[a + 1]] = np.inf
        if k == n:
            for s in range(first[a], first[a + 1]):  # numba takes seconds to compile what copies an array into another
                to_go[k, 0, s] = back[m, s]
        else:
            ahead = np.empty(memories)
            for b in range(n):
                if not lawful[a, b] or k + 1 < earliest[b] or k + 1 > latest[b]:
                    continue
                for t in range(first[b], first[b + 1]):
                    ahead[:] = np.inf
                    for before in range(memories):
                        after = carried[a, b, before]
                        if after >= 0:
                            ahead[after] = min(ahead[after], to_go[k + 1, before, t])
                    row = back[t]
                    for after in range(memories):
                        if ahead[after] < np.inf:
                            cost = ahead[after] - price[b]
                            here = to_go[k, after]
                            for s in range(first[a], first[a + 1]):
                                total = row[s] + cost
                                here[s] = min(here[s], total)
        for s in range(first[a], first[a + 1]):
            for memory in range(memories):
                best = np.inf
                bit = 1
                while bit < memories:
                    if memory & bit:
                        best = min(best, least[k, memory ^ bit, s])
                    bit <<= 1
                if to_go[k, memory, s] < best:
                    best = to_go[k, memory, s]
                else:
                    to_go[k, memory, s] = np.inf
                least[k, memory, s] = best


@kept(nogil=True)
def walk_on(  # pragma: no cover - compiled
    back: Floats, lawful: NDArray[np.bool_], price: Floats, first: Ints, carried: Int16s, to_go: Floats, walk: Ints
) -> float:  # fmt: skip
    """The cheapest walk from home, its contours in `walk`; its cost."""
    n, m, memories = len(first) - 1, len(back) - 1, carried.shape[2]
    at, here, memory, cost = m, n, 0, np.inf
    for k in range(1, n + 1):
        best = np.inf
        site, contour, remembered = -1, -1, 0
        for b in range(n):
            if not lawful[here, b]:
                continue
            for ahead in range(memories):
                if here < n and carried[here, b, ahead] != memory:
                    continue
                for t in range(first[b], first[b + 1]):
                    total = back[t, at] - price[b] + to_go[k, ahead, t]
                    if total < best:
                        best, site, contour, remembered = total, t, b, ahead
        if site < 0:
            return np.inf
        if k == 1:
            cost = best
        walk[k - 1] = contour
        at, here, memory = site, contour, remembered
    return cost
