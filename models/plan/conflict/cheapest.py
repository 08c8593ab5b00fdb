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
from kerfwise.models.problem.simplify import simplify
from kerfwise.rules.statements import About, Statement
from kerfwise.rules.stating.state_rules import resolve

from .relax import LAST, soften
from .whole import Engines

MOST_SETS, MOST_PLANS = 20_000, 60
"""How many sets are looked through, and how many plans are made; past them the best found so far is taken."""
WORK = 2.0
"""Work for one plan."""


def cheapest(
    engines: Engines,
    statements: Sequence[Statement],
    found: Sequence[About],
    clashes: Collection[frozenset[About]],
    gives_way: Mapping[str, int],
) -> tuple[About, ...]:
    """What should give way in place of `found`: as many statements, no more of them locks, and one of each clash."""
    sets = [given for given in _sets(found, clashes) if set(given) != set(found)]
    if not sets:
        return tuple(found)
    best, cost = tuple(found), _cost(engines, statements, found, gives_way)
    for given in sets:
        if engines.purse.left <= 0:
            break
        other = _cost(engines, statements, given, gives_way)
        if other is not None and (cost is None or other < cost):
            best, cost = given, other
    return best


def _sets(found: Sequence[About], clashes: Collection[frozenset[About]]) -> list[tuple[About, ...]]:
    pool = sorted(set().union(*clashes), key=lambda about: (about.rule, about.sentence))
    if comb(len(pool), len(found)) > MOST_SETS:
        return []
    locks = _locks(found)
    hitting = (
        given
        for given in combinations(pool, len(found))
        if _locks(given) <= locks and all(not clash.isdisjoint(given) for clash in clashes)
    )
    return list(islice(hitting, MOST_PLANS))


def _locks(abouts: Collection[About]) -> int:
    return sum(about.rule == LAST for about in abouts)


def _cost(
    engines: Engines, statements: Sequence[Statement], given: Sequence[About], gives_way: Mapping[str, int]
) -> int | None:
    """The cost of the best plan that was found once these have given way, µm."""
    purse = engines.purse
    try:
        stated = resolve(soften(statements, given), engines.facts.n, gives_way).statements
        problem = simplify(make_problem(engines.facts, stated, engines.home_mm, engines.feeds))
    except RulesConflict:
        return None
    options = SolveOptions(work=WORK, time_s=min(WORK, max(purse.left, 0.0)) if purse.timed else None)
    known = run_portfolio(problem, options, Watch(options))
    purse.spend(known.work)
    return None if known.incumbent is None else known.incumbent.cost
