"""What the hard order rules put before a contour in every plan, by their own geometry."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.distinct import distinct, distinct_pairs

from .hard_orders import HardOrders


class Forcing:
    """Called with a contour id: the contours that must be cut before it.

    What was cut before a stop is among them. What is cut in one go with a contour comes with it. Orders that the plan
    itself does not keep are left out: they lie on cycles, where one of them has to give way.
    """

    def __init__(self, orders: HardOrders) -> None:
        self.orders, self.cuts = orders, orders.cuts

    def __call__(self, contour: str) -> frozenset[str]:
        own = self._runs.get(contour, (contour,))
        inside = self._inside(contour, frozenset(own))
        before = self._before[self._number[contour]] if contour in self._number else 0
        bits = np.unpackbits(
            np.frombuffer(before.to_bytes(len(self._groups) // 8 + 1, "little"), np.uint8), bitorder="little"
        )
        outside = (name for k in np.flatnonzero(bits).tolist() for name in self._groups[k])
        made = frozenset(cut.contour for cut in self.cuts[: self.cuts.made])
        return frozenset(inside) | (frozenset(outside) - frozenset(own)) | made

    def _inside(self, contour: str, own: frozenset[str]) -> list[str]:
        """What the orders put before a contour within the run that it is cut in."""
        if len(own) == 1:
            return []
        names = self.orders.names
        within: dict[str, list[str]] = {name: [] for name in own}
        ours = [self._place[name] for name in own if name in self._place]
        for before, after in self._kept[np.isin(self._kept, ours).all(axis=1)].tolist():
            within[names[after]].append(names[before])
        reached = within[contour].copy()
        seen = set(reached)
        for name in reached:
            new = set(within[name]) - seen
            seen |= new
            reached += new
        return reached

    @cached_property
    def _place(self) -> dict[str, int]:
        """Contour → its number in `orders`."""
        return {name: k for k, name in enumerate(self.orders.names)}

    @cached_property
    def _kept(self) -> Ints:
        """The orders that the plan keeps, (k, 2) numbers, each once; what is not cut comes before all."""
        asked = np.concatenate([np.empty((0, 2), np.int64), *self.orders.by_rule.values()])
        at = self.orders.at
        return distinct_pairs(asked[at[asked[:, 0]] < at[asked[:, 1]]])

    @cached_property
    def _groups(self) -> list[tuple[str, ...]]:
        """What is cut in one go, and every other contour by itself, in the order of the cuts."""
        at, names = self.cuts.positions(), self.orders.names
        known = {*at, *(names[k] for k in distinct(self._kept.ravel()).tolist())}
        groups = {self._runs.get(name, (name,)) for name in known}
        return sorted(groups, key=lambda group: (min(at.get(name, 0) for name in group), group))

    @cached_property
    def _number(self) -> dict[str, int]:
        """Contour → the number of its group."""
        return {name: k for k, group in enumerate(self._groups) for name in group}

    @cached_property
    def _before(self) -> list[int]:
        """For each group all the groups that must go before it, a bit each.

        Groups are gone through in the order of the cuts, which what is kept of the orders follows: once is enough,
        but where a run is torn apart and so on a cycle.
        """
        straight = self._straight()
        with_itself = [1 << k for k in range(len(self._groups))]
        in_turn = all(other < k for k, others in enumerate(straight) for other in others)
        changed = True
        while changed:
            changed = False
            for k, others in enumerate(straight):
                reached = with_itself[k]
                for other in others:
                    reached |= with_itself[other]
                if reached != with_itself[k]:
                    with_itself[k], changed = reached, not in_turn
        return [reached & ~(1 << k) for k, reached in enumerate(with_itself)]

    def _straight(self) -> list[list[int]]:
        """For each group the others that an order puts before it."""
        group = np.array([self._number.get(name, -1) for name in self.orders.names], dtype=np.int64)
        pairs, size = group[self._kept[:, ::-1]], len(self._groups)
        into, of = distinct_pairs(pairs[pairs[:, 0] != pairs[:, 1]]).T
        ends = np.searchsorted(into, np.arange(1, size))
        return [row.tolist() for row in np.split(of, ends)] if size else []

    @cached_property
    def _runs(self) -> dict[str, tuple[str, ...]]:
        """Contour → all that is cut in one go with it."""
        orders = self.orders
        book = orders.profile.rulebook()
        return {
            name: tuple(sorted(run))
            for rule, setting in orders.hard.items()
            for run in book[rule].together(orders.nest, setting.options)
            for name in run
        }
