"""A kind of statement that nobody knows is refused by name wherever kinds are told apart, and the page lists where."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

import kerfwise
from kerfwise.apps.resequence.burn_order import _with_chains
from kerfwise.benchmarks.flattened import said
from kerfwise.encoder.facts.facts import Copies
from kerfwise.encoder.geometry.segment import Point
from kerfwise.jobs.plan_without_zones import without_moves
from kerfwise.jobs.route_paths import RoutePaths
from kerfwise.models.engines.baselines import solve_by
from kerfwise.models.engines.minizinc_model import condition_arrays, conditions, data_text
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.solve import solve
from kerfwise.models.heat_prices import HEAT
from kerfwise.models.physics.heat import TorchOn
from kerfwise.models.plan.conflict import conflict, order_model
from kerfwise.models.plan.conflict.core import Way
from kerfwise.models.plan.conflict.groups import (
    Group,
    contours_of,
    hard_groups,
    moves_or_seconds,
    order_groups,
    suspects,
)
from kerfwise.models.plan.conflict.order_conflicts import orders_of
from kerfwise.models.plan.explain import context as explain_setting
from kerfwise.models.plan.explain.alternatives import PositionCosts, other_statements, try_order
from kerfwise.models.plan.explain.context import PlanContext, make_context
from kerfwise.models.plan.explain.explain import heat_prices
from kerfwise.models.plan.explain.other_places import OtherPlaces
from kerfwise.models.plan.explain.reasons import price_split
from kerfwise.models.plan.make_plan import entry_reasons, excuses, make_plan
from kerfwise.models.plan.plan import Plan
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.conditions import LoweredStatements, lower_statements
from kerfwise.models.problem.evaluate import unpriced_crossings
from kerfwise.models.problem.problem import links_on
from kerfwise.rules.statements import EXEMPTION_MM, About, Statement, by_kind, candidates_named, contours_named
from kerfwise.rules.stating.feasible_order import positions
from kerfwise.rules.stating.feasible_sums import sums_of_orders
from kerfwise.rules.stating.lazy_statements import in_held_metal
from kerfwise.rules.stating.reduced_statements import GantryStatements, Remainder, remaining_statements
from kerfwise.rules.stating.state_rules import Stated, hopeless, resolve
from kerfwise.rules.stating.zones_yield import zones_that_yield
from kerfwise.tests.models.every_kind import ABOUT, FEEDS, HOME, PARTS, PROFILE, TRAVEL
from kerfwise.tests.models.plan.conflict.statements import row

ROOT = Path(kerfwise.__file__).parent
PAGE = (ROOT / "docs" / "writing-a-statement.md").read_text(encoding="utf-8")
KINDS = {kind.__name__ for kind in get_args(Statement)}
UNIONS = {"Statement", "CanClash", "PricedStatement"}
WORDS = {*KINDS, *UNIONS, "by_kind", "lags"}
"""A file without any of these in its text can neither tell kinds apart nor read what is made of them."""
FACTS = row(PARTS)
OPTIONS = SolveOptions(work=0.5, home_mm=HOME, feeds=FEEDS)


def cold(number: int, now_s: float, at: Point) -> tuple[tuple[TorchOn, ...], float]:
    """Nothing is burnt."""
    return (), now_s


@dataclass(frozen=True)
class Invented:
    """Not in the union."""

    about: About = ABOUT
    weight: float | None = None


INVENTED: Any = Invented()
GROUP = Group(ABOUT, (INVENTED,))
STATED = Stated((TRAVEL, INVENTED), ())


def at_weight(weight: float, rule: str = "r") -> Any:
    return Stated((TRAVEL, Invented(replace(ABOUT, rule=rule), weight)), ())  # type: ignore[arg-type]


@cache
def planned() -> tuple[tuple[int, ...], Plan, PlanContext]:
    """A plan without the invented statement."""
    stated = Stated((TRAVEL,), ())
    solution = solve(FACTS, stated.statements, OPTIONS)
    plan = make_plan(FACTS, PROFILE, stated, solution, "portfolio", 1)
    return solution.route, plan, make_context(FACTS, PROFILE, stated, plan)


def setting(stated: Stated = STATED) -> PlanContext:
    """Explain's view of the plan, with the invented statement added."""
    return replace(planned()[2], stated=stated)


def find_conflict(patch: pytest.MonkeyPatch) -> None:
    """A rule states the invented kind."""
    patch.setattr(conflict, "every_statement", lambda facts, profile: ([INVENTED], ()))
    conflict.find_conflict(FACTS, PROFILE)


def price_crossings(_: pytest.MonkeyPatch) -> None:
    """The problem remembers the invented statement."""
    problem = planned()[2].problem
    told = replace(problem.told, statements=(INVENTED,))
    unpriced_crossings(replace(problem, told=told), (), planned()[0])


def set_up(patch: pytest.MonkeyPatch) -> None:
    """Explain reads a plan; the problem, which refuses the kind as well, is made already."""
    patch.setattr(explain_setting, "make_problem", lambda *given: planned()[2].problem)
    make_context(FACTS, PROFILE, STATED, planned()[1])


def ask_order_model(patch: pytest.MonkeyPatch) -> None:
    built = order_model.OrderModel(FACTS)
    order_model._ask(built, INVENTED, built.model.new_bool_var(""))


def alone() -> Copies:
    """A gantry with one torch."""
    ones = np.ones(FACTS.n, dtype=np.int64)
    return Copies(FACTS, (), np.arange(FACTS.n), np.arange(len(FACTS.candidates)), ones, (0.0, 0.0))


Refuses = Callable[[pytest.MonkeyPatch], object]
REFUSES: dict[str, list[Refuses]] = {
    "rules/statements.py": [
        lambda _: by_kind([INVENTED]),
        lambda _: list(contours_named(INVENTED)),
        lambda _: list(candidates_named(INVENTED)),
    ],
    "rules/stating/feasible_order.py": [lambda _: positions([INVENTED], PARTS)],
    "rules/stating/feasible_sums.py": [lambda _: sums_of_orders([INVENTED])],
    "rules/stating/reduced_statements.py": [
        lambda _: list(remaining_statements([INVENTED], Remainder(range(PARTS), {}))),
        lambda _: list(GantryStatements(alone()).of_first([INVENTED])),
    ],
    "rules/stating/state_rules.py": [lambda _: hopeless([INVENTED]), lambda _: resolve([INVENTED], PARTS, {})],
    "rules/stating/lazy_statements.py": [lambda _: list(in_held_metal(FACTS, Remainder(range(PARTS), {}), [INVENTED]))],
    "rules/stating/zones_yield.py": [lambda _: zones_that_yield(FACTS, [INVENTED], frozenset())],
    "models/plan/make_plan.py": [
        lambda _: excuses(FACTS, at_weight(EXEMPTION_MM), planned()[0]),
        lambda _: entry_reasons(FACTS, STATED, planned()[0], HOME, [None] * len(planned()[0])),
    ],
    "models/problem/compile.py": [lambda _: make_problem(FACTS, (INVENTED,), HOME)],
    "models/problem/conditions.py": [lambda _: lower_statements((INVENTED,), (), LoweredStatements())],
    "models/problem/evaluate.py": [price_crossings],
    "models/problem/problem.py": [lambda _: links_on(FACTS.candidates, (INVENTED,), planned()[0], HOME)],
    "models/plan/conflict/conflict.py": [find_conflict],
    "models/plan/conflict/groups.py": [
        lambda _: hard_groups([INVENTED]),
        lambda _: moves_or_seconds([GROUP]),
        lambda _: order_groups([GROUP]),
        lambda _: contours_of(GROUP, []),
        lambda _: suspects(FACTS, [GROUP]),
    ],
    "models/plan/conflict/order_model.py": [
        lambda _: order_model.build_order_model(FACTS, [GROUP]),
        lambda _: order_model._loose([GROUP]),
        ask_order_model,
    ],
    "models/plan/conflict/order_conflicts.py": [lambda _: orders_of(FACTS, [GROUP])],
    "models/plan/conflict/core.py": [lambda _: Way(range(PARTS), []).keeps(INVENTED)],
    "models/plan/explain/alternatives.py": [
        lambda _: PositionCosts(setting()),
        lambda _: other_statements(setting(), 0),
        lambda _: try_order(setting(), range(PARTS)),
    ],
    "models/plan/explain/explain.py": [lambda _: heat_prices(setting(at_weight(1.0, HEAT)), 0)],
    "models/plan/explain/context.py": [set_up],
    "models/plan/explain/other_places.py": [lambda _: OtherPlaces(setting())],
    "models/plan/explain/reasons.py": [lambda _: price_split(setting())],
    "models/engines/minizinc_model.py": [
        lambda _: condition_arrays(PROFILE, STATED),
        lambda _: conditions(INVENTED),
        lambda _: data_text(FACTS, PROFILE, STATED, OPTIONS, clock=False),
    ],
    "benchmarks/flattened.py": [lambda _: said(INVENTED)],
    "apps/resequence/burn_order.py": [lambda _: list(_with_chains(FACTS, [INVENTED], []))],
    "jobs/plan_without_zones.py": [lambda _: without_moves([INVENTED])],
    "jobs/route_paths.py": [lambda _: RoutePaths(FACTS, PROFILE, STATED)],
    "models/engines/baselines.py": [lambda _: solve_by("random", FACTS, PROFILE, (INVENTED,), OPTIONS, cold)],
}
"""File → what is called there with the invented statement."""


@pytest.mark.parametrize(
    ("file", "number"), [(file, k) for file, calls in REFUSES.items() for k in range(len(calls))], ids=str
)
def test_a_kind_that_nobody_knows_is_refused_by_name(file: str, number: int, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(AssertionError, match="Invented"):
        REFUSES[file][number](monkeypatch)


@pytest.mark.slow
def test_each_file_that_tells_kinds_apart_is_tried() -> None:
    found = {"rules/statements.py", *matching(), *sorting()}
    assert not found - set(REFUSES), "these tell kinds apart and are not tried"
    assert not set(REFUSES) - found, "these no longer tell kinds apart"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("heading", "kind", "found"),
    [
        ("## 3.", "a match over kinds", lambda: matching()),
        ("## 4.", "by_kind", lambda: sorting()),
        ("## 5.", "lags", lambda: reading("lags")),
    ],
    ids=["match", "by_kind", "lags"],
)
def test_the_page_lists_the_files(heading: str, kind: str, found: Callable[[], set[str]]) -> None:
    listed, there = set(listed_under(heading)), found()
    assert len(there) > 5
    assert not there - listed, f"docs/writing-a-statement.md, {heading}: these use {kind} and are not listed"
    assert not listed - there, f"docs/writing-a-statement.md, {heading}: these do not use {kind}"


def test_the_page_names_files_that_are_there() -> None:
    named = re.findall(r"`([\w/]+\.py)`", PAGE)
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_every_match_over_kinds_is_exhaustive() -> None:
    open_ended = [f"{file}:{node.lineno}" for file, tree in telling() for node in matches(tree) if not exhaustive(node)]
    assert open_ended == [], "a match over kinds ends in `case _: assert_never(…)`"


def test_nobody_tells_kinds_apart_in_another_way() -> None:
    found = [f"{file}:{line}" for file, tree in telling() for line in other_ways(tree)]
    assert found == [], "use by_kind or an exhaustive match"


OPEN = """
match s:
    case Precede():
        go()
    case _:
        pass
"""


@pytest.mark.parametrize("text", ["isinstance(s, Precede)", "isinstance(s, AtLeast | NoGood)", "type(s) is Lag"])
def test_other_ways_are_seen(text: str) -> None:
    assert list(other_ways(ast.parse(text))) == [1]


def test_an_open_match_is_seen() -> None:
    (node,) = matches(ast.parse(OPEN))
    assert not exhaustive(node)
    (node,) = matches(ast.parse(OPEN.replace("pass", "assert_never(s)")))
    assert exhaustive(node)


def listed_under(heading: str) -> Iterator[str]:
    """The files that a section of the page lists."""
    section = PAGE.split(f"\n{heading}")[1].split("\n## ")[0]
    yield from re.findall(r"^- `([\w/]+\.py)`", section, re.MULTILINE)


@cache
def sources() -> tuple[tuple[str, ast.Module], ...]:
    """Every file of the program that may know of kinds, by its path, with what is in it."""
    floors = ("rules", "models", "postproc", "jobs", "apps", "commands", "encoder", "benchmarks")
    files = (file for floor in floors for file in sorted((ROOT / floor).rglob("*.py")))
    texts = ((file.relative_to(ROOT).as_posix(), file.read_text(encoding="utf-8")) for file in files)
    return tuple((file, ast.parse(text)) for file, text in texts if any(word in text for word in WORDS))


def telling() -> Iterator[tuple[str, ast.Module]]:
    """Those that know kinds by name: a `Move` of a program or of a drawing is none."""
    for file, tree in sources():
        modules = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
        if file == "rules/statements.py" or any((module or "").endswith("rules.statements") for module in modules):
            yield file, tree


def names(node: ast.AST) -> set[str]:
    """Names and attributes anywhere below."""
    found = {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}
    return found | {n.attr for n in ast.walk(node) if isinstance(n, ast.Attribute)}


def matches(tree: ast.AST) -> Iterator[ast.Match]:
    """Each match with a kind of statement among its patterns."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Match):
            patterns = (p for case in node.cases for p in ast.walk(case.pattern) if isinstance(p, ast.MatchClass))
            if any(names(p.cls) & KINDS for p in patterns):
                yield node


def exhaustive(node: ast.Match) -> bool:
    """Whether a match ends in `case _: assert_never(…)`."""
    last, refused = node.cases[-1], f"assert_never({ast.unparse(node.subject)})"
    return ast.unparse(last.pattern) == "_" and ast.unparse(last.body[0]) == refused


def other_ways(tree: ast.AST) -> Iterator[int]:
    """Lines that ask for the type of something and name a kind of statement, or a union of them."""
    kinds = KINDS | UNIONS
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            asks = names(node.func) & {"isinstance", "issubclass"} and names(node.args[1]) & kinds
        elif isinstance(node, ast.Compare):
            asks = "type" in names(node) and names(node) & kinds
        else:
            continue
        if asks:
            yield node.lineno


def matching() -> set[str]:
    """Files with a match over kinds."""
    return {file for file, tree in telling() if any(matches(tree))}


def sorting() -> set[str]:
    """Files that call `by_kind`."""
    calls = ((file, node) for file, tree in sources() for node in ast.walk(tree) if isinstance(node, ast.Call))
    return {file for file, call in calls if isinstance(call.func, ast.Name) and call.func.id == "by_kind"}


def reading(field: str) -> set[str]:
    """Files of the models that read a field of the problem, or of what is made of it."""
    return {
        file
        for file, tree in sources()
        if file.startswith("models/")
        and any(isinstance(node, ast.Attribute) and node.attr == field for node in ast.walk(tree))
    }
