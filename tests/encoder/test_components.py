"""Connected components: the same without the library as with it."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from kerfwise.arrays import Ints
from kerfwise.encoder.graphs import strong_components, weak_components

LINKS = st.lists(st.tuples(st.integers(0, 7), st.integers(0, 7)), max_size=14)


def _same_groups(one: Ints, other: Ints) -> bool:
    return bool(((one[:, None] == one) == (other[:, None] == other)).all())


def _weak_by_library(size: int, links: Ints) -> Ints:
    graph = coo_array((np.ones(len(links)), (links[:, 0], links[:, 1])), shape=(size, size))
    return np.asarray(connected_components(graph, directed=True, connection="weak")[1])


@given(LINKS)
def test_by_plain_python_as_by_the_library(links: list[tuple[int, int]]) -> None:
    pairs = np.array(links, dtype=np.int64).reshape(-1, 2)
    assert _same_groups(strong_components(8, pairs), strong_components(8, pairs, few=-1))
    assert weak_components(8, pairs).tolist() == _weak_by_library(8, pairs).tolist()


def test_no_nodes() -> None:
    none = np.empty((0, 2), dtype=np.int64)
    assert len(strong_components(0, none)) == len(weak_components(0, none)) == 0


def test_a_long_chain_is_one_component_whichever_way_it_leads() -> None:
    order = np.random.default_rng(1).permutation(5000)
    links = np.column_stack([order[:-1], order[1:]])
    assert set(weak_components(5000, links).tolist()) == {0}
    assert len(set(strong_components(5000, links).tolist())) == 5000
    assert set(strong_components(5000, np.vstack([links, [order[-1], order[0]]])).tolist()) == {0}
