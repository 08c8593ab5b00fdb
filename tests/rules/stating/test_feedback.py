"""The fewest links that break all cycles, against trying every set."""

from __future__ import annotations

import sys
from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder import graphs as graphs_encoder
from kerfwise.encoder.graphs import Link, Unbreakable, components, lightest_cut
from kerfwise.tests.tools.amount import examples

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
