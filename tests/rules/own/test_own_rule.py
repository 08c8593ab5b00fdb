"""Own rules as they are read: every mistake with its place and the nearest name, every value written back."""

from __future__ import annotations

import jsonschema
import pytest
import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.rules.own.criteria import NumberSpan
from kerfwise.rules.own.selector import Selector
from kerfwise.rules.profile.schema import profile_schema
from kerfwise.tests.rules.own.made import rules_of
from kerfwise.tests.rules.own.test_agree import RULES, WAYS

NUMBER = "a number of mm such as 6, '< 6', '>= 6', '!= 6' or 2..6, or a list of them"
COUNT = NUMBER.replace(" of mm", "")
PLACES = "bottom_gap_mm, edge_gap_mm, left_gap_mm, right_gap_mm, top_gap_mm, x_mm, y_mm"
MISTAKES = {
    "- 3": "1:3: own_rules[1]: expected a mapping (key: value), got '3'",
    "- {name: r, select: {}}": "1:3: own_rules[1]: nothing is asked: give one of before, after, first, last, not_first",
    "- {first: true}": "1:3: own_rules[1]: give the rule a name",
    "- {name: r, firs: true}": "1:13: own_rules[1]: unknown key 'firs': did you mean 'first'?",
    "- {name: r, first: true, last: true}": "1:26: own_rules[1]: a rule asks one thing, this one asks first and last;",
    "- {name: r, first: false}": "1:20: own_rules[1].first: expected true; leave the key out to ask nothing",
    "- {name: r, first: soon}": "1:20: own_rules[1].first: expected true or false, got 'soon'",
    "- {name: r, first: true, weight: 5}": "1:34: own_rules[1].weight: only a soft rule has a weight, this one is hard",
    "- {name: r, first: true, strength: firm}": (
        "1:36: own_rules[1].strength: expected one of hard, soft, off, got 'firm'"
    ),
    "- {name: r, first: true, scope: part-wise}": (
        "1:33: own_rules[1].scope: expected sheet, part, zone or attribute.<name>, got 'part-wise'"
    ),
    "- {name: r, first: true}\n- {name: r, last: true}": (
        "2:3: own_rules[2]: the name 'r' is taken by an own rule before it"
    ),
    "- {name: r, first: true, select: all}": (
        "1:34: own_rules[1].select: expected a selector such as {kind: hole, area_mm2: '< 100'}, got 'all'"
    ),
    "- {name: r, first: true, select: {widht_mm: 3}}": (
        "1:35: own_rules[1].select: unknown fact 'widht_mm': did you mean 'width_mm'?"
    ),
    "- {name: r, first: true, select: {not: {deep: 3}}}": (
        "1:41: own_rules[1].select.not: unknown fact 'deep': did you mean 'depth'?"
    ),
    "- {name: r, first: true, select: {kind: holes}}": (
        "1:41: own_rules[1].select.kind: expected one of outer, hole, mark, slit, scrap, got 'holes': did you mean "
        "'hole'?"
    ),
    "- {name: r, first: true, select: {width_mm: wide}}": f"1:45: own_rules[1].select.width_mm: expected {NUMBER}, got",
    "- {name: r, first: true, select: {depth: '< '}}": f"1:42: own_rules[1].select.depth: expected {COUNT}, got '< '",
    "- {name: r, first: true, select: {depth: 3..1}}": (
        "1:42: own_rules[1].select.depth: '3..1' is empty: write the smaller number first"
    ),
    "- {name: r, first: true, select: {long: 4}}": "1:41: own_rules[1].select.long: expected true or false, got '4'",
    "- {name: r, before: {attribut.load: 1}}": (
        "1:22: own_rules[1].before: unknown fact 'attribut.load': did you mean 'attribute.load'?"
    ),
    "- {name: r, before: {zoen: 1}}": "1:22: own_rules[1].before: unknown fact 'zoen': did you mean 'zone'?",
    "- {name: r, apart: {cut: 1}}": (
        "1:21: own_rules[1].apart: unknown key 'cut': did you mean 'cuts'? (valid: cuts, from, time, within)"
    ),
    "- {name: r, apart: {within: 5}}": (
        "1:20: own_rules[1].apart: say how far apart: cuts, time or both, such as {cuts: 2}"
    ),
    "- {name: r, next: {sam: layer}}": "1:20: own_rules[1].next: unknown key 'sam': did you mean 'same'? (valid: ",
    "- {name: r, next: {same: layr}}": "1:26: own_rules[1].next.same: unknown fact 'layr': did you mean 'layer'?",
    "- {name: r, next: {same: layer, to: {part: A}}}": (
        "1:33: own_rules[1].next: a rule asks one thing, this one asks same and to"
    ),
    "- {name: r, next: {within: 5}}": "1:19: own_rules[1].next: say what may follow: one of same, differs, to, never",
    "- {name: r, next: {same: kind, within: 5}}": (
        "1:19: own_rules[1].next.within: only lengths such as y_mm, and attributes, are nearly the same"
    ),
    "- {name: r, direction: left}": "1:24: own_rules[1].direction: expected one of cw, ccw, got 'left'",
    "- {name: r, pierce: {}}": (
        "1:21: own_rules[1].pierce: expected a place such as {left_gap_mm: '< 50'}, got a mapping"
    ),
    "- {name: r, pierce: {left: 3}}": (
        f"1:22: own_rules[1].pierce: unknown key 'left': did you mean 'left_gap_mm'? (valid: {PLACES})"
    ),
    "- {file: none.mzn}": "1:10: own_rules[1].file: there is no file 'none.mzn'",
    "- {file: rule.txt}": "1:10: own_rules[1].file: expected a MiniZinc file such as plant_rule.mzn, got 'rule.txt'",
    "- {file: none.mzn, select: {}}": "1:20: own_rules[1]: unknown key of a rule in a file 'select' (valid: ",
}


@pytest.mark.parametrize("text", MISTAKES)
def test_mistake(text: str) -> None:
    with pytest.raises(InputError) as caught:
        rules_of(text)
    assert str(caught.value).startswith(f"plant.yaml:{MISTAKES[text]}")


SCHEMA = profile_schema()
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)


@pytest.mark.parametrize("text", [*RULES, *WAYS])
def test_rule_is_written_back(text: str) -> None:
    (rule,) = rules_of(text)
    shown = yaml.safe_dump([rule.plain()], sort_keys=False)
    assert rules_of(shown) == (rule,)
    assert VALIDATOR.is_valid({"own_rules": yaml.safe_load(text)})
    assert VALIDATOR.is_valid({"own_rules": yaml.safe_load(shown)})


SEEN_BY_THE_READER_ONLY = ("are nearly the same", "is taken", "only a soft", "no file", "a MiniZinc file", "is empty")


@pytest.mark.parametrize("text", [t for t, m in MISTAKES.items() if not any(s in m for s in SEEN_BY_THE_READER_ONLY)])
def test_schema_refuses_what_the_reader_does(text: str) -> None:
    assert not VALIDATOR.is_valid({"own_rules": yaml.safe_load(text)})


NUMBERS = {
    "6": ([6, 6.0, "6"], [5, 7, None, True, "six"]),
    "< 6": ([5.999], [6, 6.0000001, 5.9999999]),
    "<= 6": ([6, 6.0000001], [6.1]),
    "> 6": ([6.1], [6, 6.0000001]),
    ">= 6": ([6, 5.9999999], [5.9]),
    "!= 6": ([5, 7], [6, None]),
    "2..6": ([2, 4, 6], [1.9, 6.1]),
    "-3..-1": ([-2], [0]),
    "< 0.5 cm": ([4.9], [5]),
    "[1, '> 5']": ([1, 6], [2, 5]),
}


@pytest.mark.parametrize("text", NUMBERS)
def test_numbers(text: str) -> None:
    ((rule),) = rules_of(f"- {{name: r, first: true, select: {{left_gap_mm: {text if '[' in text else repr(text)}}}}}")
    ((_, criterion),) = rule.select.criteria  # type: ignore[union-attr]
    met, missed = NUMBERS[text]
    assert [v for v in met if not criterion.met(v)] == []
    assert [v for v in missed if criterion.met(v)] == []


ATTRIBUTES = {
    "1": ([1, 1.0, "1"], [2, True, "one"]),
    "'> 1'": ([2, "3"], [1, "A"]),
    "'A*'": (["A1", "A"], ["B", 1, None]),
    "true": ([True], [False, 1, "true"]),
    "[A, 2]": (["A", 2], ["B", 3]),
}


@pytest.mark.parametrize("text", ATTRIBUTES)
def test_attributes(text: str) -> None:
    (rule,) = rules_of(f"- {{name: r, first: true, select: {{attribute.x: {text}}}}}")
    ((_, criterion),) = rule.select.criteria  # type: ignore[union-attr]
    met, missed = ATTRIBUTES[text]
    assert [v for v in met if not criterion.met(v)] == []
    assert [v for v in missed if criterion.met(v)] == []


def test_select_left_out_is_every_contour() -> None:
    (rule,) = rules_of("- {name: r, direction: cw}")
    assert rule.select == Selector()  # type: ignore[union-attr]


def test_points_near_a_limit_are_on_either_side() -> None:
    under = NumberSpan(high=6.0, without_high=True)
    assert [under.surely_met(v, 0.05) for v in (5.9, 5.97, 6.03)] == [True, False, False]
    assert [under.perhaps_met(v, 0.05) for v in (5.97, 6.03, 6.1)] == [True, True, False]
