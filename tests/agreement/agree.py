"""One random nest through every engine and every plan through the check: what they must agree on."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass, replace
from math import inf

from kerfwise import RulesConflict
from kerfwise.models.engines.solution import Solution
from kerfwise.models.plan.make_plan import make_plan
from kerfwise.postproc.check.rule_verdicts import judge
from kerfwise.postproc.nc.program import write_program
from kerfwise.rule_kit import CutSequence
from kerfwise.rules.catalogue.part_rigidity import ALLOWANCE
from kerfwise.rules.statements import EXEMPTION_MM
from kerfwise.rules.stating.lazy_statements import lazy_statements
from kerfwise.rules.stating.state_rules import Stated, state_rules
from kerfwise.tests.agreement.by_check import Judge, Let, shifted
from kerfwise.tests.agreement.cases import Mixed, judged_case
from kerfwise.tests.agreement.engines import ENGINES, IMPOSSIBLE, UNPROVEN, Answer
from kerfwise.tests.agreement.orders import ORDER_RULES, order_disagreements
from kerfwise.tests.agreement.stretch_nests import stretch_agreement
from kerfwise.tests.agreement.trial import Trial
from kerfwise.tests.metal.findings import Kind
from kerfwise.tests.metal.plant import plant, tabs_of
from kerfwise.tests.metal.simulate import simulate
from kerfwise.tests.models.engines.cases import Case

ROUNDED_MM = 0.01
"""Engines count whole micrometres, the check does not: so much may come of it on a small nest."""
PATIENT = 60
"""The limit of an engine that has proven nothing within the usual one."""
FEW = 6
"""Contours of the nests on which the sets of admissible orders are compared: 720 orders at most.

Not where parts have common edges: there the check lets them hold together by corners alone, as rows of a grid do.
"""
_ORDERS = frozenset({"inner-before-outer", "nested-before-host-holes", "pierce"})
KEPT_OUT_BY: Mapping[Kind, Set[str]] = {
    "loose-part-burnt": _ORDERS,
    "loose-waste-burnt": _ORDERS,
    "pierce-in-part": {"pierce"},
    "pierce-over-void": {"pierce"},
    "lead-over-void": {"pierce"},
    "part-eroded": {"shared-metal", "pierce"},
}
"""Findings of the simulation that only these rules keep out: where a random mixture has one of them off, or soft, a
plan may have them."""


@dataclass(frozen=True)
class Agreement:
    """`outcome` is solved, infeasible or unproven; `engines` those compared; `differ` has a line for each difference.

    `blurred` says that the check's allowance leaves the optimum a range; `has` names what the nest has beyond contours
    that are each pierced and cut all round.
    """

    outcome: str
    engines: tuple[str, ...]
    blurred: bool
    order_sets: int
    differ: tuple[str, ...]
    has: tuple[str, ...] = ()


def agreement(seed: int, kind: Mixed = "plain") -> Agreement:
    """Everything compared on the nest of a seed, of a kind."""
    if kind == "stretches":
        has, proved, differ = stretch_agreement(seed)
        return Agreement("solved" if proved else "unproven", proved, False, 0, differ, (has,))
    case = judged_case(seed, kind)
    return replace(_agreement(case), has=tuple(_techniques(case)))


def _techniques(case: Case) -> Iterator[str]:
    nest = case.facts.nest
    if case.facts.tabbed:
        yield "tabs"
    if case.facts.links:
        yield "links"
    if any(c.span is not None for c in case.facts.candidates):
        yield "common cuts"
    if nest.scrap:
        yield "scrap lines"
    if any(c.kind == "slit" for c in nest.contours):
        yield "slits"


def _agreement(case: Case) -> Agreement:
    few = case.facts.n <= FEW and not any(c.out or c.still_in for c in case.facts.candidates)
    differ = order_disagreements(case.facts.nest, case.profile) if few else []
    sets = len(ORDER_RULES) if few else 0
    try:
        stated = state_rules(case.facts, case.profile)
    except RulesConflict:
        return _contradiction(case, sets, differ)
    judges = _judges(case, frozenset((d.rule, d.contours) for d in stated.dropped))
    tried = sorted(_least(judge) for judge in judges)
    proven, outcome = [], "unproven"
    for name, engine in ENGINES.items():
        answer = engine(case, stated)
        if answer.says == UNPROVEN:
            answer = engine(replace(case, options=replace(case.options, work=PATIENT)), stated)
        if answer.says == UNPROVEN:
            differ.append(f"{name} proves nothing")
            continue
        proven.append(name)
        outcome = "infeasible" if answer.says == IMPOSSIBLE else "solved"
        told = [_priced(judge, case, answer) for judge in judges]
        differ += [f"{name}: {line}" for line in _differ(answer, sorted(told), tried)]
        differ += [f"{name}'s plan breaks {rule}" for rule in _broken(case, stated, answer)]
    blurred = tried[1] - tried[0] > ROUNDED_MM if tried[0] < inf else False
    return Agreement(outcome, tuple(proven), blurred, sets, tuple(differ))


def _judges(case: Case, dropped: Let = frozenset()) -> list[Judge]:
    """The check with its thresholds ALLOWANCE under and over what the profile asks: the planner's lie between."""
    trial = Trial.of(case)
    return [Judge(replace(trial, profile=shifted(trial.profile, share)), dropped) for share in (-ALLOWANCE, ALLOWANCE)]


def _least(judge: Judge) -> float:
    """The price of the cheapest plan of all, inf where there is none."""
    found = judge.cheapest_mm()
    return inf if found is None else found


def _contradiction(case: Case, sets: int, differ: list[str]) -> Agreement:
    """Rules that contradict each other before any engine is asked: the check must find that no plan keeps them."""
    for found in map(_least, _judges(case)):
        if found < inf:
            differ.append(f"the rules contradict each other, and the check lets a plan of {found:.3f} mm pass")
    return Agreement("infeasible", ("rules",), False, sets, tuple(differ))


def _priced(judge: Judge, case: Case, answer: Answer) -> float:
    """What the answer's plan costs by the check; inf where there is none."""
    if answer.mm is None:
        return inf
    facts = case.facts
    order = tuple(facts.candidates[c].contour for c in answer.route)
    picks = [0] * facts.n
    for c, i in zip(answer.route, order, strict=True):
        picks[i] = c - facts.candidates_of(i)[0]
    return judge.price_mm(order, picks)


def _differ(answer: Answer, told: list[float], tried: list[float]) -> list[str]:
    """Where the answer is not what trying every plan says; `told` is its plan's price by the check, `tried` the least.

    Both are ranges, as wide as the check's allowance. An excuse is told of a part once, however many ways lead to it,
    so that excuses are compared by the plan's price and not by what the engine says of it.
    """
    lines = []
    if not (told[0] <= tried[1] + ROUNDED_MM and tried[0] <= told[1] + ROUNDED_MM):
        lines.append(f"a plan of {told[0]:.3f} to {told[1]:.3f} mm, of all tried {tried[0]:.3f} to {tried[1]:.3f} mm")
    if answer.mm is not None and told[1] - told[0] <= ROUNDED_MM:
        off_mm = (answer.mm - told[0] + EXEMPTION_MM / 2) % EXEMPTION_MM - EXEMPTION_MM / 2
        if abs(off_mm) > ROUNDED_MM:
            lines.append(f"it says {answer.mm:.3f} mm of a plan that costs {told[0]:.3f} mm by the check")
    return lines


def _broken(case: Case, stated: Stated, answer: Answer) -> list[str]:
    """Hard rules that the answer's plan breaks by the check, all that is excused granted; and scrap it would burn."""
    if answer.mm is None:
        return []
    seen = lazy_statements(case.facts, case.profile)([case.facts.candidates[c].contour for c in answer.route])
    stated = replace(stated, statements=(*stated.statements, *seen))
    solution = Solution(answer.route, answer.mm, answer.mm, "optimal", "", "", 0.0)
    plan = make_plan(case.facts, case.profile, stated, solution, "", 0)
    cuts = CutSequence(tuple(p.cut for p in plan.cuts), plan.start_side, case.profile.machine.home)
    judged = judge(case.facts.nest, cuts, case.profile)
    program = write_program(plan, case.facts.nest, case.profile)
    hard = {name for name, setting in case.profile.rules.items() if setting.strength == "hard"}
    found = simulate(case.facts.nest, program, tabs=tabs_of(plan), **plant(case.profile))
    scrap = [f for f in found if hard >= KEPT_OUT_BY.get(f.kind, set())]
    return [*(j.id for j in judged if j.strength == "hard" and not j.holds), *map(str, scrap)]
