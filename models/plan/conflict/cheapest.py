"""Of several ways out of a contradiction that are equally few, the one whose plan costs least by its own objective.

Which of them leaves the best plan only a plan can tell, so one is made for each. Contradictions that have been found
say which sets there are: one of the fewest statements never has a statement that is in none of them.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from itertools import combinations, islice
from math import comb

from kerfwise.encoder.errors import RulesConflict
from kerfwise.models.engines.portfolio import run_portfolio
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.watch import Watch
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.problem import Problem
from kerfwise.models.problem.simplify import simplify
from kerfwise.rules.statements import About, Statement
from kerfwise.rules.stating.state_rules import resolve

from .relax import soften
from .suspects import LAST
from .whole import Engines

MOST_SETS, MOST_PLANS = 20_000, 60
"""How many sets are looked through, and how many plans are made; past them the best found so far is taken."""
MOST_CONTOURS = 200
"""Of a nest with more, ways out are not compared: getting ready for each plan would take longer than the rest."""
WORK = 2.0
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
) -> tuple[tuple[About, ...], bool]:
    """What should give way in place of `found`: as many statements, no more of them locks, and one of each clash.

    And whether all such sets were compared.
    """
    ways, whole = _sets(found, clashes)
    sets = [given for given in ways if set(given) != set(found)]
    if not sets or engines.facts.n > MOST_CONTOURS:
        return tuple(found), whole and not sets
    budget, began = engines.budget, engines.budget.left
    best, (cost, first) = tuple(found), _cost(engines, statements, found, gives_way)
    took = began - budget.left
    for given in sets:
        if budget.left <= 0 or (budget.timed and budget.left < took):
            return best, False
        other, problem = _cost(engines, statements, given, gives_way, first)
        alike = first is None or problem is None or first.left_out == problem.left_out
        if other is not None and alike and (cost is None or other < cost):
            best, cost, first = given, other, problem
    return best, whole


def _sets(found: Sequence[About], clashes: Collection[frozenset[About]]) -> tuple[list[tuple[About, ...]], bool]:
    """Sets that may give way, and whether they are all there are."""
    pool = sorted(set().union(*clashes), key=lambda about: (about.rule, about.sentence))
    if comb(len(pool), len(found)) > MOST_SETS:
        return [], False
    locks = _locks(found)
    hitting = (
        given
        for given in combinations(pool, len(found))
        if _locks(given) <= locks and all(not clash.isdisjoint(given) for clash in clashes)
    )
    sets = list(islice(hitting, MOST_PLANS + 1))
    return sets[:MOST_PLANS], len(sets) <= MOST_PLANS


def _locks(abouts: Collection[About]) -> int:
    return sum(about.rule in LAST for about in abouts)


def _cost(
    engines: Engines,
    statements: Sequence[Statement],
    given: Sequence[About],
    gives_way: Mapping[str, int],
    earlier: Problem | None = None,
) -> tuple[int | None, Problem | None]:
    """The cost of the best plan that was found once these have given way, µm, and the problem that it solves.

    With a budget that counts seconds no plan takes much more than its share of them: moves over parts that are out have
    no price where looking at them takes longer, or had none in an `earlier` problem.
    """
    budget = engines.budget
    work = min(WORK, 0.5 * max(budget.left, 0.0))
    most_s = min(WORK, SHARE * max(budget.left, 0.0))
    until = budget.left - MOVES * most_s
    try:
        stated = resolve(soften(statements, given), engines.facts.n, gives_way).statements
        problem = make_problem(
            engines.facts,
            stated,
            engines.home_mm,
            engines.feeds,
            earlier,
            lambda share: not budget.timed or budget.left > until,
        )
    except RulesConflict:
        return None, None
    options = SolveOptions(work=work, time_s=most_s if budget.timed else None)
    known = run_portfolio(simplify(problem), options, Watch(options))
    budget.spend(known.work)
    return None if known.incumbent is None else known.incumbent.cost, problem
