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
    return None if solved is None or solved.out is None else (solved.out, solved.shown)


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
    return solved is not None and solved.out is None and solved.shown


@dataclass(frozen=True, slots=True)
class _Solved:
    """The links that are dropped, None where no drop helps or is known to be needed, and whether this is shown."""

    out: list[int] | None
    shown: bool


def _likely_held(n: int, links: Sequence[Link], runs: Sequence[Sequence[int]], sums: Sequence[AtLeast]) -> bool:
    """Whether an order was found that keeps everything: what sums want soon is cut as soon as the links let it."""
    soon: Counter[int] = Counter()
    for s in sums:
        for x, weight in zip(s.literals, s.weights, strict=True):
            if isinstance(x, Before):
                soon[x.i] += weight
                soon[x.j] -= weight
    place = order_in_runs(n, links, runs, {}, {k: 0 for k, of in soon.items() if of > 0})
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
