"""What is known of a problem while engines work on it, and their shares of the work."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from kerfwise.models.problem.problem import Problem

from . import Member, solution
from .deadline import Deadline, Progress
from .solution import Incumbent, SolveOptions, table_bytes

if TYPE_CHECKING:
    from kerfwise.models.engines import ideals
    from kerfwise.models.engines.ideals.priced_stretches import StretchPrices
    from kerfwise.models.engines.search import Searcher


@dataclass(slots=True)
class SharedState:
    """What is known of a problem so far, who found it, and what was chosen why.

    `priced` is what a proof has found out of every stretch of the order, where it was begun.
    `unable` says why the one member that was asked for cannot find a plan; empty where it can, or all may run.
    """

    incumbent: Incumbent | None = None
    found_by: str = ""
    bound_um: int = 0
    proved_by: str = ""
    infeasible: bool = False
    work: float = 0.0
    notes: list[str] = field(default_factory=list)
    unable: str = ""
    priced: tuple[StretchPrices, ...] = ()

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
        self.infeasible = self.infeasible or fewer.infeasible
        if fewer.proved_by:
            self.raise_bound(fewer.bound_um, fewer.proved_by)


Found = Callable[[Incumbent], None]
"""Told of a plan that is better than those before it."""


class Run:
    """One problem, its limits and what is known so far; members read it and write to `known`.

    `count` is how many sets there are, as far as they were counted, `swept` whether a sweep of all of them was tried.
    `preview` is a plan that was `shown` meanwhile and that no member goes on from, `searcher` the search that is gone
    on with.
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

FIRST, FIRST_S = 0.03, 0.9
"""Share of the work for a first look by the search; as many seconds at the least."""
AT_ONCE = 0.6
"""Share of what is left that a first look, or a sweep over all sets before it, may take at the most."""
WITHOUT_WISHES = 0.1
"""Share of what is left for the best plan without wishes that tie the whole order together."""
PROOF, PROOF_SMALL, PROOF_ZONES = 0.45, 0.9, 0.75
"""Share that the proof by ideals may take, where it fits; most take next to nothing.

On small problems the search has found the best plan long since, and only the proof is left to do. Zones that linear
programs hold have more: their sweeps find better plans than a search does.
"""
SET_OUT_S = 0.2
"""Seconds below which no further member begins: each has tables of its own to make first."""
LOOKS, SEEDS_APART = 3, 1_000_003
"""Searches from scratch in the first look, where contours are few, and how far their seeds are apart.

With more they are so short that orders which bind tightly hold all of them up.
"""
DENSE, WIDENED = 0.15, 0.5
"""Share of the pairs of contours that hard orders decide, from which on the most promising sets lead to good plans; and
share of what is left for sweeps of these, each wider than the last."""
FLOW_FEW = 80
"""Contours up to which the bound by flows and its multipliers may prove a plan at once, so that they come before more
search; with more, plans are improved at the same time."""
FLOW_FIRST, FLOW_CARRIED, FLOW = 0.15, 0.4, 0.95
"""Shares for the bound by flows before more search; where CP-SAT alone holds all that is asked; and at last, after that
search or beside it: the better the plan, the more it closes."""
SEARCH_NEST = 0.3
"""Share for more search in small nests that flows bound well."""
PRICED = 0.6
"""Share for the ideals with multipliers of the flow, where these hold all that is asked of a small nest."""
FIRST_BOUNDS = 1 / 30
"""Share of the work beside a search in which such programs must come to their first bounds: with less work sweeps are
far from the plan, and flows alone bound higher."""
SEARCH_ALONE, SEARCH_BESIDE = 0.1, 0.4
"""For larger ones shares for search alone, and then for search beside the bound, which keeps one core busy:
the search has what that leaves of two."""
SEARCH, SEARCH_PLAIN, SEARCH_LAST = 0.6, 0.9, 0.97
"""Shares for more search elsewhere: where CP-SAT alone can prove anything, as statements look further back than a state
does; where CP-SAT has the rest; and where that would not do for CP-SAT's model."""
AT_ONCE_S, AT_ONCE_MANY_S = 1.5, 2.5
"""A sweep over all sets is begun with, before any search, if it takes no longer. Where contours are so many that no
bound makes the sets few, a plan known before helps less, and it may take longer."""
SURE = 0.4
"""Share of what is left that a sweep over all sets may take so that nothing else is tried before it."""
COUNTED, COUNTED_FEW = 2e7, 5e6
"""Entries that are counted beforehand at the most, where there are `COUNTED_S` seconds or more; and where contours are
so few that a bound is tried anyway."""
COUNTED_S, COUNTED_DENSE_S, COUNTED_ALONE_S, COUNTED_ALONE_CONTOURS = 15.0, 5.0, 2.5, 2500
"""The second where orders are dense, and sets often few enough; the third where nothing but a sweep is asked for,
beyond so many contours: there most of the work is a sweep's."""
PREVIEW_WORK, PREVIEW_MOST_CONTOURS, PREVIEW_AFTER_ENTRIES = 0.05, 200, 3_000_000
"""Work of a preview while sets are counted, contours up to which it takes less than a second, and entries that are
counted before, in less than a second: a plan is shown while many are counted, and where they are few the search need
not be compiled. It is no part of what a plan takes, so that a plan is the same whoever looks on."""
LONGEST, LONGEST_ZONE = 36, 80
"""Contours in a stretch up to which a bound may make the ideals few; and in one of several, none of which is most of
all."""
