"""What all walkers have: a state, a schedule of temperatures, and the best routes so far."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Ints
from kerfwise.models.engines.search.state.route_state import BEST, BROKEN, COST, WORK, SearchTables
from kerfwise.models.engines.tuning import ANNEALED, COOL, HEATS, SIZE
from kerfwise.models.engines.tuning import WALKER_SHORT as SHORT
from kerfwise.models.engines.tuning import WALKER_SHORTEST as SHORTEST

# What all walkers have: a state of their own, temperatures that suit the problem, and the best route so far.


class Walked(Protocol):
    """The arrays of a walk; `number` is as `state` says, `best` lists sites in order."""

    @property
    def number(self) -> Ints: ...
    @property
    def best(self) -> Ints: ...


class Walker(ABC):
    """Walks over one problem; equal seeds and numbers walk equal ways.

    Parameters
    ----------
    fields
        The problem.
    walked
        What the walk writes to.
    like
        A walker whose temperatures suit this one, too.
    """

    def __init__(self, fields: SearchTables, walked: Walked, like: Walker | None = None) -> None:
        self._fields = fields
        self._walked = walked
        self._hot: float = 0.0 if like is None else like._hot
        self._cold: float = 0.0 if like is None else like._cold
        self._taken: Elite | None = None

    @abstractmethod
    def start(self) -> None:
        """Make a first route, unless it stands on one."""

    @abstractmethod
    def descend(self, chunk: int) -> None:
        """Walk on for `chunk` operations without going uphill."""

    @abstractmethod
    def measure(self, most: int) -> None:
        """Choose the temperatures, by the rises of the cost so far or in at most about `most` operations."""

    @abstractmethod
    def stand_on(self, sites: NDArray[np.int64]) -> None:
        """Go on from a lawful route."""

    @abstractmethod
    def go(self, chunk: int, hot: float, cold: float) -> None:
        """Walk on for `chunk` operations while the temperature falls from `hot` to `cold`."""

    @abstractmethod
    def stands_on(self) -> Ints:
        """The route that it stands on, sites in cutting order."""

    @property
    def best(self) -> Elite | None:
        """The best lawful route so far."""
        now = self._best_now()
        if self._taken is None or (now is not None and now.cost < self._taken.cost):
            return now
        return self._taken

    @property
    def cost(self) -> int | None:
        """Cost of the best lawful route so far, µm."""
        now = int(self._walked.number[BEST])
        if self._taken is None:
            return now if now >= 0 else None
        return min(self._taken.cost, now) if now >= 0 else self._taken.cost

    def take(self) -> Elite | None:
        """The best lawful route since `forget`, or `take`; it is remembered, but the next one may be worse."""
        now, self._taken = self._best_now(), self.best
        self.forget()
        return now

    def forget(self) -> None:
        """Count from the route we stand on as the best, if it is lawful."""
        self._taken, walked = self.best, self._walked
        lawful = walked.number[BROKEN] == 0
        walked.number[BEST] = walked.number[COST] if lawful else -1
        if lawful:
            walked.best[:] = self.stands_on()

    def _best_now(self) -> Elite | None:
        cost = int(self._walked.number[BEST])
        return Elite(cost, self._walked.best.copy()) if cost >= 0 else None

    @property
    def work(self) -> int:
        """Operations so far."""
        return int(self._walked.number[WORK])

    @property
    def ready(self) -> bool:
        """Whether its temperatures are known."""
        return self._hot > 0.0

    def anneal(self, chunk: int, part: CoolingPart, heat: float) -> None:
        """Walk on for `chunk` operations through a part of an annealing, `heat` times as hot as is usual."""
        hot, fall = self._hot * heat, self._cold / self._hot
        self.go(chunk, hot * fall**part.done, hot * fall**part.ahead)

    def cool(self, operations: int) -> None:
        """A whole annealing."""
        self.go(operations, self._hot, self._cold)


# When to anneal how long: several times, each as long as all before, and hotter or cooler by turns.


@dataclass(frozen=True, slots=True)
class CoolingPart:
    """A part of one annealing: from which share of its cooling to which, and a number for its heat."""

    done: float
    ahead: float
    turn: int

    def annealing(self, count: int) -> tuple[int, CoolingPart] | None:
        """Which of `count` equal annealings it is in, and the part of that; None if it begins after them.

        Examples
        --------
        >>> CoolingPart(0.375, 0.5, 0).annealing(2)
        (1, CoolingPart(done=0.5, ahead=1.0, turn=1))
        """
        done, ahead = count * self.done / ANNEALED, count * self.ahead / ANNEALED
        number = int(done)
        if number >= count:
            return None
        return number, CoolingPart(done - number, min(1.0, ahead - number), self.turn + number)

    def heat(self, walker: int) -> float:
        """Factor on the temperatures; walkers differ."""
        return HEATS[(self.turn + walker) % len(HEATS)]


@dataclass(frozen=True, slots=True)
class Schedule:
    """`stages` annealings; the last takes half of all, the one before it a quarter, the first two the same.

    `turn` is the number for the heat of the last one. `short` says that there is time for one at the most.

    Examples
    --------
    >>> Schedule(3, 0).part(0.25, 0.375)
    CoolingPart(done=0.0, ahead=0.5, turn=1)
    """

    stages: int
    turn: int
    short: bool = False

    @classmethod
    def of(cls, n: int, operations: int) -> Schedule:
        """As many as there is time for, for n contours."""
        stages = int(operations / (SHORTEST * n**1.5)).bit_length()
        return cls(max(1, stages), 0 if stages else COOL, operations < SHORT * n**1.5)

    def part(self, done: float, ahead: float) -> CoolingPart:
        """What to do between two shares of the whole."""
        bounds = [0.0, *(2.0**-k for k in range(self.stages - 1, -1, -1))]
        stage = sum(done >= bound for bound in bounds[1:])
        start, stop = bounds[stage], bounds[stage + 1]
        whole, turn = stop - start, self.turn + self.stages - 1 - stage
        return CoolingPart((done - start) / whole, min(1.0, (ahead - start) / whole), turn)


# The best routes of several annealings, and what is made of two of them.


@dataclass(frozen=True, eq=False, slots=True)
class Elite:
    """A lawful route (sites in cutting order) and its cost, µm."""

    cost: int
    route: Ints

    def same(self, other: Elite) -> bool:
        """Whether both are one route."""
        return self.cost == other.cost and bool((self.route == other.route).all())


class Pool:
    """A few different routes; pairs of them are drawn by random numbers of its own."""

    def __init__(self, seed: int) -> None:
        self._random = np.random.default_rng(seed)
        self.members: list[Elite] = []

    def add(self, elite: Elite) -> None:
        """Take a route in if it is new, and let the dearest go if there are too many."""
        if not any(elite.same(member) for member in self.members):
            self.members = sorted([*self.members, elite], key=lambda member: member.cost)[:SIZE]

    def keep_best(self) -> None:
        """Let all go but the best: the next generation comes from new annealings."""
        self.members = self.members[:1]

    def pair(self) -> tuple[Elite, Elite]:
        """Two routes, the better first; twice the same if there is one only."""
        count = len(self.members)
        i, j = sorted(self._random.choice(count, 2, replace=False).tolist()) if count > 1 else (0, 0)
        return self.members[i], self.members[j]

    def succeed(self, elder: Elite, child: Elite) -> None:
        """Put a child in the place of the worse of its parents, unless it is worse itself or there already."""
        if child.cost <= elder.cost and not any(child.same(member) for member in self.members):
            rest = [member for member in self.members if member is not elder]
            self.members = sorted([*rest, child], key=lambda member: member.cost)
