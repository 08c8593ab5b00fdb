"""The decisions as CP-SAT variables: the arcs of the route, positions, times, and moves over parts that may be out."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray
from ortools.sat.python.cp_model import CpModel, Domain, IntVar, LinearExprT, LiteralT

from kerfwise.arrays import Bools, Int32s, Ints
from kerfwise.models.engines.deadline import Progress
from kerfwise.models.engines.tuning import VARIABLES_LOOKS as LOOKS
from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.moves import LAWFUL_MOST
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import Before, plain

Pair = tuple[int, int]


@dataclass(frozen=True, eq=False, slots=True)
class Variables:
    """Variables of one model.

    `pick[s]`: site s is used. `travel[a]`: arc a is on the route. `follow[i, j]`: contour j directly follows i (n is
    the machine's home). `position[i]` counts from 0. `order[i, j]`: contour i is cut before contour j, only for pairs
    that a statement asks about and the hard orders leave open. `broken[k]`: soft condition k is not met; `failed[k]`:
    soft general statement k does not hold; `missing[k]`: the cuts that soft lag k lacks, `late[k]` the milliseconds;
    `over[k]`: crossing k of `crossings`, a soft one, is made. `begin[i]`: when the cut of contour i begins, ms, only
    where a statement counts seconds; then `linked[i]` are the arcs of links to it, and the ms that each makes its cut
    longer.
    """

    problem: Problem
    pick: list[IntVar]
    travel: list[IntVar]
    follow: dict[Pair, IntVar]
    position: list[IntVar]
    order: dict[Pair, LiteralT]
    broken: dict[int, IntVar]
    failed: dict[int, IntVar]
    missing: dict[int, IntVar]
    late: dict[int, IntVar]
    crossings: tuple[OpenCrossing, ...]
    over: dict[int, IntVar]
    begin: list[IntVar]
    linked: list[list[tuple[int, int]]]

    def before(self, i: int, j: int) -> LiteralT:
        """Literal, or constant, that says that contour i is cut before contour j."""
        if i == j or self.problem.before[j, i]:
            return False
        return True if self.problem.before[i, j] else self.order[i, j]


def make_variables(model: CpModel, problem: Problem, arcs: ArcLiterals) -> Variables:
    """All variables of the problem over these arcs."""
    travel = [model.new_bool_var("") for _ in arcs.tail]
    crossings = open_crossings(problem, arcs)
    return Variables(
        problem=problem,
        pick=[model.new_bool_var("") for _ in range(problem.m)],
        travel=travel,
        follow=_follow(model, arcs, travel),
        position=_positions(model, problem),
        order=_orders(model, problem, crossings),
        broken={
            k: model.new_bool_var("") for k, c in enumerate(problem.conditions) if c.cost is not None and c.cost > 0
        },
        failed={k: model.new_bool_var("") for k, s in enumerate(problem.general) if s.weight is not None},
        missing={
            k: model.new_int_var(0, lag.cuts + 1, "")
            for k, lag in enumerate(problem.lags)
            if lag.weight is not None and lag.cuts > 0
        },
        late={
            k: model.new_int_var(0, round(lag.seconds * 1000), "")
            for k, lag in enumerate(problem.lags)
            if lag.weight is not None and lag.seconds > 0
        },
        crossings=crossings,
        over={k: model.new_bool_var("") for k, crossing in enumerate(crossings) if crossing.cost != FORBIDDEN},
        begin=_begins(model, problem, arcs),
        linked=linked_ms(problem, arcs) if counts_seconds(problem) else [],
    )


def _begins(model: CpModel, problem: Problem, arcs: ArcLiterals) -> list[IntVar]:
    """A clock, if a statement counts seconds."""
    if not counts_seconds(problem):
        return []
    longest = longest_ms(problem, arcs)
    return [model.new_int_var(0, longest, "") for _ in range(problem.n)]


def _follow(model: CpModel, arcs: ArcLiterals, travel: list[IntVar]) -> dict[Pair, IntVar]:
    """One literal for every two contours; where a single arc joins them it is that arc's."""
    follow: dict[Pair, IntVar] = {}
    for i, j, span in arcs.spans():
        follow[i, j] = travel[span.start] if span.stop == span.start + 1 else model.new_bool_var("")
    return follow


def _positions(model: CpModel, problem: Problem) -> list[IntVar]:
    """What must come before and after a contour bounds its position."""
    return [model.new_int_var(int(low), int(high), "") for low, high in zip(*windows(problem), strict=True)]


def _orders(model: CpModel, problem: Problem, crossings: Sequence[OpenCrossing]) -> dict[Pair, LiteralT]:
    """One literal for two contours; for all pairs of two blocks it is the same, since blocks are not mixed."""
    literals: dict[Pair, LiteralT] = {}
    order: dict[Pair, LiteralT] = {}
    block = problem.block.tolist()
    for i, j in sorted(set(_asked(problem, crossings))):
        key = (i, j) if block[i] == block[j] else (block[i], block[j])
        if key not in literals:
            literal = model.new_bool_var("")
            literals[key], literals[key[1], key[0]] = literal, literal.negated()
        order[i, j], order[j, i] = literals[key], literals[key[1], key[0]]
    return order


def _asked(problem: Problem, crossings: Sequence[OpenCrossing]) -> Iterator[Pair]:
    """Pairs (the smaller number first) whose order a statement asks about and no hard order decides."""
    pairs: list[Pair] = [(k, c.contour) for c in problem.conditions for k in c.members]
    pairs += [(lag.first, lag.second) for lag in problem.lags if lag.cuts > 1 or lag.seconds > 0]
    pairs += [(crossing.over, crossing.leave) for crossing in crossings]
    pairs += [(lit.i, lit.j) for s in problem.general for lit in plain(s.literals) if isinstance(lit, Before)]
    for i, j in pairs:
        if i != j and not problem.before[i, j] and not problem.before[j, i]:
            yield min(i, j), max(i, j)


def in_domain(model: CpModel, number: LinearExprT, least: int, most: int) -> IntVar:
    """A new literal that holds if and only if the number is `least` to `most`."""
    holds, domain = model.new_bool_var(""), Domain(least, most)
    model.add_linear_expression_in_domain(number, domain).only_enforce_if(holds)
    model.add_linear_expression_in_domain(number, domain.complement()).only_enforce_if(holds.negated())
    return holds


# Moves over parts that may be out: what the hard orders decide of them, and what stays open.


class OutByThen(IntEnum):
    """Whether the contour that a move crosses is out by the time of the move."""

    NO = 0
    YES = 1
    OPEN = 2


def out_by_then(problem: Problem) -> Ints:
    """For every row of the problem's crossings an `OutByThen`."""
    rows, n = problem.crossings, problem.n
    contour = np.append(problem.site_contour, n)
    leave, reach, over = contour[rows.leave], contour[rows.reach], rows.over
    before = np.zeros((n + 1, n + 1), dtype=np.bool_)
    before[:n, :n] = problem.before
    no = (leave == n) | (over == reach) | before[leave, over]
    yes = (reach == n) | (over == leave) | before[over, leave]
    return np.where(no, OutByThen.NO, np.where(yes, OutByThen.YES, OutByThen.OPEN)).astype(np.int64)


def arc_of_move(m: int, tail: Ints, head: Ints, leave: Ints | Int32s, reach: Ints | Int32s) -> Ints:
    """The arc of every move from a site to a site, -1 where there is none."""
    past_all = (m + 1) ** 2
    keys, wanted = np.append(tail * (m + 1) + head, past_all), leave.astype(np.int64) * (m + 1) + reach
    order = np.argsort(keys, kind="stable")
    found = order[np.searchsorted(keys, wanted, sorter=order)]
    return np.where(keys[found] == wanted, found, -1)


# Crossings that the hard orders leave open, gathered: of the moves that leave one contour only one is made.


@dataclass(frozen=True, slots=True)
class OpenCrossing:
    """Leaving contour `leave` by one of `arcs` costs `cost` µm (or is `FORBIDDEN`) if contour `over` is out."""

    leave: int
    over: int
    cost: int
    arcs: tuple[int, ...]


def open_crossings(problem: Problem, arcs: ArcLiterals) -> tuple[OpenCrossing, ...]:
    """All of them; an arc that crosses several areas of the same contour is in as many."""
    rows = problem.crossings
    arc = arc_of_move(problem.m, arcs.tail, arcs.head, rows.leave, rows.reach)
    left = np.flatnonzero((out_by_then(problem) == OutByThen.OPEN) & (arc >= 0) & (rows.cost != 0))
    leave = problem.site_contour[rows.leave[left]]
    columns = (arc[left].tolist(), leave.tolist(), rows.over[left].tolist(), rows.cost[left].tolist())
    times: Counter[tuple[int, int, int]] = Counter()
    gathered: dict[tuple[int, int, int, int], list[int]] = defaultdict(list)
    for a, i, over, cost in zip(*columns, strict=True):
        gathered[i, over, cost, times[a, over, cost]].append(a)
        times[a, over, cost] += 1
    return tuple(OpenCrossing(i, over, cost, tuple(found)) for (i, over, cost, _), found in gathered.items())


# Where in the order a contour can stand, by what must come before and after it.


def windows(problem: Problem) -> tuple[Ints, Ints]:
    """The first and the last position (from 0) of every contour."""
    return problem.before.sum(axis=0), problem.n - 1 - problem.before.sum(axis=1)


def windows_of_steps(problem: Problem) -> tuple[Ints, Ints]:
    """Matrices (n, n): the first position of i, and the last of j, if j directly follows i.

    Before i comes what must precede i or j, and the whole block of i if the route leaves it; after j likewise.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> zero_before_two = np.array([[0, 0, 1], [0, 0, 0], [0, 0, 0]], dtype=bool)
    >>> first, last = windows_of_steps(SimpleNamespace(n=3, before=zero_before_two, block=np.arange(3)))
    >>> int(first[1, 2]), int(last[0, 1])
    (1, 1)
    """
    n, before = problem.n, problem.before
    together = problem.block[:, None] == problem.block[None, :]
    itself = np.eye(n, dtype=np.bool_)
    within = (_united(before.T | itself, before.T), _united(before, before | itself))
    across = (_united(before.T | together, before.T), _united(before, before | together))
    ahead, behind = (np.where(together, one, other) for one, other in zip(within, across, strict=True))
    return ahead - 1, n - behind


def distances(problem: Problem) -> Ints:
    """Matrix (n, n): by how much the position of j exceeds that of i at least, where i must come before j; else 0."""
    steps = problem.before.astype(np.float32)  # whole numbers well below 2^24: exact, and fast to multiply
    return np.where(problem.before, (steps @ steps).astype(np.int64) + 1, 0)


def _united(one: NDArray[np.bool_], other: NDArray[np.bool_]) -> Ints:
    """How many there are in row i of the one or in row j of the other."""
    common = (one.astype(np.float32) @ other.T.astype(np.float32)).astype(np.int64)
    return np.asarray(one.sum(axis=1)[:, None] + other.sum(axis=1)[None, :] - common, dtype=np.int64)


# How long cuts and moves take, for the clock of a model.


def counts_seconds(problem: Problem) -> bool:
    """Whether a statement counts seconds, so that a clock is needed."""
    return any(lag.seconds > 0 for lag in problem.lags)


def cuts_ms(problem: Problem) -> Ints:
    """Time of the cut of every site."""
    return problem.pace.cut_ms if len(problem.pace.cut_ms) else np.zeros(problem.m, dtype=np.int64)


def moves_ms(problem: Problem, arcs: ArcLiterals) -> Ints:
    """Time of the idle travel along every arc; along a link there is none."""
    idle = problem.pace.move_ms(problem.ends()[arcs.tail], problem.pierces()[arcs.head])
    return np.where(problem.links.rows_of(arcs.tail, arcs.head) >= 0, 0, idle)


def linked_ms(problem: Problem, arcs: ArcLiterals) -> list[list[tuple[int, int]]]:
    """For every contour the links that lead to it, as arcs, and by how much each makes its cut longer."""
    row = problem.links.rows_of(arcs.tail, arcs.head)
    found: list[list[tuple[int, int]]] = [[] for _ in range(problem.n)]
    for arc in np.flatnonzero(row >= 0).tolist():
        found[int(problem.site_contour[arcs.head[arc]])].append((arc, int(problem.links.ms[row[arc]])))
    return found


def longest_ms(problem: Problem, arcs: ArcLiterals) -> int:
    """No plan takes longer than the longest cuts and the longest moves together."""
    cuts = np.maximum.reduceat(cuts_ms(problem), problem.first[:-1])
    burnt = problem.n * int(problem.links.ms.max(initial=0))
    return int(cuts.sum()) + burnt + (problem.n + 1) * int(moves_ms(problem, arcs).max(initial=0))


# Whether CP-SAT may go on: its arcs, prices and model take seconds on large nests before it runs at all.

GoOn = Callable[[], None]
"""Asked again and again by what takes long; raises `Stopped` where it may not go on."""


class Stopped(Exception):
    """There is no time left for what was begun, or somebody said stop."""


def always() -> None:
    """There is no limit."""


def report_progress(engine: str, progress: Progress, cost_um: int | None, bound_um: int) -> GoOn:
    """Asks `progress` with what is known already."""

    def go_on() -> None:
        if not progress(engine, cost_um, bound_um):
            raise Stopped

    return go_on


# The arcs of the route: which contour may directly follow which, by which sites, and at what cost.


@dataclass(frozen=True, eq=False, slots=True)
class ArcLiterals:
    """Arcs between sites, in groups of the same two contours; the machine's home is site m and contour n.

    Group g leads from contour `groups[g, 0]` to `groups[g, 1]` and holds arcs `first[g]` … `first[g + 1] - 1`; arc a
    leads from site `tail[a]` to `head[a]` and costs `cost[a]` µm.
    """

    groups: Ints
    first: Ints
    tail: Ints
    head: Ints
    cost: Ints

    def spans(self) -> Iterator[tuple[int, int, slice]]:
        """Contours i and j, and the arcs between them, for every group."""
        for (i, j), a, b in zip(self.groups.tolist(), self.first[:-1].tolist(), self.first[1:].tolist(), strict=True):
            yield i, j, slice(a, b)


def site_arcs(problem: Problem, lawful: Bools, go_on: GoOn = always) -> ArcLiterals:
    """Every lawful arc between sites, at the cost of its idle travel and of what it crosses in any lawful order.

    `go_on` is asked now and then.
    """
    groups = np.argwhere(lawful).astype(np.int64)
    first = np.append(problem.first, problem.m + 1)
    sites = np.arange(problem.m + 1)
    tails, heads, costs = [], [], []
    for k, (i, j) in enumerate(groups.tolist()):
        if k % LOOKS == 0:
            go_on()
        leave, reach = sites[first[i] : first[i + 1]], sites[first[j] : first[j + 1]]
        tails.append(np.repeat(leave, len(reach)))
        heads.append(np.tile(reach, len(leave)))
        costs.append(problem.travel(leave, reach).ravel())
    sizes = np.array([len(cost) for cost in costs])
    return _crossed(problem, groups, sizes, *(np.concatenate(column) for column in (tails, heads, costs)))


def _crossed(problem: Problem, groups: Ints, sizes: Ints, tail: Ints, head: Ints, cost: Ints) -> ArcLiterals:
    """Arcs with the crossings that the hard orders decide; moves that are forbidden are left out."""
    rows = problem.crossings
    always = out_by_then(problem) == OutByThen.YES
    arc = arc_of_move(problem.m, tail, head, rows.leave, rows.reach)
    paid = always & (arc >= 0) & (rows.cost != FORBIDDEN)
    np.add.at(cost, arc[paid], rows.cost[paid])
    kept = cost <= LAWFUL_MOST
    kept[arc[always & (arc >= 0) & (rows.cost == FORBIDDEN)]] = False
    left = np.add.reduceat(kept, np.cumsum(sizes) - sizes, dtype=np.int64)
    first = np.concatenate([[0], np.cumsum(left[left > 0])])
    return ArcLiterals(groups[left > 0], first, tail[kept], head[kept], cost[kept])
