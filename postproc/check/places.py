"""Whether contours can be cut at the positions that locks give them: asked of all orders that are known, at once.

What must come before a contour, or after it, is counted first. Where that says nothing, a small model of its own
answers: every run of contours that are cut in one go is an interval of the order, and no two overlap.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from ortools.sat.python.cp_model import CpModel

WORK, WORK_IN_ALL = 5.0, 20.0
"""CP-SAT's deterministic seconds for a question, and for all; where they do not show that there is no room, some
counts as being there."""

OrderedPair = tuple[str, str]
Node = TypeVar("Node")


class Room:
    """Answers whether there is room for contours at the positions `at` (from 1 on), among all `names`.

    `runs` are kept together. `questions` counts those that the model was asked.

    Examples
    --------
    >>> Room("abc", (), {"c": 2}).none([("a", "c"), ("b", "c")]), Room("abc", (), {"c": 2}).none([("a", "c")])
    (True, False)
    """

    def __init__(self, names: Sequence[str], runs: Sequence[Sequence[str]], at: Mapping[str, int]) -> None:
        self._names, self._at = names, at
        self._run_of = {name: (name,) for name in names} | {name: tuple(run) for run in runs for name in run}
        self._runs = list(dict.fromkeys(self._run_of.values()))
        self._left = WORK_IN_ALL
        self._asked: tuple[Sequence[OrderedPair], CpModel] | None = None
        self.questions = 0

    def none(self, orders: Sequence[OrderedPair], more: Sequence[OrderedPair] = ()) -> bool:
        """Whether no order of the names keeps the runs together, all orders (before, after), and the positions.

        What is asked with `more` orders beside the same list as before is answered sooner.
        """
        return self._crowded([*orders, *more]) or (self._left > 0 and self._refuted(orders, more))

    def _crowded(self, orders: Sequence[OrderedPair]) -> bool:
        """Whether more must come before a position, or after it, than there is room for."""
        turned = [(after, before) for before, after in orders]
        return any(
            self._ahead(name, orders) >= position or self._ahead(name, turned) > len(self._names) - position
            for name, position in self._at.items()
        )

    def _ahead(self, name: str, orders: Iterable[OrderedPair]) -> int:
        """How many names the orders put before one."""
        within: dict[str, set[str]] = defaultdict(set)
        between: dict[tuple[str, ...], set[tuple[str, ...]]] = defaultdict(set)
        for before, after in orders:
            one, other = self._run_of[before], self._run_of[after]
            if one == other:
                within[after].add(before)
            else:
                between[other].add(one)
        return len(_reached(within, name)) + sum(map(len, _reached(between, self._run_of[name])))

    def _refuted(self, orders: Sequence[OrderedPair], more: Sequence[OrderedPair]) -> bool:
        """Whether the model shows that there is no room."""
        from ortools.sat.python.cp_model import INFEASIBLE, CpSolver

        if self._asked is None or self._asked[0] is not orders:
            self._asked = orders, self._model(orders)
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

    def _model(self, orders: Sequence[OrderedPair]) -> CpModel:
        """Where each run begins, then where each name is within its run, from 0 on."""
        from ortools.sat.python.cp_model import CpModel

        model, last = CpModel(), len(self._names) + 1
        begin = {run: model.new_int_var(1, last - len(run), "") for run in self._runs}
        model.add_no_overlap(model.new_fixed_size_interval_var(first, len(run), "") for run, first in begin.items())
        for run, first in begin.items():
            within = {name: model.new_int_var(0, len(run) - 1, "") for name in run}
            model.add_all_different(within.values())
            for name in sorted(self._at.keys() & within.keys()):
                model.add(first + within[name] == self._at[name])
        self._ask(model, orders)
        return model

    def _ask(self, model: CpModel, orders: Sequence[OrderedPair]) -> None:
        """Put orders to a model: of names in one run, or of the runs that they are in."""
        begin = {run: model.get_int_var_from_proto_index(k) for k, run in enumerate(self._runs)}
        names = enumerate((name for run in self._runs for name in run), len(begin))
        within = {name: model.get_int_var_from_proto_index(k) for k, name in names}
        for before, after in orders:
            one, other = self._run_of[before], self._run_of[after]
            if one == other:
                model.add(within[before] < within[after])
            else:
                model.add(begin[one] + len(one) <= begin[other])


def _reached(straight: Mapping[Node, set[Node]], start: Node) -> set[Node]:
    """All that leads to a node, itself left out."""
    seen, waiting = {start}, [start]
    while waiting:
        new = straight.get(waiting.pop(), set()) - seen
        seen |= new
        waiting += new
    return seen - {start}
