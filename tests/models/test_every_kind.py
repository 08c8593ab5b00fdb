"""Each kind of statement, hard and soft, through each engine, the reference, conflict, explain and MiniZinc.

In each example the statement changes what the best plan costs, so that whoever ignores it gives another answer.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import get_args

import pytest

from kerfwise.benchmarks.flattened import said
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.engines import Member
from kerfwise.models.engines.minizinc_engine import solve_minizinc
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.solve import solve
from kerfwise.models.heat_prices import HEAT
from kerfwise.models.plan.conflict.core import Engines, find_core, find_whole_core
from kerfwise.models.plan.conflict.groups import Group, hard_groups, order_groups
from kerfwise.models.plan.conflict.ways_out import soften
from kerfwise.models.plan.explain.alternatives import (
    PositionCosts,
    explain_entry,
    other_statements,
    try_order,
    try_order_fast,
)
from kerfwise.models.plan.explain.context import PlanContext, make_context
from kerfwise.models.plan.explain.explain import heat_prices
from kerfwise.models.plan.make_plan import excuses, make_plan
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.rules.statements import EXEMPTION_MM, About, Crossing, Forbid, Precede, Statement, contours_named
from kerfwise.rules.stating.reduced_statements import OUT, Remainder, remaining_statements
from kerfwise.rules.stating.state_rules import Stated
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.every_kind import (
    ABOUT,
    FEEDS,
    HOME,
    NEAR_MM,
    PARTS,
    PROFILE,
    TRAVEL,
    Example,
    Way,
    examples,
    way_of,
    ways,
)
from kerfwise.tests.models.plan.conflict.statements import row
from kerfwise.tests.tools.amount import full

FACTS = row(PARTS)
KINDS = get_args(Statement)
MEMBERS: tuple[Member | None, ...] = (None, *get_args(Member))
EXACT: tuple[Member | None, ...] = (None, "cp-sat")
"""What must prove its plan, whatever the kind."""
LOOKS_BACK = (
    *("sum of entries", "sum of sums", "sum of steps", "moves one after the other"),
    *("lag of cuts", "lag of seconds"),
)
NOT_ALONE = {("ideals", name) for name in LOOKS_BACK}
"""What a state of these members does not hold: alone they have no plan, or one that they do not call the best."""
HARD = [e for e in examples() if e.hard]
every_example = pytest.mark.parametrize("example", examples(), ids=str)
every_hard_one = pytest.mark.parametrize("example", HARD, ids=str)


def test_every_kind_has_its_examples() -> None:
    hard = {type(e.statement) for e in examples() if e.hard}
    soft = {type(e.statement) for e in examples() if not e.hard}
    without = [kind.__name__ for kind in KINDS if kind not in soft]
    assert not without, f"tests/models/every_kind.py has no example of {', '.join(without)}"
    never_hard = {kind.__name__ for kind in KINDS if kind not in hard}
    assert never_hard == {"IdleTravel", "Link"}


@every_example
def test_the_statement_changes_the_best_plan(example: Example) -> None:
    assert abs(example.without_mm - example.best_mm) > 1
    assert example.best_mm < math.inf


@every_example
def test_the_reference_prices_every_way_as_by_hand(example: Example) -> None:
    problem = make_problem(FACTS, example.statements, HOME, FEEDS)
    for way in ways():
        route = tuple(int(problem.candidate_site[c]) for c in way.candidates)
        price_mm = example.price_mm(way)
        assert (-1 in route or bool(broken(problem, route))) == math.isinf(price_mm), way
        if price_mm < math.inf:
            assert route_cost(problem, route) / UM_PER_MM == pytest.approx(price_mm, abs=NEAR_MM), way
    best = cheapest(problem)
    assert best is not None
    assert best.cost / UM_PER_MM == pytest.approx(example.best_mm, abs=NEAR_MM)


@pytest.mark.parametrize("member", MEMBERS)
@every_example
def test_every_engine_finds_the_best_plan(example: Example, member: Member | None) -> None:
    options = SolveOptions(work=0.15, home_mm=HOME, feeds=FEEDS, member=member)
    alone = (member, example.name) not in NOT_ALONE
    try:
        found = solve(FACTS, example.statements, options)
    except (InputError, RulesConflict):
        if alone:
            raise
        return
    assert found.objective == pytest.approx(example.price_mm(way_of(FACTS, found.route)), abs=NEAR_MM)
    if alone:
        assert found.objective == pytest.approx(example.best_mm, abs=NEAR_MM)
        assert found.status == "optimal" or member not in EXACT
    else:
        assert found.status == "feasible"


@pytest.mark.minizinc
@every_example
def test_minizinc_finds_the_best_plan_or_says_that_it_has_no_words(example: Example) -> None:
    options = SolveOptions(work=20.0, home_mm=HOME, feeds=FEEDS)
    stated = Stated(example.statements, ())
    if isinstance(example.statement, Crossing):
        with pytest.raises(InputError, match="rule r cannot be stated for MiniZinc"):
            solve_minizinc(FACTS, PROFILE, stated, options)
        return
    found = solve_minizinc(FACTS, PROFILE, stated, options)
    assert found.status == "optimal"
    assert found.objective == pytest.approx(example.best_mm, abs=NEAR_MM)


@pytest.mark.parametrize(
    "example",
    [
        full(pytest.param(e, id=str(e))) if str(e) == "lag of seconds, hard" else pytest.param(e, id=str(e))
        for e in HARD
    ],
)
def test_a_conflict_names_it(example: Example) -> None:
    """Against it stands all that fixes one way to cut the row which breaks it."""
    breaking = next(way for way in ways() if _keeps_the_given(example, way) and math.isinf(example.price_mm(way)))
    fixed = _fixed(breaking)
    assert _clash(hard_groups(fixed)) is None
    core = _clash(hard_groups([*fixed, example.statement]))
    assert core is not None
    assert ABOUT in [group.about for group in core]


@every_hard_one
def test_it_can_give_way(example: Example) -> None:
    *others, softened = soften(example.statements, [ABOUT])
    assert tuple(others) == example.others
    assert softened.weight is not None


@every_example
def test_explain_tries_orders_by_it(example: Example) -> None:
    """An order is refused where every way along it breaks the statement, else priced with it."""
    setting = _setting(example)
    along = PositionCosts(setting)
    seen: set[bool] = set()
    for order in {way.order for way in ways()}:
        tried = try_order(setting, order)
        quick = try_order_fast(along, order)
        assert (quick.breaks, quick.cost) == (tried.breaks, tried.cost)
        prices = [example.price_mm(way) for way in ways() if way.order == order]
        seen.add(bool(tried.breaks))
        if math.isinf(min(prices)):
            assert tried.breaks, order
        elif not tried.breaks:
            assert tried.cost is not None
            chosen = way_of(FACTS, [int(setting.problem.site_candidate[s]) for s in tried.route])
            assert tried.cost / UM_PER_MM == pytest.approx(example.price_mm(chosen), abs=NEAR_MM), order
    assert False in seen


@every_example
def test_no_place_that_tells_kinds_apart_has_forgotten_it(example: Example) -> None:
    """After a stop, as an excuse, where explain tells what holds a contour or heats it, and beside another text."""
    statement, setting = example.statement, _setting(example)
    for out in range(PARTS):
        number = [OUT if k == out else k - (k > out) for k in range(PARTS)]
        left = remaining_statements([statement], Remainder(number, {out: 1}))
        assert {k for s in left for k in contours_named(s)} <= set(range(PARTS - 1))
    named = {FACTS.nest.contours[k].id for k in contours_named(statement)}
    known = {s.about for s in example.statements}
    assert all(known.issuperset(other_statements(setting, k)) for k in range(PARTS))
    if statement.weight is not None:
        excusable = Stated((TRAVEL, replace(statement, weight=EXEMPTION_MM)), ())
        assert set(excuses(FACTS, excusable, [2 * k for k in range(PARTS)])) <= named | set(ABOUT.contours)
        priced = replace(statement, about=replace(ABOUT, rule=HEAT))
        for price in heat_prices(replace(setting, stated=Stated((priced,), ())), 0):
            assert price.price_mm == priced.weight
    assert said(statement) == said(statement)


def test_explain_says_that_an_entry_is_forbidden() -> None:
    (example,) = (e for e in HARD if isinstance(e.statement, Forbid))
    entry = explain_entry(PositionCosts(_setting(example)), FACTS.candidates[0].contour)
    assert [way.against for way in entry.unlawful] == [(ABOUT,)]


def _setting(example: Example) -> PlanContext:
    """The best plan of an example, as explain sees it."""
    stated = Stated(example.statements, ())
    options = SolveOptions(work=0.15, home_mm=HOME, feeds=FEEDS)
    plan = make_plan(FACTS, PROFILE, stated, solve(FACTS, example.statements, options), "portfolio", 1)
    return make_context(FACTS, PROFILE, stated, plan)


def _keeps_the_given(example: Example, way: Way) -> bool:
    return all(way.place(i) < way.place(j) for i, j in example.given)


def _fixed(way: Way) -> list[Statement]:
    """Statements that leave one way to cut the row."""
    orders = [Precede(i, j, About("locks", (), f"{i} before {j}")) for i, j in pairwise(way.order)]
    out = [c for c in range(len(FACTS.candidates)) if c not in way.candidates]
    return [*orders, *(Forbid(c, About("locks", (), f"not {c}")) for c in out)]


def _clash(groups: tuple[Group, ...]) -> tuple[Group, ...] | None:
    core = find_core(FACTS, order_groups(groups), {})
    if core is None:
        core = find_whole_core(Engines(FACTS, HOME, FEEDS), groups, {})
    return None if core is None else core.groups
