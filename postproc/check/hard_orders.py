"""What hard orders, locks and sums ask, by their own geometry, and what comes before a contour in every plan."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from kerfwise.arrays import Ints, unique, unique_pairs
from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.graphs import Link
from kerfwise.encoder.nest import Ids, Nest
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


if TYPE_CHECKING:
    from ortools.sat.python.cp_model import CpModel, IntVar

MOST_CELLS = 200_000
"""Where the model had more rows, for orders or between contours that sums are about, it is asked what may come last."""

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
        if self._small and len(self._pivots) * len(kept) <= MOST_CELLS:
            return self._refuted(kept, [more])
        return self._endless([*kept, more])

    def _endless(self, orders: Iterable[Link]) -> bool:
        """Whether of some things none can come last, by these orders and by what each sum says of a thing of its own.

        Whatever may come last is put there, and the rest is looked at without it: that only helps the others, as long
        as what would help a sum before its thing still counts for it.
        """
        behind: list[int] = [0] * self._n
        ahead: list[list[int]] = [[] for _ in range(self._n)]
        for before, after in self._of_runs(orders):
            behind[before] += 1
            ahead[after].append(before)
        room: dict[int, list[int]] = {}  # of each thing, what its sums have left to lose while all else comes before it
        losing: list[list[tuple[int, int, int]]] = [[] for _ in range(self._n)]
        for terms, bound in self._sums:
            for own in set.intersection(*(set(link) for link, _ in terms)):
                gained = [(before, weight) for (before, after), weight in terms if after == own]
                lost = [(after, weight) for (before, after), weight in terms if before == own]
                room.setdefault(own, []).append(sum(weight for _, weight in gained) - bound)
                for other, weight in lost:
                    losing[other].append((own, len(room[own]) - 1, weight))
        left = set(range(self._n))
        ready = [k for k in left if not behind[k] and min(room.get(k, [0])) >= 0]
        while ready:
            last = ready.pop()
            if last not in left:
                continue
            left.remove(last)
            for before in ahead[last]:
                behind[before] -= 1
            for own, number, weight in losing[last]:
                room[own][number] += weight
            near = [*ahead[last], *(own for own, _, _ in losing[last])]
            ready += [k for k in dict.fromkeys(near) if k in left and not behind[k] and min(room.get(k, [0])) >= 0]
        return bool(left)

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
