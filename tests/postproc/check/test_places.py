"""Room for locked positions: counted where counting tells, else asked of a model, with so much work in all."""

from __future__ import annotations

from itertools import permutations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.postproc.check import rule_verdicts
from kerfwise.postproc.check.rule_verdicts import Room

NAMES = "abcde"
RUN = ("a", "b")
ORDERS = [(x, y) for x in NAMES for y in NAMES if x != y]


def there_is_room(orders: list[tuple[str, str]], runs: list[tuple[str, ...]], at: dict[str, int]) -> bool:
    """By trying every order."""
    for order in permutations(NAMES):
        place = {name: k for k, name in enumerate(order, 1)}
        together = all(max(map(place.get, run)) - min(map(place.get, run)) == len(run) - 1 for run in runs)
        if together and all(place[x] < place[y] for x, y in orders) and all(place[x] == k for x, k in at.items()):
            return True
    return False


@given(
    st.lists(st.sampled_from(ORDERS), max_size=6, unique=True),
    st.sampled_from([[], [RUN], [("b", "c", "d")]]),
    st.dictionaries(st.sampled_from(NAMES), st.integers(1, 5), min_size=1, max_size=2),
)
def test_no_room_is_said_exactly_where_no_order_is_left(
    orders: list[tuple[str, str]], runs: list[tuple[str, ...]], at: dict[str, int]
) -> None:
    assert Room(NAMES, runs, at).none(orders) is not there_is_room(orders, runs, at)
    room, others = Room(NAMES, runs, at), orders[1:]
    for order in orders:  # each beside the same others
        assert room.none(others, [order]) is not there_is_room([*others, order], runs, at)


def test_what_counting_tells_is_asked_of_no_model() -> None:
    """Of 300 in a row the last is locked to be the first: each of 299 orders before it is answered at once."""
    names = [f"P{k}" for k in range(300)]
    room = Room(names, (), {"P299": 1})
    assert all(room.none([(name, "P299")]) for name in names[:-1])
    assert room.questions == 0


def test_a_run_counts_whole_before_another_contour_and_in_part_before_its_own() -> None:
    room = Room(NAMES, [RUN], {"c": 2, "b": 2})
    assert room.none([("a", "c")])
    assert Room(NAMES, [RUN], {"c": 3, "b": 2}).none([("b", "c")]) is False
    assert room.questions == 0


def test_questions_end_when_the_work_for_all_is_spent(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two positions together leave no room for the orders, which counting for one after the other does not tell."""
    at, orders = {"a": 2, "b": 3}, [("c", "b"), ("d", "b")]
    assert Room(NAMES, (), at).none(orders)
    monkeypatch.setattr(rule_verdicts, "WORK_IN_ALL", 0.0)
    room = Room(NAMES, (), at)
    assert not room.none(orders)
    assert room.questions == 0
