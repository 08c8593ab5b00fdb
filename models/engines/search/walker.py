"""One walker: a state of its own, and the temperatures that suit the problem."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .anneal import GO_ON, MAKE_ROUTE, TAKE_ROUTE, walk
from .pool import Elite
from .schedule import CoolingPart
from .state import BEST, BROKEN, CLIMBS, COST, LENGTH, PRICE, TRADED, TRADES, WORK, new_state
from .structs import for_kernels
from .tables import SearchTables

HOT, COLD = 1.0, 0.01  # temperatures, in typical rises of the cost
LIVELY = 0.01  # share of exchanges taken at the first temperature, on plain problems
FALL = 25.0  # by what the temperature falls there
LOOK = 200_000  # operations for a look at how many are taken
LOOKS = 40
STEP = 1.4  # between the temperatures looked at


class Walker:
    """Walks over one problem; equal seeds and numbers walk equal ways.

    Parameters
    ----------
    tables, fields
        The problem as kernels take it, and as it was made.
    seed
        What random numbers come from.
    like
        A walker whose temperatures suit this one, too.
    """

    def __init__(
        self, tables: SearchTables, fields: SearchTables, seed: tuple[int, ...], like: Walker | None = None
    ) -> None:
        self._tables = tables
        self._fields = fields
        self.arrays = new_state(fields, seed)
        self._state = for_kernels(self.arrays)
        self.arrays.number[PRICE] = 1
        self._hot: float = 0.0 if like is None else like._hot
        self._cold: float = 0.0 if like is None else like._cold
        self._taken: Elite | None = None

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
        now = int(self.arrays.number[BEST])
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
        self._taken, state = self.best, self.arrays
        lawful = state.number[BROKEN] == 0
        state.number[BEST] = state.number[COST] if lawful else -1
        if lawful:
            state.best[:] = state.site_now[state.order_now]

    def _best_now(self) -> Elite | None:
        cost = int(self.arrays.number[BEST])
        return Elite(cost, self.arrays.best.copy()) if cost >= 0 else None

    @property
    def work(self) -> int:
        """Operations so far."""
        return int(self.arrays.number[WORK])

    @property
    def ready(self) -> bool:
        """Whether its temperatures are known."""
        return self._hot > 0.0

    def start(self) -> None:
        """Make a first route, unless it stands on one."""
        number = self.arrays.number
        if number[LENGTH] == 0:
            walk(self._tables, self._state, MAKE_ROUTE, 0, 1.0, 1.0)
        number[PRICE] = 1 + 10 * int(number[COST]) // self._fields.legs.n

    def descend(self, chunk: int) -> None:
        """Walk on for `chunk` operations without going uphill."""
        self._go(chunk, 1.0, 1.0)

    def measure(self, most: int) -> None:
        """Choose the temperatures, by the rises of the cost so far or in at most about `most` operations."""
        if self._fields.arcs.plain:
            self._hot = self._lively(max(1, min(LOOK, most // LOOKS)))
            self._cold = self._hot / FALL
            return
        rises = self.arrays.climb[: self.arrays.number[CLIMBS]]
        rise = max(1.0, float(np.median(rises))) if len(rises) else 1.0
        self._hot, self._cold = HOT * rise, COLD * rise

    def anneal(self, chunk: int, part: CoolingPart, heat: float) -> None:
        """Walk on for `chunk` operations through a part of an annealing, `heat` times as hot as is usual."""
        hot, fall = self._hot * heat, self._cold / self._hot
        self._go(chunk, hot * fall**part.done, hot * fall**part.ahead)

    def cool(self, operations: int) -> None:
        """A whole annealing."""
        self._go(operations, self._hot, self._cold)

    def stand_on(self, sites: NDArray[np.int64]) -> None:
        """Go on from a lawful route."""
        self.arrays.order[:] = self._fields.legs.contour[sites]
        self.arrays.position[self.arrays.order] = np.arange(len(sites))
        self.arrays.site[self.arrays.order] = sites
        walk(self._tables, self._state, TAKE_ROUTE, 0, 1.0, 1.0)

    def _go(self, chunk: int, hot: float, cold: float) -> None:
        walk(self._tables, self._state, GO_ON, self.work + chunk, hot, cold)

    def _lively(self, look: int) -> float:
        """The temperature at which `LIVELY` of the exchanges are taken and change the cost, by looks of that length."""
        number, arcs = self.arrays.number, self._fields.arcs
        near = np.take_along_axis(arcs.cost, arcs.near, axis=1)
        temperature = 1.0 + 4.0 * float(np.median(near))
        for _ in range(LOOKS):
            tried, taken = int(number[TRADES]), int(number[TRADED])
            self._go(look, temperature, temperature)
            if number[TRADED] - taken < LIVELY * (number[TRADES] - tried):
                break
            temperature /= STEP
        return temperature
