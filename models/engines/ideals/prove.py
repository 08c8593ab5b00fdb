"""Proves the best plan wherever the sets that can occur are few, stretch after stretch."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from kerfwise.models.engines import bounds
from kerfwise.models.engines.solution import Incumbent, Progress
from kerfwise.models.kernels import running_s
from kerfwise.models.problem.problem import Problem

from .budget import TABLE_BYTES, SweepBudget, TooLarge
from .lattice import THREADS
from .series import series
from .sweep import sweep_through

if TYPE_CHECKING:
    from kerfwise.models.engines.bounds import Completion

STAGES = (0.03, 0.1, 0.4)
"""Shares of the work, or the time, for the bound by walks: a quick one first, as a sweep often is short even so."""
AS_GOOD_AS_IT_GETS = 0.8
"""A bound that took no more than this of its share will not become better with more."""
MOST_SITES, MOST_SITES_BOUND = 4000, 1500
"""Sites of a stretch: with more the table of moves is too large; sites altogether: the bound takes too long."""


@dataclass(frozen=True, slots=True)
class Proof:
    """The best route there is; `incumbent` is None where no lawful route exists at all.

    `work` is what the proof took, in deterministic seconds (`count.ADDITIONS_PER_S` additions each).
    """

    incumbent: Incumbent | None
    work: float = field(default=0.0, compare=False)


def applies(problem: Problem) -> bool:
    """Whether a state of the sweep holds all that a step costs: all crossings have one price."""
    return problem.looks_one_back and len(np.unique(problem.crossings.cost)) <= 1


def unfit(problem: Problem) -> str:
    """Why a proof is not worth a try; empty where it is: it applies, and the moves of every stretch fit in a table."""
    if problem.further_back is not None:
        return f"rule {problem.further_back.rule} looks further back than the last cut"
    if not applies(problem):
        return "moves over parts that are out have several prices"
    size = np.diff(problem.first)
    longest = max((int(size[list(g)].sum()) for g in series(problem)), default=0)
    return "" if 0 < longest <= MOST_SITES else f"it takes up to {MOST_SITES} ways to cut, a stretch has {longest}"


def prove(
    problem: Problem,
    incumbent: Incumbent | None,
    work: float,
    progress: Progress | None = None,
    stages: tuple[float, ...] = STAGES,
    time_s: float | None = None,
    most_bytes: float = TABLE_BYTES,
) -> Proof | None:
    """Solve exactly, or return None if the budget does not suffice.

    Parameters
    ----------
    problem
        Anything; where a state cannot hold what is asked, the answer is None.
    incumbent
        Makes it faster, never different: states that cannot lead to a plan as cheap are dropped.
    work
        Deterministic limit, in seconds or so.
    progress
        Asked now and then whether to go on.
    stages
        Shares of the work for a bound by walks, which takes its time and drops far more states.
    time_s
        Wall-clock time, s, of which the bound takes no more than its share.
    most_bytes
        What the tables may take, those of the bound included.
    """
    if unfit(problem):
        return None
    known = incumbent.cost if incumbent else None

    def go() -> bool:
        return progress is None or progress("ideals", known, None)

    rounds = _Rounds(problem, known, work, go, most_bytes)
    if not stages or known is None or problem.m > MOST_SITES_BOUND:
        return rounds.sweep(None, work)
    for share in stages:
        until_s = np.inf if time_s is None else running_s() + share * time_s

        def pricing(engine: str, cost_um: int | None, bound_um: int | None, until_s: float = until_s) -> bool:
            return go() and running_s() < until_s

        bound = bounds.complete(problem, float(known), share * work, pricing, most_bytes=most_bytes)
        rounds.left -= bound.work
        last = share == stages[-1] or bound.work <= AS_GOOD_AS_IT_GETS * share * work
        proof = rounds.sweep(bound, rounds.left if last else min(rounds.left, share * work))
        if proof is not None or last or not go():
            return proof
    return None


@dataclass(slots=True)
class _Rounds:
    """Sweeps of a problem, paid from `work` seconds of which `left` are left."""

    problem: Problem
    known: int | None
    work: float
    go: Callable[[], bool]
    most_bytes: float
    left: float = field(init=False)

    def __post_init__(self) -> None:
        self.left = self.work

    def sweep(self, bound: Completion | None, most: float) -> Proof | None:
        """What a sweep of no more than so many seconds proves."""
        held = 0 if bound is None else bound.to_go.nbytes
        budget = SweepBudget.of(max(0.0, most), self.go, self.most_bytes - held)
        best: Incumbent | None = None
        with ThreadPoolExecutor(THREADS) as threads:
            try:
                best = sweep_through(self.problem, self.known, bound, budget, threads)
                swept = True
            except TooLarge:
                swept = False
        self.left -= most - max(0.0, budget.work.left)
        return Proof(best, self.work - self.left) if swept else None
