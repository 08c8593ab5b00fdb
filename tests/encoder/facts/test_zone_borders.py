"""Borders of zones along an order, against all ways to draw them."""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.facts.zones import divisions
from kerfwise.tests.tools.amount import examples


@examples(60)
@given(st.integers(1, 8), st.integers(0, 2**32 - 1), st.integers(1, 9))
def test_no_other_zones_of_that_number_cost_less(count: int, seed: int, most: int) -> None:
    random = np.random.default_rng(seed)
    prices, weight = random.integers(0, 20, (count + 1, count + 1)).astype(float), random.integers(1, 6, count)

    def bears(begin: int, end: int) -> bool:
        return end - begin == 1 or int(weight[begin:end].sum()) <= most

    def price(begins: Ints, end: int) -> Floats:
        return prices[begins, end]

    def together(edges: tuple[int, ...]) -> float:
        return sum(float(prices[edge]) for edge in pairwise(edges))

    found = {int(zone.max()): zone for zone in divisions(count, price, bears, count)}
    fewest = min(found)
    assert [int(zone.max()) for zone in divisions(count, price, bears, 3)] == [k for k in found if k <= max(3, fewest)]
    for zones in range(1, count + 1):
        ways = ((0, *inner, count) for inner in combinations(range(1, count), zones - 1))
        lawful = [way for way in ways if all(bears(a, b) for a, b in pairwise(way))]
        assert (zones in found) == bool(lawful)
        if lawful:
            edges = (0, *(np.flatnonzero(np.diff(found[zones])) + 1).tolist(), count)
            assert edges in lawful
            assert together(edges) == min(together(way) for way in lawful)
    assert list(found) == sorted(found)
