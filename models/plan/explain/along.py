"""What a plan costs with one place of its order changed: from the best ways to that place, and on from it.

With F(k, s) the least cost of the first k places, the last of them by site s, and B(k, s) the least of all that follows
it, the plan costs F(k, s) + B(k, s) with that site. An order that differs between two places only is worked out between
them. Both are exact where a step's cost depends on nothing but the contours that are out and the two sites.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.evaluate import order_cost
from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.statements import About

from .resite import costs_here
from .setting import Setting


class Along:
    """The best ways along the order of a plan, from both ends.

    Attributes
    ----------
    setting
        The plan.
    exact
        Whether nothing is stated that ties entries of several contours together, or that seconds decide; where it is,
        no answer is given here.
    asked
        Hard statements that are about more of the order than which of two contours comes first.
    forbidden
        By candidate, what forbids it whatever the order.
    """

    def __init__(self, setting: Setting) -> None:
        self.setting = setting
        problem, order = setting.problem, setting.order
        self.exact = not problem.general and not any(lag.seconds for lag in problem.lags)
        kinds = by_kind(setting.stated.statements)
        others = {id(s) for s in (*kinds.precede, *kinds.forbid)}
        self.asked = tuple(s for s in setting.stated.statements if s.weight is None and id(s) not in others)
        self.forbidden: dict[int, list[About]] = defaultdict(list)
        for forbid in kinds.forbid:
            if forbid.weight is None:
                self.forbidden[forbid.candidate].append(forbid.about)
        self._home = problem.n
        contour = np.append(problem.site_contour, problem.n)
        keys = contour[problem.crossings.leave] * (problem.n + 1) + contour[problem.crossings.reach]
        self._sorted = np.argsort(keys, kind="stable")
        self._keys = keys[self._sorted]
        self._order = (*order, self._home)
        self._place = np.append(np.argsort(order), self._home)
        self._extra = order_cost(problem, order)
        if self.exact:
            self._here = self._by_themselves()
            self._first, self._last = self._forward(), self._backward()

    def pinned(self, contour: int, site: int) -> int | None:
        """What the plan costs with this site of a contour, the others' chosen anew, µm; None where there is no way."""
        k = int(self._place[contour])
        s = site - int(self.setting.problem.first[contour])
        cost = self._first[k][s] + self._last[k][s]
        return int(cost) + self._extra if np.isfinite(cost) else None

    def moved(self, order: Sequence[int]) -> int | None:
        """What another order costs by the best entries along it, µm; None where no way along it is lawful."""
        changed = [k for k, (now, then) in enumerate(zip(self._order, order, strict=False)) if now != then]
        if not changed:
            cost = self._first[-1].min()
            return int(cost) + self._extra if np.isfinite(cost) else None
        low, high = changed[0], changed[-1]
        place = np.empty(len(order) + 1, dtype=np.int64)
        place[[*order, self._home]] = np.arange(len(order) + 1)
        before = self._order[low - 1] if low else self._home
        best = self._first[low - 1] if low else np.zeros(1)
        already = set(order[:low])
        problem = self.setting.problem
        for k in range(low, high + 1):
            contour = order[k]
            here = costs_here(self.setting, contour, problem.sites(contour), already)[0]
            best = (best[:, None] + self._step(before, contour, k, place)).min(axis=0) + here
            if not np.isfinite(best).any():
                return None
            already.add(contour)
            before = contour
        after = self._order[high + 1]
        last = best[:, None] + self._step(before, after, high + 1, place) + self._here[high + 1] + self._last[high + 1]
        cost = last.min()
        return int(cost) + order_cost(problem, order) if np.isfinite(cost) else None

    def _by_themselves(self) -> list[Floats]:
        """What the sites of every contour of the order cost by themselves, and home, which costs nothing."""
        found: list[Floats] = []
        already: set[int] = set()
        for contour in self.setting.order:
            found.append(costs_here(self.setting, contour, self._sites(contour), already)[0])
            already.add(contour)
        return [*found, np.zeros(1)]

    def _forward(self) -> list[Floats]:
        best, before, found = np.zeros(1), self._home, []
        for k, contour in enumerate(self._order):
            best = (best[:, None] + self._step(before, contour, k, self._place)).min(axis=0) + self._here[k]
            found.append(best)
            before = contour
        return found

    def _backward(self) -> list[Floats]:
        best, found = np.zeros(1), [np.zeros(1)]
        for k in range(len(self._order) - 1, 0, -1):
            step = self._step(self._order[k - 1], self._order[k], k, self._place)
            best = (step + (self._here[k] + best)[None, :]).min(axis=1)
            found.append(best)
        return found[::-1]

    def _step(self, leave: int, reach: int, k: int, place: Ints) -> Floats:
        """What the moves from the sites of one contour (or home) to those of another cost as step k of an order."""
        problem = self.setting.problem
        table = problem.travel(self._sites(leave), self._sites(reach)).astype(np.float64)
        key = leave * (problem.n + 1) + reach
        low, high = np.searchsorted(self._keys, [key, key + 1]).tolist()
        if low < high:
            rows = problem.crossings
            mine = self._sorted[low:high]
            mine = mine[place[rows.over[mine]] < k]
            cost = np.where(rows.cost[mine] == FORBIDDEN, np.inf, rows.cost[mine].astype(np.float64))
            at = (rows.leave[mine] - self._sites(leave)[0], rows.reach[mine] - self._sites(reach)[0])
            np.add.at(table, at, cost)
        return table

    def _sites(self, contour: int) -> range:
        problem = self.setting.problem
        return range(problem.m, problem.m + 1) if contour == self._home else problem.sites(contour)
