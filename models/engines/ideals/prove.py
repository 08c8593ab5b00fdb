"""Proves the best plan wherever the sets that can occur are few, stretch after stretch.

With a bound on what is still to come, far fewer states are gone through the less a plan may cost. So plans are looked
for that cost little more than the bound, then such that cost more, until there is one: it is the best (as A* by rising
limits does, Korf 1985). How good the plan is that was known before hardly matters then, and where the budget ends too
soon, every limit that no plan kept to is a bound.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field, replace
from math import ceil, inf, isinf
from typing import TYPE_CHECKING

import numpy as np

from kerfwise.models.engines import bounds
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals.stretches.stretch_bounds import (
    Ahead,
    LeastIn,
    least_rest,
    limits_within_work,
    look_ahead,
    missed_in,
    rising_limits,
    walked_rest,
)
from kerfwise.models.engines.ideals.stretches.stretch_tables import FAR, one_price
from kerfwise.models.engines.solution import Incumbent, flows_s
from kerfwise.models.engines.tuning import (
    AS_GOOD_AS_IT_GETS,
    BACKWARD,
    BOUND,
    FIRST_WIDTH,
    LARGE_NEST,
    MOST_SITES_BOUND,
    MOST_SITES_PRICED,
    OVERDRAWN_S,
    PRICED_ALONE,
    PRICED_WIDER,
    SETTING_OUT,
    STAGES,
)
from kerfwise.models.engines.tuning import PROVE_MOST_SITES as MOST_SITES
from kerfwise.models.engines.tuning import PROVE_PRICED as PRICED
from kerfwise.models.engines.tuning import PROVE_WIDENED as WIDENED
from kerfwise.models.engines.tuning import STRETCH_WIDER as WIDER
from kerfwise.models.problem.problem import Problem

from .lattice import THREADS, Rests, TooLarge, Width, sweep_through, sweeping
from .stretch import Local, RestBound, series

if TYPE_CHECKING:
    from kerfwise.models.engines.bounds import Completion
    from kerfwise.models.engines.ideals.stretches.priced_stretches import StretchPrices

_Sweep = Callable[[int | None], Incumbent | None]


@dataclass(frozen=True, slots=True)
class Proof:
    """The best route there is; `incumbent` is None where no lawful route exists at all.

    `work` is what the proof took, in deterministic seconds (`count.ADDITIONS_PER_S` additions each). Where it did not
    suffice, `least` is what every route costs at least, µm, and there is no incumbent; `better` is the best route that
    is known all the same. `priced` is what was found out of its stretches by linear programs, where it was asked for.
    """

    incumbent: Incumbent | None
    work: float = field(default=0.0, compare=False)
    least: int | None = None
    priced: tuple[StretchPrices, ...] = field(default=(), compare=False, repr=False)
    better: Incumbent | None = None


def unfit(problem: Problem) -> str:
    """Why a proof is not worth a try; empty where it is: it applies, and the moves of every stretch fit in a table."""
    if problem.further_back is not None:
        return f"rule {problem.further_back.rule} looks further back than the last cut"
    longest = max((sites for _, sites in _sizes(problem)), default=0)
    return "" if 0 < longest <= MOST_SITES else f"it takes up to {MOST_SITES} ways to cut, a stretch has {longest}"


def priceable(problem: Problem) -> bool:
    """Whether linear programs of all stretches hold all that is asked: no groups cost, and crossings have one price."""
    if unfit(problem) or problem.soft_groups or problem.general or not one_price(problem):
        return False
    return problem.n <= LARGE_NEST and max(sites for _, sites in _sizes(problem)) <= MOST_SITES_PRICED


def sets_out(problem: Problem, work: float) -> bool:
    """Whether linear programs of all stretches have their first bounds well within the work of `prove_priced`."""
    took_s = sum(flows_s(contours, sites) for contours, sites in _sizes(problem))
    return took_s <= SETTING_OUT * PRICED_ALONE * work


def _sizes(problem: Problem) -> list[tuple[int, int]]:
    """How many contours and sites every stretch has."""
    size = np.diff(problem.first)
    return [(len(group), int(size[list(group)].sum())) for group in series(problem)]


def prove_priced(
    problem: Problem,
    incumbent: Incumbent,
    deadline: Deadline,
) -> Proof | None:
    """As `prove`, by linear programs of the stretches alone, of which one may be all there is; it must be `priceable`.

    `incumbent` is a lawful plan. Of the seconds, where they count, the programs take no more than their share.
    """
    if incumbent.cost >= FAR:
        return None
    return _Rounds(problem, incumbent.cost, deadline).priced(incumbent, (), PRICED_ALONE)


def prove(
    problem: Problem,
    incumbent: Incumbent | None,
    deadline: Deadline,
    stages: tuple[float, ...] = STAGES,
    earlier: tuple[StretchPrices, ...] = (),
) -> Proof | None:
    """Solve exactly, or say what is proven if the budget does not suffice; None if nothing is.

    Parameters
    ----------
    problem
        Anything; where a state cannot hold what is asked, the answer is None.
    incumbent
        Makes it faster, never different: no plan is looked for that costs more.
    deadline
        Of its bytes the tables take no more, those of the bound included.
    stages
        Shares of the work, and of as many seconds where they count, for a bound by walks, which takes its time and
        drops far more states.
    earlier
        Multipliers of the stretches of the same problem with fewer statements.
    """
    if unfit(problem):
        return None
    known, work = incumbent.cost if incumbent else None, deadline.work
    rounds = _Rounds(problem, known, deadline)
    apart = len(series(problem)) > 1
    if not stages or incumbent is None or known is None or (not apart and problem.m > MOST_SITES_BOUND):
        return rounds.sweep(None, work)
    programs = apart and len(stages) > 1 and known < FAR and priceable(problem)
    for share in stages:
        tried = share != stages[0] or earlier
        if programs and tried and (found := rounds.priced(incumbent, earlier)) is not None:
            return found
        try:
            most = rounds.left + (OVERDRAWN_S if programs else 0.0)  # with as much no sweep is left, but programs are
            bound = bound_by_walks(problem, incumbent, deadline.within(share * work), most)
        except bounds.TooMuch as error:
            rounds.left -= error.work
            return (rounds.priced(incumbent, earlier) if programs and not tried else None) or rounds.proven
        rounds.left -= bound.work
        more = programs and share == stages[0]  # linear programs come next
        last = share == stages[-1] or (bound.work <= AS_GOOD_AS_IT_GETS * share * work and not more)
        proof = rounds.sweep(bound, rounds.left if last else min(rounds.left, share * work))
        if proof is not None or last or not deadline.go():
            return proof or rounds.proven
        del bound  # the next has tables of its own
    return rounds.proven


def bound_by_walks(
    problem: Problem,
    incumbent: Incumbent,
    deadline: Deadline,
    most: float = inf,
) -> Completion | Apart:
    """Bounds of every stretch apart, or of the one that there is.

    Raises TooMuch if the least that they take is `most` deterministic seconds or more.
    """
    if len(series(problem)) > 1:
        return Apart(look_ahead(problem, incumbent.route, deadline, most), incumbent)
    return bounds.complete(problem, float(incumbent.cost), deadline, most=most)


def rests_of(
    problem: Problem, bound: Completion | Apart | None, deadline: Deadline, threads: Executor
) -> tuple[Rests, float]:
    """What a sweep needs of a bound by walks, or of none, and what plans cost at least; infinite where that is unknown.

    Raises TooLarge over the budget.
    """
    if isinstance(bound, Apart):
        return bound.rests(problem, deadline, threads)
    if bound is not None:
        return (lambda number, local, earlier: walked_rest(local, earlier, bound)), bound.root
    least = LeastIn(problem)
    return (lambda number, local, earlier: least_rest(local, earlier, least)), inf


@dataclass(frozen=True, eq=False, slots=True)
class Apart:
    """Bounds of every stretch, and a lawful plan."""

    ahead: list[Ahead]
    plan: Incumbent

    @property
    def work(self) -> float:
        """Deterministic seconds that they took."""
        return sum(stretch.bound.work for stretch in self.ahead)

    def rests(self, problem: Problem, deadline: Deadline, threads: Executor) -> tuple[Rests, float]:
        """What a sweep of all stretches needs of them, sharpened by what they miss, and what plans cost at least.

        Raises TooLarge over the budget.
        """
        missed = missed_in(problem, self.ahead, self.plan.route, self.plan.cost, deadline, threads)

        def rests(number: int, local: Local, earlier: frozenset[int]) -> Callable[[int], RestBound]:
            return self.ahead[number].rests(local, sum(missed[number + 1 :]))

        return rests, self.ahead[0].bound.root + sum(missed)


@dataclass(slots=True)
class _Rounds:
    """Sweeps of a problem, paid from the deadline's work, of which `left` is left; all plans cost `least` or more."""

    problem: Problem
    known: int | None
    deadline: Deadline
    left: float = field(init=False)
    least: int = 0
    better: Incumbent | None = None

    def __post_init__(self) -> None:
        self.left = self.deadline.work
        self.deadline.engine = "ideals"
        self.deadline("ideals", self.known, None)

    @property
    def proven(self) -> Proof | None:
        """What is proven where no sweep came to its end."""
        return Proof(None, self.deadline.work - self.left, self.least, better=self.better) if self.least > 0 else None

    def sweep(self, bound: Completion | Apart | None, most: float) -> Proof | None:
        """What sweeps of no more than so many seconds prove."""

        def sweeps(deadline: Deadline, threads: Executor) -> tuple[_Sweep, float]:
            rests, least = rests_of(self.problem, bound, deadline, threads)
            return (lambda limit: sweep_through(self.problem, limit, rests, deadline, threads)), least

        return self._rise(sweeps, held_by(bound), most)

    def priced(
        self,
        incumbent: Incumbent,
        earlier: tuple[StretchPrices, ...],
        part: float = PRICED,
    ) -> Proof | None:
        """What sweeps prove by linear programs of all stretches, which take so much at the most; None for nothing."""
        from . import priced  # its programs take long to load

        share = part * self.left
        apart = len(series(self.problem)) > 1
        swept = BACKWARD * self.left if apart else 0.0
        within = self.deadline.within(part * self.deadline.work).counting(share)
        stretches = priced.price(self.problem, incumbent, within, earlier, swept, OVERDRAWN_S)
        if stretches is None:
            self.left -= share
            return self.proven
        self.left -= stretches.work
        self.least = max(self.least, int(stretches.root))

        def sweeps(deadline: Deadline, threads: Executor) -> tuple[_Sweep, float]:
            found = stretches.descend(incumbent.cost, deadline, threads) if apart else None
            self.better = incumbent if found is None or found.cost >= incumbent.cost else found
            self.known = self.better.cost
            return (lambda limit: stretches.sweep(limit, deadline, threads)), stretches.root

        proof = self._rise(sweeps, stretches.nbytes, self.left, None if apart else PRICED_WIDER) or self.proven
        return None if proof is None else replace(proof, priced=stretches.found)

    def _rise(
        self,
        sweeps: Callable[[Deadline, Executor], tuple[_Sweep, float]],
        held: int,
        most: float,
        wider: float | None = WIDER,
    ) -> Proof | None:
        deadline = sweeping(self.deadline, max(0.0, most), held)
        best: Incumbent | None = None
        swept = False
        with ThreadPoolExecutor(THREADS) as threads, suppress(TooLarge):
            sweep_to, least = sweeps(deadline, threads)
            if self.better is not None and self.better.cost <= least:
                best = self.better
            for limit in () if best is not None else self._limits(least, wider, deadline):
                if limit is not None and limit < self.least:
                    continue
                best = sweep_to(limit)  # layers are kept for once
                if best is not None or limit is None:
                    break
                self.least = max(self.least, limit + 1)
            swept = True
        self.left -= most - max(0.0, deadline.left)
        return Proof(best, self.deadline.work - self.left) if swept else None

    def _limits(self, least: float, wider: float | None, deadline: Deadline) -> Iterator[int | None]:
        """Limits that rise, each so many times `wider`; None for such that each sweep will end."""

        def left() -> float:
            return deadline.left

        if wider is None and self.known is not None:
            return limits_within_work(least, self.known, left)
        return rising_limits(least, self.known, left, WIDER if wider is None else wider)


def held_by(bound: Completion | Apart | None) -> int:
    """Bytes that a bound takes."""
    if isinstance(bound, Apart):
        return sum(stretch.bound.to_go.nbytes for stretch in bound.ahead)
    return 0 if bound is None else bound.to_go.nbytes


# Sweeps that keep the most promising states of every layer, each sweep wider than the last (Libralesso et al. 2020).
#
# Where the sets are too many for a sweep of all, one of few finds a plan soon. What it drops bounds all plans that it
# could have missed, and where nothing is dropped that a better plan could be in, the plan is proven.

ROUNDING = 1e-3
"""Bounds are sums of doubles, costs whole: what is under the next whole number by less is taken for it."""


def widen(
    problem: Problem,
    incumbent: Incumbent | None,
    deadline: Deadline,
    width: int = FIRST_WIDTH,
) -> Proof:
    """The best plan of sweeps of so many states and more, until it is proven or the work is spent.

    Parameters
    ----------
    problem
        One that the ideals are fit for (`prove.unfit`).
    incumbent
        A lawful plan: states that cannot lead to a cheaper one are dropped without a loss.
    """
    best, least, work = incumbent, 0, deadline.work
    deadline.engine = "ideals"
    deadline("ideals", None if best is None else best.cost, None)
    bound: Completion | Apart | None = None
    if incumbent is not None and incumbent.cost < FAR and (len(series(problem)) > 1 or problem.m <= MOST_SITES_BOUND):
        with suppress(bounds.TooMuch):
            bound = bound_by_walks(problem, incumbent, deadline.counting(BOUND * work), work)
    spent = 0.0 if bound is None else bound.work
    swept = sweeping(deadline, work - spent, held_by(bound))
    with ThreadPoolExecutor(THREADS) as threads, suppress(TooLarge):
        rests, root = rests_of(problem, bound, swept, threads)
        least = 0 if isinf(root) else max(0, ceil(root - ROUNDING))
        while True:
            had, kept = swept.left, Width(width)
            limit = None if best is None else best.cost - 1
            found = sweep_through(problem, limit, rests, swept, threads, kept)
            if found is not None:
                best = found
                deadline("ideals", best.cost, None)
            if isinf(kept.dropped) or (best is not None and kept.dropped > best.cost - 1 + ROUNDING):
                return Proof(best, work - swept.left)
            least = max(least, ceil(kept.dropped - ROUNDING))
            if swept.left < WIDENED * (had - swept.left):
                break
            width *= WIDENED
    return Proof(None, work - max(0.0, swept.left), least, better=best)
