"""Which orders each order rule admits: by the check, by its statements, and by its MiniZinc file."""

from __future__ import annotations

import warnings
from dataclasses import replace
from itertools import permutations

from minizinc import Instance
from minizinc.error import MiniZincWarning

from kerfwise import Nest, Profile, RulesConflict
from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.facts import compute_facts
from kerfwise.models.engines.minizinc_model import condition_arrays, data_text, model_text
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import broken
from kerfwise.postproc.clock import contour_heat_kj
from kerfwise.rule_kit import About, CutSequence, Facts, RuleSetting
from kerfwise.rules.catalogue.no_islands import ALLOWANCE
from kerfwise.rules.minizinc.installation import driver, solver_named
from kerfwise.rules.registry import RULES
from kerfwise.rules.statements import IdleTravel
from kerfwise.rules.stating.state_rules import Stated
from kerfwise.tests.agreement.by_check import shifted

ORDER_RULES = (
    "inner-before-outer",
    "nested-before-host-holes",
    "part-contiguous",
    "level-ahead",
    "hull-before",
    "zone-order",
    "marks-first",
    "no-islands",
    "heat-lag",
)
Orders = frozenset[tuple[int, ...]]


def order_disagreements(nest: Nest, profile: Profile) -> list[str]:
    """Where the three differ on a nest, a line for every rule; the check's allowance makes its set a range."""
    profile = only(profile, *ORDER_RULES)
    ways = {kind: way[:1] for kind, way in profile.lead_options().directions.items()}
    leads = replace(profile.lead_options(), entries=1, directions=ways)
    candidates = build_candidates(nest, leads)
    heat_kj = contour_heat_kj(nest, candidates, profile)
    facts = compute_facts(nest, profile.fact_options(nest), candidates, heat_kj)
    gecode = admitted_by_gecode(facts, profile)
    lines = []
    for rule in ORDER_RULES:
        stated = admitted_by_statements(facts, profile, rule)
        lenient, strict = (admitted_by_check(facts, shifted(profile, by), rule) for by in (-ALLOWANCE, ALLOWANCE))
        if not (lenient & strict <= stated <= lenient | strict and stated == gecode[rule]):
            lines.append(
                f"{rule} admits {len(lenient)} or {len(strict)} orders by the check, {len(stated)} by statements, "
                f"{len(gecode[rule])} by Gecode, {len(lenient & stated & gecode[rule])} by all three"
            )
    return lines


def admitted_by_check(facts: Facts, profile: Profile, rule: str) -> Orders:
    """The orders of contour numbers in which geometry finds nothing wrong."""
    nest, options = facts.nest, profile.settings()[rule].options
    cuts = []
    for i in range(facts.n):
        c = facts.candidates[facts.candidates_of(i)[0]]
        name = nest.contours[i].id
        cuts.append(c.as_cut(name, int(facts.zone[i])))
    return frozenset(
        order
        for order in permutations(range(facts.n))
        if not RULES[rule].violations(nest, CutSequence(tuple(cuts[k] for k in order), facts.start_side), options)
    )


def admitted_by_statements(facts: Facts, profile: Profile, rule: str) -> Orders:
    """The orders that break none of the rule's statements, as every engine but MiniZinc reads them."""
    statements = tuple(RULES[rule].statements(facts, profile.settings()[rule].options))
    try:
        problem = make_problem(facts, statements, (0.0, 0.0))
    except RulesConflict:
        return frozenset()
    routes = permutations(int(problem.first[i]) for i in range(facts.n))
    lawful = (route for route in routes if not broken(problem, route))
    return frozenset(tuple(int(problem.site_contour[s]) for s in route) for route in lawful)


def admitted_by_gecode(facts: Facts, profile: Profile) -> dict[str, Orders]:
    """Order rule → the orders that its MiniZinc file admits; Gecode enumerates all orders and judges each."""
    stated = Stated((IdleTravel(About("test", (), "")),), ())
    arrays = condition_arrays(profile, stated)
    names = {rule: f"{rule.replace('-', '_')}_holds" for rule in ORDER_RULES}
    assert set(names.values()) <= {a.name for a in arrays}
    free = [replace(a, weight_mm=0.0) for a in arrays]
    verdicts = [f"constraint verdict[{k}] = forall({name});" for k, name in enumerate(names.values(), 1)]
    goal = [f"array[1..{len(names)}] of var bool: verdict :: add_to_output;", *verdicts, "solve satisfy;"]
    instance = Instance(solver_named("gecode"), driver=driver())
    instance.add_string(
        model_text(free, "\n".join(goal)) + data_text(facts, profile, stated, SolveOptions(), clock=False)
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MiniZincWarning)
        solutions = instance.solve(all_solutions=True).solution
    found = [
        (tuple(facts.candidates[c - 1].contour for c in solution.stop if c > 0), solution.verdict)
        for solution in solutions
    ]
    assert {order for order, _ in found} == set(permutations(range(facts.n)))
    return {rule: frozenset(order for order, verdict in found if verdict[k]) for k, rule in enumerate(names)}


def only(profile: Profile, *rules: str) -> Profile:
    """The profile with these rules hard and all others off, without locks; heat lags count cuts alone."""
    settings = {
        name: RuleSetting("hard" if name in rules else "off", None, setting.options)
        for name, setting in profile.rules.items()
    }
    heat = settings["heat-lag"]
    settings["heat-lag"] = replace(heat, options=replace(heat.options, lag_s=0.0))
    return replace(profile, rules=settings, locks=())
