"""A profile with one rule switched on or off."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.overrides import with_rule, without_rule
from kerfwise.rules.registry import RULES

OFF_BY_DEFAULT = next(name for name, rule in RULES.items() if rule.default == "off")
HARD = next(name for name, rule in RULES.items() if rule.default == "hard" and {"soft", "off"} <= set(rule.strengths))


@pytest.mark.parametrize("name", [name for name, rule in RULES.items() if "off" in rule.strengths])
def test_a_rule_that_is_off_is_not_among_the_settings(name: str) -> None:
    profile = load_profile()
    assert name not in without_rule(profile, name).settings()
    assert {n: s for n, s in profile.rules.items() if n != name}.items() <= without_rule(profile, name).rules.items()


def test_a_changed_profile_is_another_one() -> None:
    profile = load_profile()
    assert len({profile.sha256, without_rule(profile, HARD).sha256, with_rule(profile, HARD, "soft").sha256}) == 3


def test_a_soft_rule_has_its_weight() -> None:
    assert with_rule(load_profile(), HARD, "soft").settings()[HARD].weight == RULES[HARD].default_weight
    assert with_rule(load_profile(), HARD).settings()[HARD].weight is None


def test_a_rule_that_was_off_is_on() -> None:
    profile = load_profile()
    assert OFF_BY_DEFAULT not in profile.settings()
    assert OFF_BY_DEFAULT in with_rule(profile, OFF_BY_DEFAULT).settings()


def test_an_own_rule_is_switched_too(tmp_path: Path) -> None:
    file = tmp_path / "own.yaml"
    file.write_text("own_rules: [{name: b, select: {kind: hole}, before: {kind: outer}}]\n")
    profile = load_profile(file)
    assert "own:b" in profile.settings()
    assert "own:b" not in without_rule(profile, "own:b").settings()
    assert with_rule(profile, "own:b", "soft").settings()["own:b"].weight == 1000.0


def test_what_cannot_be() -> None:
    must = next(name for name, rule in RULES.items() if "soft" not in rule.strengths)
    with pytest.raises(InputError, match="cannot be soft: it can be"):
        with_rule(load_profile(), must, "soft")
    with pytest.raises(InputError, match="did you mean"):
        without_rule(load_profile(), HARD + "x")


def test_no_price_comes_near_an_excuse_from_a_hard_rule(tmp_path: Path) -> None:
    (tmp_path / "p.yaml").write_text("rules:\n  level-ahead: {strength: soft, weight: 100.1 m}\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"level-ahead\.weight.* no more than 100000 mm"):
        load_profile(tmp_path / "p.yaml")
