"""Whether hard sums of orders can hold beside orders that are kept: a share of all cutting within which a part is out.

What must come before what is followed through all orders first. Where that says nothing, a small model of its own
answers: of each contour that sums are about, what is cut before it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.graphs import Link
from kerfwise.encoder.nest import Ids

from .hard_orders import HardOrders, ModelOfOrders

if TYPE_CHECKING:
    from ortools.sat.python.cp_model import CpModel, IntVar

MOST_CELLS = 200_000
"""Where the model had more rows, for orders or between contours that sums are about, sums count as possible."""

SumOfOrders = tuple[tuple[tuple[Link, int], ...], int]
"""Orders (before, after), each with a weight above 0, and what the weights of those that are kept come to at least."""


def beside_sums(
    orders: HardOrders,
    pairs: Ints,
    asked_by: Sequence[str],
    runs: Sequence[Sequence[int]],
    holding: set[str],
    known: Collection[Ids],
) -> dict[Ids, str]:
    """Every broken order, but those `known`, that leaves sums of orders no way to hold beside the kept ones."""
    book, names, size = orders.profile.rulebook(), orders.names, len(orders.cuts.positions())
    ranks = np.array([book[rule].gives_way for rule in asked_by], dtype=np.int64)
    kept = orders.at[pairs[:, 0]] < orders.at[pairs[:, 1]]
    wrong = np.flatnonzero(~kept & (ranks > 0)).tolist()
    broken = [k for k in wrong if (names[pairs[k, 0]], names[pairs[k, 1]]) not in known]
    if not broken:
        return {}
    number = {name: k for k, name in enumerate(names)}
    sums, asking = [], []
    for rule in sorted(orders.hard.keys() & holding):
        for terms, bound in book[rule].sums(orders.nest, orders.cuts, orders.hard[rule].options):
            told = tuple(((number[a], number[b]), w) for (a, b), w in terms if a in number and b in number)
            if len(told) == len(terms) and all(max(link) < size for link, _ in told):
                sums.append((told, bound))
                asking.append(rule)
    if not sums:
        return {}
    links = [(a, b) for a, b in pairs.tolist()]
    made = [(k, k + 1) for k in range(min(orders.cuts.made, size - 1))]
    room, found = SumsRoom(size, runs, sums), {}
    firm = {
        rank: made + [links[k] for k in np.flatnonzero(kept & (ranks <= rank)).tolist()]
        for rank in sorted(set(ranks[broken].tolist()))
    }
    for k in broken:
        if room.none(firm[int(ranks[k])], links[k]):
            rules = ", ".join(dict.fromkeys(asking))
            found[names[links[k][0]], names[links[k][1]]] = f"beside this order no plan could keep {rules}"
    return found


class SumsRoom(ModelOfOrders[Link]):
    """Answers whether sums can hold in an order of `n` things that keeps `runs` together.

    Examples
    --------
    >>> early = (((2, 0), 1), ((2, 1), 1)), 1
    >>> SumsRoom(3, (), [early]).none([(0, 1)], (1, 2)), SumsRoom(3, (), [early]).none([(0, 2)], (0, 1))
    (True, False)
    """

    def __init__(self, n: int, runs: Sequence[Sequence[int]], sums: Sequence[SumOfOrders]) -> None:
        super().__init__()
        self._n, self._runs, self._sums = n, [set(run) for run in runs], sums
        self._pivots = self._few_that_meet_all({link for terms, _ in sums for link, _ in terms})
        self._small = len(self._pivots) ** 2 * n <= MOST_CELLS

    def none(self, kept: Sequence[Link], more: Link) -> bool:
        """Whether no order of all things keeps the runs, these orders and one more, and the sums."""
        if self._short([*kept, more]):
            return True
        return self._small and len(self._pivots) * len(kept) <= MOST_CELLS and self._refuted(kept, [more])

    def _of_runs(self, orders: Iterable[Link]) -> list[Link]:
        """The orders, those into and out of a run asked of all that is in it."""
        found = dict.fromkeys(orders)
        for before, after in tuple(found):
            for run in self._runs:
                if (before in run) != (after in run):
                    found |= dict.fromkeys((before, k) if after in run else (k, after) for k in sorted(run))
        return list(found)

    def _short(self, orders: Sequence[Link]) -> bool:
        """Whether a sum comes to too little by what must come before what alone."""
        links = self._of_runs(orders)
        behind: list[list[int]] = [[] for _ in range(self._n)]
        for before, after in links:
            behind[before].append(after)
        later, changed = [sum(1 << k for k in set(those)) for those in behind], True
        while changed:  # orders that a plan keeps lead from lower numbers to higher ones: the second round ends it
            changed = False
            for k in reversed(range(self._n)):
                reached = later[k]
                for after in behind[k]:
                    reached |= later[after]
                later[k], changed = reached, changed or reached != later[k]
        return any(
            sum(weight for (before, after), weight in terms if not later[after] >> before & 1) < bound
            for terms, bound in self._sums
        )

    def _model(self, kept: Sequence[Link]) -> CpModel:
        """For each pivot and each thing, in turn, whether the thing comes before the pivot."""
        from ortools.sat.python.cp_model import CpModel

        model = CpModel()
        early = {p: [model.new_bool_var("") for _ in range(self._n)] for p in self._pivots}
        for p, before_p in early.items():
            model.add(before_p[p] == 0)
            for q in (q for q in early if q != p):
                if p < q:
                    model.add_exactly_one(before_p[q], early[q][p])
                for k in range(self._n):
                    model.add_implication(before_p[k], early[q][k]).only_enforce_if(early[q][p])
            for run in self._runs:
                members = [before_p[k] for k in sorted(run)]
                if p not in run:
                    for one in members[1:]:
                        model.add(one == members[0])
        for terms, bound in self._sums:
            total = [w * (early[b][a] if b in early else early[a][b].negated()) for (a, b), w in terms]
            model.add(sum(total) >= bound)
        self._ask(model, kept)
        return model

    def _ask(self, model: CpModel, orders: Iterable[Link]) -> None:
        """Put orders to a model."""

        def early(number: int, k: int) -> IntVar:
            return model.get_bool_var_from_proto_index(number * self._n + k)

        for number, p in enumerate(self._pivots):
            for before, after in self._of_runs(orders):
                if after == p:
                    model.add(early(number, before) == 1)
                else:
                    model.add_implication(early(number, after), early(number, before))

    @staticmethod
    def _few_that_meet_all(links: set[Link]) -> list[int]:
        """Few things of which every order has one: those first that the most orders have."""
        others: dict[int, set[int]] = {}
        for before, after in links:
            others.setdefault(before, set()).add(after)
            others.setdefault(after, set()).add(before)
        found = []
        while any(others.values()):
            found.append(max(sorted(others), key=lambda k: len(others[k])))
            for k in others.pop(found[-1]):
                others[k].discard(found[-1])
        return found
