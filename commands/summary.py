"""What solve prints: the plan in four lines, then every rule with its verdict."""

from __future__ import annotations

from ..models.plan import Dropped, Plan
from ..postproc.check import CheckResult, report
from ..rules.statements import EXEMPTION_MM


def summary(plan: Plan, verdict: CheckResult) -> str:
    """The plan's totals, what is proven of it, and the verdict of the independent check on every rule."""
    totals, solve = plan.totals, plan.solve
    minutes, seconds = divmod(round(totals.time_s), 60)
    proof = "no bound is proven"
    if solve.status == "optimal":
        proof = f"proven optimal (by {solve.proved_by})"
    elif solve.bound is not None and solve.gap is not None:
        proof = f"at most {solve.gap:.2%} above the best possible (bound {solve.bound / 1000:.3f} m)"
    excuses, rest_mm = divmod(solve.objective, EXEMPTION_MM)
    objective = f"objective {rest_mm / 1000:.3f} m"
    if excuses:
        objective += f" and {excuses:.0f} excuses, the fewest there can be where the plan is optimal"
    lines = [
        f"{len(plan.cuts)} contours, {totals.pierces} pierces, cut {totals.cut_mm / 1000:.3f} m, "
        f"idle {totals.idle_mm / 1000:.3f} m, {minutes} min {seconds:02d} s",
        f"{objective}, found by {solve.found_by}, {proof}",
        f"start side {plan.start_side} (because: {plan.start_side_because}), "
        f"{max((p.cut.zone for p in plan.cuts), default=0)} zones",
    ]
    for dropped in plan.dropped:
        lines.append(f"{_left_out(dropped)}, {dropped.why}")
    return "\n".join([*lines, report(verdict)])


def _left_out(dropped: Dropped) -> str:
    if dropped.relaxed or not dropped.contours:
        return dropped.rule
    return f"left out: {' before '.join(dropped.contours)} ({dropped.rule})"
