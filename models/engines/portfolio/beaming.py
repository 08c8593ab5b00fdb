"""The beam in a run."""

from __future__ import annotations

from kerfwise.models.engines import beam, setting_out

from .run import NOT_BEGUN, Run
from .suits import density


def beam_applies(run: Run) -> bool:
    """Whether the beam may run; it is noted why, or why not."""
    if run.options.member not in (None, "beam"):
        return False
    if why := beam.unfit(run.problem):
        run.leave_out("beam", why)
        return False
    return run.takes("beam", f"hard orders decide {density(run.problem):.0%} of the pairs")


def widen_beam(run: Run, share: float) -> None:
    """Beams, each wider than the last."""
    known = run.known
    if not run.sets_out(setting_out.beam_s(run.problem), share):
        known.notes.append(NOT_BEGUN.format("beam"))
        return
    outcome = beam.beam(run.problem, known.incumbent, share, run.limit_s(share), run.watch, most_bytes=run.most_bytes)
    known.offer(outcome.incumbent, "beam")
    known.work += outcome.work
    if outcome.proven and outcome.incumbent is None:
        known.infeasible = True
    elif outcome.bound is not None:
        known.raise_bound(outcome.bound, "beam")
