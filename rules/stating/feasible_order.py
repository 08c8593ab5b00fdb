"""An order that keeps positions, runs and what comes before what, and what must give way where none does."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from heapq import heappop, heappush
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from kerfwise.encoder.graphs import Link, weak_components
from kerfwise.rules.statements import About, AtLeast, Before, Statement, by_kind

if TYPE_CHECKING:
    from ortools.sat.python.cp_model import CpSolver

# Positions that are firm, among orders that may give way: which orders must be dropped so that all positions can
# hold.
#
# The contours cut before a position are a set of that many contours. An order is broken where such a set holds the
# later one of its two contours without the other. So the sets before all the positions are chosen together, as a
# small integer program, each inside the next; what is cut in one go is torn by no more of them than can be.

MOST_ROWS = 100_000
"""Where the program had more rows, nothing is dropped: the contradiction is told as any other."""
WORK = 1.0
"""CP-SAT's deterministic seconds, after which it is not shown which links weigh least."""
ANY = 1 << 40


def quiet_solver(work: float) -> CpSolver:
    """One thread, a fixed seed and a limit in deterministic time, so that the same question has the same answer."""
    from ortools.sat.python.cp_model import CpSolver

    solver = CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = 1
    solver.parameters.catch_sigint_signal = False
    solver.parameters.max_deterministic_time = work
    return solver


def positions(statements: Sequence[Statement], n: int) -> dict[int, int]:
    """Contour → its position among n, counted from 1, where hard statements leave it one only.

    Examples
    --------
    >>> from kerfwise.rules.statements import About, AtLeast
    >>> about = About("locks", ("B",), "B is cut 2 in order")
    >>> second = [AtLeast((Before(0, 1), Before(2, 1)), (1, 1), 1, about)]
    >>> positions([*second, AtLeast((Before(1, 0), Before(1, 2)), (1, 1), 1, about)], 3)
    {1: 2}
    """
    ends = _ends(statements, n)
    firm = {
        k: bounds for k, bounds in ends.items() if len(bounds) == 2 and sum(of[0] for of in bounds.values()) == n - 1
    }
    return {k: bounds[True][0] + 1 for k, bounds in firm.items()}


def position_clashes(statements: Sequence[Statement], n: int) -> tuple[About, ...]:
    """Where hard statements come from that want one contour at two positions, or two contours at one; mostly none.

    Examples
    --------
    >>> from kerfwise.rules.statements import About, AtLeast
    >>> def at_first(k, other):
    ...     return AtLeast((Before(k, other),), (1,), 1, About("locks", (), f"{k} first"))
    >>> [about.sentence for about in position_clashes([at_first(0, 1), at_first(1, 0)], 2)]
    ['0 first', '1 first']
    """
    taken: dict[int, tuple[About, ...]] = {}
    for bounds in _ends(statements, n).values():
        abouts = tuple(dict.fromkeys(about for _, about in bounds.values()))
        if sum(of[0] for of in bounds.values()) > n - 1:
            return abouts
        if len(bounds) == 2 and sum(of[0] for of in bounds.values()) == n - 1:
            place = bounds[True][0]
            if place in taken:
                return tuple(dict.fromkeys((*taken[place], *abouts)))
            taken[place] = abouts
    return ()


def _ends(statements: Sequence[Statement], n: int) -> dict[int, dict[bool, tuple[int, About]]]:
    """Contour → how many others hard statements want before it (True) and after it (False) at the least, and which."""
    found: dict[int, dict[bool, tuple[int, About]]] = {}
    for s in by_kind(statements).at_least:
        for contour, early in ends_of(s, n) if s.weight is None else ():
            bounds = found.setdefault(contour, {})
            if early not in bounds or s.bound > bounds[early][0]:
                bounds[early] = (s.bound, s.about)
    return found


def ends_of(statement: AtLeast, n: int) -> list[tuple[int, bool]]:
    """The contour of n before which (True), or after which (False), so many others must be cut; none if it says else.

    Of two contours one is before the other where the other is after it: both are said.

    Examples
    --------
    >>> from kerfwise.rules.statements import About, AtLeast
    >>> ends_of(AtLeast((Before(0, 1), Before(2, 1)), (1, 1), 1, About("locks", (), "")), 3)
    [(1, True)]
    """
    if statement.when is not None or len(statement.literals) != n - 1 or set(statement.weights) != {1}:
        return []
    pairs = [(literal.i, literal.j) for literal in statement.literals if isinstance(literal, Before)]
    found = []
    for inner, outer in ((1, 0), (0, 1)):
        contours, around = {pair[inner] for pair in pairs}, {pair[outer] for pair in pairs}
        if len(contours) == 1 and len(around) == n - 1 and not contours & around:
            found.append((contours.pop(), inner == 1))
    return found


def links_to_drop(
    n: int,
    links: Sequence[Link],
    weights: Sequence[int | None],
    runs: Sequence[Sequence[int]],
    at: Mapping[int, int],
    cycles: Collection[frozenset[int]] = (),
) -> tuple[list[int], bool] | None:
    """Numbers of the links (before, after) to drop so that the positions `at` can hold, of least total weight.

    And whether it was shown that they weigh least. None where no drop helps, or none was found. A weight of None is
    kept. `runs` are contours cut in one go. Of each of the `cycles` some link is dropped; others are not looked for.

    Examples
    --------
    >>> links_to_drop(3, [(0, 2), (1, 2)], [2, 1], [], {2: 2})
    ([1], True)
    """
    if not cycles and _nothing_in_the_way(n, links, runs, at):
        return [], True
    sizes = sorted({size for place in at.values() for size in (place - 1, place)} - {0, n})
    group = np.arange(n)
    for run in runs:
        group[list(run)] = min(run)
    several = sorted({int(group[run[0]]) for run in runs if len(run) > 1})
    if len(sizes) * (len(links) + 2 * n) > MOST_ROWS:
        return None
    if not sizes and not cycles:
        return [], True
    program = _Program(n, len(links), len(sizes), several)
    for k, size in enumerate(sizes):
        program.row([(program.inside(k, c), 1) for c in range(n)], size, size)
        for run in runs:
            for c in run if len(run) > 1 else ():
                low, high = program.run(k, int(group[c]))
                program.row([(program.inside(k, c), 1), (low, -1)], 0, ANY)
                program.row([(high, 1), (program.inside(k, c), -1)], 0, ANY)
        torn = [(column, sign) for g in several for column, sign in zip(program.run(k, g), (-1, 1), strict=True)]
        if torn:
            program.row(torn, -ANY, 1)
        for number, (a, b) in enumerate(links):
            apart = group[a] != group[b]
            early = program.run(k, int(group[a]))[0] if apart and group[a] in several else program.inside(k, a)
            late = program.run(k, int(group[b]))[1] if apart and group[b] in several else program.inside(k, b)
            row = [(early, 1), (late, -1)] + [(number, 1)] * (weights[number] is not None)
            program.row(row, 0, ANY)
    for k in range(len(sizes) - 1):
        for c in range(n):
            program.row([(program.inside(k + 1, c), 1), (program.inside(k, c), -1)], 0, ANY)
    for k, between in enumerate(np.diff(sizes).tolist()):  # a run that both sets tear: nothing else comes between them
        for g in several:
            low, high, low_, high_ = (*program.run(k, g), *program.run(k + 1, g))
            members = np.flatnonzero(group == g).tolist()
            inside = [(program.inside(m, c), sign) for m, sign in ((k + 1, 1), (k, -1)) for c in members]
            torn = [(high, -between), (low, between), (high_, -between), (low_, between)]
            program.row([*inside, *torn], -between, ANY)
    for contour, place in at.items():
        if place - 1 in sizes:
            program.fixed[program.inside(sizes.index(place - 1), contour)] = 0
        if place in sizes:
            program.fixed[program.inside(sizes.index(place), contour)] = 1
    for cycle in cycles:
        program.row([(number, 1) for number in sorted(cycle) if weights[number] is not None], 1, ANY)
    return program.least([w or 0 for w in weights])


def _nothing_in_the_way(n: int, links: Sequence[Link], runs: Sequence[Sequence[int]], at: Mapping[int, int]) -> bool:
    """Whether an order was found in which all links, runs and positions hold."""
    firm = {contour: position - 1 for contour, position in at.items()}
    place = order_in_runs(n, links, runs, firm, firm)
    if place is None or any(place[contour] != position for contour, position in firm.items()):
        return False
    spans = [[place[contour] for contour in run] for run in runs]
    return all(max(span) - min(span) < len(set(span)) for span in spans)


class _Program:
    """Columns: a link is dropped; a contour is inside a set; of a run all, and any, are inside a set. All 0 or 1."""

    def __init__(self, n: int, links: int, sets: int, several: Sequence[int]) -> None:
        self.n, self.links, self.of_run = n, links, {g: links + sets * n + 2 * sets * k for k, g in enumerate(several)}
        self.columns = links + sets * n + 2 * sets * len(several)
        self.rows: list[list[tuple[int, int]]] = []
        self.low: list[int] = []
        self.high: list[int] = []
        self.fixed: dict[int, int] = {}

    def inside(self, k: int, contour: int) -> int:
        return self.links + k * self.n + contour

    def run(self, k: int, group: int) -> tuple[int, int]:
        return self.of_run[group] + 2 * k, self.of_run[group] + 2 * k + 1

    def row(self, cells: list[tuple[int, int]], low: int, high: int) -> None:
        self.rows.append(cells)
        self.low.append(low)
        self.high.append(high)

    def least(self, weights: Sequence[int]) -> tuple[list[int], bool] | None:
        """The links dropped, at the least weight if `WORK` is enough to show that; None where nothing was found."""
        from ortools.sat.python.cp_model import FEASIBLE, OPTIMAL, CpModel

        model = CpModel()
        columns = [model.new_bool_var("") for _ in range(self.columns)]
        for row, low, high in zip(self.rows, self.low, self.high, strict=True):
            model.add_linear_constraint(sum(sign * columns[column] for column, sign in row), low, high)
        for column, value in self.fixed.items():
            model.add(columns[column] == value)
        model.minimize(sum(weight * columns[k] for k, weight in enumerate(weights)))
        solver = quiet_solver(WORK)
        status = solver.solve(model)
        if status not in (OPTIMAL, FEASIBLE):
            return None
        return [k for k in range(self.links) if solver.boolean_value(columns[k])], status == OPTIMAL


# An order in which runs stay together, contours come before others as asked, and places are kept, if one is found.


def order_in_runs(
    n: int,
    links: Sequence[Link],
    runs: Sequence[Sequence[int]],
    earliest: Mapping[int, int],
    latest: Mapping[int, int],
) -> list[int] | None:
    """The place, from 0 on, of each of n contours; None where links and runs form a cycle.

    Each run is put in an order of its own, and runs one after the other: of those that may come next the one that must
    come soonest, unless it would take the place of another. Places are kept where that finds a way, not always.

    Examples
    --------
    >>> order_in_runs(4, [(0, 2), (2, 3)], [(0, 3)], {}, {})
    >>> order_in_runs(4, [(3, 0), (0, 2)], [(0, 3)], {2: 3}, {})
    [1, 2, 3, 0]
    """
    if not runs:
        return likely_order(n, links, earliest, latest)
    chain = np.array([link for run in runs for link in pairwise(run)], dtype=np.int64).reshape(-1, 2)
    block = weak_components(n, chain).tolist()
    blocks = 1 + max(block)
    inside: dict[int, list[Link]] = defaultdict(list)
    before: list[set[int]] = [set() for _ in range(blocks)]
    for i, j in links:
        if block[i] == block[j]:
            inside[block[i]].append((i, j))
        else:
            before[block[j]].add(block[i])
    members: list[list[int]] = [[] for _ in range(blocks)]
    for k in range(n):
        members[block[k]].append(k)
    for b, orders in inside.items():
        straight = _straight(members[b], orders, latest)
        if straight is None:
            return None
        members[b] = straight
    sequence = _in_turn(members, before, earliest, latest)
    if sequence is None:
        return None
    place = [0] * n
    for position, k in enumerate(k for b in sequence for k in members[b]):
        place[k] = position
    return place


def _straight(members: Sequence[int], orders: Sequence[Link], latest: Mapping[int, int]) -> list[int] | None:
    """The members of a run in an order that keeps the orders, soonest first."""
    number = {k: m for m, k in enumerate(members)}
    soon = sorted({latest[k] for k in members if k in latest})
    due = {number[k]: soon.index(latest[k]) for k in members if k in latest}
    places = likely_order(len(members), [(number[i], number[j]) for i, j in orders], {}, due)
    return places and sorted(members, key=lambda k: places[number[k]])


def _in_turn(
    members: Sequence[Sequence[int]],
    before: Sequence[set[int]],
    earliest: Mapping[int, int],
    latest: Mapping[int, int],
) -> list[int] | None:
    """The runs one after the other; None where they wait for each other."""
    blocks, n = len(members), sum(map(len, members))
    after: list[list[int]] = [[] for _ in range(blocks)]
    waits_for = [len(of) for of in before]
    for b, of in enumerate(before):
        for a in of:
            after[a].append(b)
    straight = chain(after, waits_for)
    if straight is None:
        return None
    begins = [max(0, *(earliest.get(k, 0) - m for m, k in enumerate(of))) for of in members]
    ends = [min(n - len(of), *(latest.get(k, n - 1) - m for m, k in enumerate(of))) for of in members]
    for a in straight:
        for b in after[a]:
            begins[b] = max(begins[b], begins[a] + len(members[a]))
    for a in reversed(straight):
        ends[a] = min([ends[a], *(ends[b] - len(members[a]) for b in after[a])])
    ready = {b for b in range(blocks) if not waits_for[b]}
    due = sorted(range(blocks), key=lambda b: -ends[b])
    sequence: list[int] = []
    done = [False] * blocks
    position = 0
    while ready:
        while done[due[-1]]:
            due.pop()
        next_due = due[-1]
        may = [b for b in ready if begins[b] <= position] or list(ready)
        fits = [b for b in may if b == next_due or position + len(members[b]) <= ends[next_due]]
        b = min(fits or may, key=lambda b: (ends[b], b))
        ready.discard(b)
        done[b] = True
        sequence.append(b)
        position += len(members[b])
        for other in after[b]:
            waits_for[other] -= 1
            if not waits_for[other]:
                ready.add(other)
    return sequence


# An order that keeps what is asked of places and of what comes before what, where one does: what is tried first.


def likely_order(
    n: int, orders: Sequence[tuple[int, int]], earliest: Mapping[int, int], latest: Mapping[int, int]
) -> list[int] | None:
    """The place, from 0 on, of each of n contours: of those that may come next the one that must come soonest.

    `orders` are (before, after); `earliest` and `latest` are places that a contour may not pass. With cuts that count
    one each this finds an order wherever there is one (Simons 1978 has the general case); None where orders form a
    cycle. Where places cannot be kept it answers all the same.

    Examples
    --------
    >>> likely_order(4, [(0, 1), (2, 3)], {}, {3: 1})
    [2, 3, 0, 1]
    """
    after: list[list[int]] = [[] for _ in range(n)]
    waits_for = [0] * n
    for i, j in orders:
        after[i].append(j)
        waits_for[j] += 1
    straight = chain(after, waits_for)
    if straight is None:
        return None
    soonest = [earliest.get(k, 0) for k in range(n)]
    last = [latest.get(k, n - 1) for k in range(n)]
    for k in straight:
        for j in after[k]:
            soonest[j] = max(soonest[j], soonest[k] + 1)
    for k in reversed(straight):
        last[k] = min([last[k], *(last[j] - 1 for j in after[k])])
    waiting = sorted(range(n), key=lambda k: -soonest[k])
    released = [False] * n
    ready: list[tuple[int, int]] = []
    place = [-1] * n
    for position in range(n):
        while waiting and soonest[waiting[-1]] <= position:
            k = waiting.pop()
            released[k] = True
            if not waits_for[k] and place[k] < 0:
                heappush(ready, (last[k], k))
        if ready:
            _, k = heappop(ready)
        else:  # some contour must come too early
            k = min((k for k in range(n) if place[k] < 0 and not waits_for[k]), key=lambda k: (soonest[k], k))
        place[k] = position
        for j in after[k]:
            waits_for[j] -= 1
            if not waits_for[j] and released[j]:
                heappush(ready, (last[j], j))
    return place


def chain(after: Sequence[Sequence[int]], waits_for: Sequence[int]) -> list[int] | None:
    """Things each before what comes `after` it, which `waits_for` so many others; None where they form a cycle.

    Examples
    --------
    >>> chain([[], [0]], [1, 0]), chain([[1], [0]], [1, 1])
    ([1, 0], None)
    """
    straight = [k for k, others in enumerate(waits_for) if not others]
    left = list(waits_for)
    for k in straight:  # it grows
        for j in after[k]:
            left[j] -= 1
            if not left[j]:
                straight.append(j)
    return straight if len(straight) == len(after) else None
