"""One case through every engine: what they must agree on."""

from __future__ import annotations

from math import factorial, prod

from kerfwise import RulesConflict
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.engines.cpsat import solve_cpsat
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals import prove
from kerfwise.models.engines.minizinc_engine import solve_minizinc
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.stating.state_rules import state_rules
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.engines.cases import Case

FEW_ROUTES = 8_000
_LIMITS = SolveOptions(work=20)


def disagreements(case: Case) -> tuple[str, list[str]]:
    """What the case is (`solved`, `no plan` or `contradiction`), and where engines differ, a line each."""
    try:
        stated = state_rules(case.facts, case.profile)
    except RulesConflict:
        return "contradiction", []
    try:
        problem = make_problem(case.facts, stated.statements, case.options.home_mm, case.options.feeds)
    except RulesConflict:
        problem = None
    try:
        found = solve_minizinc(case.facts, case.profile, stated, case.options)
    except RulesConflict as conflict:
        if conflict.message != "no plan meets every hard rule":
            return "no plan", [f"MiniZinc: {conflict.message}"]
        return "no plan", [] if problem is None else _differ(None, optima(problem))
    if problem is None:
        return "solved", [f"MiniZinc finds {found.objective}, but no problem can be made of the statements"]
    cost = round(found.objective * UM_PER_MM)
    differ = [] if found.status == "optimal" else ["MiniZinc does not prove its plan"]
    route = [int(problem.candidate_site[c]) for c in found.route]
    if -1 in route:
        return "solved", [*differ, "MiniZinc uses a candidate that a statement forbids"]
    differ += [f"MiniZinc's plan breaks: {about.rule}: {about.sentence}" for about in broken(problem, route)]
    if route_cost(problem, route) != cost:
        differ.append(f"MiniZinc's plan costs {route_cost(problem, route)}, and it says {cost}")
    return "solved", differ + _differ(cost, optima(problem))


def optima(problem: Problem) -> dict[str, int | None]:
    """Engine → the least cost, µm, as it proves it; None where it says that there is no plan."""
    found: dict[str, int | None] = {}
    if problem.looks_one_back:
        proof = prove(problem, None, Deadline(10))
        if proof is not None:
            found["ideals"] = None if proof.incumbent is None else proof.incumbent.cost
    else:
        outcome = solve_cpsat(problem, Deadline(_LIMITS.work), None)
        if outcome.infeasible or outcome.proven_optimal:
            found["cp-sat"] = None if outcome.incumbent is None else outcome.incumbent.cost
    if factorial(problem.n) * prod(len(problem.sites(i)) for i in range(problem.n)) <= FEW_ROUTES:
        best = cheapest(problem)
        found["brute force"] = None if best is None else best.cost
    assert found, "nothing to compare with"
    return found


def _differ(cost: int | None, others: dict[str, int | None]) -> list[str]:
    return [f"MiniZinc: {cost}, {engine}: {other}" for engine, other in others.items() if other != cost]
