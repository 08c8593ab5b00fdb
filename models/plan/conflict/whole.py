"""Contradictions over moves and seconds: the engines themselves are asked whether statements can all hold.

Every question is a plan of the whole nest to be found or proven impossible, so that this is for small nests.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.segment import Point
from kerfwise.models.engines.budget import Budget
from kerfwise.models.engines.portfolio import run_portfolio
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.watch import Watch
from kerfwise.models.physics.timing.constant import Feeds
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.simplify import simplify

from .core import Core, in_order
from .group import Group
from .shrinking import shrink, without_rules
from .solver import DEFAULT_WORK, NotAnswered

QUESTION = 3.0
"""Work, as `SolveOptions` counts it, for one question; past it the question counts as not answered."""
ALL_QUESTIONS = 45.0
"""Work for all questions together; past it a contradiction is told as far as it has been shrunk."""


class Engines:
    """What the engines answer, as long as their work and the budget last."""

    def __init__(
        self, facts: Facts, home_mm: Point, feeds: Feeds, work: float = ALL_QUESTIONS, budget: Budget | None = None
    ) -> None:
        self.facts, self.home_mm, self.feeds, self.left = facts, home_mm, feeds, work
        self.budget = budget or Budget(DEFAULT_WORK)

    def clash(self, groups: Sequence[Group]) -> list[int] | None:
        """All the groups by number if they cannot all hold, None if they can.

        Raises
        ------
        NotAnswered
            If neither was shown, or all work is done.
        """
        if self.left <= 0 or self.budget.left <= 0:
            raise NotAnswered
        statements = tuple(s for group in groups for s in group.statements)
        try:
            problem = simplify(make_problem(self.facts, statements, self.home_mm, self.feeds, going=self._going))
        except RulesConflict:
            return list(range(len(groups)))
        options = SolveOptions(work=QUESTION, time_s=min(QUESTION, self.budget.left) if self.budget.timed else None)
        known = run_portfolio(problem, options, Watch(options, lambda engine, cost_um, bound_um: cost_um is None))
        self.left -= known.work
        self.budget.spend(known.work)
        if known.incumbent is not None:
            return None
        if not known.infeasible:
            raise NotAnswered
        return list(range(len(groups)))

    def _going(self, share: float) -> bool:
        """Asked while moves are looked at, as many as there are; there is no answer once nothing is left."""
        if self.budget.timed and self.budget.left <= 0:
            raise NotAnswered
        return True


def find_whole_core(engines: Engines, groups: Sequence[Group], gives_way: Mapping[str, int]) -> Core | None:
    """A contradiction among the groups, minimal unless the work runs out before; None if there is none.

    Whole rules are left out first, then halves, quarters, … and at last single groups.

    Raises
    ------
    NotAnswered
        If it was not shown whether all can hold.
    """
    core = sorted(groups, key=lambda group: -gives_way.get(group.about.rule, 0))
    if engines.clash(core) is None:
        return None
    core, minimal = shrink(without_rules(core, gives_way, engines.clash), engines.clash)
    return in_order(groups, core, minimal)
