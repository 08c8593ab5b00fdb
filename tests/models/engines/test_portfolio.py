"""The portfolio: every member alone, all together, and what it says of its choices."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from itertools import count
from math import inf
from typing import Any

import pytest

from kerfwise.commands.shared_options import EngineChoice
from kerfwise.models.engines import BUILT_IN, ENGINES, OLD_NAMES, Member, bounds, cpsat, ideals, portfolio, tuning
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.portfolio import run_portfolio
from kerfwise.models.engines.shared_state import SharedState
from kerfwise.models.engines.solution import Incumbent, SolveOptions
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem, SoftGroup
from kerfwise.models.problem.simplify import without_wishes
from kerfwise.rules.statements import AtLeast, Lag, Move, Pick
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.problems import ABOUT, problem, scattered
from kerfwise.tests.tools.amount import few


def found(given: Problem, member: Member | None = None, work: float = 0.5) -> SharedState:
    options = SolveOptions(work=work, member=member)
    return run_portfolio(given, options)


@pytest.mark.slow
@pytest.mark.parametrize("member", [None, "search", "ideals", "cp-sat"])
def test_every_member_finds_the_best_of_a_small_problem(member: Member | None) -> None:
    six = scattered(2, contours=6, sites=2, pairs=3)
    best = cheapest(six)
    assert best is not None
    known = found(six, member)
    assert known.incumbent is not None
    assert known.incumbent.cost == best.cost
    assert known.proven == (member != "search")


@pytest.mark.slow
def test_a_forced_member_is_the_only_one_that_speaks() -> None:
    six = scattered(2, contours=6, sites=2)
    assert [note.split(":")[0] for note in found(six, "ideals").notes] == ["ideals"]
    assert found(six, "search").notes == ["search: asked for"]
    assert found(six, "search").proved_by == ""


def test_a_search_that_bans_on_moves_leave_no_route_ends_without_one() -> None:
    """It bred from the best of what it had found, and found nothing: it ended with an IndexError."""
    never = [Move((0,), (1,), ABOUT), Move((1,), (0,), ABOUT)]
    known = found(problem([[(10.0, 0.0)], [(20.0, 0.0)]], moves=never), "search", work=0.05)
    assert known.incumbent is None


def test_a_sweep_of_all_sets_at_once_asks_for_no_bound_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """A plan that is known, as that of the round before, is no reason to look for one."""
    six = scattered(2, contours=6, sites=2, pairs=3)
    best = cheapest(six)
    assert best is not None
    monkeypatch.setattr(import_module("kerfwise.models.engines.ideals.prove"), "bound_by_walks", None)
    known = run_portfolio(six, SolveOptions(work=0.5), start=best.route)
    assert known.incumbent is not None
    assert (known.incumbent.cost, known.proven) == (best.cost, True)


@pytest.mark.slow
def test_it_says_how_many_sets_there_are_and_what_it_makes_of_that() -> None:
    few = found(problem([[(float(x), 0.0)] for x in range(5)]))
    assert few.notes == [
        "ideals: swept at once, 31 sets, 80 states, 1 stretches one after the other, of 5 contours at most"
    ]
    many = found(scattered(1, contours=45, sites=1), work=0.5)
    assert many.notes[1].startswith("ideals: left to the others, more than ")


def test_what_the_ideals_cannot_hold_is_carried_by_cp_sat() -> None:
    apart = problem([[(float(x), 0.0)] for x in range(5)], lags=[Lag(3, 4, ABOUT, cuts=3), Lag(0, 1, ABOUT, cuts=1)])
    known = found(apart)
    best = cheapest(apart)
    assert best is not None
    assert known.incumbent is not None
    assert (known.incumbent.cost, known.bound_um, known.proved_by) == (best.cost, best.cost, "cp-sat")
    assert any(note.startswith("ideals: left out") for note in known.notes)
    assert any(note.startswith("cp-sat: ") for note in known.notes)


def _not_together(one: int, other: int) -> AtLeast:
    """Two sites are not both used."""
    return AtLeast((Pick(other),), (-1,), 0, ABOUT, when=one)


def test_what_sets_cannot_tell_is_left_out_of_the_sets_and_a_plan_that_keeps_it_is_proven_all_the_same() -> None:
    six = scattered(2, contours=6, sites=2, pairs=3)
    best = cheapest(six)
    assert best is not None
    unused = sorted(set(range(six.m)) - set(best.route))
    known = found(replace(six, general=(_not_together(unused[0], unused[1]),)))
    assert known.incumbent is not None
    assert (known.incumbent.cost, known.bound_um, known.proved_by) == (best.cost, best.cost, "ideals")


@pytest.mark.slow
@pytest.mark.parametrize("pair", few([(0, 1), (0, 5), (2, 3)]))
def test_where_the_best_plan_of_the_sets_breaks_the_rest_it_is_a_bound_only(pair: tuple[int, int]) -> None:
    six = scattered(2, contours=6, sites=2, pairs=3)
    free = cheapest(six)
    assert free is not None
    bound = replace(six, general=(_not_together(free.route[pair[0]], free.route[pair[1]]),))
    best, known = cheapest(bound), found(bound)
    assert best is not None
    assert best.cost > free.cost
    assert known.incumbent is not None
    assert (known.incumbent.cost, known.bound_um, known.proved_by) == (best.cost, best.cost, "cp-sat")
    assert "ideals: the best plan breaks what a set cannot tell, it is a bound only" in known.notes


def test_no_lawful_route_is_proven() -> None:
    known = found(problem([[(1.0, 0.0)], [(2.0, 0.0)]], lags=[Lag(0, 1, ABOUT, cuts=1)]))
    assert known.infeasible
    assert known.proven
    assert known.incumbent is None


def test_the_better_plan_and_the_better_bound_are_kept() -> None:
    known = SharedState()
    known.offer(Incumbent((1, 0), 9), "search")
    known.offer(Incumbent((0, 1), 9), "ideals")
    known.raise_bound(0, "cp-sat")
    known.raise_bound(7, "ideals")
    known.raise_bound(5, "cp-sat")
    assert (known.found_by, known.bound_um, known.proved_by, known.proven) == ("search", 7, "ideals", False)
    known.offer(Incumbent((0, 1), 7), "cp-sat")
    assert (known.found_by, known.proven) == ("cp-sat", True)


def test_a_flow_bounds_what_neither_state_nor_order_proves() -> None:
    apart = problem([[(float(x), 0.0)] for x in range(5)], lags=[Lag(0, 1, ABOUT, cuts=2)])
    known = found(apart)
    assert (known.bound_um, known.proved_by, known.proven) == (8000, "flow", True)


def test_an_earlier_plan_and_bound_are_gone_on_from() -> None:
    six = scattered(2, contours=6, sites=2, pairs=3)
    best = found(six)
    assert best.incumbent is not None
    options = SolveOptions(work=1e-6, member="search")
    again = run_portfolio(six, options, start=best.incumbent.route, earlier=best)
    assert again.incumbent == best.incumbent
    assert again.proven
    assert (again.bound_um, again.proved_by) == (best.bound_um, best.proved_by)
    assert again.notes == []


@pytest.mark.slow
def test_no_member_sets_out_without_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each step takes a second by the clock; what is left is too little for the others' tables."""
    given, seconds, set_out = scattered(1, contours=45, sites=1), count(), list[str]()
    for module, name in ((bounds, "flow_bound"), (cpsat, "solve_cpsat")):
        monkeypatch.setattr(module, name, lambda *given, name=name: set_out.append(name))
    limits = SolveOptions(time_s=5.0)
    whole = Deadline.of(replace(limits, time_s=1e9), clock=lambda: float(next(seconds)))
    assert run_portfolio(given, limits, whole).incumbent is not None
    assert set_out == []


@pytest.mark.slow
def test_with_little_memory_other_members_take_over() -> None:
    given = scattered(1, contours=9, sites=2)
    plenty, scarce = (SolveOptions(work=2.0, memory_gb=gb) for gb in (2.0, 1e-6))
    proven = run_portfolio(given, plenty)
    assert proven.proved_by == "ideals"
    found = run_portfolio(given, scarce)
    assert found.incumbent is not None
    assert proven.incumbent is not None
    assert found.incumbent.cost == proven.incumbent.cost
    assert found.proved_by != "ideals"


@pytest.mark.parametrize(("little", "note"), [(True, "flow: a bound by linear programming"), (False, "")])
def test_nothing_is_said_to_be_proven_where_programs_of_stretches_come_to_no_bound(
    monkeypatch: pytest.MonkeyPatch, little: bool, note: str
) -> None:
    """With little work a bound by flows, which needs less, is looked for instead."""
    monkeypatch.setattr(tuning, "FLOW_FEW", 10)
    monkeypatch.setattr(ideals, "prove_priced", lambda *_: None)
    monkeypatch.setattr(import_module("kerfwise.models.engines.ideals.prove"), "SETTING_OUT", 0.0 if little else inf)
    held = [Condition(k, (k + 1,), (-1,), 0, ABOUT, cost=90_000) for k in range(0, 40, 5)]
    known = found(replace(scattered(1, contours=42, sites=2, pairs=40), conditions=tuple(held)), work=0.1)
    assert "ideals: too many sets for the limit, a bound is proven" not in known.notes
    assert not note or note in known.notes


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sites", "work", "note"),
    [
        (0, 0.3, "flow: a bound by linear programming"),
        (1000, 0.7, "ideals: too many sets for the limit, a bound is proven"),
    ],
)
def test_a_plan_that_is_improved_while_it_is_bounded_is_the_same_each_time(
    monkeypatch: pytest.MonkeyPatch, sites: int, work: float, note: str
) -> None:
    """Bound and search run at the same time, and neither sees how far the other is."""
    monkeypatch.setattr(tuning, "FLOW_FEW", 10)
    monkeypatch.setattr(import_module("kerfwise.models.engines.ideals.prove"), "MOST_SITES_PRICED", sites)
    held = [Condition(k, (k + 1,), (-1,), 0, ABOUT, cost=90_000) for k in range(0, 40, 5)]
    many = replace(scattered(1, contours=42, sites=2, pairs=40), conditions=tuple(held))
    first, again = (found(many, work=work) for _ in range(2))
    assert note in first.notes
    assert (first.incumbent, first.bound_um, first.work, first.notes) == (
        again.incumbent,
        again.bound_um,
        again.work,
        again.notes,
    )
    assert first.incumbent is not None
    assert 0 < first.bound_um <= first.incumbent.cost


def test_what_a_bound_has_reached_in_another_thread_is_told_with_the_next_news() -> None:
    told = []
    deadline = Deadline.of(SolveOptions(), lambda engine, cost, bound: told.append((engine, cost, bound)) is None)
    deadline.overhear(70)
    deadline.overhear(60)
    assert deadline("search", 100, None)
    assert told == [("search", 100, 70)]


@pytest.mark.slow
def test_a_plan_is_shown_while_many_sets_are_counted_and_plans_stay_what_they_are(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    many = scattered(1, contours=40, sites=1, pairs=60)
    told: list[int] = []
    counted: list[int] = []
    real = ideals.count_sets

    def listen(engine: str, cost: int | None, bound: int | None) -> bool:
        told.extend([] if cost is None else [cost])
        return True

    def count_sets(given: Problem, most: float, going: Callable[[int], bool]) -> Any:
        count = real(given, 1e4, going)
        counted.append(len(told))
        return count

    monkeypatch.setattr(ideals, "count_sets", count_sets)
    options = SolveOptions(work=0.3)
    plans = []
    for entries in (0.0, inf):
        monkeypatch.setattr(tuning, "PREVIEW_AFTER_ENTRIES", entries)
        told.clear()
        known = run_portfolio(many, options, listen)
        assert known.incumbent is not None
        assert told == sorted(told, reverse=True)
        plans.append((known.incumbent, known.bound_um, known.work, known.notes))
    assert counted[0] > 0 == counted[1]
    assert plans[0] == plans[1]


def apart(seed: int) -> Problem:
    """Three zones one after the other, and a wish that contours of all of them follow each other."""
    zones = [(a, b) for a in range(24) for b in range(24) if a // 8 < b // 8]
    made = scattered(seed, contours=24, sites=2)
    points = [made.pierce_um[list(made.sites(k))] / 1000 for k in range(24)]
    return problem(
        [[(float(x), float(y)) for x, y in of] for of in points],
        pairs=zones,
        conditions=[Condition(k, ((k + 5) % 24,), (1,), 1, ABOUT, cost=1_000_000_000) for k in range(0, 24, 3)],
        soft_groups=[SoftGroup(tuple(range(0, 24, 2)), 50_000, ABOUT)],
    )


def stuck(step: portfolio.Step) -> portfolio.Step:
    """A step that comes to nothing where contours are wished to follow each other."""
    return step._replace(suits=lambda run: not run.problem.soft_groups and step.suits(run))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("work", [0.004, 0.02])
@pytest.mark.parametrize("nothing_else", [False, True])
def test_a_wish_is_never_worse_than_the_plan_without_it(
    seed: int, work: float, nothing_else: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However short the limit, and even where all else comes to nothing: excuses first, money after."""
    wished = apart(seed)
    fewer = without_wishes(wished)
    assert fewer is not None
    steps = [step for step in portfolio.STEPS if step.work is not portfolio.sweep]  # nothing is swept at once
    if nothing_else:
        steps = [step if step.work is portfolio.plan_without_wishes else stuck(step) for step in steps]
    monkeypatch.setattr(portfolio, "STEPS", tuple(steps))
    known, plain = found(wished, work=work), found(fewer, work=tuning.WITHOUT_WISHES * work)
    assert known.incumbent is not None
    assert plain.incumbent is not None
    assert not broken(wished, known.incumbent.route)
    assert known.incumbent.cost == route_cost(wished, known.incumbent.route)
    assert known.incumbent.cost <= route_cost(wished, plain.incumbent.route)


def test_a_plan_without_wishes_that_keeps_them_is_the_best() -> None:
    row = [[(float(x), 0.0)] for x in range(0, 120, 10)]
    wished = problem(row, soft_groups=[SoftGroup((2, 3, 4), 50_000, ABOUT)])
    known = found(wished)
    assert known.incumbent is not None
    assert known.proven
    assert known.incumbent.cost == 220_000


def test_the_old_name_is_read_as_the_new_one() -> None:
    assert EngineChoice().convert("cp-sat", None, None) == "portfolio"
    assert EngineChoice(BUILT_IN).convert("cp-sat-alone", None, None) == "cp-sat-alone"
    assert not OLD_NAMES.keys() & ENGINES.keys()
