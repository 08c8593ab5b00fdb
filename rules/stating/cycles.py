"""Orders that contradict each other: which of them lie on a cycle, and which way round the cycle goes.

Orders are pairs (before, after). Contours that are cut together (`together`) count as one towards everything else:
nothing else can come between them, so that an order of one of them is an order of all.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.components import strong_components, weak_components

Link = tuple[int, int]


def contracted(n: int, pairs: Sequence[Link], together: Iterable[Sequence[int]]) -> list[Link]:
    """The pairs over n contours as links between nodes, each set of contours cut together being one node.

    Orders within such a set are kept apart, as links between nodes n and up.

    Examples
    --------
    >>> contracted(4, [(0, 3), (3, 1), (0, 1)], [(0, 1)])
    [(0, 2), (2, 0), (4, 5)]
    """
    return list(zip(*joined(n, _ends(pairs), together).T.tolist(), strict=True))


def joined(n: int, ends: Ints, together: Iterable[Sequence[int]]) -> Ints:
    """As `contracted`, of pairs as an array (k, 2), and as one."""
    chain = [link for members in together for link in pairwise(members)]
    node = weak_components(n, _ends(chain))
    return np.where((node[ends[:, 0]] != node[ends[:, 1]])[:, None], node[ends], n + ends)


def components(links: Sequence[Link] | Ints) -> list[list[int]]:
    """The links, by number, that lie on cycles: one list for each strongly connected component.

    Examples
    --------
    >>> components([(0, 1), (1, 2), (2, 1), (3, 3)])
    [[1, 2], [3]]
    """
    ends = _ends(links)
    label = strong_components(1 + int(ends.max(initial=0)), ends)[ends]
    within = np.flatnonzero(label[:, 0] == label[:, 1])
    found: dict[int, list[int]] = defaultdict(list)
    for k, component in zip(within.tolist(), label[within, 0].tolist(), strict=True):
        found[component].append(k)
    return sorted(found.values())


def path(links: Sequence[Sequence[int]], among: Iterable[int], start: int, goal: int) -> list[int] | None:
    """The fewest of the links numbered in `among` that lead from start to goal, in order; None where none do."""
    leaving: dict[int, list[int]] = defaultdict(list)
    for k in among:
        leaving[links[k][0]].append(k)
    came_by: dict[int, int] = {}
    waiting = deque([start])
    while waiting:
        for k in leaving[waiting.popleft()]:
            reached = links[k][1]
            if reached in came_by:
                continue
            came_by[reached] = k
            if reached == goal:
                return _traced(links, came_by, start, goal)
            waiting.append(reached)
    return None


def _traced(links: Sequence[Sequence[int]], came_by: Mapping[int, int], start: int, goal: int) -> list[int]:
    trail = [came_by[goal]]
    while links[trail[-1]][0] != start:
        trail.append(came_by[links[trail[-1]][0]])
    return trail[::-1]


def _ends(links: Sequence[Link] | Ints) -> Ints:
    return np.asarray(links, dtype=np.int64).reshape(-1, 2)
