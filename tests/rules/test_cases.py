"""Every rule has cases, and every case gives the violations it says, to the letter."""

from __future__ import annotations

import inspect
from dataclasses import replace
from pathlib import Path

import pytest

from kerfwise.rule_kit import Case
from kerfwise.rules import catalogue
from kerfwise.rules.options.option import options_of
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import HEADINGS, OTHER_CUTS
from kerfwise.rules.run_cases import cases_of

ALL = [pytest.param(rule, case, id=f"{rule}: {case.name}") for rule in RULES for case in cases_of(rule)]


@pytest.mark.parametrize(("rule", "case"), ALL)
def test_violations(rule: str, case: Case) -> None:
    options = case.options or RULES[rule].Options()
    assert tuple(RULES[rule].violations(case.nest, case.cuts, options)) == case.violations


@pytest.mark.parametrize("rule", RULES)
def test_rule_has_a_case_of_each_kind(rule: str) -> None:
    its = cases_of(rule)
    assert {case.kind for case in its} == {"passes", "fails", "boundary"}
    assert all(case.violations for case in its if case.kind == "fails")
    assert not any(case.violations for case in its if case.kind == "passes")
    assert len({case.name for case in its}) == len(its)


BY_THEIR_DEFAULT = {
    "cut-direction": {"mark"},
    "heat-lag": {"heat_radius", "lag_cuts"},
    "locks": {"entry_tolerance"},
    "no-narrow-strips": {"strip", "strip_thicknesses"},
    "part-rigidity": {"rigid_min", "tail_share", "head_share", "head_rigid_max", "head_weight", "web"},
    "pierce": {"clearance", "splash"},
    "start-side": {"edge_band", "long_ratio", "offcut_share"},
    "t-max": {"dwells", "longest_dwell"},
    "zone-order": {"zone_contours", "square_ratio"},
}
"""Options that cases show by their default alone: most are thresholds that a case stands on. Add none."""


@pytest.mark.parametrize("rule", RULES)
def test_each_option_is_shown_by_a_case(rule: str) -> None:
    given = [case.options for case in cases_of(rule) if case.options is not None]
    unseen = {
        option.key
        for option in options_of(RULES[rule].Options)
        if all(getattr(options, option.name) == option.default for options in given)
    }
    file = f"rules/catalogue/{rule.replace('-', '_')}/cases.yaml"
    assert unseen == BY_THEIR_DEFAULT.get(rule, set()), f"{file}: no case gives these another value than their default"


@pytest.mark.parametrize("rule", RULES)
def test_a_rule_has_all_that_is_its_own_in_its_folder(rule: str) -> None:
    folder = Path(catalogue.__path__[0], rule.replace("-", "_"))
    files = {path.name for path in folder.iterdir() if path.is_file()}
    assert files >= {"__init__.py", "cases.yaml"}  # that there is a picture is a test of the docs
    own = {
        "no-narrow-strips": {"strips.py"},
        "scrap-last": {"skeleton.py"},
    }  # how it judges, and facts that it alone reads
    known = {"__init__.py", "cases.yaml", "model_data.py", "picture.svg"} | own.get(rule, set())
    assert {name for name in files if not name.endswith(".mzn")} <= known


def test_comparison_can_fail() -> None:
    case = next(case for case in cases_of("hull-before") if case.kind == "fails")
    found = tuple(RULES["hull-before"].violations(case.nest, case.cuts, RULES["hull-before"].Options()))
    assert found != (replace(case.violations[0], text="another text"),)
    assert found != (replace(case.violations[0], cuts=(2, 1)),)
    assert found != ()


@pytest.mark.parametrize("rule", RULES)
def test_docstring_has_its_headings(rule: str) -> None:
    page = inspect.getdoc(type(RULES[rule])) or ""
    assert page.splitlines()[0] == RULES[rule].sentence
    assert tuple(line.removeprefix("## ") for line in page.splitlines() if line.startswith("## ")) == HEADINGS
    sections = page.split("## ")[1:]
    assert all(len(section.splitlines()) > 2 for section in sections), "a heading without text"


@pytest.mark.parametrize("kind", ["Links", "Tabs", "Common cuts", "Scrap lines"])
@pytest.mark.parametrize("rule", RULES)
def test_page_says_what_the_rule_means_for_other_cuts(rule: str, kind: str) -> None:
    page = inspect.getdoc(type(RULES[rule])) or ""
    section = page.split(f"## {OTHER_CUTS}")[1].split("## ")[0]
    (said,) = (text for text in section.split("- **") if text.startswith(f"{kind}**:"))
    assert len(said.split()) > 3, f"say under '{OTHER_CUTS}' what {rule} means for {kind.lower()}"


@pytest.mark.parametrize("rule", RULES)
def test_empty_sequence_breaks_nothing(rule: str) -> None:
    case = cases_of(rule)[0]
    nothing = replace(case.cuts, cuts=())
    options = RULES[rule].Options()
    broken = RULES[rule].violations(case.nest, nothing, options)
    assert [v.rule for v in broken if rule != "start-side"] == []


UNJUDGED = {
    "level-ahead": "the side that cutting starts from is not stated",
    "start-side": "the side that cutting starts from is not stated",
    "zone-order": "the zones of the cuts are not stated",
}


@pytest.mark.parametrize("rule", RULES)
def test_what_cannot_be_judged_is_said(rule: str) -> None:
    case = cases_of(rule)[0]
    blind = replace(case.cuts, cuts=tuple(replace(cut, zone=0) for cut in case.cuts), start_side=None)
    seeing = replace(case.cuts, cuts=tuple(replace(cut, zone=1) for cut in case.cuts), start_side="left")
    options = RULES[rule].Options()
    assert RULES[rule].unjudged(case.nest, blind, options) == UNJUDGED.get(rule)
    assert RULES[rule].unjudged(case.nest, seeing, options) is None
