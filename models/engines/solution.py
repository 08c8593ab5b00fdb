"""What is asked of an engine, what it answers, what it needs to set up, and when it stops."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from kerfwise.models.jit import running_s
from kerfwise.models.physics.motion import Feeds
from kerfwise.models.problem.problem import Problem

from . import Member

Status = Literal["optimal", "feasible"]
MEMORY_GB = 2.0
"""What a solve may hold where nobody says more or less."""
BYTES_PER_GB = 1e9
BESIDE_GB, LEAST_SHARE = 0.4, 0.2
"""What libraries, nest and problem take beside the tables of engines; and the share that is left for those anyway."""


def table_bytes(memory_gb: float, held_bytes: float = 0.0) -> float:
    """How many bytes the tables of engines that run at the same time may take, of so much memory in all.

    `held_bytes` are taken by what is held beside them, above what every problem takes.

    Examples
    --------
    >>> table_bytes(2.0), table_bytes(0.4), table_bytes(2.0, 6e8)
    (1600000000.0, 80000000.0, 1000000000.0)
    """
    held_gb = BESIDE_GB + held_bytes / BYTES_PER_GB
    return round(max(memory_gb - held_gb, LEAST_SHARE * memory_gb) * BYTES_PER_GB, 0)


@dataclass(frozen=True, slots=True)
class SolveOptions:
    """Limits of a solve.

    `work` is deterministic: about as many seconds as this machine class needs, but counted in iterations and
    CP-SAT's deterministic time, so that the same input gives the same plan. `time_s`, if given, is wall-clock time
    and cuts the work short. `gap` is a share of the objective: a plan proven to be that close to the best is good
    enough. `no_improvement_s` is how long, s, a plan may stay the best known before it is taken. `member` names the
    one member of the portfolio that is to run, None lets it choose. `feeds` are needed where rules count seconds.
    `memory_gb` is what the process may hold: it limits the tables of the members that keep sets, less what is held
    beside them; not CP-SAT, and not linear programs.
    """

    seed: int = 1
    work: float = 30.0
    time_s: float | None = None
    home_mm: tuple[float, float] = (0.0, 0.0)
    feeds: Feeds | None = None
    gap: float | None = None
    no_improvement_s: float | None = None
    member: Member | None = None
    memory_gb: float = MEMORY_GB


@dataclass(frozen=True, slots=True)
class Incumbent:
    """A lawful route (sites in cutting order) and its cost, µm."""

    route: tuple[int, ...]
    cost: int


@dataclass(frozen=True, slots=True)
class Solution:
    """The best route found, as candidate numbers in cutting order.

    `objective` and `bound` are in mm; `bound` is None unless proven for the whole model. `seconds` is wall-clock time
    under a time limit, else the deterministic work spent, so that the same input gives the same plan to the byte.
    `notes` say which members of the portfolio ran, which did not, and why.
    `left_out` are soft rules that objective and bound say nothing of, because the nest is too large, and why.
    """

    route: tuple[int, ...]
    objective: float
    bound: float | None
    status: Status
    found_by: str
    proved_by: str
    seconds: float
    notes: tuple[str, ...] = ()
    left_out: tuple[tuple[str, str], ...] = ()


class Progress(Protocol):
    """Called now and then by an engine; returns False to ask it to stop with what it has."""

    def __call__(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool: ...


Stop = Callable[[], bool]


# What it takes an engine to make its tables, or its model, of a problem: before that it finds and proves nothing.
#
# Deterministic seconds, worked out from sizes alone: measured on nests of 60 to 308 contours and on routing instances
# of 17 to 699.

MAX_ARCS = 80_000
"""Arcs between sites above which CP-SAT's smaller model, of pairs of contours, gives the better bound for the same work
(measured on plates of 115, 308 contours)."""
ROWS_PER_S = 8e6
"""Crossings that are put in order in a second."""
ARCS_LISTED_PER_S, ARCS_PER_S, PAIRS_PER_S = 1e6, 1e5, 2.5e4
"""Arcs between sites that CP-SAT's model is made of: listed with their prices, and made, presolved and begun with; and
pairs of contours that may follow each other, of which there are orders and arcs."""
BYTES_A_ROW = 60
"""What every crossing takes in the tables of the search, and of windows after it, while they are made."""


def crossed_bytes(problem: Problem) -> int:
    """What crossings take, with the tables that any engine makes of them: large nests without zones have millions."""
    return problem.crossings.nbytes + BYTES_A_ROW * len(problem.crossings)


def windows_s(problem: Problem) -> float:
    """Of the windows of a plan."""
    return len(problem.crossings) / ROWS_PER_S


def count_site_arcs(problem: Problem) -> int:
    """How many arcs between sites there are at most, home's included."""
    sites = np.append(np.diff(problem.first), 1)
    return int(sites @ problem.followers().weighed(sites))


def cpsat_s(problem: Problem) -> float:
    """Of CP-SAT's model."""
    arcs, pairs = count_site_arcs(problem), int(problem.followers().weighed(np.ones(problem.n + 1, np.int64)).sum())
    listed_s = arcs / ARCS_LISTED_PER_S + len(problem.crossings) / ROWS_PER_S
    if arcs > MAX_ARCS:
        return listed_s + (0.0 if pairs > MAX_ARCS else pairs / PAIRS_PER_S)
    return listed_s + arcs / ARCS_PER_S + pairs / PAIRS_PER_S


# What a job may spend: work, which is the same each time, and seconds by the clock.


class Budget:
    """So much work, and so many seconds from now on; what is spent first counts.

    Parameters
    ----------
    work
        Deterministic seconds.
    time_s
        Wall-clock limit, s; without one the clock does not count.
    per_s
        Operations that are a deterministic second; work is spent in operations.
    clock
        Seconds, for tests.

    Examples
    --------
    >>> budget = Budget(work=2.0)
    >>> budget.spend(1.5)
    >>> budget.left, budget.part(0.5).left, budget.share_spent
    (0.5, 0.25, 0.75)
    """

    def __init__(
        self,
        work: float = math.inf,
        time_s: float | None = None,
        per_s: float = 1.0,
        clock: Callable[[], float] = running_s,
    ) -> None:
        self.per_s, self.operations, self._time_s, self._clock = per_s, work * per_s, time_s, clock
        self.operations_spent = 0.0
        self._began_s = clock()

    @staticmethod
    def of(options: SolveOptions) -> Budget:
        """As much as a solve under these options may spend: the work, or the time if that is limited."""
        return Budget(options.work if options.time_s is None else math.inf, options.time_s)

    @property
    def timed(self) -> bool:
        """Whether the clock counts."""
        return self._time_s is not None

    @property
    def spent(self) -> float:
        """Deterministic seconds so far."""
        return self.operations_spent / self.per_s

    @property
    def left(self) -> float:
        """Deterministic seconds, or seconds by the clock if they are fewer; not above 0 when all is spent."""
        return min((self.operations - self.operations_spent) / self.per_s, self._left_s)

    @property
    def share_spent(self) -> float:
        """Share of the work, or of the time if that is more."""
        share = self.operations_spent / max(self.operations, 1e-9)
        return share if self._time_s is None else max(share, self._passed_s / max(self._time_s, 1e-3))

    def spend(self, operations: float) -> None:
        """Count work; the clock counts by itself."""
        self.operations_spent += operations

    def part(self, share: float) -> Budget:
        """A share of what is left. What is spent of it by work is to be spent of this one as well."""
        time_s = self._left_s * share if self.timed else None
        return Budget((self.operations - self.operations_spent) / self.per_s * share, time_s, self.per_s, self._clock)

    def mark(self) -> tuple[float, float]:
        """Where it stands, for `times`."""
        return self.operations_spent, self._passed_s

    def times(self, mark: tuple[float, float]) -> float:
        """How many times what was spent since `mark` can be spent once more."""
        operations = self.operations_spent - mark[0]
        times = (self.operations - self.operations_spent) / max(operations, 1)
        return min(times, self._left_s / max(self._passed_s - mark[1], 1e-3)) if self.timed else times

    @property
    def _passed_s(self) -> float:
        return self._clock() - self._began_s

    @property
    def _left_s(self) -> float:
        return math.inf if self._time_s is None else self._time_s - self._passed_s


# When to stop: the clock, a gap that is small enough, no improvement for long enough, or the listener says so.


class Watch:
    """Passes the engines' progress on, and says stop where the options do.

    Parameters
    ----------
    options
        `time_s`, `gap` and `no_improvement_s` are looked at; the rest is the engines' own.
    progress
        Who listens.
    clock
        Seconds, for tests.

    Examples
    --------
    >>> watch = Watch(SolveOptions(gap=0.1))
    >>> watch("search", 100, None), watch("ideals", 100, 89), watch("ideals", 100, 90)
    (True, True, False)
    """

    def __init__(
        self,
        options: SolveOptions,
        progress: Progress | None = None,
        clock: Callable[[], float] = running_s,
    ) -> None:
        self._options, self._progress, self._clock = options, progress, clock
        self._started = self._improved = clock()
        self._cost: int | None = None
        self._preview_cost: int | None = None
        self._bound = 0
        self.stopped = False

    @property
    def seconds(self) -> float:
        """Wall-clock time since the start, without that in which kernels were compiled."""
        return self._clock() - self._started

    def begin(self) -> None:
        """Forget costs and bounds: another problem (the same with more statements) is solved from now on."""
        self._cost, self._preview_cost, self._bound, self._improved = None, None, 0, self._clock()

    def __call__(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        """Note what an engine has reached, tell the listener the best of it all, and say whether to go on."""
        if cost_um is not None and (self._cost is None or cost_um < self._cost):
            self._cost, self._improved = cost_um, self._clock()
        self._bound = max(self._bound, bound_um or 0)
        heard = self._tell(engine)
        self.stopped = self.stopped or not heard or self._late() or self._enough()
        return not self.stopped

    def preview(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        """Tell the listener of a plan that nobody goes on from: it counts for no gap, and as no improvement."""
        if cost_um is not None and (self._preview_cost is None or cost_um < self._preview_cost):
            self._preview_cost = cost_um
        self.stopped = self.stopped or not self._tell(engine)
        return not self.stopped

    def _tell(self, engine: str) -> bool:
        """Tell the listener the best of all that was reached; whether to go on."""
        best = min((cost for cost in (self._cost, self._preview_cost) if cost is not None), default=None)
        return self._progress is None or self._progress(engine, best, self._bound or None)

    def overhear(self, bound_um: int | None) -> None:
        """Note a bound from another thread: it is passed on with whatever is told next."""
        self._bound = max(self._bound, bound_um or 0)

    def _late(self) -> bool:
        return self._options.time_s is not None and self.seconds >= self._options.time_s

    def _enough(self) -> bool:
        if self._cost is None:
            return False
        idle_s = self._options.no_improvement_s
        if idle_s is not None and self._clock() - self._improved >= idle_s:
            return True
        gap = self._options.gap
        return gap is not None and self._cost - self._bound <= gap * self._cost
