"""The shipped rules' model files, flattened, say what their Python statements say: one by one, none different."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from kerfwise import read_nest
from kerfwise.benchmarks.flattened import MOVES, counted
from kerfwise.encoder.facts.facts import Facts
from kerfwise.jobs.request import facts_of
from kerfwise.rules.flat.model_file import read_model_file
from kerfwise.rules.flat.model_rule import ModelRule
from kerfwise.rules.minizinc.twin import rule_file
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.registry import RULES
from kerfwise.rules.statements import Statement
from kerfwise.tests.models.engines.cases import case
from kerfwise.tests.tools.amount import few

pytestmark = pytest.mark.minizinc

NEST = Path(__file__).parents[3] / "examples" / "nests" / "e1x_6.dxf"

FLAT = [name for name in RULES if rule_file(name).exists() and name != MOVES]
SEEDS = (0, 1, 2, 3, 4, 5)


@cache
def asked(seed: int) -> tuple[Facts, Profile]:
    """A nest with its profile: made at random, or -1, one as it is cut."""
    if seed < 0:
        return facts_of(read_nest(NEST), load_profile()), load_profile()
    made = case(seed)
    return made.facts, made.profile


def stated(rule: str, seed: int) -> tuple[list[Statement], list[Statement]]:
    """What the file and what the Python of a rule state of a nest, as hard."""
    facts, profile = asked(seed)
    options = profile.settings()[rule].options if rule in profile.settings() else RULES[rule].Options()
    flat = ModelRule(read_model_file(rule_file(rule))).statements(facts, options)
    return list(flat), list(RULES[rule].statements(facts, options))


@pytest.mark.parametrize("rule", FLAT)
def test_the_same_statements(rule: str) -> None:
    flat, own = stated(rule, -1)
    assert counted(flat) == counted(own)
    assert all(f"{rule_file(rule).name}:" in statement.about.sentence for statement in flat)


@pytest.mark.slow
@pytest.mark.parametrize("rule", few(FLAT, 3))
def test_the_same_statements_under_other_options(rule: str) -> None:
    for seed in SEEDS:
        _, profile = asked(seed)
        if rule == "heat-lag" and rule in profile.settings() and profile.settings()[rule].options.lag_s > 0:
            continue  # seconds stand in a file of their own
        flat, own = stated(rule, seed)
        assert counted(flat) == counted(own), seed
