"""Rules are found by themselves, one a module, and no id is taken twice."""

from __future__ import annotations

from types import ModuleType

import pytest

from kerfwise.rules import catalogue
from kerfwise.rules.catalogue import hull_before
from kerfwise.rules.options.option import NoOptions, options_of
from kerfwise.rules.registry import RULES, catalogue_modules, collect
from kerfwise.rules.rule import Rule


def module_with(**members: object) -> ModuleType:
    module = ModuleType("plant_rules")
    vars(module).update(members)
    return module


def test_every_module_holds_one_rule_of_its_name() -> None:
    names = [m.__name__.removeprefix(f"{catalogue.__name__}.").replace("_", "-") for m in catalogue_modules()]
    assert names == list(RULES)


def test_new_module_is_a_new_rule() -> None:
    new = type("New", (hull_before.HullBefore,), {"id": "new", "__module__": "plant_rules"})
    assert list(collect([module_with(New=new)])) == ["new"]


def test_rule_that_is_only_imported_is_not_counted() -> None:
    assert collect([module_with(HullBefore=hull_before.HullBefore, Rule=Rule)]) == {}


def test_same_id_twice_is_an_error() -> None:
    twin = type("Twin", (hull_before.HullBefore,), {"__module__": "plant_rules"})
    with pytest.raises(ValueError, match=r"two rules have the id 'hull-before': .*hull_before, plant_rules"):
        collect([hull_before, module_with(Twin=twin)])


@pytest.mark.parametrize("rule", RULES.values(), ids=lambda rule: rule.id)
def test_metadata_is_complete(rule: Rule[object]) -> None:
    assert rule.sentence.endswith(".")
    assert rule.source
    assert rule.default in rule.strengths
    assert all(option.help for option in options_of(rule.Options))
    assert rule.Options is NoOptions or rule.Options() == rule.Options()


def test_only_the_two_order_rules_of_choice_give_way() -> None:
    ranks = {name: rule.gives_way for name, rule in RULES.items() if rule.gives_way}
    assert ranks == {"hull-before": 2, "level-ahead": 1}
