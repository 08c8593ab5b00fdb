"""Zones that are joined: no more than may be, and no two that could still be one."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.facts.zones import merge_zones, sets_within, units_of
from kerfwise.tests.tools.amount import examples


@examples(60)
@given(
    st.lists(st.integers(0, 5), min_size=1, max_size=14), st.integers(0, 2**32 - 1), st.sampled_from([4.0, 12.0, 90.0])
)
def test_as_large_as_they_may_be(given_zones: list[int], seed: int, most: float) -> None:
    zone = np.unique(sorted(given_zones), return_inverse=True)[1] + 1
    n, random = len(zone), np.random.default_rng(seed)
    pairs = [(a, b) for a in range(n) for b in range(a) if zone[a] <= zone[b] and random.random() < 0.2]
    pairs += [(a, b) for b in range(n) for a in range(b) if random.random() < 0.2]
    units = units_of(np.arange(n), np.zeros(n, bool), np.array(pairs, dtype=np.int64).reshape(-1, 2), True)
    found = merge_zones(zone, units, most, np.zeros(zone.max()))

    def sets(*names: int) -> float:
        return sets_within(np.flatnonzero(np.isin(found, names)), units, 1e9)

    assert (np.diff(found) >= 0).all()
    assert all(len(np.unique(found[zone == z])) == 1 for z in zone)
    for z in range(1, found.max() + 1):
        assert sets(z) <= most or len(np.unique(zone[found == z])) == 1
        first_of_next = zone == zone[found == z].max() + 1
        larger = np.flatnonzero((found == z) | first_of_next)
        assert z == found.max() or sets_within(larger, units, 1e9) > most


def test_no_more_than_the_budget_of_heat_is_joined() -> None:
    four = units_of(np.arange(4), np.zeros(4, bool), np.empty((0, 2), dtype=np.int64), True)
    zone = np.arange(1, 5)
    assert merge_zones(zone, four, 1e9, np.full(4, 2.0), 4.0).tolist() == [1, 1, 2, 2]
    assert merge_zones(zone, four, 1e9, np.array([9.0, 1.0, 1.0, 1.0]), 3.0).tolist() == [1, 2, 2, 2]
