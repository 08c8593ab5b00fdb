"""The orders of the hard rules as numbers: each pair that a rule names is there, once among the cut, of the firmest."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.postproc.check import hard_orders
from kerfwise.postproc.check.hard_orders import Forcing, HardOrders
from kerfwise.postproc.check.rule_verdicts import Room
from kerfwise.rule_kit import CutSequence
from kerfwise.tests.postproc.plans import good_cuts, plate, profile

PLATE, PROFILE = plate(), profile()


def sequence(left_out: tuple[str, ...] = ()) -> CutSequence:
    cuts = tuple(cut for cut in good_cuts(PLATE) if cut.contour not in left_out)
    return CutSequence(cuts, "left", (0.0, 0.0))


def asked(cuts: CutSequence) -> dict[str, set[tuple[str, str]]]:
    book = PROFILE.rulebook()
    hard = {name: s for name, s in PROFILE.settings().items() if s.strength == "hard"}
    return {name: set(book[name].pairs(PLATE, cuts, s.options)) for name, s in hard.items()}


def test_pairs_are_those_of_the_rules() -> None:
    for left_out in ((), ("A.hole1", "E.outer")):
        cuts = sequence(left_out)
        orders = HardOrders(PLATE, cuts, PROFILE)
        named = {
            rule: {(orders.names[a], orders.names[b]) for a, b in pairs.tolist()}
            for rule, pairs in orders.by_rule.items()
        }
        assert named == asked(cuts)
        assert sum(map(len, named.values())) > 5
        at = cuts.positions()
        assert {name: k for name, k in zip(orders.names, orders.at.tolist(), strict=True) if k} == at
        assert set(orders.names) - set(at) <= set(left_out)


def test_pairs_of_cut_contours_come_once_with_the_firmest_rule() -> None:
    cuts, book = sequence(("E.outer",)), PROFILE.rulebook()
    orders = HardOrders(PLATE, cuts, PROFILE)
    pairs, rules = orders.of_cut()
    told = {(orders.names[a], orders.names[b]): rule for (a, b), rule in zip(pairs.tolist(), rules, strict=True)}
    assert len(told) == len(pairs)
    every = asked(cuts)
    cut = cuts.positions()
    want = {pair for of in every.values() for pair in of if set(pair) <= cut.keys()}
    assert told.keys() == want
    for pair, rule in told.items():
        assert pair in every[rule]
        assert book[rule].gives_way == min(book[name].gives_way for name, of in every.items() if pair in of)


def test_what_must_go_before_is_reached_by_the_orders_that_are_kept() -> None:
    good = sequence()
    for cuts in (good, replace(good, cuts=good.cuts[::-1])):
        forced = Forcing(HardOrders(PLATE, cuts, PROFILE))
        at = cuts.positions()
        kept = {(a, b) for of in asked(cuts).values() for a, b in of if at[a] < at[b]}
        runs = [
            set(run)
            for name, s in PROFILE.settings().items()
            if s.strength == "hard"
            for run in PROFILE.rulebook()[name].together(PLATE, s.options)
        ]
        for name in at:
            own = next((run for run in runs if name in run), {name})
            within = {name}
            while more := {a for a, b in kept if b in within and a in own} - within:
                within |= more
            reached = set(own)
            while (
                more := {c for a, b in kept if b in reached for c in next((run for run in runs if a in run), {a})}
                - reached
            ):
                reached |= more
            assert forced(name) == (within - {name}) | (reached - own)


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
    monkeypatch.setattr(hard_orders, "WORK_IN_ALL", 0.0)
    room = Room(NAMES, (), at)
    assert not room.none(orders)
    assert room.questions == 0
