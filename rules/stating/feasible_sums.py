"""Orders that give way so that hard sums of orders can hold, such as a share of all cutting before which a part is out.

What is cut before a contour is a set of contours. An order is broken where such a set holds the later one of its two
contours without the other. So the sets before all contours that sums are about are chosen together, each inside the
next, as a small integer program: every order of cuts is a solution of it, so that what it cannot keep no plan keeps.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from kerfwise.encoder.graphs import Link
from kerfwise.rules.statements import AtLeast, Before, Statement, by_kind

from .feasible_order import MOST_ROWS, WORK, order_in_runs, quiet_solver


def sums_of_orders(statements: Iterable[Statement]) -> list[AtLeast]:
    """The hard sums that hold whatever is picked, and are about nothing but orders."""
    found = (s for s in by_kind(statements).at_least if s.weight is None and s.when is None and s.literals)
    return [s for s in found if all(isinstance(x, Before) and x.i != x.j for x in s.literals)]


def links_to_drop_for_sums(
    n: int,
    links: Sequence[Link],
    weights: Sequence[int | None],
    runs: Sequence[Sequence[int]],
    sums: Sequence[AtLeast],
) -> tuple[list[int], bool] | None:
    """Numbers of the links (before, after) of n contours to drop so that the sums can hold, of least total weight.

    And whether it was shown that they weigh least. None where no drop helps, or it was not shown that any is needed. A
    weight of None is kept; `runs` are contours cut in one go, and links must be free of cycles.

    Examples
    --------
    >>> from kerfwise.rules.statements import About
    >>> early = AtLeast((Before(2, 0), Before(2, 1)), (1, 1), 1, About("early", (), "2 is not last"))
    >>> links_to_drop_for_sums(3, [(0, 1), (0, 2), (1, 2)], [1, 1, 1], [], [early])
    ([2], True)
    """
    if not sums or _likely_held(n, links, runs, sums):
        return [], True
    solved = _lightest(n, links, weights, runs, sums)
    if solved is None:
        out = _lighter(n, links, weights, runs, sums)
        return None if out is None else (out, False)
    return None if solved.out is None else (solved.out, solved.shown)


def shown_impossible(n: int, links: Sequence[Link], runs: Sequence[Sequence[int]], sums: Sequence[AtLeast]) -> bool:
    """Whether it is shown that no order of n contours keeps all links, runs and sums; links are free of cycles.

    Examples
    --------
    >>> from kerfwise.rules.statements import About
    >>> early = AtLeast((Before(2, 0), Before(2, 1)), (1, 1), 1, About("early", (), "2 is not last"))
    >>> shown_impossible(3, [(0, 2), (1, 2)], [], [early]), shown_impossible(3, [(0, 2)], [], [early])
    (True, False)
    """
    if not sums or _likely_held(n, links, runs, sums):
        return False
    solved = _lightest(n, links, [None] * len(links), runs, sums)
    if solved is None:
        return _none_can_be_last(n, links, sums)
    return solved.out is None and solved.shown


@dataclass(frozen=True, slots=True)
class _Solved:
    """The links that are dropped, None where no drop helps or is known to be needed, and whether this is shown."""

    out: list[int] | None
    shown: bool


def _likely_held(n: int, links: Sequence[Link], runs: Sequence[Sequence[int]], sums: Sequence[AtLeast]) -> bool:
    """Whether an order was found that keeps everything: what sums want soon is cut as soon as the links let it."""
    place = order_in_runs(n, links, runs, {}, dict.fromkeys(_wanted_soon(sums), 0))
    if place is None:
        return False
    spans = [[place[contour] for contour in run] for run in runs]
    if any(max(span) - min(span) >= len(set(span)) for span in spans):
        return False
    return all(
        sum(w for x, w in zip(s.literals, s.weights, strict=True) if isinstance(x, Before) and place[x.i] < place[x.j])
        >= s.bound
        for s in sums
    )


def _wanted_soon(sums: Sequence[AtLeast]) -> list[int]:
    """The contours that sums want before others, all in all."""
    soon: Counter[int] = Counter()
    for s in sums:
        for x, weight in zip(s.literals, s.weights, strict=True):
            if isinstance(x, Before):
                soon[x.i] += weight
                soon[x.j] -= weight
    return [k for k, of in soon.items() if of > 0]


# Where the integer program would be too large.

MOST_LOOKS = 60
"""How often an order is looked for to put links back."""


def _lighter(
    n: int, links: Sequence[Link], weights: Sequence[int | None], runs: Sequence[Sequence[int]], sums: Sequence[AtLeast]
) -> list[int] | None:
    """Links to drop, not shown to be the fewest; None where no order was found without them.

    They lead to what is wanted soon, or must come before that, from what is neither. Those are put back, half of them
    at a time at first, without which an order is still found.
    """
    into: dict[int, set[int]] = {k: set() for k in range(n)}
    for (first, then), weight in zip(links, weights, strict=True):
        if weight is None:
            into[then].add(first)
    for run in runs:
        for k in run:
            into[k].update(run)
    wanted, waiting = set[int](), _wanted_soon(sums)
    while waiting:
        if (contour := waiting.pop()) not in wanted:
            wanted.add(contour)
            waiting += into[contour]

    def held(without: Sequence[int]) -> bool:
        gone = set(without)
        return _likely_held(n, [link for k, link in enumerate(links) if k not in gone], runs, sums)

    out = [k for k, (i, j) in enumerate(links) if weights[k] is not None and j in wanted and i not in wanted]
    if not held(out):
        return None
    size, looks = -(-len(out) // 2), 0
    while size and looks < MOST_LOOKS:
        for k in range(0, len(out), size)[::-1]:
            looks += 1
            if held(fewer := out[:k] + out[k + size :]):
                out = fewer
        size //= 2
    for k in tuple(out):  # the check wants it shown of each
        kept = [link for number, link in enumerate(links) if number == k or number not in out]
        if not _none_can_be_last(n, kept, sums) and held([number for number in out if number != k]):
            out.remove(k)
    return out


def _none_can_be_last(n: int, links: Sequence[Link], sums: Sequence[AtLeast]) -> bool:
    """Whether of some contours none can come last, by links and by sums whose orders are all about one contour."""
    ends = np.array(links, dtype=np.int64).reshape(-1, 2)
    alone = [(k, s) for s in sums for k in _common(s)]
    terms = [
        (number, x.j if x.i == k else x.i, -weight if x.i == k else weight)
        for number, (k, s) in enumerate(alone)
        for x, weight in zip(s.literals, s.weights, strict=True)
        if isinstance(x, Before)
    ]
    row, member, weight = np.array(terms, dtype=np.int64).reshape(-1, 3).T
    of = np.array([k for k, _ in alone], dtype=np.int64)
    bound = np.array([s.bound for _, s in alone], dtype=np.int64)
    for number, (k, s) in enumerate(alone):  # that it is before another is that the other is not before it
        bound[number] -= sum(
            w for x, w in zip(s.literals, s.weights, strict=True) if isinstance(x, Before) and x.i == k
        )
    left = np.ones(n, dtype=np.bool_)
    while left.any():
        leaves = left.copy()
        leaves[ends[left[ends].all(axis=1), 0]] = False
        value = np.bincount(row, np.where(left[member], weight, np.maximum(weight, 0)), len(of))
        leaves[of[value < bound]] = False
        if not leaves.any():
            return True
        left &= ~leaves
    return False


def _common(s: AtLeast) -> set[int]:
    """The contours that all orders of a sum are about: one, none, or both of a single order."""
    return set.intersection(*({x.i, x.j} for x in s.literals if isinstance(x, Before)))


def _pivots(sums: Sequence[AtLeast]) -> list[int]:
    """Few contours of which every order in the sums has one: those first that the most orders have."""
    with_it: dict[int, set[int]] = defaultdict(set)
    for s in sums:
        for x in s.literals:
            if isinstance(x, Before):
                with_it[x.i].add(x.j)
                with_it[x.j].add(x.i)
    found = []
    while any(with_it.values()):
        busiest = min(with_it, key=lambda k: (-len(with_it[k]), k))
        for k in with_it.pop(busiest):
            with_it[k].discard(busiest)
        found.append(busiest)
    return sorted(found)


def _lightest(
    n: int,
    links: Sequence[Link],
    weights: Sequence[int | None],
    runs: Sequence[Sequence[int]],
    sums: Sequence[AtLeast],
) -> _Solved | None:
    """The links dropped, by the integer program; None where it would be too large."""
    from ortools.sat.python.cp_model import FEASIBLE, INFEASIBLE, OPTIMAL, CpModel

    pivots = _pivots(sums)
    rows = len(pivots) * (len(links) + n * len(runs) + n * len(pivots)) + sum(len(s.literals) for s in sums)
    if rows > MOST_ROWS:
        return None
    model = CpModel()
    before = {p: {k: model.new_bool_var("") for k in range(n)} for p in pivots}
    for p in pivots:
        model.add(before[p][p] == 0)
    for p, q in permutations(pivots, 2):
        if p < q:
            model.add(before[p][q] + before[q][p] == 1)
        for k in range(n):  # what comes before p comes before q, if p does
            model.add_bool_or(before[q][p].negated(), before[p][k].negated(), before[q][k])
    dropped = {number: model.new_bool_var("") for number, weight in enumerate(weights) if weight is not None}
    tied: list[set[int]] = [set().union({k}, *(run for run in runs if k in run)) for k in range(n)]
    for number, (first, then) in enumerate(links):
        unless = [dropped[number]] if number in dropped else []
        for p in pivots:
            if p == then or (p in tied[then] and first not in tied[then]):  # an order into a run is one of all of it
                model.add_bool_or(before[p][first], *unless)
            elif p in tied[first] and then not in tied[first]:
                model.add_bool_or(before[p][then].negated(), *unless)
            else:
                model.add_bool_or(before[p][then].negated(), before[p][first], *unless)
    for run in (set(run) for run in runs):
        own = [p for p in pivots if p in run]
        for p in (p for p in pivots if p not in run):
            model.add_allowed_assignments([before[p][k] for k in sorted(run)], [[0] * len(run), [1] * len(run)])
        for p in own[1:]:  # nothing else comes between two of a run
            for k in set(range(n)) - run:
                model.add(before[p][k] == before[own[0]][k])
    for s in sums:
        pairs = [(x.i, x.j) for x in s.literals if isinstance(x, Before)]
        terms = [before[j][i] if j in before else before[i][j].negated() for i, j in pairs]
        model.add(sum(w * term for w, term in zip(s.weights, terms, strict=True)) >= s.bound)
    model.minimize(sum((weights[k] or 0) * literal for k, literal in dropped.items()))
    solver = quiet_solver(WORK)
    status = solver.solve(model)
    if status not in (OPTIMAL, FEASIBLE) or (status == FEASIBLE and solver.best_objective_bound < 1):
        return _Solved(None, status == INFEASIBLE)
    return _Solved([k for k, literal in dropped.items() if solver.boolean_value(literal)], status == OPTIMAL)
