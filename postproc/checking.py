"""The check of a plan and of its program: what they hold is handed to the check, and its verdicts back to the plan."""

from __future__ import annotations

from dataclasses import replace

from ..encoder.nest import Nest
from ..models.plan import Plan, RuleReport
from ..rules.own import PREFIX as OWN
from ..rules.profile import Profile
from ..rules.registry import RULES
from .check import CheckResult, Claims, Relaxed, check_cuts, check_program

__all__ = ["check_plan", "check_program", "judge", "report_of"]


def check_plan(nest: Nest, plan: Plan, profile: Profile) -> CheckResult:
    """Judge a plan by geometry and the profile alone, and what it states of itself.

    A plan whose `rules` are empty claims nothing about them; see `report_of` to fill them in.
    """
    claims = Claims(
        plan.totals.cut_mm,
        plan.totals.idle_mm,
        plan.totals.pierces,
        plan.totals.time_s,
        tuple(planned.length_mm for planned in plan.cuts),
        {rule.id: rule.holds for rule in plan.rules},
    )
    relaxed = tuple(Relaxed(dropped.rule, dropped.contours) for dropped in plan.dropped if dropped.relaxed)
    return check_cuts(nest, plan.sequence(profile.machine.home), profile, claims, relaxed)


def judge(nest: Nest, plan: Plan, program: str, profile: Profile) -> CheckResult:
    """Judge a plan and the program written from it: a rule holds if it holds in both."""
    planned, written = check_plan(nest, plan, profile), check_program(nest, program, profile)
    of_program = {judgement.id: judgement for judgement in written.rules}
    rules = []
    for judgement in planned.rules:
        other = of_program.pop(judgement.id, None)
        more = () if other is None else other.violations
        rules.append(replace(judgement, violations=judgement.violations or more))
    warnings = tuple(dict.fromkeys(planned.warnings + written.warnings))
    return CheckResult((*of_program.values(), *rules), warnings, written.measured)


def report_of(result: CheckResult) -> tuple[RuleReport, ...]:
    """The verdicts on the profile's rules as a plan states them."""
    return tuple(
        RuleReport(
            judgement.id,
            judgement.strength,
            judgement.holds,
            tuple((excused.violation.contours, excused.why) for excused in judgement.excused),
        )
        for judgement in result.rules
        if (judgement.id in RULES or judgement.id.startswith(OWN)) and judgement.strength != "off"
    )
