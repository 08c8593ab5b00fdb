"""Connected components of a graph; where links are few, found without the library, which takes long to load."""

from __future__ import annotations

from graphlib import CycleError, TopologicalSorter

import numpy as np

from kerfwise.arrays import Ints

FEW = 3000
"""Links up to which plain Python is quicker than loading the library."""


def strong_components(size: int, links: Ints, few: int = FEW) -> Ints:
    """For each of `size` nodes the number of its strongly connected component; `links` (k, 2) lead from and to nodes.

    Examples
    --------
    >>> strong_components(3, np.array([[0, 1], [1, 2]])).tolist()
    [0, 1, 2]
    >>> one, two, three = strong_components(3, np.array([[0, 1], [1, 0], [1, 2]])).tolist()
    >>> one == two, two == three
    (True, False)
    """
    if len(links) <= few and not _go_round(links):
        return np.arange(size)
    return _by_library(size, links, "strong")


def weak_components(size: int, links: Ints, few: int = FEW) -> Ints:
    """The same whichever way links lead; components are numbered in the order of their first nodes.

    Examples
    --------
    >>> weak_components(4, np.array([[3, 0], [2, 1]])).tolist()
    [0, 1, 1, 0]
    """
    if len(links) > few:
        return _by_library(size, links, "weak")
    first = list(range(size))

    def root(node: int) -> int:
        while first[node] != node:
            first[node] = first[first[node]]
            node = first[node]
        return node

    for a, b in links.tolist():
        one, other = sorted((root(a), root(b)))
        first[other] = one
    return np.unique([root(node) for node in range(size)], return_inverse=True)[1].astype(np.int64)


def _go_round(links: Ints) -> bool:
    """Whether some lead round in a circle of more than one node."""
    sorter: TopologicalSorter[int] = TopologicalSorter()
    for a, b in links.tolist():
        if a != b:
            sorter.add(b, a)
    try:
        sorter.prepare()
    except CycleError:
        return True
    return False


def _by_library(size: int, links: Ints, connection: str) -> Ints:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(links)), (links[:, 0], links[:, 1])), shape=(size, size))
    return np.asarray(connected_components(graph, directed=True, connection=connection)[1], dtype=np.int64)
