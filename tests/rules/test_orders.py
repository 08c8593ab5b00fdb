"""Orders that are made together are those that an order rule makes one by one."""

from __future__ import annotations

import numpy as np
import pytest

from kerfwise.encoder.by_hand import nest, part, rect
from kerfwise.encoder.cut import Side
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.facts import FactOptions, Facts
from kerfwise.rules.catalogue.level_ahead import LevelAhead
from kerfwise.rules.catalogue.zone_order import ZoneOrder, ZoneOrderOptions
from kerfwise.rules.options.option import NoOptions
from kerfwise.rules.orders import orders_of
from kerfwise.rules.statements import Precede


def facts_of_row(parts: int, **options: int) -> Facts:
    row = nest(100 * parts, 100, *(part(f"P{k}", rect(10 + 100 * k, 10, 80, 80)) for k in range(parts)))
    return compute_facts(row, FactOptions(**options), ())  # type: ignore[arg-type]


def test_they_are_those_made_one_by_one() -> None:
    facts, rule = facts_of_row(6), LevelAhead()
    one_by_one = [rule.precede(facts, before, after) for before, after in facts.level_ahead.tolist()]
    assert len(one_by_one) == 15
    assert list(rule.statements(facts, NoOptions())) == one_by_one
    assert one_by_one[0].about.sentence.startswith("P0.outer is cut before P1.outer: it lies between P1.outer and the ")


def test_there_may_be_none() -> None:
    assert orders_of(LevelAhead(), facts_of_row(1), np.empty((0, 2), dtype=np.int64)) == []


class Failing(LevelAhead):
    """An order rule that cannot say why."""

    def reason(self, before: str, after: str, start_side: Side | None) -> str:
        raise RuntimeError(f"no reason for {before}")


def test_a_rule_of_a_plant_fails_while_it_is_at_work() -> None:
    """Sentences of rules of the catalogue wait until they are read."""
    facts, rule = facts_of_row(2), Failing()
    (order,) = rule.statements(facts, NoOptions())
    rule.brought = "file own.py"
    with pytest.raises(Exception, match="rule level-ahead fails in reason: RuntimeError: no reason"):
        rule.statements(facts, NoOptions())
    with pytest.raises(Exception, match="no reason"):
        order.about.sentence  # noqa: B018


def test_zones_are_cut_in_turn() -> None:
    facts = facts_of_row(5, zone_contours=2)
    rule, zone = ZoneOrder(), facts.zone.tolist()
    asked = [
        Precede(
            i,
            j,
            rule.about(
                (f"P{i}.outer", f"P{j}.outer"),
                f"P{i}.outer is cut before P{j}.outer: zone {zone[i]} comes before zone {zone[j]}",
            ),
        )
        for first in sorted(set(zone))
        for i in range(5)
        for j in range(5)
        if zone[i] == first and zone[j] == first + 1
    ]
    assert len(asked) > 2
    assert list(rule.statements(facts, ZoneOrderOptions())) == asked
