"""The optimum of a case as every engine proves it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from kerfwise import RulesConflict
from kerfwise.models.engines.minizinc_engine import solve_minizinc
from kerfwise.models.engines.solution import Solution
from kerfwise.models.engines.solve import solve
from kerfwise.rules.stating.lazy_statements import lazy_statements
from kerfwise.rules.stating.state_rules import Stated
from kerfwise.tests.models.engines.cases import Case

IMPOSSIBLE = "no plan meets every hard rule"
UNPROVEN = "nothing proven"


@dataclass(frozen=True)
class Answer:
    """What an engine says: the optimum in mm and its plan, or that there is no plan, or nothing proven."""

    says: str
    mm: float | None = None
    route: tuple[int, ...] = ()


def default_pipeline(case: Case, stated: Stated) -> Answer:
    """Search, ideals and CP-SAT as `kerfwise solve` runs them, with afterthoughts."""
    refine = lazy_statements(case.facts, case.profile)
    return _answer(lambda: solve(case.facts, stated.statements, case.options, refine=refine))


def gecode(case: Case, stated: Stated) -> Answer:
    """MiniZinc's Gecode over the rule files, with afterthoughts."""
    refine = lazy_statements(case.facts, case.profile)
    return _answer(lambda: solve_minizinc(case.facts, case.profile, stated, case.options, refine=refine))


def _answer(ask: Callable[[], Solution]) -> Answer:
    try:
        found = ask()
    except RulesConflict as conflict:
        return Answer(UNPROVEN if "within the limit" in conflict.message else IMPOSSIBLE)
    if found.status != "optimal":
        return Answer(UNPROVEN, found.objective, found.route)
    return Answer("optimal", found.objective, found.route)


ENGINES = {"default pipeline": default_pipeline, "Gecode": gecode}
"""Name → what is asked of it."""
