"""Every engine finds the same optimum, and every order rule admits the same orders, whichever way it is stated."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from minizinc import Instance

from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.facts import FactOptions, compute_facts
from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.minizinc import solve_minizinc
from kerfwise.models.minizinc.asked import asked
from kerfwise.models.minizinc.data import data_text, travel_um
from kerfwise.models.minizinc.installation import driver, solver_named
from kerfwise.models.minizinc.model_text import model_text
from kerfwise.models.problem import make_problem
from kerfwise.models.solution import SolveOptions
from kerfwise.rules.profile import Profile, load_profile
from kerfwise.rules.registry import RULES
from kerfwise.rules.sections import RuleSetting
from kerfwise.rules.state import Stated, state_rules
from kerfwise.rules.statements import About, IdleTravel
from kerfwise.tests.models.minizinc.agree import disagreements, optima
from kerfwise.tests.models.minizinc.cases import case, profile_of, random_nest
from kerfwise.tests.rules.case import cut

pytestmark = pytest.mark.filterwarnings("ignore::minizinc.error.MiniZincWarning")
SEEDS = range(36)
ORDER_RULES = (
    "inner-before-outer",
    "nested-before-host-holes",
    "part-contiguous",
    "level-ahead",
    "hull-before",
    "zone-order",
    "marks-first",
)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_engines_agree(seed: int) -> None:
    _, differ = disagreements(case(seed))
    assert differ == []


def test_the_seeds_have_every_rule_in_every_strength() -> None:
    profiles = [profile_of(seed) for seed in SEEDS]
    seen = {(name, setting.strength) for p in profiles for name, setting in p.rules.items()}
    assert seen >= {(name, strength) for name, rule in RULES.items() for strength in rule.strengths}
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


@pytest.mark.parametrize("seed", range(8))
def test_the_same_orders_are_admitted(seed: int) -> None:
    drawn = random_nest(np.random.default_rng(seed), 6)
    profile = only(load_profile(), *ORDER_RULES)
    leads = replace(profile.lead_options(), entries=1, directions={"outer": ("cw",), "hole": ("cw",), "mark": ("cw",)})
    facts = compute_facts(drawn, FactOptions(zone_contours=2), build_candidates(drawn, leads))
    verdicts = judged_by_gecode(facts, profile)
    assert sorted(verdicts) == list(permutations(range(facts.n)))
    cuts = [cut(drawn, c.id, zone=int(facts.zone[k])) for k, c in enumerate(drawn.contours)]
    for order, verdict in verdicts.items():
        sequence = CutSequence(tuple(cuts[k] for k in order), facts.start_side)
        for rule in ORDER_RULES:
            holds = not RULES[rule].violations(drawn, sequence, profile.rules[rule].options)
            assert verdict[rule] == holds, (rule, order)


def judged_by_gecode(facts: Facts, profile: Profile) -> dict[tuple[int, ...], dict[str, bool]]:
    """Every order of the contours, as Gecode enumerates them, with what it makes of each rule."""
    stated = Stated((IdleTravel(About("test", (), "")),), ())
    arrays = asked(profile, stated)
    names = {rule: f"{rule.replace('-', '_')}_holds" for rule in ORDER_RULES}
    assert set(names.values()) <= {a.name for a in arrays}
    free = [replace(a, weight_mm=0.0) for a in arrays]
    verdicts = [f"constraint verdict[{k}] = forall({name});" for k, name in enumerate(names.values(), 1)]
    goal = [f"array[1..{len(names)}] of var bool: verdict :: add_to_output;", *verdicts, "solve satisfy;"]
    instance = Instance(solver_named("gecode"), driver=driver())
    instance.add_string(
        model_text(free, "\n".join(goal)) + data_text(facts, profile, stated, SolveOptions(), clock=False)
    )
    found = instance.solve(all_solutions=True)
    return {
        tuple(facts.candidates[c - 1].contour for c in solution.stop if c > 0): dict(
            zip(names, solution.verdict, strict=True)
        )
        for solution in found.solution
    }


def only(profile: Profile, *rules: str) -> Profile:
    """The profile with these rules hard and all others off, without locks."""
    settings = {
        name: RuleSetting("hard" if name in rules else "off", None, setting.options)
        for name, setting in profile.rules.items()
    }
    return replace(profile, rules=settings, locks=())
