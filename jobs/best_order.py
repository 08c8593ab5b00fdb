"""The burns of an old program as they are, in the best order: by the rules of the profile, or else by travel alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.nest import Nest
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.reader.on_machine import moved, old_on_machine
from kerfwise.postproc.check.reader.program import NcProgram
from kerfwise.postproc.dialects import fitting_dialect
from kerfwise.postproc.nc.blocks import comment
from kerfwise.postproc.old.contours import NoNest, Told, Unclear
from kerfwise.postproc.old.orders import changes_material_or_tool
from kerfwise.postproc.old.pieces import TakenApart, taken_apart
from kerfwise.postproc.old.reordered import expect_same, reordered
from kerfwise.postproc.verdict.checking import check_program

from .given import Tell
from .kept_burns import BurnWriter, facts_of_burns, plan_order
from .listening import Listener
from .old_program import OldJob
from .order_only import route
from .resequenced import Measured, Resequenced

_SLACK_MM = 0.01
_TOLD = 3


def in_best_order(job: OldJob, limits: SolveOptions, listener: Listener, tell: Tell) -> Resequenced:
    """Put the burns into the best order; where they make no nest, what lies inside and what touches keeps its turn.

    Raises
    ------
    InputError
        If the program cannot be taken apart, or the burns in their new order cannot be read back.
    """
    apart = taken_apart(job.old, job.name)
    told, unclear = job.told, job.unclear
    if told is not None and changes_material_or_tool(apart.pieces):
        told, unclear = None, (Unclear(apart.pieces[0].line, "the program changes its material or tool"),)
    if told is not None:
        try:
            return _by_rules(job, told, apart, limits, listener)
        except NoNest as none:
            unclear = none.unclear
    before = Measured.of(job.program, job.profile, None, None)
    more = f"; and {len(unclear) - _TOLD} more" if len(unclear) > _TOLD else ""
    reasons = "; ".join(map(str, unclear[:_TOLD])) + more
    note = f"rules on contours are not asked, only what lies inside and what touches: {reasons}"
    tell(note)
    job = replace(job, notes=(*job.notes, note))
    with listener:
        routed = route(job, apart, limits, listener)
    ends = routed.why or ("proven: no order has less travel" if routed.proven else "found, not proven")
    stays = _stays(job, before, None, routed.proven, ends, listener)
    if list(routed.order) == list(range(len(apart.pieces))):
        return stays
    top = comment(fitting_dialect(job.profile), "RESEQUENCED BY KERFWISE, ORDER AND TRAVEL ONLY")
    text = reordered(apart, routed.order, [top] if top else [])
    after = Measured.of(_read_back(text, job, apart, routed.order), job.profile, None, None)
    if after.idle_mm > before.idle_mm - _SLACK_MM:
        return stays
    return replace(stays, program=text, after=after)


def _by_rules(job: OldJob, told: Told, apart: TakenApart, limits: SolveOptions, listener: Listener) -> Resequenced:
    facts = facts_of_burns(job, told)
    old = check_program(told.nest, job.text, job.profile, job.name, trusted=job.trusted, side=facts.start_side)
    before = Measured.of(job.program, job.profile, told.nest, old)
    try:
        made = plan_order(job, facts, told, apart, limits, listener)
    except RulesConflict as conflict:  # a lead that crosses another part is in the way of every order
        ends = f"the old order stays: no order of these burns keeps the hard rules ({conflict.message})"
        return _stays(job, before, told.nest, False, ends, listener)
    plan = made.plan
    proven = plan.solve.status == "optimal"
    ends = "proven: no order is better by these rules" if proven else "found, not proven"
    order = BurnWriter(told, apart).order(plan)
    program = _read_back(made.program, job, apart, order)
    after = Measured.of(program, job.profile, told.nest, made.verdict)
    if worse := _broken_more(after.verdict, before.verdict):
        ends = f"the old order stays: the new one would break {', '.join(worse)}"
        return _stays(job, before, told.nest, False, ends, listener)
    mended = _broken_more(before.verdict, after.verdict)
    if after.idle_mm > before.idle_mm - _SLACK_MM and not mended:
        ends = (
            "the old order stays: the best by all rules" + ("" if proven else " that was found") + " has no less travel"
        )
        return _stays(job, before, told.nest, proven, ends, listener)
    if after.idle_mm > before.idle_mm:
        ends += f"; it is longer since the old order breaks {', '.join(mended)}"
    stays = _stays(job, before, told.nest, proven, ends, listener)
    return replace(stays, program=made.program, after=after, plan=plan)


def _stays(
    job: OldJob, before: Measured, nest: Nest | None, proven: bool, ends: str, listener: Listener
) -> Resequenced:
    """The old program as it is."""
    text, ended = job.old.text, listener.interrupted
    return Resequenced(job.name, "keep", text, before, before, nest, None, proven, ends, job.notes, job.home, ended)


def _broken_more(one: CheckResult | None, other: CheckResult | None) -> list[str]:
    """Hard rules that one order breaks oftener than another does, excuses counted: what none can keep is no fault."""
    if one is None or other is None:
        return []
    least = {judgement.id: len(judgement.violations) + len(judgement.excused) for judgement in other.rules}
    return [
        judgement.id
        for judgement in one.rules
        if judgement.strength == "hard" and len(judgement.violations) > least.get(judgement.id, 0)
    ]


def _read_back(text: str, job: OldJob, apart: TakenApart, order: Sequence[int]) -> NcProgram:
    """The new program in the coordinates of the drawing, with every burn as it was."""
    try:
        written = old_on_machine(text, job.profile, job.trusted)
    except InputError as error:
        line = text.split("\n")[error.line - 1] if error.line else ""
        raise InputError(
            f"the burns in their new order cannot be read back ({line!r}: {error.message}); nothing is written",
            file=job.name,
        ) from None
    expect_same(apart, order, written)
    return moved(written.program, job.program.zero or (0.0, 0.0))
