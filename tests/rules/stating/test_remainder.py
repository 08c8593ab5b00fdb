"""Statements about a whole nest, once some of it is cut: every order that goes on is tried, for random statements."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.rules.statements import (
    About,
    AtLeast,
    Before,
    Contiguous,
    Crossing,
    Forbid,
    IdleTravel,
    Lag,
    NoGood,
    Pick,
    Precede,
    Statement,
)
from kerfwise.rules.stating.reduced_statements import OUT, Remainder, remaining_statements
from kerfwise.tests.tools.amount import examples

N = 5
ABOUT = About("r", (), "")
CONTOUR_OF = (0, 1, 2, 2, 3, 3, 4)
"""Two candidates of contours 2 and 3, one of the others."""


def holds(s: Statement, order: Sequence[int], picked: frozenset[int]) -> bool:
    """Whether a statement holds of a whole order, by its own words."""
    at = {contour: k for k, contour in enumerate(order)}
    match s:
        case Precede():
            return at[s.before] < at[s.after]
        case Forbid():
            return s.candidate not in picked
        case AtLeast():
            true = (at[lit.i] < at[lit.j] if isinstance(lit, Before) else lit.c in picked for lit in s.literals)
            total = sum(w for w, t in zip(s.weights, true, strict=True) if t)
            return total >= s.bound or (s.when is not None and s.when not in picked)
        case Contiguous():
            places = sorted(at[k] for k in s.contours)
            return places[-1] - places[0] == len(places) - 1
        case Lag():
            return abs(at[s.first] - at[s.second]) > s.cuts
        case NoGood():
            return min(at[k] for k in s.left) < max(at[k] for k in s.out)
        case _:
            raise AssertionError(s)


def picks() -> list[frozenset[int]]:
    return [frozenset({0, 1, a, b, 6}) for a in (2, 3) for b in (4, 5)]


contours = st.integers(0, N - 1)
pairs = st.lists(contours, min_size=2, max_size=2, unique=True)
literals = st.one_of(pairs.map(lambda p: Before(*p)), st.integers(2, 5).map(Pick))


@st.composite
def at_leasts(draw: st.DrawFn) -> AtLeast:
    chosen = draw(st.lists(literals, max_size=4, unique=True))
    weights = draw(st.lists(st.sampled_from((-2, -1, 1, 2)), min_size=len(chosen), max_size=len(chosen)))
    when = draw(st.one_of(st.none(), st.integers(2, 5)))
    return AtLeast(tuple(chosen), tuple(weights), draw(st.integers(-2, 4)), ABOUT, when)


sets = st.lists(contours, min_size=2, max_size=N, unique=True).flatmap(
    lambda chosen: st.integers(1, len(chosen) - 1).map(
        lambda k: NoGood(frozenset(chosen[:k]), frozenset(chosen[k:]), ABOUT)
    )
)
statements = st.one_of(pairs.map(lambda p: Precede(*p, ABOUT)), at_leasts(), sets)


@pytest.mark.slow
@examples(400)
@given(statements, st.permutations(range(2)), st.integers(1, 2))
def test_what_is_left_asks_what_the_whole_does(s: Statement, order: list[int], made: int) -> None:
    """Contours 0 and 1 may be out; their only candidates are named by nobody, as what is out offers none."""
    out = order[:made]
    left = [k for k in range(N) if k not in out]
    number = [left.index(k) if k in left else OUT for k in range(N)]
    reduced = list(remaining_statements([s], Remainder(number, {k: at for at, k in enumerate(out, 1)})))
    told = []
    for rest in permutations(left):
        for picked in picks():
            whole = holds(s, (*out, *rest), picked)
            of_rest = all(holds(r, [number[k] for k in rest], picked) for r in reduced)
            told.append((whole, of_rest))
    too_late = not any(whole for whole, _ in told)
    assert all(whole == of_rest for whole, of_rest in told) or (too_late and all(of_rest for _, of_rest in told))


def test_what_the_past_says_nothing_of_any_more() -> None:
    rest = Remainder([OUT, 0, 1], {0: 1})
    assert not list(remaining_statements([Lag(0, 1, ABOUT, cuts=2), Contiguous((0, 2), ABOUT)], rest))
    assert list(remaining_statements([Contiguous((0, 1, 2), ABOUT)], rest)) == [Contiguous((0, 1), ABOUT)]
    assert list(remaining_statements([Lag(1, 2, ABOUT, seconds=3.0)], rest)) == [Lag(0, 1, ABOUT, seconds=3.0)]


def test_travel_over_what_is_out_stays_asked() -> None:
    rest = Remainder([OUT, 0, 1], {0: 1})
    area = shapely.box(0, 0, 1, 1)
    asked = [Crossing(0, area, ABOUT), Crossing(2, area, ABOUT), IdleTravel(ABOUT)]
    assert [getattr(s, "over", "travel") for s in remaining_statements(asked, rest)] == [None, 1, "travel"]


def test_a_lock_on_a_place_that_is_gone_is_still_told() -> None:
    """With no literal known the statement is as it was: whoever asked for what cannot be is to hear of it."""
    s = AtLeast((Before(1, 2),), (1,), 2, ABOUT)
    assert list(remaining_statements([s], Remainder([OUT, 0, 1], {0: 1}))) == [AtLeast((Before(0, 1),), (1,), 2, ABOUT)]


def test_an_unknown_statement_is_not_passed_over() -> None:
    with pytest.raises(AssertionError):
        list(remaining_statements([object()], Remainder([0], {})))  # type: ignore[list-item]
