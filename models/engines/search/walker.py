"""What all walkers have: a state of their own, temperatures that suit the problem, and the best route so far."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Ints

from .pool import Elite
from .schedule import CoolingPart
from .state import BEST, BROKEN, COST, WORK
from .tables import SearchTables


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
