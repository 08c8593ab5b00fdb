"""Graphs: connected components, cycles, and the fewest links to take out so that no cycle is left."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise

import numpy as np

from kerfwise.arrays import Ints

# Connected components of a graph.

FEW = 50_000
"""Links up to which plain Python is quicker than loading the library."""


def strong_components(size: int, links: Ints, few: int = FEW) -> Ints:
    """For each of `size` nodes the number of its strongly connected component; `links` (k, 2) lead from and to nodes.

    Examples
    --------
    >>> len(set(strong_components(3, np.array([[0, 1], [1, 2]])).tolist()))
    3
    >>> one, two, three = strong_components(3, np.array([[0, 1], [1, 0], [1, 2]])).tolist()
    >>> one == two, two == three
    (True, False)
    """
    if len(links) <= few:
        return _by_depth(size, links)
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(links)), (links[:, 0], links[:, 1])), shape=(size, size))
    return np.asarray(connected_components(graph, directed=True, connection="strong")[1], dtype=np.int64)


def _by_depth(size: int, links: Ints) -> Ints:
    """The same by one walk in depth with two stacks (Gabow 2000)."""
    links = links[np.argsort(links[:, 0], kind="stable")]
    heads = links[:, 1].tolist()
    first = np.searchsorted(links[:, 0], np.arange(size + 1)).tolist()
    place, reached, label = first[:-1], [0] * size, [-1] * size
    unlabelled: list[int] = []
    borders: list[int] = []  # the first node of each component of these, as far as is known
    count = components_found = 0
    for root in range(size):
        trail = [] if reached[root] else [root]
        while trail:
            node = trail[-1]
            if not reached[node]:
                count += 1
                reached[node] = count
                unlabelled.append(node)
                borders.append(node)
            for k in range(place[node], first[node + 1]):
                head = heads[k]
                if not reached[head]:
                    place[node] = k + 1
                    trail.append(head)
                    break
                if label[head] < 0:
                    while reached[borders[-1]] > reached[head]:
                        borders.pop()
            else:
                trail.pop()
                if borders[-1] == node:
                    borders.pop()
                    while label[node] < 0:
                        label[unlabelled.pop()] = components_found
                    components_found += 1
    return np.array(label, dtype=np.int64)


def weak_components(size: int, links: Ints) -> Ints:
    """The same whichever way links lead; components are numbered in the order of their first nodes.

    Examples
    --------
    >>> weak_components(4, np.array([[3, 0], [2, 1]])).tolist()
    [0, 1, 1, 0]
    """
    first = np.arange(size)  # the lowest node known to hang together with each
    one, other = links[:, 0], links[:, 1]
    while len(one):
        low, high = np.minimum(first[one], first[other]), np.maximum(first[one], first[other])
        apart = low < high
        one, other = one[apart], other[apart]
        np.minimum.at(first, high[apart], low[apart])
        while not np.array_equal(lower := first[first], first):
            first = lower
    return np.unique(first, return_inverse=True)[1].astype(np.int64)


# Orders that contradict each other: which of them lie on a cycle, and which way round the cycle goes.
#
# Orders are pairs (before, after). Contours that are cut together (`together`) count as one towards everything else:
# nothing else can come between them, so that an order of one of them is an order of all.

Link = tuple[int, int]


def contracted(n: int, pairs: Sequence[Link], together: Iterable[Sequence[int]]) -> list[Link]:
    """The pairs over n contours as links between nodes, each set of contours cut together being one node.

    Orders within such a set are kept apart, as links between nodes n and up.

    Examples
    --------
    >>> contracted(4, [(0, 3), (3, 1), (0, 1)], [(0, 1)])
    [(0, 2), (2, 0), (4, 5)]
    """
    return list(zip(*contract_pairs(n, _ends(pairs), together).T.tolist(), strict=True))


def contract_pairs(n: int, ends: Ints, together: Iterable[Sequence[int]]) -> Ints:
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
    if 2 * len(ends) <= ends.max(initial=0):  # a few of many nodes
        ends = np.unique(ends, return_inverse=True)[1].reshape(-1, 2)
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


# The fewest links to take out of a graph so that no cycle is left (a minimum feedback arc set).

EXACT_LINKS = 400
"""Components with more links are broken up greedily: good, but not proven to be the fewest."""


class Unbreakable(Exception):
    """A cycle of links none of which may be taken out; `cycle` are their numbers in order."""

    def __init__(self, cycle: list[int]) -> None:
        super().__init__(cycle)
        self.cycle = cycle


def lightest_cut(links: Sequence[Link], weights: Sequence[int | None]) -> list[int]:
    """Numbers of the links to take out so that no cycle is left, of least total weight; a weight of None is kept.

    Exact for up to `EXACT_LINKS` links on the cycles of a component. Raises Unbreakable if the links that must be kept
    form a cycle by themselves.

    Examples
    --------
    >>> lightest_cut([(0, 1), (1, 0), (1, 2), (2, 0)], [1, 1, 1, 1])
    [0]
    """
    kept = [k for k, weight in enumerate(weights) if weight is None]
    for component in components([links[k] for k in kept]):
        raise Unbreakable(_cycle_through(links, kept[component[0]], [kept[k] for k in component]))
    out: list[int] = []
    for component in components(links):
        find = _exact if len(component) <= EXACT_LINKS else _greedy
        out += find([links[k] for k in component], [weights[k] for k in component], component)
    return sorted(out)


def some_cycles(links: Sequence[Link], among: Sequence[int]) -> list[list[int]]:
    """Of the links numbered in `among`, for each that lies on a cycle a shortest one, as numbers of links in order."""
    return [
        _cycle_through(links, among[k], [among[m] for m in component])
        for component in components([links[k] for k in among])
        for k in component
    ]


def _exact(links: Sequence[Link], weights: Sequence[int | None], names: Sequence[int]) -> list[int]:
    """Covers the cycles found so far, looks for cycles that are left, and so on until there are none."""
    cycles: dict[frozenset[int], None] = {}
    out: set[int] = set()
    while True:
        left = [k for k in range(len(links)) if k not in out]
        found = [frozenset(cycle) for cycle in some_cycles(links, left)]
        if not found:
            return [names[k] for k in sorted(out)]
        cycles |= dict.fromkeys(found)
        out = _cover(list(cycles), weights)


def _cover(cycles: Sequence[frozenset[int]], weights: Sequence[int | None]) -> set[int]:
    """The lightest set of links that has at least one of each cycle."""
    taken, left = _sure_cover(cycles, weights)
    if not left:
        return taken
    from scipy.optimize import Bounds, LinearConstraint, milp
    from scipy.sparse import coo_array

    free = sorted({k for cycle in cycles for k in cycle if weights[k] is not None})
    column = {k: c for c, k in enumerate(free)}
    cells = [(row, column[k]) for row, cycle in enumerate(cycles) for k in sorted(cycle) if k in column]
    rows, columns = np.array(cells).T
    matrix = coo_array((np.ones(len(cells)), (rows, columns)), shape=(len(cycles), len(free)))
    costs = np.array([weights[k] for k in free], dtype=np.float64)
    found = milp(costs, integrality=1, bounds=Bounds(0, 1), constraints=LinearConstraint(matrix.tocsr(), lb=1))
    return {k for k, taken in zip(free, found.x, strict=True) if taken > 0.5}


def _sure_cover(cycles: Sequence[frozenset[int]], weights: Sequence[int | None]) -> tuple[set[int], list[set[int]]]:
    """Links that every lightest cover has, and what may be taken of the cycles that these do not cover.

    A heavier link that covers no more than another is in none of them; most tangles are pairs of orders of two rules
    one of which gives way, and nothing is left of these.
    """
    left = [{k for k in cycle if weights[k] is not None} for cycle in cycles]
    taken: set[int] = set()
    while True:
        on: dict[int, set[int]] = defaultdict(set)
        for row, cycle in enumerate(left):
            for k in cycle:
                on[k].add(row)
        heavier = {
            k
            for k, rows in on.items()
            if any((weights[m] or 0) < (weights[k] or 0) and rows <= on[m] for m in left[min(rows)])
        }
        left = [cycle - heavier for cycle in left]
        sure = {k for cycle in left if len(cycle) == 1 for k in cycle}
        if not sure and not heavier:
            return taken, left
        taken |= sure
        left = [cycle for cycle in left if not cycle & sure]


def _greedy(links: Sequence[Link], weights: Sequence[int | None], names: Sequence[int]) -> list[int]:
    """Lines the nodes up, each time the one with the least weight of links from nodes not yet in line; the links that
    then point backwards go, except those that close no cycle after all.
    """
    nodes = {node: k for k, node in enumerate(sorted({end for link in links for end in link}))}
    tail, head = np.array([[nodes[a], nodes[b]] for a, b in links]).T
    heavy = 1 + sum(weight or 0 for weight in weights)
    weight = np.array([heavy if w is None else w for w in weights], dtype=np.float64)
    waiting = np.bincount(head, weights=weight, minlength=len(nodes))
    place = np.zeros(len(nodes), dtype=np.int64)
    by_tail = np.split(np.argsort(tail, kind="stable"), np.cumsum(np.bincount(tail, minlength=len(nodes)))[:-1])
    for position in range(len(nodes)):
        node = int(waiting.argmin())
        place[node], waiting[node] = position, np.inf
        leaving = by_tail[node]
        np.subtract.at(waiting, head[leaving], weight[leaving])
    backward = np.flatnonzero(place[tail] > place[head]).tolist()
    kept = sorted(set(range(len(links))) - set(backward))
    out = []
    for k in sorted(backward, key=lambda k: (-weight[k], k)):
        if path(links, kept, links[k][1], links[k][0]) is None:
            kept.append(k)
        else:
            out.append(k)
    return [names[k] for k in sorted(out)]


def _cycle_through(links: Sequence[Link], link: int, among: Sequence[int]) -> list[int]:
    """The shortest cycle that a link of a strongly connected component lies on."""
    start, end = links[link]
    return [link, *(path(links, among, end, start) or [])] if start != end else [link]
