"""Burns of which nobody can tell all that they cut, put in order by travel: where the user asks for that."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from kerfwise.encoder.facts import compute_facts
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.dialects import fitting_dialect
from kerfwise.postproc.nc.blocks import comment
from kerfwise.postproc.old.pieces import TakenApart
from kerfwise.postproc.old.reordered import reordered
from kerfwise.postproc.old.unclear import Unclear
from kerfwise.postproc.verdict.checking import check_program

from .given import Tell
from .listening import Listener
from .new_order import SLACK_MM, broken_more, read_back, stays
from .old_program import OldJob, is_of_sheet, without_comments
from .order_only import route
from .resequenced import Measured, Resequenced

_TOLD = 3
_NOT_ASKED = "no rule was asked"
_LEAST_TRAVEL = (
    "proven: of all orders in which what lies inside comes first, and what touches keeps its turn, none has less "
    f"travel; {_NOT_ASKED}"
)


def by_travel(
    job: OldJob, apart: TakenApart, unclear: Sequence[Unclear], limits: SolveOptions, listener: Listener, tell: Tell
) -> Resequenced:
    """Put the burns into an order of less travel: what lies inside comes first, what touches keeps its turn.

    What can be told of the nest, without the burns that are `unclear`, is judged in both orders: where the new one
    breaks a hard rule oftener, the old one stays.
    """
    more = f"; and {len(unclear) - _TOLD} more" if len(unclear) > _TOLD else ""
    reasons = "; ".join(map(str, unclear[:_TOLD])) + more
    note = f"no rule on contours is asked, only what lies inside and what touches keeps its turn: {reasons}"
    tell(note)
    job = replace(job, notes=(*job.notes, note))
    before = Measured.of(job.program, job.profile, None, None)
    with listener:
        routed = route(job, apart, limits, listener)
    ends = routed.why or (_LEAST_TRAVEL if routed.proven else f"found, not proven; {_NOT_ASKED}")
    old = stays(job, before, None, routed.proven, ends, listener)
    if list(routed.order) == list(range(len(apart.pieces))):
        return old
    top = comment(fitting_dialect(job.profile), "RESEQUENCED BY KERFWISE, ORDER AND TRAVEL ONLY, NO RULES ASKED")
    of_sheet = [row for row in apart.head if apart.ours and is_of_sheet(row)]
    text = reordered(apart, routed.order, [*([top] if top else []), *of_sheet])
    after = Measured.of(read_back(text, job, apart, routed.order), job.profile, None, None)
    if after.idle_mm > before.idle_mm - SLACK_MM:
        return old
    if worse := broken_more(_judged(job, text), _judged(job, job.old.text)):
        ends = f"the old order stays: as far as can be told, another would break {', '.join(worse)}; {_NOT_ASKED}"
        return stays(job, before, None, False, ends, listener)
    return replace(old, program=text, after=after)


def _judged(job: OldJob, text: str) -> CheckResult | None:
    """The verdict on the contours that can be told; None where none can."""
    told, profile = job.told or job.partly, job.profile
    if told is None:
        return None
    side = compute_facts(told.nest, profile.fact_options(told.nest), ()).start_side
    return check_program(told.nest, without_comments(text), profile, job.name, trusted=job.trusted, side=side)
