"""Contradictions on nests of a hundred parts and more are named with little work."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.request import facts_of
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.plan.conflict import conflict as conflict_module
from kerfwise.models.plan.conflict import find_conflict
from kerfwise.models.plan.conflict.core import Engines, find_core
from kerfwise.models.plan.conflict.groups import hard_groups, order_groups
from kerfwise.models.plan.conflict.ways_out import _cost
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.stating.state_rules import every_statement, state_rules


def squares(rows: int) -> Nest:
    """Rows of twelve squares."""
    return nest(
        610, 10 + 50 * rows, *(part(f"P{12 * row + column + 1}", rect(10 + 50 * column, 10 + 50 * row, 40, 40))
                               for row in range(rows) for column in range(12))
    )  # fmt: skip


SQUARES, FEW = squares(10), squares(2)
BOTH_FIFTH = [f"{name} is cut 5 in order: locked by the operator" for name in ("P1.outer", "P2.outer")]


def locked(*locks: Lock, sheet: Nest = SQUARES) -> tuple[Facts, Profile]:
    profile = replace(load_profile(), locks=locks)
    return facts_of(sheet, profile), profile


def test_two_contours_locked_at_one_position_are_refused_before_any_plan() -> None:
    with pytest.raises(RulesConflict) as error:
        state_rules(*locked(Lock(contour="P1.outer", position=5), Lock(contour="P2.outer", position=5)))
    assert list(error.value.reasons) == BOTH_FIFTH


def test_one_contour_locked_at_two_positions_is_refused_before_any_plan() -> None:
    with pytest.raises(RulesConflict) as error:
        state_rules(*locked(Lock(contour="P1.outer", position=5), Lock(contour="P1.outer", position=9)))
    assert [text.split(":")[0] for text in error.value.reasons] == [
        "P1.outer is cut 9 in order", "P1.outer is cut 5 in order",
    ]  # fmt: skip


@pytest.mark.full
@pytest.mark.slow
def test_two_positions_at_odds_are_named_and_one_is_let_go() -> None:
    facts, profile = locked(Lock(contour="P1.outer", position=5), Lock(contour="P2.outer", position=5))
    conflict = find_conflict(facts, profile, Deadline(work=1.0))
    assert conflict is not None
    assert sorted(about.sentence for about in conflict.clash) == BOTH_FIFTH
    assert conflict.minimal
    assert conflict.relax is not None
    assert [about.rule for about in conflict.relax] == ["locks"]


@pytest.mark.slow
def test_twelve_ways_round_that_no_rule_offers_are_all_let_go() -> None:
    names = [f"P{k}.outer" for k in range(1, 13)]
    facts, profile = locked(*(Lock(contour=name, direction="ccw") for name in names))
    conflict = find_conflict(facts, profile, Deadline(work=5.0))
    assert conflict is not None
    assert (len(conflict.clash), conflict.stuck) == (1, "")
    assert conflict.relax is not None
    assert [(about.rule, about.contours) for about in conflict.relax] == [("locks", (name,)) for name in names]


@pytest.mark.slow
def test_it_takes_next_to_nothing_to_see_that_a_position_can_be_kept() -> None:
    """Of three contours that come one after another the first is locked where it fits, and where it does not."""
    for position, kept in ((118, True), (119, False)):
        locks = [Lock(contour="P1.outer", position=position)]
        locks += [Lock(contour="P1.outer", before="P2.outer"), Lock(contour="P2.outer", before="P3.outer")]
        facts, profile = locked(*locks)
        groups = [g for g in order_groups(hard_groups(every_statement(facts, profile)[0])) if g.about.rule == "locks"]
        core = find_core(facts, groups, {}, Deadline(work=0.2))
        assert (core is None) == kept
        assert core is None or len(core.groups) == 3


@pytest.mark.slow
def test_a_way_out_is_priced_without_moves_where_there_is_no_time_to_look_at_them() -> None:
    facts, profile = locked()
    statements = every_statement(facts, profile)[0]
    gives_way = {name: rule.gives_way for name, rule in profile.rulebook().items()}
    clock = iter(range(10**6))
    late = Deadline(time_s=60.0, clock=lambda: float(next(clock)))
    cost, problem = _cost(Engines(facts, (0.0, 0.0), feeds_of(profile), deadline=late), statements, (), gives_way)
    assert cost is not None
    assert problem is not None
    assert [rule for rule, _ in problem.left_out] == ["no-tip-travel"]


@pytest.mark.slow
def test_ways_out_that_there_is_no_time_to_compare_are_said_to_be_so(monkeypatch: pytest.MonkeyPatch) -> None:
    facts, profile = locked(Lock(contour="P1.outer", position=5), Lock(contour="P2.outer", position=5), sheet=FEW)
    monkeypatch.setattr(conflict_module, "PLANS", 1e9)
    for deadline, said in (
        (Deadline(time_s=1000.0), "a way out (which one costs least was not compared):"),
        (Deadline(work=10.0), "the cheapest way out:"),
    ):
        conflict = find_conflict(facts, profile, deadline)
        assert conflict is not None
        assert conflict.relax is not None
        assert said in list(conflict.lines())
