"""Orders that give way to cycles and to positions are chosen together: no fewer would do, every order tried."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from kerfwise import RulesConflict
from kerfwise.rule_kit import About, AtLeast, Before, Contiguous, Precede, Statement
from kerfwise.rules.stating import feasible_order
from kerfwise.rules.stating import state_rules as stating
from kerfwise.rules.stating.feasible_order import likely_order
from kerfwise.rules.stating.state_rules import resolve
from kerfwise.tests.tools.amount import examples

N = 5
GIVES_WAY = {"level-ahead": 1, "hull-before": 2, "inner-before-outer": 0, "locks": 0, "part-contiguous": 0}


@dataclass(frozen=True)
class Asked:
    """Orders by rule, contours locked at positions from 1 on, and contours cut in one go."""

    orders: tuple[tuple[str, int, int], ...]
    at: tuple[tuple[int, int], ...]
    run: tuple[int, ...]

    def statements(self) -> list[Statement]:
        made: list[Statement] = [
            Precede(i, j, About(rule, (str(i), str(j)), f"{i} before {j} by {rule}")) for rule, i, j in self.orders
        ]
        for k, place in self.at:
            about = About("locks", (str(k),), f"{k} at {place}")
            others = [other for other in range(N) if other != k]
            made.append(AtLeast(tuple(Before(o, k) for o in others), (1,) * (N - 1), place - 1, about))
            made.append(AtLeast(tuple(Before(k, o) for o in others), (1,) * (N - 1), N - place, about))
        if self.run:
            made.append(Contiguous(self.run, About("part-contiguous", (), "in one go")))
        return made

    def least(self) -> tuple[int, int] | None:
        """How many orders of level-ahead, then of hull-before, must be broken at the least; None if no order does."""
        return min(filter(None, map(self._broken, permutations(range(N)))), default=None)

    def _broken(self, order: tuple[int, ...]) -> tuple[int, int] | None:
        place = {k: m for m, k in enumerate(order, 1)}
        wrong = [rule for rule, i, j in self.orders if place[i] > place[j]]
        span = [place[k] for k in self.run]
        together = not span or max(span) - min(span) < len(span)
        if "inner-before-outer" in wrong or not together or any(place[k] != at for k, at in self.at):
            return None
        return wrong.count("level-ahead"), wrong.count("hull-before")


def dropped(asked: Asked) -> tuple[int, int]:
    rules = [d.rule for d in resolve(asked.statements(), N, GIVES_WAY).dropped]
    return rules.count("level-ahead"), rules.count("hull-before")


@st.composite
def asked(draw: st.DrawFn) -> Asked:
    contour = st.integers(0, N - 1)
    rule = st.sampled_from(["level-ahead", "level-ahead", "hull-before", "hull-before", "inner-before-outer"])
    pairs = draw(
        st.lists(st.tuples(contour, contour).filter(lambda p: p[0] != p[1]), min_size=3, max_size=9, unique=True)
    )
    orders = tuple((draw(rule), i, j) for i, j in pairs)
    locked = draw(st.lists(contour, min_size=1, max_size=2, unique=True))
    places = draw(st.lists(st.integers(1, N), min_size=len(locked), max_size=len(locked), unique=True))
    run = draw(st.one_of(st.just(()), st.lists(contour, min_size=2, max_size=3, unique=True).map(tuple)))
    return Asked(orders, tuple(zip(locked, places, strict=True)), run)


TWO_STEPS = Asked(
    (("level-ahead", 0, 1), ("level-ahead", 1, 0), ("level-ahead", 1, 2), ("level-ahead", 3, 0), ("level-ahead", 4, 1)),
    ((1, 1),), (),
)  # fmt: skip


def test_what_is_out_of_place_may_break_a_cycle_too() -> None:
    """1 is locked to the first place: what must come before it goes anyway, and breaks the cycle of 0 and 1."""
    assert dropped(TWO_STEPS) == TWO_STEPS.least() == (2, 0)


TORN_TWICE = Asked((("level-ahead", 0, 1), ("level-ahead", 0, 2), ("level-ahead", 3, 0)), ((0, 2), (2, 4)), (2, 3, 0))


def test_nothing_comes_between_two_positions_that_one_run_has() -> None:
    """0 and 2 are second and fourth, 3 is cut in one go with them: so 3 is third, behind 0."""
    assert dropped(TORN_TWICE) == TORN_TWICE.least() == (1, 0)


@pytest.mark.slow
@examples(100)
@given(asked())
def test_no_fewer_would_do(asked: Asked) -> None:
    least = asked.least()
    assume(least is not None)
    assert dropped(asked) == least


def test_where_it_takes_too_long_it_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stating, "MOST_ROUNDS", 0)
    one = Asked((("level-ahead", 0, 1), ("level-ahead", 1, 0), ("level-ahead", 3, 2)), ((2, 1),), ())
    whys = [d.why for d in resolve(one.statements(), N, GIVES_WAY).dropped]
    assert sum(why.endswith("whether others would be fewer was not shown") for why in whys) == 1


def test_positions_alone_are_cut_short_and_said_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """With next to no work there is no proof: what is dropped says so, or nothing is and the contradiction is told."""
    one = Asked((("level-ahead", 0, 1), ("level-ahead", 3, 1), ("level-ahead", 2, 4)), ((1, 1), (4, 2)), ())
    assert not any(stating.NOT_SHOWN in d.why for d in resolve(one.statements(), N, GIVES_WAY).dropped)
    monkeypatch.setattr(feasible_order, "WORK", 1e-9)
    assert all(stating.NOT_SHOWN in d.why for d in resolve(one.statements(), N, GIVES_WAY).dropped)


def test_a_contradiction_that_nothing_mends_stays_one() -> None:
    firm = Asked((("inner-before-outer", 0, 1), ("inner-before-outer", 1, 0)), ((2, 1),), ())
    with pytest.raises(RulesConflict):
        resolve(firm.statements(), N, GIVES_WAY)


MANY = 5
PAIRS = st.lists(
    st.tuples(st.integers(0, MANY - 1), st.integers(0, MANY - 1)).filter(lambda p: p[0] != p[1]),
    max_size=5,
)
PLACES = st.dictionaries(st.integers(0, MANY - 1), st.integers(0, MANY - 1), max_size=3)


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

    found = likely_order(MANY, orders, earliest, latest)
    straight = any(all(place[i] < place[j] for i, j in orders) for place in permutations(range(MANY)))
    assert (found is not None) == straight
    if found is not None:
        assert sorted(found) == list(range(MANY))
        assert kept(found) == any(map(kept, permutations(range(MANY))))
