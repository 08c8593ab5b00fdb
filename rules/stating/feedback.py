"""The fewest links to take out of a graph so that no cycle is left (a minimum feedback arc set)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .cycles import Link, components, path

EXACT_LINKS = 400
"""Components with more links are broken up greedily: good, but not proven to be the fewest."""


class Unbreakable(Exception):
    """A cycle of links none of which may be taken out; `cycle` are their numbers in order."""

    def __init__(self, cycle: list[int]) -> None:
        super().__init__(cycle)
        self.cycle = cycle


def lightest_cut(links: Sequence[Link], weights: Sequence[int | None]) -> list[int]:
    """Numbers of the links to take out so that no cycle is left, of least total weight; a weight of None is kept.

    Exact for up to `EXACT_LINKS` links on the cycles of a component.

    Raises
    ------
    Unbreakable
        If the links that must be kept form a cycle by themselves.

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
