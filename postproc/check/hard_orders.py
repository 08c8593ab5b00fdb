"""What the hard order rules and locks ask, by their own geometry, and what they put before a contour in every plan."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from kerfwise.arrays import Ints, unique, unique_pairs
from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.active_rules import ActiveRules
from kerfwise.rules.profile.sections import RuleSetting
from kerfwise.rules.rule import Rule

if TYPE_CHECKING:
    from ortools.sat.python.cp_model import CpModel


class HardOrders:
    """Pairs of contours, the first of which must be cut before the second, of every hard rule of a profile.

    Contours are numbered as in `names`: those that are cut come first, in the order of their cuts.
    """

    def __init__(self, nest: Nest, cuts: CutSequence, profile: ActiveRules) -> None:
        self.nest, self.cuts, self.profile = nest, cuts, profile

    @cached_property
    def hard(self) -> dict[str, RuleSetting]:
        """The hard rules."""
        return {rule: s for rule, s in self.profile.settings().items() if s.strength == "hard"}

    @cached_property
    def names(self) -> list[str]:
        """Contour ids by number: those that are cut, and behind them others that orders name."""
        _ = self.by_rule
        return list(self._number)

    @cached_property
    def at(self) -> Ints:
        """The position of each contour's cut, from 1 on; 0 where it is not cut."""
        at = self.cuts.positions()
        return np.fromiter((at.get(name, 0) for name in self.names), np.int64, len(self.names))

    @cached_property
    def by_rule(self) -> dict[str, Ints]:
        """Rule → the orders that it asks for, (k, 2) numbers."""
        book, torches = self.profile.rulebook(), torch_of_each(self.cuts)
        found = {}
        for name, setting in self.hard.items():
            rule = book[name]
            pairs = list(rule.pairs(self.nest, self.cuts, setting.options))
            if torches and rule.of_each_torch:
                pairs = [pair for pair in pairs if applies_to(rule, pair, torches)]
            numbers = map(self._number.__getitem__, chain.from_iterable(pairs))
            found[name] = np.fromiter(numbers, np.int64, 2 * len(pairs)).reshape(-1, 2)
        return found

    def of_cut(self) -> tuple[Ints, list[str]]:
        """The orders between contours that are cut, each once, (k, 2), and the rule of each: the firmest that asks."""
        book = self.profile.rulebook()
        rules, size = sorted(self.hard, key=lambda name: book[name].gives_way), len(self.cuts.positions())
        pairs = np.concatenate([np.empty((0, 2), np.int64), *(self.by_rule[name] for name in rules)])
        rule = np.repeat(np.arange(len(rules)), [len(self.by_rule[name]) for name in rules])
        cut = np.flatnonzero((pairs < size).all(axis=1))
        _, first = np.unique(pairs[cut, 0] * size + pairs[cut, 1], return_index=True)
        kept = cut[np.sort(first)]
        return pairs[kept], [rules[k] for k in rule[kept].tolist()]

    @cached_property
    def _number(self) -> _Numbers:
        return _Numbers({name: k for k, name in enumerate(self.cuts.positions())})


class _Numbers(dict[str, int]):
    """Numbers of names; a new name has the next one."""

    def __missing__(self, name: str) -> int:
        self[name] = number = len(self)
        return number


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
        cut_names = frozenset(cut.contour for cut in self.cuts[: self.cuts.made])
        return frozenset(inside) | (frozenset(outside) - frozenset(own)) | cut_names

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
        pairs = np.concatenate([np.empty((0, 2), np.int64), *self.orders.by_rule.values()])
        at = self.orders.at
        return unique_pairs(pairs[at[pairs[:, 0]] < at[pairs[:, 1]]])

    @cached_property
    def _groups(self) -> list[tuple[str, ...]]:
        """What is cut in one go, and every other contour by itself, in the order of the cuts."""
        at, names = self.cuts.positions(), self.orders.names
        known = {*at, *(names[k] for k in unique(self._kept.ravel()).tolist())}
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
        into, of = unique_pairs(pairs[pairs[:, 0] != pairs[:, 1]]).T
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


# Whether an order can be in which kept orders hold and more beside them: asked of a small model, again and again.

WORK, WORK_IN_ALL = 5.0, 20.0
"""CP-SAT's deterministic seconds for a question, and for all; what they do not refute counts as possible."""

Order = TypeVar("Order")


class ModelOfOrders(ABC, Generic[Order]):
    """A model of all cuts in their order, asked with the same kept orders and others beside them.

    `questions` counts those that it was asked.
    """

    def __init__(self) -> None:
        self.questions, self._left = 0, WORK_IN_ALL
        self._asked: tuple[Sequence[Order], CpModel] | None = None

    @abstractmethod
    def _model(self, kept: Sequence[Order]) -> CpModel:
        """The model with the kept orders."""

    @abstractmethod
    def _ask(self, model: CpModel, orders: Sequence[Order]) -> None:
        """Put orders to a model."""

    def _refuted(self, kept: Sequence[Order], more: Sequence[Order]) -> bool:
        """Whether the model shows that `more` cannot hold beside the kept orders; false where no work is left."""
        from ortools.sat.python.cp_model import INFEASIBLE, CpSolver

        if self._left <= 0:
            return False
        if self._asked is None or self._asked[0] is not kept:
            self._asked = kept, self._model(kept)
        model = self._asked[1].clone()
        self._ask(model, more)
        solver = CpSolver()
        solver.parameters.num_workers = 1
        solver.parameters.random_seed = 1
        solver.parameters.catch_sigint_signal = False
        solver.parameters.max_deterministic_time = min(WORK, self._left)
        answer = solver.solve(model)
        self.questions += 1
        self._left -= solver.response_proto.deterministic_time
        return bool(answer == INFEASIBLE)


# What rules of each torch ask where several torches cut.


def torch_of_each(cuts: CutSequence) -> dict[str, int]:
    """Contour id → the torch that cuts it; empty where one torch cuts all."""
    torches = {cut.contour: cut.torch for cut in cuts}
    return torches if len(set(torches.values())) > 1 else {}


def applies_to(rule: Rule[Any], contours: Sequence[str], torches: Mapping[str, int]) -> bool:
    """Whether a rule asks anything of these contours: one of each torch does so only of what a single torch cuts."""
    return not torches or not rule.of_each_torch or len({torches[name] for name in contours if name in torches}) < 2
