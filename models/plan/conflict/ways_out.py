"""What gives way so that the rest can hold: the fewest statements, and of several such sets the cheapest."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, islice
from math import comb
from typing import Any

from ortools.sat.python.cp_model import OPTIMAL, CpModel

from kerfwise.encoder.errors import RulesConflict
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.portfolio import run_portfolio
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.problem import Problem
from kerfwise.models.problem.simplify import simplify
from kerfwise.rules.rule import Rule
from kerfwise.rules.statements import RELAXED_MM, About, Statement
from kerfwise.rules.stating.state_rules import resolve

from .core import Core, Engines
from .groups import DEFAULT_WORK, LAST, Group, NotAnswered, solver_within

WORK = 20.0
"""CP-SAT's deterministic seconds for one choice of the lightest groups."""
SLOW, AT_ONCE = 2, 0.3
"""Contradictions that took a solver each, after which all is asked at once; share of what is left for that."""
MOST_ASKED = 12_000
"""How many groups are asked about in all: each contradiction that is looked for asks about every group once."""
SOON = 0.01
"""What asking about a group counts for where a contradiction was found soon."""


@dataclass(frozen=True, slots=True)
class Relaxation:
    """Groups that give way, the fewest if `fewest`. `clashes` are what of every contradiction found may give way.

    They are those that show it if `whole`.
    """

    groups: tuple[Group, ...]
    clashes: tuple[frozenset[About], ...] = ()
    fewest: bool = True
    whole: bool = True


def find_relaxation(
    groups: Sequence[Group],
    book: Mapping[str, Rule[Any]],
    core_of: Callable[[Sequence[Group]], Core | None],
    deadline: Deadline | None = None,
    known: Iterable[Sequence[int]] = (),
    at_once: Callable[[Sequence[Group], Sequence[int | None]], tuple[list[int], bool] | None] | None = None,
) -> Relaxation | None:
    """The fewest groups without which the others can hold; None if no rule that may be soft helps.

    `core_of` finds a contradiction among groups, None where there is none; `known` are some, by numbers of groups.
    Where a few contradictions took a solver each, `at_once` is asked for groups that need not be the fewest: many alike
    contradict each other in more ways than can be gone through.

    Each counts the same, as in the objective of the plan that is made then; what is relaxed last, such as locks, weighs
    more than everything else together. Found by implicit hitting sets (Davies and Bacchus 2011): contradictions are
    gathered, the fewest groups that hit each of them taken out, until no contradiction is left. Raises NotAnswered if
    no answer was found within the work, or the time, allowed.
    """
    deadline = deadline or Deadline(DEFAULT_WORK)
    weights = _weights(groups, book)
    clashes = [[k for k in clash if weights[k] is not None] for clash in known]
    if not all(clashes):
        return None
    asked, slow = 0.0, 0
    while True:
        out = _lightest(clashes, weights, deadline)
        left = [k for k in range(len(groups)) if k not in out]
        whole = True
        if asked > MOST_ASKED:
            raise NotAnswered
        while (core := core_of([groups[k] for k in left])) is not None:
            named = {group.about for group in core.groups}
            soft = [k for k in left if groups[k].about in named and weights[k] is not None]
            if not soft:
                return None
            if deadline.timed and deadline.left <= 0:
                raise NotAnswered  # a contradiction that is shown without a solver takes time as well
            clashes.append(soft)
            asked += len(groups) * (SOON if core.soon else 1.0)
            slow += not core.soon
            if at_once and slow == SLOW and (found := _found_at_once(groups, weights, core_of, at_once)):
                return found
            left = [k for k in left if k not in soft]
            whole = False
        if whole:
            hit = tuple(frozenset(groups[k].about for k in clash) for clash in clashes)
            return Relaxation(tuple(groups[k] for k in sorted(out)), hit)


def _found_at_once(
    groups: Sequence[Group],
    weights: Sequence[int | None],
    core_of: Callable[[Sequence[Group]], Core | None],
    at_once: Callable[[Sequence[Group], Sequence[int | None]], tuple[list[int], bool] | None],
) -> Relaxation | None:
    """What is given up at once, if nothing else contradicts each other then; None where that is not known."""
    try:
        if (found := at_once(groups, weights)) is None:
            return None
        out, fewest = found
        if core_of([group for k, group in enumerate(groups) if k not in set(out)]) is not None:
            return None
    except NotAnswered:
        return None
    return Relaxation(tuple(groups[k] for k in sorted(out)), (), fewest, whole=False)


def _lightest(clashes: Sequence[Sequence[int]], weights: Sequence[int | None], deadline: Deadline) -> set[int]:
    """The groups of least total weight that hit every clash."""
    model = CpModel()
    taken = {k: model.new_bool_var("") for clash in clashes for k in clash}
    for clash in clashes:
        model.add_bool_or(taken[k] for k in clash)
    model.minimize(sum((weights[k] or 0) * literal for k, literal in taken.items()))
    solver = solver_within(deadline, WORK)
    status = solver.solve(model)
    deadline.spend(solver.response_proto.deterministic_time)
    if status != OPTIMAL:
        raise NotAnswered
    return {k for k, literal in taken.items() if solver.boolean_value(literal)}


def _weights(groups: Sequence[Group], book: Mapping[str, Rule[Any]]) -> list[int | None]:
    """What relaxing each group costs; None where it may not be."""
    weights: list[int | None] = []
    for group in groups:
        rule = book.get(group.about.rule)  # what is of no rule, such as which ways common cuts leave, stays
        weights.append(1 if rule is not None and rule.may_be_relaxed else None)
    heavy = 1 + sum(w for w in weights if w is not None)
    return [heavy if group.about.rule in LAST else w for group, w in zip(groups, weights, strict=True)]


def soften(statements: Iterable[Statement], relaxed: Iterable[About]) -> list[Statement]:
    """The statements, those about which `relaxed` speaks at a price that no plan pays without need."""
    abouts = set(relaxed)
    return [replace(s, weight=RELAXED_MM) if s.weight is None and s.about in abouts else s for s in statements]


# Of several ways out of a contradiction that are equally few, the one whose plan costs least by its own objective.
#
# Which of them leaves the best plan only a plan can tell, so one is made for each. Contradictions that have been
# found say which sets there are: one of the fewest statements never has a statement that is in none of them.

MOST_SETS, MOST_PLANS = 20_000, 8
"""How many sets are looked through, and how many plans are made; past them the best found so far is taken."""
MOST_CONTOURS = 200
"""Of a nest with more, ways out are not compared: getting ready for each plan would take longer than the rest."""
CHEAPEST_WORK = 2.0
"""Work for one plan, or half of what is left, so that at least two can be compared."""
SHARE, MOVES = 0.25, 0.2
"""Where seconds are counted, share of them for one plan at the most; share of that for looking at moves over parts that
are out."""


def cheapest(
    engines: Engines,
    statements: Sequence[Statement],
    found: Sequence[About],
    clashes: Collection[frozenset[About]],
    gives_way: Mapping[str, int],
    of_sums: Collection[str] = (),
) -> tuple[tuple[About, ...], bool]:
    """What should give way in place of `found`: as many statements, no more of them locks, and one of each clash.

    And whether all such sets were compared.
    """
    ways, whole = _sets(found, clashes)
    sets = [way for way in ways if set(way) != set(found)]
    if not sets or engines.facts.n > MOST_CONTOURS:
        return tuple(found), whole and not sets
    deadline, began = engines.deadline, engines.deadline.left
    best, (cost, first) = tuple(found), _cost(engines, statements, found, gives_way, of_sums=of_sums)
    took = began - deadline.left
    for way in sets:
        if deadline.left <= 0 or (deadline.timed and deadline.left < took):
            return best, False
        other, problem = _cost(engines, statements, way, gives_way, first, of_sums)
        alike = first is None or problem is None or first.left_out == problem.left_out
        if other is not None and alike and (cost is None or other < cost):
            best, cost, first = way, other, problem
    return best, whole


def _sets(found: Sequence[About], clashes: Collection[frozenset[About]]) -> tuple[list[tuple[About, ...]], bool]:
    """Sets that may give way, and whether they are all there are."""
    pool = sorted(set().union(*clashes), key=lambda about: (about.rule, about.sentence))
    if comb(len(pool), len(found)) > MOST_SETS:
        return [], False
    locks = _locks(found)
    hitting = (
        subset
        for subset in combinations(pool, len(found))
        if _locks(subset) <= locks and all(not clash.isdisjoint(subset) for clash in clashes)
    )
    sets = list(islice(hitting, MOST_PLANS + 1))
    return sets[:MOST_PLANS], len(sets) <= MOST_PLANS


def _locks(abouts: Collection[About]) -> int:
    return sum(about.rule in LAST for about in abouts)


def _cost(
    engines: Engines,
    statements: Sequence[Statement],
    relaxed: Sequence[About],
    gives_way: Mapping[str, int],
    earlier: Problem | None = None,
    of_sums: Collection[str] = (),
) -> tuple[int | None, Problem | None]:
    """The cost of the best plan that was found once these have given way, µm, and the problem that it solves.

    Where seconds count no plan takes much more than its share: moves over parts that are out have no price where
    looking at them takes longer, or had none in an `earlier` problem.
    """
    deadline = engines.deadline
    work = min(CHEAPEST_WORK, 0.5 * max(deadline.left, 0.0))
    most_s = min(CHEAPEST_WORK, SHARE * max(deadline.left, 0.0))
    until = deadline.left - MOVES * most_s
    try:
        stated = resolve(soften(statements, relaxed), engines.facts.n, gives_way, of_sums).statements
        problem = make_problem(
            engines.facts,
            stated,
            engines.home_mm,
            engines.feeds,
            earlier,
            lambda share: not deadline.timed or deadline.left > until,
        )
    except RulesConflict:
        return None, None
    options = SolveOptions(work=work, time_s=most_s if deadline.timed else None)
    known = run_portfolio(simplify(problem), options)
    deadline.spend(known.work)
    return None if known.incumbent is None else known.incumbent.cost, problem
