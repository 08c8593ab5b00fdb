"""Zones move along a plan without them, and where its runs are no zones, along one that mixes neighbouring zones."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest

from kerfwise.arrays import Ints
from kerfwise.encoder.by_hand import nest, part, rect
from kerfwise.encoder.facts import FactOptions, Facts, compute_facts, zones
from kerfwise.encoder.facts.zone_runs import zones_along
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs import zones_moved
from kerfwise.jobs.ask import ask, facts_of
from kerfwise.jobs.solve_options import options_for
from kerfwise.jobs.zones_moved import of_neighbours, planned_by_zones
from kerfwise.models.problem.closure import transitive
from kerfwise.rules.profile.profile import load_profile


def test_neighbours_may_be_mixed_and_no_others() -> None:
    """Six plates in a row, a mark on each: a zone for every plate."""
    plates = (
        part(str(k), rect(10 + 100 * k, 10, 80, 80), marks=[[(20 + 100 * k, 20), (40 + 100 * k, 20)]]) for k in range(6)
    )
    facts = compute_facts(nest(600, 100, *plates), FactOptions(zone_contours=1))
    index = facts.nest.index
    outer = [index[f"{k}.outer"] for k in range(6)]
    assert facts.zone[outer].tolist() == [1, 2, 3, 4, 5, 6]
    found = [(outer.index(s.before), outer.index(s.after)) for s in of_neighbours(facts, frozenset({"some-rule"}))]
    before = np.zeros((6, 6), dtype=np.bool_)
    before[tuple(np.transpose(found))] = True
    assert (transitive(before) == (np.arange(6)[:, None] + 2 <= np.arange(6))).all()
    assert (0, 4) not in found, "it follows from the others"


@pytest.mark.slow
def test_where_runs_are_no_zones_neighbouring_zones_are_mixed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(zones, "MOST_OF_ONE", 100)
    profile = load_profile()
    off = replace(profile.rules["no-tip-travel"], strength="off", weight=None)
    profile = replace(profile, rules={**profile.rules, "no-tip-travel": off})
    sheet = read_json(json.dumps(make_sheet(2, 40)).encode(), ReadOptions())
    asked, limits = ask(facts_of(sheet, profile), profile), options_for(sheet, profile, work=5.0)
    orders: list[Sequence[int]] = []

    def none_at_first(facts: Facts, order: Sequence[int]) -> Iterator[Ints]:
        orders.append(order)
        yield from () if len(orders) == 1 else zones_along(facts, order)

    monkeypatch.setattr(zones_moved, "zones_along", none_at_first)
    by, moved, free = planned_by_zones(asked, profile, limits)
    assert free is not None
    assert len(orders) == 2
    place = {k: at for at, k in enumerate(orders[1])}
    for statement in of_neighbours(asked.facts, frozenset({"zone-order"})):
        assert place[statement.before] < place[statement.after]
    assert moved.status == "optimal"
    assert (by.facts.zone != asked.facts.zone).any()
