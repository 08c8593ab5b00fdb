"""The shipped rules' model files, flattened, say what their Python statements say."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from kerfwise import read_nest
from kerfwise.encoder.facts.facts import Facts
from kerfwise.jobs.ask import facts_of
from kerfwise.rules.flat.model_file import read_model_file
from kerfwise.rules.flat.model_rule import ModelRule
from kerfwise.rules.minizinc.twin import rule_file
from kerfwise.rules.profile.profile import load_profile
from kerfwise.rules.statements import Precede

NEST = Path(__file__).parents[3] / "examples" / "nests" / "e1x_6.dxf"
PROFILE = load_profile()


@cache
def facts() -> Facts:
    return facts_of(read_nest(NEST), PROFILE)


@pytest.mark.minizinc
@pytest.mark.parametrize("rule", ["level-ahead", "inner-before-outer"])
def test_orders(rule: str) -> None:
    setting = PROFILE.settings()[rule]
    stated = list(ModelRule(read_model_file(rule_file(rule))).statements(facts(), setting.options))
    own = list(PROFILE.rulebook()[rule].statements(facts(), setting.options))

    def pairs(statements: list[object]) -> list[tuple[int, int]]:
        return sorted((s.before, s.after) for s in statements if isinstance(s, Precede))

    assert pairs(stated) == pairs(own) != []
    assert f"{rule.replace('-', '_')}.mzn:" in stated[0].about.sentence
