"""A copy of a shipped file in a rule's place states and blames the same: every plan of small nests is tried."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.apps.authoring.trials import try_rules
from kerfwise.apps.authoring.trials.try_rules import Bench, rules_to_try
from kerfwise.rules.flat.model_rule import ModelRule
from kerfwise.rules.minizinc.twin import rule_file
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.registry import RULES
from kerfwise.rules.run_cases import cases_of
from kerfwise.tests.tools.amount import few

REPLACED = [name for name, rule in RULES.items() if not rule.takes_no_file]
ALWAYS = ("level-ahead", "marks-first")


@pytest.mark.slow
@pytest.mark.minizinc
@pytest.mark.parametrize("rule", few(sorted(REPLACED, key=lambda rule: rule not in ALWAYS), len(ALWAYS)))
def test_a_copy_is_judged_as_it_is_stated(rule: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(try_rules, "SEEDS", (1, 2))  # beside the nests of the rule's cases
    monkeypatch.setattr(try_rules, "WAYS_SEEDS", (5,))
    path = tmp_path / rule_file(rule).name
    path.write_text(rule_file(rule).read_text(encoding="utf-8"), encoding="utf-8")
    profile, _ = rules_to_try(load_profile(), [str(path)])
    bench = Bench(profile.known_rules()[rule], profile, cases_of(rule))
    assert isinstance(bench.rule, ModelRule)
    assert sum(len(trial.plans) for trial in bench.trials) > 500
    assert bench.orders() == ((), "")
