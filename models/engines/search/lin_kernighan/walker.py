"""A walker that goes on by kicks and chains: for problems of arcs and few orders."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Ints
from kerfwise.models.engines.search.state import BEST, COST
from kerfwise.models.engines.search.structs import for_kernels
from kerfwise.models.engines.search.tables import SearchTables
from kerfwise.models.engines.search.walker import Walker

from .first_route import nearest_lawful
from .state import FRONT, QUEUED, new_chain_state
from .tables import make_chain_tables, typical_cost
from .walk import walk_by_chains

NEAR, BESIDE = 0.5, 8.0
"""What the first temperature is, in reduced costs of near arcs, and of the arcs of the first good route: orders make
those dear."""
FALL = 30.0
"""By what the temperature falls."""
STILL = 1e-6
"""A temperature at which nothing goes uphill."""


class ChainedWalker(Walker):
    """See `Walker`; random numbers come from `seed`. For problems that are `plain` (see `ArcCosts`)."""

    def __init__(self, fields: SearchTables, seed: tuple[int, ...], like: Walker | None = None) -> None:
        self.tables = make_chain_tables(fields)
        self.arrays = new_chain_state(self.tables, seed)
        super().__init__(fields, self.arrays, like)
        self._kernel_tables, self._state = for_kernels(self.tables), for_kernels(self.arrays)

    def start(self) -> None:
        if self.arrays.number[BEST] < 0:
            self.stand_on(nearest_lawful(self.tables))

    def descend(self, chunk: int) -> None:
        self.go(chunk, STILL, STILL)

    def measure(self, most: int) -> None:
        line = self.arrays.stood
        taken = float(self.tables.cost[line[:-1], line[1:]].mean(dtype=np.float64))
        self._hot = max(STILL, NEAR * typical_cost(self.tables) + BESIDE * taken)
        self._cold = self._hot / FALL

    def stand_on(self, sites: NDArray[np.int64]) -> None:
        arrays = self.arrays
        arrays.line[1:-1] = arrays.stood[1:-1] = sites
        arrays.place[sites] = np.arange(1, len(sites) + 1)
        arrays.number[COST] = self._fields.arcs.cost[arrays.line[:-1], arrays.line[1:]].sum(dtype=np.int64)
        if arrays.number[BEST] < 0 or arrays.number[COST] < arrays.number[BEST]:
            arrays.number[BEST], arrays.best[:] = arrays.number[COST], sites
        self._ask_for_all()

    def go(self, chunk: int, hot: float, cold: float) -> None:
        walk_by_chains(self._kernel_tables, self._state, self.work + chunk, hot, cold)

    def stands_on(self) -> Ints:
        return self.arrays.stood[1:-1].astype(np.int64)

    def _ask_for_all(self) -> None:
        """Let every arc be looked at."""
        arrays = self.arrays
        arrays.queue[:] = arrays.line[:-1]
        arrays.waits[:] = True
        arrays.number[FRONT], arrays.number[QUEUED] = 0, len(arrays.queue)
