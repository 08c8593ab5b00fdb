"""The sets that can be out while zones are cut, against a count of all sets."""

from __future__ import annotations

from itertools import combinations, pairwise, product

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.facts.zones import MOST_UNITS, divisions, merge_zones, sets_within, units_of
from kerfwise.tests.tools.amount import examples


def lawful_sets(part: list[int], pairs: list[tuple[int, int]]) -> int:
    """Sets of contours of parts, each cut in one go with its outer contour (its last number) at the end."""
    outer = {p: max(k for k, q in enumerate(part) if q == p) for p in part}
    count = 0
    for chosen in product((False, True), repeat=len(part)):
        out = {k for k, there in enumerate(chosen) if there}
        begun = {p for p in outer if any(part[k] == p for k in out) and outer[p] not in out}
        whole = all(part[k] != p or k in out for p in outer if outer[p] in out for k in range(len(part)))
        ahead = all(outer[part[a]] in out for a, b in pairs if part[b] in {part[k] for k in out})
        count += whole and ahead and len(begun) <= 1
    return count


@examples(80)
@given(st.lists(st.integers(0, 3), min_size=1, max_size=9), st.integers(0, 2**32 - 1))
def test_as_many_as_a_count_of_all_sets(parts: list[int], seed: int) -> None:
    part = sorted(parts)
    random = np.random.default_rng(seed)
    pairs = [(a, b) for a in range(len(part)) for b in range(len(part)) if part[a] < part[b] and random.random() < 0.15]
    units = units_of(np.array(part), np.zeros(len(part), bool), np.array(pairs, dtype=np.int64).reshape(-1, 2), True)
    assert sets_within(np.arange(len(units.inner)), units, 1e6) == lawful_sets(part, pairs)


def test_orders_that_go_round_in_a_circle_are_none() -> None:
    pairs = np.array([[0, 1], [1, 0], [1, 2]])
    units = units_of(np.arange(3), np.zeros(3, bool), pairs, True)
    assert sets_within(np.arange(3), units, 100.0) == 6  # {}, 0, 1, 01, 12, 012


def test_more_than_a_word_holds_in_one_piece_is_too_much() -> None:
    count = MOST_UNITS + 1
    chain = np.stack([np.zeros(count - 1, dtype=np.int64), np.arange(1, count)], axis=1)
    units = units_of(np.arange(count), np.zeros(count, bool), chain, True)
    assert sets_within(np.arange(count), units, 1e9) == float("inf")


def test_what_is_known_of_orders_is_known_of_those_alone() -> None:
    """Asked again with other orders, other holes and another limit, each has an answer of its own."""
    none, chain = np.empty((0, 2), dtype=np.int64), np.array([[0, 1]])
    for _ in range(2):
        for pairs, most, wanted in ((none, 9.0, 4.0), (chain, 9.0, 3.0), (none, 3.0, float("inf")), (none, 4.0, 4.0)):
            assert sets_within(np.arange(2), units_of(np.arange(2), np.zeros(2, bool), pairs, True), most) == wanted
        holed = units_of(np.array([0, 0, 1]), np.zeros(3, bool), none, True)
        assert sets_within(np.arange(2), holed, 9.0) == 6.0


def test_too_many_are_told() -> None:
    units = units_of(np.arange(4), np.zeros(4, bool), np.empty((0, 2), dtype=np.int64), True)
    assert sets_within(np.arange(2), units, 4.0) == 4.0
    assert sets_within(np.arange(2), units, 3.0) == float("inf")


def test_marks_are_in_no_set() -> None:
    units = units_of(np.array([0, 0]), np.array([True, False]), np.array([[0, 1]]), True)
    assert sets_within(np.array([0]), units, 100.0) == 2.0


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
