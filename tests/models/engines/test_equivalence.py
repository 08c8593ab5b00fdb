"""Every engine finds the same optimum, whichever way the rules are stated; the check has its say in tests/agreement."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from kerfwise.encoder.minizinc_data import Fields
from kerfwise.models.engines.minizinc_engine import solve_minizinc
from kerfwise.models.engines.minizinc_model import travel_um
from kerfwise.models.problem.compile import make_problem
from kerfwise.rules.catalogue.heat_lag import HeatLagOptions
from kerfwise.rules.catalogue.heat_lag.model_data import HeatLagTwin
from kerfwise.rules.minizinc import twin
from kerfwise.rules.registry import RULES
from kerfwise.rules.statements import About, IdleTravel
from kerfwise.rules.stating.state_rules import state_rules
from kerfwise.tests.agreement.orders import only
from kerfwise.tests.models.engines.agree import disagreements, optima
from kerfwise.tests.models.engines.cases import SIMULATED, case, drawn_case, profile_of
from kerfwise.tests.tools.amount import full

pytestmark = [pytest.mark.filterwarnings("ignore::minizinc.error.MiniZincWarning"), pytest.mark.minizinc]
SEEDS = range(36)
DRAWN = tuple(range(24))


THIRD = 3
"""One of this many seeds is tried always."""


def a_third(seeds: Iterable[int]) -> list[Any]:
    return [full(seed) if seed % THIRD else seed for seed in seeds]


@pytest.mark.parametrize("seed", a_third(SEEDS))
def test_the_engines_agree(seed: int) -> None:
    _, differ = disagreements(case(seed))
    assert differ == []


@pytest.mark.slow
@pytest.mark.parametrize("seed", a_third(DRAWN))
def test_the_engines_agree_whatever_the_options(seed: int) -> None:
    drawn = drawn_case(seed)
    assert drawn is not None, "choose another seed: a contour of this nest has no room for its leads"
    _, differ = disagreements(drawn)
    assert differ == []


def test_an_option_that_minizinc_ignores_makes_the_engines_differ(monkeypatch: pytest.MonkeyPatch) -> None:
    rightly = HeatLagTwin.data

    def ignoring(self: HeatLagTwin, case: twin.TwinCase, options: HeatLagOptions) -> Fields:
        return rightly(self, case, replace(options, heat_radius_mm=1.0))

    monkeypatch.setattr(HeatLagTwin, "data", ignoring)
    assert any(differ for seed in DRAWN if (drawn := drawn_case(seed)) for differ in disagreements(drawn)[1])


def test_the_seeds_have_every_rule_in_every_strength() -> None:
    profiles = [profile_of(seed) for seed in SEEDS]
    seen = {(name, setting.strength) for p in profiles for name, setting in p.rules.items()}
    stated = {(name, strength) for name, rule in RULES.items() for strength in rule.strengths if name != SIMULATED}
    assert seen >= stated
    assert any(p.locks for p in profiles)


def test_a_rule_told_the_wrong_way_round_is_noticed() -> None:
    drawn = case(0)
    profile = only(drawn.profile, "level-ahead")
    stated = state_rules(drawn.facts, profile)
    wrong = replace(drawn.facts, level_ahead=drawn.facts.level_ahead[:, ::-1])
    problem = make_problem(drawn.facts, stated.statements, drawn.options.home_mm)
    found = solve_minizinc(wrong, profile, stated, drawn.options)
    assert round(found.objective * 1000) not in optima(problem).values()


def test_moves_cost_what_they_cost_elsewhere() -> None:
    drawn = case(2)
    profile = only(drawn.profile, "inner-before-outer")
    statements = (*state_rules(drawn.facts, profile).statements, IdleTravel(About("test", (), ""), 0.37))
    problem = make_problem(drawn.facts, statements, drawn.options.home_mm)
    travel = travel_um(drawn.facts, problem.travel_weight, drawn.options.home_mm)
    sites = problem.site_candidate + 1
    assert (travel[np.ix_(sites, sites)] == problem.travel(range(problem.m), range(problem.m))).all()
    assert (travel[0, sites] == problem.travel([problem.m], range(problem.m))[0]).all()
    assert (travel[sites, 0] == problem.travel(range(problem.m), [problem.m])[:, 0]).all()
