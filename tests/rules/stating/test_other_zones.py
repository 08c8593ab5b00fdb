"""What is stated by other zones is what is stated from nothing, whatever is taken over."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs import request
from kerfwise.jobs.request import facts_of
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.catalogue.level_ahead import LevelAhead
from kerfwise.rules.flat.model_rule import read_model_rule
from kerfwise.rules.options.option import NoOptions
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.registry import RULES
from kerfwise.rules.statements import Precede
from kerfwise.rules.stating import state_rules as stating
from kerfwise.rules.stating.state_rules import state_rules

ROUND = nest(
    600,
    400,
    *(part(f"{x}{y}", rect(20 + 90 * x, 20 + 120 * y, 70, 90), [circle(55 + 90 * x, 65 + 120 * y, 20)])
      for x in range(6) for y in range(3)),
)  # fmt: skip


def in_zones(contours: int) -> Profile:
    profile = load_profile()
    rule = profile.rules["zone-order"]
    changed = replace(rule, options=replace(rule.options, zone_contours=contours))
    return replace(profile, rules={**profile.rules, "zone-order": changed})


@pytest.mark.parametrize("seed", [1, 2])
def test_it_is_the_same_as_stated_from_nothing(seed: int) -> None:
    sheet = read_json(json.dumps(make_sheet(seed, 115)).encode(), ReadOptions())
    profile = in_zones(8)
    facts, by = facts_of(sheet, profile), facts_of(sheet, in_zones(20))
    assert facts.zone.tolist() != by.zone.tolist()
    by = replace(facts, zone=by.zone)
    first = state_rules(facts, profile)
    assert (seed == 2) == bool(first.dropped), "with orders that go round in a circle, and without"
    again, anew = state_rules(by, profile, first), state_rules(by, profile)
    for one, other in ((again.statements, anew.statements), (again.exempt, anew.exempt)):
        assert Counter(map(repr, one)) == Counter(map(repr, other))
    assert Counter(repr(d.statement) for d in again.dropped) == Counter(repr(d.statement) for d in anew.dropped)
    known = {id(s) for s in (*first.statements, *(d.statement for d in first.dropped))}
    kept = {s.about.rule for s in again.statements if id(s) in known}
    assert "level-ahead" in kept
    assert "zone-order" not in kept


class Unzoned(Facts):
    """Facts that nobody may ask for zones."""

    __slots__ = ()

    def __getattribute__(self, name: str) -> Any:
        if name in ("zone", "zone_heat_kj"):
            raise AssertionError("asked for zones")
        return super().__getattribute__(name)


def unzoned(facts: Facts) -> Facts:
    found = object.__new__(Unzoned)
    for one in fields(Facts):
        object.__setattr__(found, one.name, getattr(facts, one.name))
    return found


def test_no_rule_looks_at_zones_that_says_it_does_not() -> None:
    profile = load_profile()
    facts = unzoned(facts_of(ROUND, profile))
    blind = [name for name, rule in RULES.items() if not rule.minds_zones]
    assert blind
    for name in blind:
        assert list(RULES[name].statements(facts, profile.rules[name].options)) is not None
    with pytest.raises(Exception, match="asked for zones"):
        list(RULES["zone-order"].statements(facts, profile.rules["zone-order"].options))


def test_a_rule_that_states_anew_minds_zones_again() -> None:
    class Later(LevelAhead):
        def statements(self, facts: Facts, options: NoOptions) -> Iterator[Precede]:
            yield from ()

    class Same(LevelAhead):
        sentence = "The same."

    assert (LevelAhead.minds_zones, Later.minds_zones, Same.minds_zones) == (False, True, False)


def test_what_is_taken_over_is_not_stated(monkeypatch: pytest.MonkeyPatch) -> None:
    profile = load_profile()
    facts = facts_of(ROUND, profile)
    first = state_rules(facts, profile)
    asked: list[str] = []
    plain = stating.stated_by

    def stated_by(rule: Any, facts: Facts, options: Any) -> Any:
        asked.append(rule.id)
        return plain(rule, facts, options)

    monkeypatch.setattr(stating, "stated_by", stated_by)
    state_rules(facts, profile, first)
    assert "zone-order" in asked
    assert not {"level-ahead", "part-rigidity", "heat-lag"} & set(asked)


def test_where_zones_yield_no_rule_but_theirs_is_stated_again(monkeypatch: pytest.MonkeyPatch) -> None:
    profile = load_profile()
    facts = facts_of(ROUND, profile)
    asked: list[str] = []
    plain = stating.stated_by

    def stated_by(rule: Any, facts: Facts, options: Any) -> Any:
        asked.append(rule.id)
        return plain(rule, facts, options)

    monkeypatch.setattr(stating, "stated_by", stated_by)
    monkeypatch.setattr(request, "zones_that_yield", lambda facts, *_: np.ones_like(facts.zone))
    stated = request.make_request(facts, profile).stated
    assert asked.count("zone-order") == 2
    assert asked.count("level-ahead") == 1
    anew = state_rules(replace(facts, zone=np.ones_like(facts.zone)), profile)
    assert Counter(s.about for s in stated.statements) == Counter(s.about for s in anew.statements)


@pytest.mark.parametrize(
    ("holds", "minds"),
    [("before(1, 2)", False), ("zone[1] = 1 \\/ before(1, 2)", True), ("before(1, 2) % by zone", False)],
)
def test_a_model_file_minds_zones_where_it_names_them(holds: str, minds: bool, tmp_path: Path) -> None:
    file = tmp_path / "own.mzn"
    file.write_text(f"% own: the first contour comes first\narray[int] of var bool: own_holds = [{holds}\n];\n")
    assert read_model_rule(file).minds_zones == minds
