"""Inequalities: what every plan's moves come to at least, and a cheapest flow comes to too little of."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix, vstack

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.problem import Problem


@dataclass(frozen=True, eq=False, slots=True)
class Inequalities:
    """For each row: moves from a site of `tail` to one of `head`, less moves to a site of `into`, plus `beside`.

    It comes to `least` at least in every plan. `tail`, `head` and `into` are (k, m + 1), home last, `least` (k,);
    `beside` (k, columns) is what the columns beside the moves count.
    """

    tail: Bools
    head: Bools
    into: Bools
    least: Floats
    beside: csr_matrix

    def __len__(self) -> int:
        return len(self.tail)

    def only(self, kept: Bools) -> Inequalities:
        """Those of them that are kept."""
        return Inequalities(self.tail[kept], self.head[kept], self.into[kept], self.least[kept], self.beside[kept])

    def joined(self, more: Inequalities) -> Inequalities:
        """With more of them."""
        return Inequalities(
            np.concatenate([self.tail, more.tail]),
            np.concatenate([self.head, more.head]),
            np.concatenate([self.into, more.into]),
            np.concatenate([self.least, more.least]),
            vstack([self.beside, more.beside], format="csr"),
        )

    def across(self, leave: Ints, reach: Ints) -> csr_matrix:
        """How much each of some moves counts in every inequality, (k, moves)."""
        starts = np.zeros(len(self) + 1, dtype=np.int64)
        places, values = [np.zeros(0, dtype=np.int64)], [np.zeros(0)]
        for k, (tail, head, into) in enumerate(zip(self.tail, self.head, self.into, strict=True)):
            counts = (tail[leave] & head[reach]).view(np.int8)
            if into.any():
                counts = counts - into[reach]
            places.append(np.flatnonzero(counts))
            values.append(counts[places[-1]].astype(np.float64))
            starts[k + 1] = starts[k] + len(places[-1])
        return csr_matrix((np.concatenate(values), np.concatenate(places), starts), shape=(len(self), len(leave)))

    def worth(self, paid: Floats) -> Floats:
        """What multipliers (k,) make every move worth, (m + 1, m + 1)."""
        worth = (self.tail.T * paid) @ self.head.astype(np.float64)
        return np.asarray(worth - (paid @ self.into)[None, :])


@dataclass(frozen=True, eq=False, slots=True)
class OrderCut:
    """Something goes from `tail` to `head`, each (m + 1,): once at least, or as often as the sites `through`, of one
    contour, are used, or where `order` holds."""

    tail: Bools
    head: Bools
    through: Bools | None = None
    order: Order | None = None


def cut_inequalities(cuts: Sequence[OrderCut], sites: int, columns: int) -> Inequalities:
    """Cuts as inequalities, over so many sites and home, and columns beside the moves."""
    tail, head = (np.array([getattr(cut, name) for cut in cuts], dtype=np.bool_) for name in ("tail", "head"))
    into = np.zeros((len(cuts), sites + 1), dtype=np.bool_)
    least = np.ones(len(cuts))
    entries = []
    for k, cut in enumerate(cuts):
        if cut.through is not None:
            into[k], least[k] = cut.through, 0.0
        elif cut.order is not None:
            least[k], times = cut.order.weights
            entries.append((k, cut.order.column, -times))
    beside = _beside(entries, len(cuts), columns)
    return Inequalities(tail.reshape(-1, sites + 1), head.reshape(-1, sites + 1), into, least, beside)


def cover_inequalities(covers: Sequence[Cover], sites: int, columns: int) -> Inequalities:
    """Covers as inequalities."""
    none = np.zeros((len(covers), sites + 1), dtype=np.bool_)
    into = none.copy()
    least = np.zeros(len(covers))
    entries = []
    for k, cover in enumerate(covers):
        into[k, cover.sites] = True
        for order in cover.orders:  # how much of it does not hold
            constant, times = order.weights
            entries.append((k, order.column, -times))
            least[k] -= 1.0 - constant
        if cover.paid >= 0:
            entries.append((k, cover.paid, 1.0))
    return Inequalities(none, none, into, least, _beside(entries, len(covers), columns))


def _beside(entries: Sequence[tuple[int, int, float]], rows: int, columns: int) -> csr_matrix:
    row, column, value = (np.array([entry[k] for entry in entries]) for k in range(3))
    return csr_matrix((value.astype(np.float64), (row.astype(int), column.astype(int))), shape=(rows, columns))


def block_inequalities(problem: Problem, columns: int = 0) -> Inequalities:
    """The contours of a contiguous block follow each other: one move less than there are leads from one to another."""
    names, size = np.unique(problem.block, return_counts=True)
    owner = np.append(problem.site_contour, problem.n)
    inside = np.append(problem.block, -1)[owner][None, :] == names[size > 1][:, None]
    least = (size[size > 1] - 1).astype(np.float64)
    none = np.zeros_like(inside)
    return Inequalities(inside, inside, none, least, csr_matrix((len(least), columns)))


# What conditions ask of a flow: a site that needs other contours still in, or already out, needs those orders.
#
# Beside the moves the linear program has a column for every pair of blocks that a condition looks at, 1 where the
# first goes before the second, and one for what a contour pays where its soft conditions are not met. A set of
# neighbours that together break the conditions of some sites is a *cover* of them: those sites are used only where
# one of the set is the other way round (covers of a knapsack: Balas 1975).

LITTLE = 0.05
"""What must be missing before a cover is asked for."""


@dataclass(frozen=True, slots=True)
class Order:
    """Contour `first` is cut before contour `then`: `column` of the program is 1, or 0 where it is `turned`."""

    first: int
    then: int
    column: int
    turned: bool

    @property
    def other_way_round(self) -> Order:
        """That `then` is cut before `first`."""
        return Order(self.then, self.first, self.column, not self.turned)

    @property
    def weights(self) -> tuple[float, float]:
        """How much of it holds is a constant and so many times its column."""
        return (1.0, -1.0) if self.turned else (0.0, 1.0)

    def value(self, columns: Floats) -> float:
        """How much of it holds."""
        constant, times = self.weights
        return constant + times * float(columns[self.column])


@dataclass(frozen=True, eq=False, slots=True)
class _Demand:
    """Of what is `bad` for the `sites` of a contour there is at most `most`: `size[k]` where order `bad[k]` holds."""

    sites: Ints
    bad: tuple[Order, ...]
    size: Ints
    most: int


@dataclass(frozen=True, eq=False, slots=True)
class _Together:
    """Demands of one contour that cost the same where they are not met; `paid` is their column, -1 if they are hard."""

    demands: tuple[_Demand, ...]
    paid: int


@dataclass(frozen=True, eq=False, slots=True)
class Cover:
    """The `sites` are used only as far as one of `orders` does not hold, or column `paid` is paid (-1: none)."""

    sites: Ints
    orders: tuple[Order, ...]
    paid: int


class DemandColumns:
    """The columns beside the moves, and what the conditions of a problem ask of them.

    `cost` (columns,) is what each costs, µm; all lie between 0 and 1. `pairs` are two contours of two blocks each.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._column: dict[tuple[int, int], int] = {}
        self.pairs: list[Order] = []
        found: dict[tuple[int, int | None], list[_Demand]] = {}
        for condition in problem.conditions:
            found.setdefault((condition.contour, condition.cost), []).append(self._demand(condition))
        cost = [0.0] * len(self._column)
        self._groups = []
        for (_, price), demands in found.items():
            self._groups.append(_Together(tuple(demands), -1 if price is None else len(cost)))
            cost += [] if price is None else [float(price)]
        self.cost: Floats = np.array(cost)

    def _demand(self, condition: Condition) -> _Demand:
        i, before = condition.contour, self._problem.before
        sites = np.array(self._problem.sites(i) if condition.when is None else [condition.when], dtype=np.int64)
        most = sum(w for w in condition.weights if w > 0) - condition.bound
        bad, size = [], []
        for k, weight in zip(condition.members, condition.weights, strict=True):
            first, then = (k, i) if weight < 0 else (i, k)
            if before[first, then] or (k == i and weight > 0):
                most -= abs(weight)
            elif not before[then, first] and weight and (order := self._order(first, then)):
                bad.append(order)
                size.append(abs(weight))
        return _Demand(sites, tuple(bad), np.array(size, dtype=np.int64), most)

    def _order(self, first: int, then: int) -> Order | None:
        """The order of two contours of two blocks; None within a block."""
        a, b = int(self._problem.block[first]), int(self._problem.block[then])
        if a == b:
            return None
        turned, pair = a > b, (min(a, b), max(a, b))
        if pair not in self._column:
            self._column[pair] = len(self._column)
            self.pairs.append(Order(*((then, first) if turned else (first, then)), self._column[pair], False))
        return Order(first, then, self._column[pair], turned)

    def covers(self, used: Floats, columns: Floats) -> Iterator[tuple[float, Cover]]:
        """Covers that are not met where sites are used so much (m + 1,), and by how much."""
        for group in self._groups:
            paid = float(columns[group.paid]) if group.paid >= 0 else 0.0
            seen = set()
            for demand in group.demands:
                if used[demand.sites].sum() <= paid + LITTLE:
                    continue
                orders = _least_cover(demand, columns)
                if orders is None or orders in seen:
                    continue
                seen.add(orders)
                sites = np.unique(np.concatenate([d.sites for d in group.demands if _covers(d, orders)]))
                missing = float(used[sites].sum()) - paid - sum(1 - order.value(columns) for order in orders)
                if missing > LITTLE:
                    yield missing, Cover(sites, orders, group.paid)


def _least_cover(demand: _Demand, columns: Floats) -> tuple[Order, ...] | None:
    """Orders that hold nearly, and together are too much; None where no orders are."""
    missing = np.array([1 - order.value(columns) for order in demand.bad])
    chosen: list[int] = []
    total = 0
    for k in np.argsort(missing / np.maximum(demand.size, 1), kind="stable").tolist():
        if total > demand.most:
            break
        chosen.append(k)
        total += int(demand.size[k])
    if total <= demand.most:
        return None
    for k in sorted(chosen, key=lambda k: -missing[k]):
        if total - demand.size[k] > demand.most:
            chosen.remove(k)
            total -= int(demand.size[k])
    return tuple(demand.bad[k] for k in sorted(chosen))


def _covers(demand: _Demand, orders: tuple[Order, ...]) -> bool:
    """Whether these orders are too much for a demand."""
    held = {(order.column, order.turned) for order in orders}
    size = sum(int(s) for order, s in zip(demand.bad, demand.size, strict=True) if (order.column, order.turned) in held)
    return size > demand.most
