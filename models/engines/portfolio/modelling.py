"""CP-SAT in a run."""

from __future__ import annotations

from dataclasses import replace

from kerfwise.models.engines import cpsat, setting_out

from .run import NOT_BEGUN, Run


def model_sets_out(run: Run, share: float) -> bool:
    """Whether CP-SAT has time for more than its model."""
    return run.sets_out(setting_out.cpsat_s(run.problem), share)


def solve_model(run: Run, share: float) -> None:
    """Constraint programming, from the best plan and the bound that are known."""
    known = run.known
    if not model_sets_out(run, share):
        known.notes.append(NOT_BEGUN.format("cp-sat"))
        return
    if not run.takes("cp-sat", "nothing is proven yet"):
        return
    limits = replace(run.options, work=share, time_s=run.options.time_s and share)
    outcome = cpsat.solve_cpsat(run.problem, limits, known.incumbent, known.bound_um, run.watch)
    known.offer(outcome.incumbent, "cp-sat")
    known.infeasible = outcome.infeasible
    if outcome.bound is not None:
        known.raise_bound(outcome.bound, "cp-sat")
    known.work += min(share, outcome.work) if known.proven else share  # a proof leaves the rest to others
