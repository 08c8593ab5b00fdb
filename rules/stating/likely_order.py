"""An order that keeps what is asked of places and of what comes before what, where one does: what is tried first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from heapq import heappop, heappush


def likely_order(
    n: int, orders: Sequence[tuple[int, int]], earliest: Mapping[int, int], latest: Mapping[int, int]
) -> list[int] | None:
    """The place, from 0 on, of each of n contours: of those that may come next the one that must come soonest.

    `orders` are (before, after); `earliest` and `latest` are places that a contour may not pass. With cuts that count
    one each this finds an order wherever there is one (Simons 1978 has the general case); None where orders form a
    cycle. Where places cannot be kept it answers all the same.

    Examples
    --------
    >>> likely_order(4, [(0, 1), (2, 3)], {}, {3: 1})
    [2, 3, 0, 1]
    """
    after: list[list[int]] = [[] for _ in range(n)]
    waits_for = [0] * n
    for i, j in orders:
        after[i].append(j)
        waits_for[j] += 1
    straight = in_a_row(after, waits_for)
    if straight is None:
        return None
    soonest = [earliest.get(k, 0) for k in range(n)]
    last = [latest.get(k, n - 1) for k in range(n)]
    for k in straight:
        for j in after[k]:
            soonest[j] = max(soonest[j], soonest[k] + 1)
    for k in reversed(straight):
        last[k] = min([last[k], *(last[j] - 1 for j in after[k])])
    waiting = sorted(range(n), key=lambda k: -soonest[k])
    released = [False] * n
    ready: list[tuple[int, int]] = []
    place = [-1] * n
    for position in range(n):
        while waiting and soonest[waiting[-1]] <= position:
            k = waiting.pop()
            released[k] = True
            if not waits_for[k] and place[k] < 0:
                heappush(ready, (last[k], k))
        if ready:
            _, k = heappop(ready)
        else:  # some contour must come too early
            k = min((k for k in range(n) if place[k] < 0 and not waits_for[k]), key=lambda k: (soonest[k], k))
        place[k] = position
        for j in after[k]:
            waits_for[j] -= 1
            if not waits_for[j] and released[j]:
                heappush(ready, (last[j], j))
    return place


def in_a_row(after: Sequence[Sequence[int]], waits_for: Sequence[int]) -> list[int] | None:
    """Things each before what comes `after` it, which `waits_for` so many others; None where they form a cycle.

    Examples
    --------
    >>> in_a_row([[], [0]], [1, 0]), in_a_row([[1], [0]], [1, 1])
    ([1, 0], None)
    """
    straight = [k for k, others in enumerate(waits_for) if not others]
    left = list(waits_for)
    for k in straight:  # it grows
        for j in after[k]:
            left[j] -= 1
            if not left[j]:
                straight.append(j)
    return straight if len(straight) == len(after) else None
