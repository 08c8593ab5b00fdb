"""The rule files: one for every rule that states anything, and each written out in the model."""

from __future__ import annotations

import re

import pytest

from kerfwise.models.engines.minizinc_model import condition_arrays, conditions, model_text
from kerfwise.rules.minizinc.twin import rule_file
from kerfwise.rules.registry import RULES
from kerfwise.rules.statements import About, AtLeast, Before, Contiguous, Forbid, Lag, NoGood, Pick, Precede, Statement
from kerfwise.rules.stating.state_rules import Stated
from kerfwise.tests.models.engines.cases import profile_of

AFTERWARDS = {"no-narrow-strips", "t-max"}
"""Rules that state nothing beforehand: geometry, or a simulation, adds to a finished order what they ask."""
ABOUT = About("own:mine", (), "")


def test_every_rule_has_its_file() -> None:
    assert {rule for rule in RULES if not rule_file(rule).exists()} == AFTERWARDS


@pytest.mark.parametrize("rule", sorted(set(RULES) - AFTERWARDS))
def test_a_file_names_its_rule_its_statements_and_every_parameter(rule: str) -> None:
    text = rule_file(rule).read_text(encoding="utf-8")
    name = rule.replace("-", "_")
    assert text.startswith(f"% {rule}: ")
    assert re.search(rf"^array\[int\] of var bool: {name}_holds =", text, re.MULTILINE)
    parameters = re.findall(r"^(?:int|bool|array\[[^\n]*?\] of|set of)[^%=\n]*;.*$", text, re.MULTILINE)
    assert [line for line in parameters if "%" not in line] == []


def test_strengths_become_constraints_and_prices() -> None:
    profile = profile_of(2)
    text = model_text(condition_arrays(profile, Stated((), ())))
    for rule, setting in profile.rules.items():
        name = f"{rule.replace('-', '_')}_holds"
        if setting.strength == "off" or rule in AFTERWARDS:
            assert f"{name})" not in text
        elif setting.weight is not None:
            assert f"{round(setting.weight * 1000)} * breaches({name})" in text
        elif rule != "part-rigidity":
            assert f"constraint forall({name});" in text


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        (Precede(0, 4, ABOUT), ["before(1, 5)"]),
        (Forbid(2, ABOUT), ["not picked(3)"]),
        (
            AtLeast((Before(0, 1), Pick(4)), (2, -1), 1, ABOUT, when=3),
            ["picked(4) -> 2 * bool2int(before(1, 2)) + -1 * bool2int(picked(5)) >= 1"],
        ),
        (AtLeast((), (), 0, ABOUT), ["0 >= 0"]),
        (
            Contiguous((0, 1), ABOUT),
            [
                "forall(j in {2})(before(1, j)) \\/ exists(j in {2})(directly_before(j, 1))",
                "forall(j in {1})(before(2, j)) \\/ exists(j in {1})(directly_before(j, 2))",
            ],
        ),
        (Lag(0, 1, ABOUT, cuts=2), ["cuts_between(1, 2) >= 1", "cuts_between(1, 2) >= 2"]),
        (NoGood(frozenset({0}), frozenset({2, 1}), ABOUT), ["exists(i in {2, 3}, j in {1})(before(i, j))"]),
    ],
    ids=lambda value: type(value).__name__,
)
def test_statements_in_words(statement: Statement, words: list[str]) -> None:
    assert conditions(statement) == words
