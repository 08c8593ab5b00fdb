"""What is known of a problem while engines work on it, and their shares of the work."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from kerfwise.models.engines.tuning import SET_OUT_S
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import About

from . import Member, solution
from .deadline import Deadline, Progress
from .solution import Incumbent, SolveOptions, table_bytes

if TYPE_CHECKING:
    from kerfwise.models.engines import ideals
    from kerfwise.models.engines.ideals.stretches.priced_stretches import StretchPrices
    from kerfwise.models.engines.search import Searcher
    from kerfwise.models.engines.search.state.route_state import TablesOf


@dataclass(slots=True)
class SharedState:
    """What is known of a problem so far, who found it, and what was chosen why.

    `priced` is what a proof has found out of every stretch of the order, where it was begun, `tables` what a search
    has read of this problem or of one with other statements.
    `against` are the statements that show that there is no plan, where they are known.
    `unable` says why the one member that was asked for cannot find a plan; empty where it can, or all may run.
    """

    incumbent: Incumbent | None = None
    found_by: str = ""
    bound_um: int = 0
    proved_by: str = ""
    infeasible: bool = False
    against: tuple[About, ...] = ()
    work: float = 0.0
    notes: list[str] = field(default_factory=list)
    unable: str = ""
    priced: tuple[StretchPrices, ...] = ()
    tables: TablesOf | None = None

    @property
    def proven(self) -> bool:
        """Whether nothing is left to find out."""
        return self.infeasible or (self.incumbent is not None and self.bound_um >= self.incumbent.cost)

    def offer(self, incumbent: Incumbent | None, engine: str) -> None:
        """Take an incumbent if it is better."""
        if incumbent is not None and (self.incumbent is None or incumbent.cost < self.incumbent.cost):
            self.incumbent, self.found_by = incumbent, engine

    def raise_bound(self, bound_um: int, engine: str) -> None:
        """Take a bound if it is better."""
        if bound_um > self.bound_um or (bound_um == self.bound_um == 0 and not self.proved_by):
            self.bound_um, self.proved_by = bound_um, engine

    def take_bound(self, fewer: SharedState) -> None:
        """What is proven of the problem with fewer statements is proven of it: a bound, or that there is no plan."""
        self.infeasible, self.against = self.infeasible or fewer.infeasible, self.against or fewer.against
        if fewer.proved_by:
            self.raise_bound(fewer.bound_um, fewer.proved_by)


Found = Callable[[Incumbent], None]
"""Told of a plan that is better than those before it."""


class Run:
    """One problem, its limits and what is known so far; members read it and write to `known`.

    `count` is how many sets there are, as far as they were counted, `swept` whether a sweep of all of them was tried.
    `preview` is a plan that was `shown` meanwhile and that no member goes on from, `near` a route that breaks something
    and that the search goes on from, `searcher` the search that is gone on with. `excuses_um` is what excuses cost
    every plan at least.
    """

    def __init__(
        self, problem: Problem, options: SolveOptions, listener: Progress | None = None, found: Found | None = None
    ) -> None:
        self.problem, self.options, self._found = problem, options, found
        self._told_um: int | None = None
        most_bytes = table_bytes(options.memory_gb, solution.crossed_bytes(problem))
        self.deadline = Deadline.of(options, listener, most_bytes)
        self.of_sets = replace(problem, general=())  # all but what a set and the last site cannot tell
        self.known = SharedState()
        self.count: ideals.Count | None = None
        self.swept = self.shown = self.wishes_left_out = False
        self.preview: Incumbent | None = None
        self.near: tuple[int, ...] | None = None
        self.excuses_um = 0
        self.searcher: Searcher | None = None

    def offer(self, incumbent: Incumbent | None, engine: str) -> None:
        """Take a plan if it is better than what is known, and tell of it."""
        self.known.offer(incumbent, engine)
        if incumbent is not None:
            self.tell(incumbent.cost, lambda: incumbent)

    def tell(self, cost_um: int | None, plan: Callable[[], Incumbent | None]) -> None:
        """Tell of a plan of that cost if it is better than all that was told: a member need not have ended for it."""
        if self._found is None or cost_um is None or (self._told_um is not None and cost_um >= self._told_um):
            return
        if (incumbent := plan()) is not None:
            self._told_um = cost_um
            self._found(incumbent)

    def left(self) -> float:
        """Seconds of work that are left, or by the clock where that is limited."""
        return max(0.0, self.deadline.left)

    def over(self) -> bool:
        """Whether no further member is to begin."""
        limited = self.deadline.timed and self.known.incumbent is not None
        late = limited and self.left() < SET_OUT_S
        return self.known.proven or self.deadline.stopped or late

    def takes(self, member: Member, why: str) -> bool:
        """Whether a member may run; it is noted why."""
        forced = self.options.member
        if forced is not None and forced != member:
            return False
        self.known.notes.append(f"{member}: {why if forced is None else 'asked for'}")
        return True

    def can(self, member: Member, unfit: str) -> bool:
        """Whether nothing, as `unfit` says, keeps a member from the problem; what does is noted."""
        if unfit:
            self.known.notes.append(f"{member}: left out, {unfit}")
            self.known.unable = unfit if self.options.member == member else ""
        return not unfit

    def sets_out(self, took_s: float, share: float) -> bool:
        """Whether a member has time for more than its tables; where there is no plan yet, or it was asked for, so."""
        return self.options.member is not None or self.known.incumbent is None or took_s <= share


# What the portfolio goes by: shares of the work for its members, and sizes up to which each is worth it.
#
# Names that end in `_S` are seconds of work, other shares are of what is left of it when the member begins.
