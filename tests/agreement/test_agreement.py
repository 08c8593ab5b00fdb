"""A few of the nests that `many` tries by the hundred, and that a wrong engine or a wrong rule would be noticed."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from math import inf
from typing import Any

import numpy as np
import pytest

from kerfwise.rules.catalogue.heat_lag import HeatLag
from kerfwise.rules.catalogue.heat_lag.model_data import HeatLagTwin
from kerfwise.rules.registry import RULES
from kerfwise.rules.stating.state_rules import state_rules
from kerfwise.tests.agreement.agree import agreement
from kerfwise.tests.agreement.by_check import Judge
from kerfwise.tests.agreement.cases import judged_case, kind_of
from kerfwise.tests.agreement.engines import gecode
from kerfwise.tests.agreement.many import Gone, Tally
from kerfwise.tests.agreement.orders import (
    ORDER_RULES,
    admitted_by_check,
    admitted_by_statements,
    only,
    order_disagreements,
)
from kerfwise.tests.agreement.trial import Trial
from kerfwise.tests.tools.amount import few, full

SEEDS = (3, 5, 6, 7, 13, 18, 20)
ONCE_WRONG = {
    9: "strips between parts that the last one cut does not touch",
    1: "a part that hangs on the frame by exactly the share asked",
    111: "a stricter share leaves a cluster on no frame, which asks less",
}
"""Seeds of nests on which the two sides once differed, and over what."""
IGNORED = 0
"""Seed of a nest with drawn options on which it matters how many cuts heat-lag asks for."""
SLOW = {1, 5, 7, 111}
"""Seeds that take some seconds."""
VERY_SLOW = {3, 6, 7, 9, 13}
BY_SEED = [
    full(k) if k in VERY_SLOW else pytest.param(k, marks=[pytest.mark.slow] if k in SLOW else [])
    for k in (*SEEDS, *ONCE_WRONG)
]


@pytest.mark.slow
@pytest.mark.minizinc
@pytest.mark.parametrize("seed", BY_SEED)
def test_the_engines_and_the_check_agree(seed: int) -> None:
    found = agreement(seed)
    assert found.outcome in ("solved", "infeasible")
    assert found.differ == ()


@pytest.mark.slow
@pytest.mark.minizinc
@pytest.mark.parametrize("seed", few([0, 8, 2, 4, 12]))
def test_they_agree_on_nests_with_slits(seed: int) -> None:
    assert any(c.kind == "slit" for c in judged_case(seed, "slits").facts.nest.contours)
    found = agreement(seed, "slits")
    assert found.outcome in ("solved", "infeasible")
    assert found.differ == ()


@pytest.mark.slow
@pytest.mark.minizinc
@pytest.mark.parametrize("seed", few([0, 5, 7, 2, 4, 6]))
def test_they_agree_on_nests_with_links(seed: int) -> None:
    found = agreement(seed, "links")
    assert found.outcome in ("solved", "infeasible")
    assert found.differ == ()


def test_links_are_offered_and_taken() -> None:
    judge = Judge(Trial.of(judged_case(5, "links")), frozenset())
    assert judge.trial.taken
    without = Judge(replace(judge.trial, links={}), frozenset()).cheapest_mm()
    least = judge.cheapest_mm()
    assert least is not None
    assert without is not None
    assert least < without


@pytest.mark.minizinc
@pytest.mark.parametrize("seed", few([2, 6, 1, 3, 4, 5, 7]))
def test_they_agree_on_nests_with_scrap_lines(seed: int) -> None:
    assert judged_case(seed, "scrap").facts.nest.scrap
    found = agreement(seed, "scrap")
    assert found.outcome in ("solved", "infeasible")
    assert found.differ == ()


@pytest.mark.slow
@pytest.mark.minizinc
@pytest.mark.parametrize("seed", few([8, 5, 11]))
def test_they_agree_on_nests_with_common_edges(seed: int) -> None:
    assert any(cut.span is not None for own in Trial.of(judged_case(seed, "common")).ways for cut in own)
    found = agreement(seed, "common")
    assert found.outcome == "solved"
    assert found.differ == ()


def test_a_way_along_a_stretch_suits_what_is_out_and_nothing_else() -> None:
    stretches = Trial.of(judged_case(11, "common")).stretches
    assert stretches is not None
    for contour, ways in enumerate(stretches.ways):
        states = [frozenset(out) for k in range(4) for out in combinations(sorted(stretches.beside[contour]), k)]
        for way, cut in enumerate(ways):
            suited = [out for out in states if stretches.open(contour, way, sorted(out))]
            assert suited == [frozenset()] if cut.span is None else len(suited) == 1 and suited[0]


def test_of_eight_nests_two_have_links_two_scrap_lines_and_one_common_edges() -> None:
    assert [kind_of(seed) for seed in range(5)] == ["plain", "links", "plain", "scrap", "common"]


@pytest.mark.minizinc
@pytest.mark.parametrize("seed", few([2, 0, 4, 10]))
def test_they_agree_whatever_the_options(seed: int) -> None:
    """Each option of each rule is drawn from what it declares: a new one is drawn by itself."""
    found = agreement(seed, "options")
    assert found.outcome in ("solved", "infeasible")
    assert found.differ == ()


SIDES: dict[str, tuple[type, str]] = {
    "all engines but MiniZinc": (HeatLag, "statements"),
    "MiniZinc": (HeatLagTwin, "data"),
    "the check": (HeatLag, "violations"),
}
"""Who may ignore an option → the function of heat-lag that hands its options on."""


@pytest.mark.slow
@pytest.mark.minizinc
@pytest.mark.parametrize("side", few(SIDES))
def test_an_option_that_one_side_ignores_is_noticed(side: str, monkeypatch: pytest.MonkeyPatch) -> None:
    owner, name = SIDES[side]
    rightly = getattr(owner, name)
    case = judged_case(IGNORED, "options")
    assert case.profile.rules["heat-lag"].strength != "off"
    assert case.profile.rules["heat-lag"].options.lag_cuts > 1
    assert order_disagreements(case.facts.nest, case.profile) == []

    def ignoring(self: object, *given: Any) -> Any:
        return rightly(self, *given[:-1], replace(given[-1], lag_cuts=1))

    monkeypatch.setattr(owner, name, ignoring)
    (found,) = order_disagreements(case.facts.nest, case.profile)
    assert found.startswith("heat-lag admits")


@pytest.mark.full
def test_the_cases_are_of_every_size_and_every_rule() -> None:
    cases = [judged_case(seed) for seed in range(30)]
    assert {case.facts.n for case in cases} == {5, 6, 7, 8, 9}
    hard = {name for case in cases for name, setting in case.profile.rules.items() if setting.strength == "hard"}
    assert hard == set(RULES) - {"t-max"}, "temperatures are simulated, not stated"
    soft = {name for case in cases for name, setting in case.profile.rules.items() if setting.strength == "soft"}
    assert soft >= {name for name, rule in RULES.items() if "soft" in rule.strengths} - {"no-narrow-strips"}
    assert any(case.profile.locks for case in cases)


@pytest.mark.minizinc
def test_a_lost_statement_is_noticed() -> None:
    """Without level-ahead an engine finds a plan that is cheaper than any the check lets pass."""
    case = judged_case(15)
    profile = only(case.profile, "inner-before-outer", "level-ahead")
    stated = state_rules(case.facts, profile)
    kept = tuple(s for s in stated.statements if s.about.rule != "level-ahead")
    lost = gecode(replace(case, profile=only(case.profile, "inner-before-outer")), replace(stated, statements=kept))
    cheapest = Judge(replace(Trial.of(case), profile=profile), frozenset()).cheapest_mm()
    assert cheapest is not None
    assert lost.mm is not None
    assert lost.mm < cheapest - 10  # engines that agree do so to 0.01 mm


@pytest.mark.slow
def test_no_plan_drawn_at_random_is_cheaper_than_the_cheapest() -> None:
    case = judged_case(15)
    judge = Judge(Trial.of(case), frozenset())
    least = judge.cheapest_mm()
    assert least is not None
    rng = np.random.default_rng(1)
    prices = []
    for _ in range(300):
        picks = [int(rng.integers(len(own))) for own in judge.trial.ways]
        prices.append(judge.price_mm(tuple(rng.permutation(case.facts.n).tolist()), picks))
    assert least - 1e-6 <= min(prices) < inf


def test_a_rule_told_the_wrong_way_round_is_noticed() -> None:
    case = judged_case(15)
    profile = only(case.profile, *ORDER_RULES)
    turned = replace(case.facts, level_ahead=case.facts.level_ahead[:, ::-1])
    check = admitted_by_check(case.facts, profile, "level-ahead")
    assert check == admitted_by_statements(case.facts, profile, "level-ahead")
    assert check != admitted_by_statements(turned, profile, "level-ahead")


def test_stopped_before_the_first_nest_no_seeds_are_told() -> None:
    lines = list(Tally(282).lines())
    assert lines[:2] == ["nests tried: 0", "solved: 0, proven infeasible: 0, unproven: 0"]
    assert lines[2].endswith("by the check: none")
    assert next(Gone(282).lines()) == "nests stopped: 0"
