"""The order that is tried first keeps all places and orders wherever an order does."""

from __future__ import annotations

from itertools import permutations

from hypothesis import given
from hypothesis import strategies as st

from kerfwise.rules.stating.feasible_order import likely_order

N = 5
PAIRS = st.lists(st.tuples(st.integers(0, N - 1), st.integers(0, N - 1)).filter(lambda p: p[0] != p[1]), max_size=5)
PLACES = st.dictionaries(st.integers(0, N - 1), st.integers(0, N - 1), max_size=3)


@given(PAIRS, PLACES, PLACES)
def test_all_is_kept_where_that_is_possible(
    orders: list[tuple[int, int]], earliest: dict[int, int], latest: dict[int, int]
) -> None:
    def kept(place: tuple[int, ...] | list[int]) -> bool:
        return (
            all(place[i] < place[j] for i, j in orders)
            and all(place[k] >= of for k, of in earliest.items())
            and all(place[k] <= of for k, of in latest.items())
        )

    found = likely_order(N, orders, earliest, latest)
    straight = any(all(place[i] < place[j] for i, j in orders) for place in permutations(range(N)))
    assert (found is not None) == straight
    if found is not None:
        assert sorted(found) == list(range(N))
        assert kept(found) == any(map(kept, permutations(range(N))))
