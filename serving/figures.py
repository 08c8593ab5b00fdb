"""What a list of plans says of one: its cost, what is proven of it, its travel and time."""

from __future__ import annotations

from typing import Any

from kerfwise.models.plan.plan import Plan


def figures_of(plan: Plan) -> dict[str, Any]:
    """The figures of a plan, as JSON can hold them: lengths in mm, times in s."""
    solve = plan.solve
    return {
        "objective_mm": float(solve.objective),
        "light_mm": float(solve.objective - plan.heavy_mm),
        "bound_mm": None if solve.bound is None else float(solve.bound),
        "gap": None if solve.gap is None else float(solve.gap),
        "light_gap": None if plan.light_gap is None else float(plan.light_gap),
        "status": solve.status,
        "idle_mm": float(plan.totals.idle_mm),
        "time_s": float(plan.totals.time_s),
        "cuts": len(plan.cuts),
        "excuses": solve.excuses,
        "dropped": len(plan.dropped),
    }
