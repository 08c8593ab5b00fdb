"""Where every state came from, layer by layer; forgets what no living state came from."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from kerfwise.arrays import Int32s

WORTH_CLEARING = 20_000_000
"""States noted, 8 bytes each, before a first clearing."""


@dataclass(slots=True)
class History:
    """The parent (a place in the layer before) and the last site of every state of every layer but the first."""

    parents: list[Int32s] = field(default_factory=list)
    sites: list[Int32s] = field(default_factory=list)
    _clear_at: int = field(default_factory=lambda: WORTH_CLEARING)

    def note(self, parent: Int32s, site: Int32s) -> None:
        """The states of the next layer."""
        self.parents.append(parent)
        self.sites.append(site)
        if sum(map(len, self.sites)) >= self._clear_at:
            self._clear()
            self._clear_at = max(WORTH_CLEARING, 2 * sum(map(len, self.sites)))

    def route(self, state: int) -> tuple[int, ...]:
        """The sites that led to a state of the last layer, in cutting order."""
        route = []
        for parent, site in zip(reversed(self.parents), reversed(self.sites), strict=True):
            route.append(int(site[state]))
            state = int(parent[state])
        return tuple(reversed(route))

    def _clear(self) -> None:
        for k in range(len(self.parents) - 1, 0, -1):
            used = np.zeros(len(self.sites[k - 1]), dtype=np.bool_)
            used[self.parents[k]] = True
            number = np.cumsum(used, dtype=np.int32) - np.int32(1)
            self.parents[k] = number[self.parents[k]]
            self.parents[k - 1], self.sites[k - 1] = self.parents[k - 1][used], self.sites[k - 1][used]
