"""A walker that anneals by ruins and exchanges: for every problem."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Ints

from .anneal import begin, walk, walk_plain
from .state import CLIMBS, COST, LENGTH, PRICE, TRADED, TRADES, new_state
from .structs import for_kernels
from .tables import SearchTables
from .walker import Walker

HOT, COLD = 1.0, 0.01  # temperatures, in typical rises of the cost
LIVELY = 0.01  # share of exchanges taken at the first temperature, on plain problems
FALL = 25.0  # by what the temperature falls there
LOOK = 200_000  # operations for a look at how many are taken
LOOKS = 40
STEP = 1.4  # between the temperatures looked at


class AnnealingWalker(Walker):
    """See `Walker`; `tables` is the problem as kernels take it, random numbers come from `seed`."""

    def __init__(
        self, tables: SearchTables, fields: SearchTables, seed: tuple[int, ...], like: Walker | None = None
    ) -> None:
        self.arrays = new_state(fields, seed)
        super().__init__(fields, self.arrays, like)
        self._tables = tables
        self._state = for_kernels(self.arrays)
        self.arrays.number[PRICE] = 1

    def stands_on(self) -> Ints:
        return self.arrays.site_now[self.arrays.order_now]

    def start(self) -> None:
        number = self.arrays.number
        if number[LENGTH] == 0:
            begin(self._tables, self._state, True)
        number[PRICE] = 1 + 10 * int(number[COST]) // self._fields.legs.n

    def descend(self, chunk: int) -> None:
        self.go(chunk, 1.0, 1.0)

    def measure(self, most: int) -> None:
        if self._fields.arcs.plain:
            self._hot = self._lively(max(1, min(LOOK, most // LOOKS)))
            self._cold = self._hot / FALL
            return
        rises = self.arrays.climb[: self.arrays.number[CLIMBS]]
        rise = max(1.0, float(np.median(rises))) if len(rises) else 1.0
        self._hot, self._cold = HOT * rise, COLD * rise

    def stand_on(self, sites: NDArray[np.int64]) -> None:
        self.arrays.order[:] = self._fields.legs.contour[sites]
        self.arrays.position[self.arrays.order] = np.arange(len(sites))
        self.arrays.site[self.arrays.order] = sites
        begin(self._tables, self._state, False)

    def go(self, chunk: int, hot: float, cold: float) -> None:
        on = walk_plain if self._fields.arcs.plain else walk
        on(self._tables, self._state, self.work + chunk, hot, cold)

    def _lively(self, look: int) -> float:
        """The temperature at which `LIVELY` of the exchanges are taken and change the cost, by looks of that length."""
        number, arcs = self.arrays.number, self._fields.arcs
        near = np.take_along_axis(arcs.cost, arcs.near, axis=1)
        temperature = 1.0 + 4.0 * float(np.median(near))
        for _ in range(LOOKS):
            tried, taken = int(number[TRADES]), int(number[TRADED])
            self.go(look, temperature, temperature)
            if number[TRADED] - taken < LIVELY * (number[TRADES] - tried):
                break
            temperature /= STEP
        return temperature
