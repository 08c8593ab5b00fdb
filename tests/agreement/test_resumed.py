"""A few of the stopped nests that `many --stopped` tries, and that a wrong answer would be noticed."""

from __future__ import annotations

from math import inf

import pytest

from kerfwise.tests.agreement import resumed
from kerfwise.tests.agreement.engines import Answer
from kerfwise.tests.agreement.resumed import Going, resumed_agreement, stopped_case
from kerfwise.tests.tools.amount import few

SOLVED = (209, 203, 211, 213)
DEAR = 203
"""Seed of a nest that may be gone on with in ways of several prices."""


@pytest.mark.slow
@pytest.mark.minizinc
@pytest.mark.parametrize("seed", few(SOLVED[::-1]))
def test_every_engine_goes_on_as_the_best_of_all_ways(seed: int) -> None:
    found = resumed_agreement(seed)
    assert found.outcome == "solved"
    assert found.differ == ()
    assert {"default pipeline", "Gecode", "search", "cp-sat-alone"} <= set(found.engines)


def test_the_old_program_is_out_and_the_rest_is_left() -> None:
    case = stopped_case(SOLVED[0])
    assert case is not None
    facts = case.facts
    assert facts.already_cut
    assert {c.id for c in facts.nest.contours} == {c.id for c in facts.whole_nest.contours} - {
        cut.contour for cut in facts.already_cut
    }


def test_a_dearer_answer_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """An engine that goes on in the dearest lawful way there is."""
    case = stopped_case(DEAR)
    assert case is not None
    judge = Going(case, case.profile)
    least = judge.cheapest_mm()
    prices = {route: judge.price_mm(route) for route in judge.ways()}
    route, mm = max(((r, mm) for r, mm in prices.items() if mm < inf), key=lambda item: item[1])
    assert min(prices.values()) == pytest.approx(least)
    assert mm > least + 1
    monkeypatch.setattr(resumed, "_answers", lambda case, stated: [("dear", Answer("optimal", mm, route))])
    assert len(resumed_agreement(DEAR).differ) == 1
