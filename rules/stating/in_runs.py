"""An order in which runs stay together, contours come before others as asked, and places are kept, if one is found."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from kerfwise.encoder.components import weak_components

from .cycles import Link
from .likely_order import in_a_row, likely_order


def order_in_runs(
    n: int,
    links: Sequence[Link],
    runs: Sequence[Sequence[int]],
    earliest: Mapping[int, int],
    latest: Mapping[int, int],
) -> list[int] | None:
    """The place, from 0 on, of each of n contours; None where links and runs form a cycle.

    Each run is put in an order of its own, and runs one after the other: of those that may come next the one that must
    come soonest, unless it would take the place of another. Places are kept where that finds a way, not always.

    Examples
    --------
    >>> order_in_runs(4, [(0, 2), (2, 3)], [(0, 3)], {}, {})
    >>> order_in_runs(4, [(3, 0), (0, 2)], [(0, 3)], {2: 3}, {})
    [1, 2, 3, 0]
    """
    if not runs:
        return likely_order(n, links, earliest, latest)
    chain = np.array([link for run in runs for link in pairwise(run)], dtype=np.int64).reshape(-1, 2)
    block = weak_components(n, chain).tolist()
    blocks = 1 + max(block)
    inside: dict[int, list[Link]] = defaultdict(list)
    before: list[set[int]] = [set() for _ in range(blocks)]
    for i, j in links:
        if block[i] == block[j]:
            inside[block[i]].append((i, j))
        else:
            before[block[j]].add(block[i])
    members: list[list[int]] = [[] for _ in range(blocks)]
    for k in range(n):
        members[block[k]].append(k)
    for b, orders in inside.items():
        straight = _straight(members[b], orders, latest)
        if straight is None:
            return None
        members[b] = straight
    sequence = _in_turn(members, before, earliest, latest)
    if sequence is None:
        return None
    place = [0] * n
    for position, k in enumerate(k for b in sequence for k in members[b]):
        place[k] = position
    return place


def _straight(members: Sequence[int], orders: Sequence[Link], latest: Mapping[int, int]) -> list[int] | None:
    """The members of a run in an order that keeps the orders, soonest first."""
    number = {k: m for m, k in enumerate(members)}
    soon = sorted({latest[k] for k in members if k in latest})
    due = {number[k]: soon.index(latest[k]) for k in members if k in latest}
    places = likely_order(len(members), [(number[i], number[j]) for i, j in orders], {}, due)
    return places and sorted(members, key=lambda k: places[number[k]])


def _in_turn(
    members: Sequence[Sequence[int]],
    before: Sequence[set[int]],
    earliest: Mapping[int, int],
    latest: Mapping[int, int],
) -> list[int] | None:
    """The runs one after the other; None where they wait for each other."""
    blocks, n = len(members), sum(map(len, members))
    after: list[list[int]] = [[] for _ in range(blocks)]
    waits_for = [len(of) for of in before]
    for b, of in enumerate(before):
        for a in of:
            after[a].append(b)
    straight = in_a_row(after, waits_for)
    if straight is None:
        return None
    begins = [max(0, *(earliest.get(k, 0) - m for m, k in enumerate(of))) for of in members]
    ends = [min(n - len(of), *(latest.get(k, n - 1) - m for m, k in enumerate(of))) for of in members]
    for a in straight:
        for b in after[a]:
            begins[b] = max(begins[b], begins[a] + len(members[a]))
    for a in reversed(straight):
        ends[a] = min([ends[a], *(ends[b] - len(members[a]) for b in after[a])])
    ready = {b for b in range(blocks) if not waits_for[b]}
    due = sorted(range(blocks), key=lambda b: -ends[b])
    sequence: list[int] = []
    done = [False] * blocks
    position = 0
    while ready:
        while done[due[-1]]:
            due.pop()
        next_due = due[-1]
        may = [b for b in ready if begins[b] <= position] or list(ready)
        fits = [b for b in may if b == next_due or position + len(members[b]) <= ends[next_due]]
        b = min(fits or may, key=lambda b: (ends[b], b))
        ready.discard(b)
        done[b] = True
        sequence.append(b)
        position += len(members[b])
        for other in after[b]:
            waits_for[other] -= 1
            if not waits_for[other]:
                ready.add(other)
    return sequence
