"""The way out that is taken costs least: on tiny nests no other set of statements leaves a better plan."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, product

import numpy as np
import pytest

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.plan.conflict import state_relaxed
from kerfwise.models.plan.conflict.conflict import soften
from kerfwise.models.plan.conflict.groups import LAST, hard_groups
from kerfwise.models.plan.plan import RELAXED
from kerfwise.models.problem.compile import make_problem
from kerfwise.pipeline import solve_and_verify
from kerfwise.postproc.check import report
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import About, Statement
from kerfwise.rules.stating.state_rules import every_statement, resolve
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.solved import plant

ROW = nest(
    420,
    110,
    part("A", rect(20, 10, 60, 80), [circle(50, 50, 12)]),
    part("B", rect(110, 20, 60, 60)),
    part("C", rect(200, 20, 70, 70), [circle(235, 55, 12)]),
)
ORDERS = [(a.id, b.id) for a in ROW.contours for b in ROW.contours if a.id != b.id]


def contradictory(seed: int) -> Profile:
    """Two or three locks that may well contradict each other, or that each part is cut in one go."""
    rng = np.random.default_rng(seed)
    chosen = rng.choice(len(ORDERS), size=int(rng.integers(2, 4)), replace=False).tolist()
    locks = [Lock(contour=ORDERS[k][0], before=ORDERS[k][1]) for k in chosen]
    if seed % 3 == 0:
        locks.append(Lock(contour=str(rng.choice([c.id for c in ROW.contours])), position=int(rng.integers(1, 6))))
    profile = plant(*locks)
    return replace(profile, leads=replace(profile.leads, entries=1))


def best_um(facts: Facts, statements: list[Statement]) -> int | None:
    """The cost of the best plan, every one tried."""
    try:
        problem = make_problem(facts, tuple(statements), (0.0, 0.0))
    except RulesConflict:
        return None
    found = cheapest(problem)
    return None if found is None else found.cost


def least_um(facts: Facts, profile: Profile) -> int:
    """The least cost of any plan, whatever is let go: the fewest locks, then the fewest statements."""
    book = profile.rulebook()
    statements = every_statement(facts, profile)[0]
    gives_way = {name: rule.gives_way for name, rule in book.items()}
    groups = [g.about for g in hard_groups(statements) if not gives_way[g.about.rule]]
    locks = [about for about in groups if about.rule in LAST]
    others = [about for about in groups if about.rule not in LAST and book[about.rule].may_be_relaxed]
    for of_locks, of_others in product(range(len(locks) + 1), range(3)):
        costs = []
        for some in product(combinations(locks, of_locks), combinations(others, of_others)):
            try:
                stated = resolve(soften(statements, [*some[0], *some[1]]), facts.n, gives_way).statements
            except RulesConflict:
                continue
            costs.append(best_um(facts, list(stated)))
        if any(cost is not None for cost in costs):
            return min(cost for cost in costs if cost is not None)
    raise AssertionError("without any lock there is a plan")


@pytest.mark.parametrize("seed", range(24))
def test_nothing_cheaper_could_be_let_go(seed: int) -> None:
    profile = contradictory(seed)
    facts = facts_of(ROW, profile)
    taken = state_relaxed(facts, profile)
    relaxed: list[About] = [d.statement.about for d in taken.dropped if d.why.startswith(RELAXED)]
    assert best_um(facts, list(taken.statements)) == least_um(facts, profile), [a.sentence for a in relaxed]


@pytest.mark.slow
def test_the_plan_of_a_way_out_passes_the_check() -> None:
    for seed in range(24):
        profile = contradictory(seed)
        facts = facts_of(ROW, profile)
        options = options_for(ROW, profile, work=2)
        verdict = solve_and_verify(make_request(facts, profile, relax=True), profile, options).verdict
        assert verdict.ok, report(verdict)
