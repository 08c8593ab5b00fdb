"""The orders that order rules make of facts."""

from __future__ import annotations

import pytest

from kerfwise.encoder.cut import Side
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.facts import FactOptions, Facts
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.catalogue.level_ahead import LevelAhead
from kerfwise.rules.catalogue.zone_order import ZoneOrder, ZoneOrderOptions
from kerfwise.rules.options.option import NoOptions
from kerfwise.rules.statements import Precede


def facts_of_row(parts: int, **options: int) -> Facts:
    row = nest(100 * parts, 100, *(part(f"P{k}", rect(10 + 100 * k, 10, 80, 80)) for k in range(parts)))
    return compute_facts(row, FactOptions(**options), ())  # type: ignore[arg-type]


def test_each_pair_is_an_order_with_its_reason() -> None:
    facts, rule = facts_of_row(6), LevelAhead()
    orders = list(rule.statements(facts, NoOptions()))
    assert [(order.before, order.after) for order in orders] == [tuple(pair) for pair in facts.level_ahead.tolist()]
    assert len(orders) == 15
    assert orders[0].about.sentence.startswith("P0.outer is cut before P1.outer: it lies between P1.outer and the ")
    assert list(rule.statements(facts_of_row(1), NoOptions())) == []


class Failing(LevelAhead):
    """An order rule that cannot say why."""

    def reason(self, before: str, after: str, start_side: Side | None) -> str:
        raise RuntimeError(f"no reason for {before}")


def test_a_rule_of_a_plant_fails_while_it_is_at_work() -> None:
    rule = Failing()
    rule.brought = "file own.py"
    with pytest.raises(Exception, match="rule level-ahead fails in reason: RuntimeError: no reason"):
        rule.statements(facts_of_row(2), NoOptions())


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
