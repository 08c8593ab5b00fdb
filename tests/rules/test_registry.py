"""Rules are found by themselves, one a module, and no id is taken twice."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

import kerfwise
from kerfwise.rule_kit import NoOptions, Rule
from kerfwise.rules import catalogue
from kerfwise.rules.catalogue import hull_before
from kerfwise.rules.options.option import options_of
from kerfwise.rules.registry import RULES, catalogue_modules, collect


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


HOUSE = Path(kerfwise.__file__).parent
ABOVE = ("rules/catalogue/", "tests/", "benchmarks/", "examples/")
"""Rules themselves and their cases, and what chooses rules as a profile does: tests, benchmarks and examples."""
OTHER_HALF = "/model_data.py"
"""Of a rule: what its text in MiniZinc reads. It may know its own rule and no other."""
CATALOGUE = re.compile(r"(^|\.)rules\.catalogue(\.|$)|^catalogue(\.|$)")
PLAIN = {name for name in RULES if "-" not in name}
QUOTED = re.compile(rf"[\"']({'|'.join(PLAIN)})[\"']")
"""Ids that are words besides: `locks` is a key of profiles, `pierce` a place in plans, facts and pictures."""
IDS = re.compile(rf"(?<![\w-])({'|'.join(sorted(set(RULES) - PLAIN))})(?![\w-])|(?<=rules\.)({'|'.join(PLAIN)})\b")
ALLOWED = {
    "rules/registry.py": "it collects the catalogue",
    "rules/own/known_nest.py": "help text that says where a plant sets `long_ratio`",
    "encoder/candidates/entries.py": "what planners call options of leads: keys of a profile, in messages",
}
WORDS = {
    "locks": {
        "jobs/nest_job/job.py",
        "rules/case_file.py",
        "rules/profile/contradictions.py",
        "rules/profile/load.py",
        "rules/profile/schema.py",
        "rules/profile/profile_yaml.py",
        "rules/profile/values.py",
    },
    "pierce": {
        "jobs/display.py",
        "jobs/programs.py",
        "encoder/candidates/lead_errors.py",
        "encoder/facts/export.py",
        "models/plan/plan.py",
        "models/plan/read_plan.py",
        "postproc/check/feeds.py",
        "postproc/report/legend.py",
        "postproc/report/picture.py",
        "rules/case_words.py",
        "rules/own/demands.py",
    },
}
"""Where a word that is an id besides means the key or the place."""


def files() -> list[str]:
    found = (file.relative_to(HOUSE).as_posix() for file in HOUSE.rglob("*.py"))
    ours = (file for file in found if not file.startswith((".", "build/", "dist/")))  # `pip install .` leaves a build
    return sorted(file for file in ours if file.endswith(OTHER_HALF) or not file.startswith(ABOVE))


def named(text: str, file: str = "") -> Iterator[str]:
    """Imports of the catalogue and rule ids in code, with their lines; docstrings may speak of rules."""
    if not ("catalogue" in text or IDS.search(text) or QUOTED.search(text)):
        return  # most files: nothing is there to be told apart
    tree = ast.parse(text)
    spoken = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    own = _own_rule(file)
    for node in ast.walk(tree):
        match node:
            case ast.ImportFrom(module=str(module)) if CATALOGUE.search(module) and not (own and module.endswith(own)):
                yield f"{node.lineno}: import of {module}"
            case ast.ImportFrom(module=module) if any(alias.name == "catalogue" for alias in node.names):
                yield f"{node.lineno}: import of the catalogue from {module}"
            case ast.Import(names=names) if any(CATALOGUE.search(alias.name) for alias in names):
                yield f"{node.lineno}: import of the catalogue"
            case ast.Constant(value=str(value)) if id(node) not in spoken and not own:
                if (found := IDS.search(value)) or (value in PLAIN and file not in WORDS[value]):
                    yield f"{node.lineno}: the id {found[0] if found else value}"


def _own_rule(file: str) -> str | None:
    """The catalogue's module that this file is the other half of."""
    folder, _, name = file.rpartition("/")
    return folder.replace("/", ".") if f"/{name}" == OTHER_HALF else None


@pytest.mark.parametrize("file", [file for file in files() if file not in ALLOWED])
def test_no_rule_is_known_by_name(file: str) -> None:
    text = (HOUSE / file).read_text(encoding="utf-8")
    assert list(named(text, file)) == [], f"{file} knows a rule by name: give `Rule` a hook (rules/rule.py)"


def test_what_is_allowed_is_needed() -> None:
    for file in ALLOWED:
        assert list(named((HOUSE / file).read_text(encoding="utf-8"), file)) != [], file
    for word, where in WORDS.items():
        for file in where:
            assert re.search(f"[\"']{word}[\"']", (HOUSE / file).read_text(encoding="utf-8")), file


@pytest.mark.parametrize(
    "code",
    [
        'if "t-max" in settings: pass',
        'text = f"{x}: heat-lag asks for it"',
        'rules["pierce"]',
        "from kerfwise.rules.catalogue.pierce import Pierce",
        "from .catalogue.pierce import Pierce",
        "from kerfwise.rules import catalogue",
        "import kerfwise.rules.catalogue.locks",
    ],
)
def test_the_search_finds_one(code: str) -> None:
    assert list(named(code, "models/a.py")) != []


def test_the_search_lets_words_be() -> None:
    assert list(named('"""The rule heat-lag."""\nx = "a pierce near it"')) == []


def test_the_other_half_of_a_rule_may_know_it_and_no_other() -> None:
    one = "from kerfwise.rules.catalogue.heat_lag import HeatLagOptions"
    assert list(named(one, "rules/catalogue/heat_lag/model_data.py")) == []
    assert list(named(one, "rules/catalogue/locks/model_data.py")) != []
