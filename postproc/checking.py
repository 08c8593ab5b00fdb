"""The check of a plan: what the plan holds is handed to the check, and its verdicts back to the plan."""

from __future__ import annotations

from ..encoder.nest import Nest
from ..models.plan import Plan, RuleReport
from ..rules.profile import Profile
from .check import CheckResult, Claims, check_cuts, check_program

__all__ = ["check_plan", "check_program", "rule_reports"]


def check_plan(nest: Nest, plan: Plan, profile: Profile) -> CheckResult:
    """Judge a plan by geometry and the profile alone, and what it states of itself.

    A plan whose `rules` are empty claims nothing about them; see `rule_reports` to fill them in.
    """
    claims = Claims(
        plan.totals.cut_mm,
        plan.totals.idle_mm,
        plan.totals.pierces,
        plan.totals.time_s,
        tuple(planned.length_mm for planned in plan.cuts),
        {rule.id: rule.holds for rule in plan.rules},
    )
    return check_cuts(nest, plan.sequence(profile.machine.home), profile, claims)


def rule_reports(result: CheckResult, profile: Profile) -> tuple[RuleReport, ...]:
    """The verdicts on the profile's rules as a plan states them."""
    on = profile.settings()
    return tuple(
        RuleReport(
            judgement.id,
            judgement.strength,
            judgement.holds,
            tuple((excused.violation.contours, excused.why) for excused in judgement.excused),
        )
        for judgement in result.rules
        if judgement.id in on
    )
