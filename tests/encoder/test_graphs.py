"""Graphs of what comes before what: their parts, circles and lightest cuts."""

from __future__ import annotations

import sys
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from kerfwise.arrays import Ints
from kerfwise.encoder import graphs as graphs_encoder
from kerfwise.encoder.graphs import (
    Link,
    Unbreakable,
    components,
    contracted,
    lightest_cut,
    path,
    strong_components,
    weak_components,
)
from kerfwise.tests.tools.amount import examples

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


def test_links_off_the_cycle_are_none() -> None:
    assert components([(0, 1), (1, 2), (2, 0), (2, 3)]) == [[0, 1, 2]]
    assert components([(0, 1), (1, 2)]) == []
    assert components([]) == []


def test_contours_cut_together_are_one_node() -> None:
    # 1 after 0 and before 3, where 0 and 3 belong to one run: no contour can come between them.
    pairs = [(0, 1), (1, 3)]
    assert components(contracted(4, pairs, [])) == []
    assert components(contracted(4, pairs, [(0, 3)])) == [[0, 1]]


def test_runs_that_share_a_contour_are_one_run() -> None:
    assert components(contracted(4, [(0, 1), (1, 3)], [(0, 2), (2, 3)])) == [[0, 1]]


def test_cycle_within_a_run_is_found() -> None:
    assert components(contracted(2, [(0, 1), (1, 0)], [(0, 1)])) == [[0, 1]]


def test_path_is_the_shortest() -> None:
    links = [(0, 1), (1, 2), (2, 3), (0, 3)]
    assert path(links, range(4), 0, 3) == [3]
    assert path(links, range(3), 0, 3) == [0, 1, 2]
    assert path(links, range(4), 3, 0) is None


@examples(100)
@given(st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), max_size=14), st.sets(st.integers(0, 5), max_size=3))
def test_links_on_cycles_are_those_from_whose_end_one_comes_back(pairs: list[tuple[int, int]], run: set[int]) -> None:
    """By walks over single links: contours of a run count as one, but for orders among themselves."""
    node = {k: min(run) if k in run else k for k in range(6)}
    links = [(node[a], node[b]) if node[a] != node[b] else (6 + a, 6 + b) for a, b in pairs]

    def reached(start: int) -> set[int]:
        found = {start}
        while more := {b for a, b in links if a in found} - found:
            found |= more
        return found

    found = components(contracted(6, pairs, [sorted(run)]))
    assert sorted(k for of in found for k in of) == [k for k, (a, b) in enumerate(links) if a in reached(b)]
    assert all(links[one][0] in reached(links[other][0]) for of in found for one in of for other in of)
    assert found == sorted(found)
    assert all(of == sorted(of) for of in found)


Graph = tuple[list[Link], list[int | None]]


def without(links: list[Link], out: list[int]) -> list[Link]:
    return [link for k, link in enumerate(links) if k not in out]


def weight_of(out: list[int], weights: list[int | None]) -> int:
    return sum(weights[k] or 0 for k in out)


def cheapest(links: list[Link], weights: list[int | None]) -> int | None:
    """Least weight of a set of removable links without which no cycle is left, by trying all sets."""
    free = [k for k, weight in enumerate(weights) if weight is not None]
    sets = [list(out) for size in range(len(free) + 1) for out in combinations(free, size)]
    good = [weight_of(out, weights) for out in sets if not components(without(links, out))]
    return min(good) if good else None


@st.composite
def graphs(draw: st.DrawFn) -> Graph:
    ends = st.integers(0, 4)
    links = draw(st.lists(st.tuples(ends, ends).filter(lambda e: e[0] != e[1]), unique=True, max_size=8))
    weights = draw(st.lists(st.sampled_from([None, 1, 1, 2, 5]), min_size=len(links), max_size=len(links)))
    return links, weights


@pytest.mark.slow
@examples(40)
@given(graphs())
def test_cut_is_the_lightest(graph: Graph) -> None:
    links, weights = graph
    best = cheapest(links, weights)
    if best is None:
        with pytest.raises(Unbreakable):
            lightest_cut(links, weights)
        return
    out = lightest_cut(links, weights)
    assert components(without(links, out)) == []
    assert weight_of(out, weights) == best


@examples(40)
@given(graphs())
def test_greedy_cut_leaves_no_cycle_and_takes_nothing_in_vain(graph: Graph) -> None:
    links, weights = graph
    tangled = sorted(k for component in components(links) for k in component)
    links, weights = [links[k] for k in tangled], [weights[k] for k in tangled]
    if not links or components([link for link, weight in zip(links, weights, strict=True) if weight is None]):
        return
    out = graphs_encoder._greedy(links, weights, range(len(links)))
    assert components(without(links, out)) == []
    assert all(weights[k] is not None for k in out)
    assert all(components(without(links, [k for k in out if k != spared])) for spared in out)


def test_unbreakable_cycle_is_named() -> None:
    with pytest.raises(Unbreakable) as caught:
        lightest_cut([(0, 1), (1, 2), (2, 0), (0, 3)], [None, None, None, 1])
    assert caught.value.cycle == [0, 1, 2]


def test_large_tangles_are_broken_up_greedily(monkeypatch: pytest.MonkeyPatch) -> None:
    links = [(a, b) for a in range(6) for b in range(6) if a != b]
    exact = lightest_cut(links, [1] * 30)
    monkeypatch.setattr(graphs_encoder, "EXACT_LINKS", 10)
    assert len(exact) == len(lightest_cut(links, [1] * 30)) == 15


def covers(cycles: list[frozenset[int]], weights: list[int]) -> list[set[int]]:
    """All lightest sets of links that have one of each cycle, by trying all sets."""
    sets = [set(out) for size in range(len(weights) + 1) for out in combinations(range(len(weights)), size)]
    good = [out for out in sets if all(out & cycle for cycle in cycles)]
    least = min(sum(weights[k] for k in out) for out in good)
    return [out for out in good if sum(weights[k] for k in out) == least]


@given(
    st.lists(st.frozensets(st.integers(0, 4), min_size=1, max_size=3), max_size=5),
    st.lists(st.integers(1, 3), min_size=5, max_size=5),
)
def test_what_is_sure_of_a_cover_lies_in_all_lightest_ones(cycles: list[frozenset[int]], weights: list[int]) -> None:
    lightest = covers(cycles, weights)
    taken, left = graphs_encoder._sure_cover(cycles, weights)
    assert all(taken <= out <= taken.union(*left) for out in lightest)
    assert left or lightest == [taken]


def test_pairs_of_orders_of_two_rules_need_no_linear_program(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "scipy.optimize", None)
    links = [(0, 1), (1, 0), (2, 3), (3, 2), (3, 4)]
    assert lightest_cut(links, [1, 2, 3, 1, 1]) == [0, 3]
