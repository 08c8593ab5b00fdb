"""The burns of an old program as they are, in the best order: by the rules, or by travel alone where that is asked."""

from __future__ import annotations

from dataclasses import replace

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.postproc.old.contours import Told
from kerfwise.postproc.old.pieces import TakenApart, taken_apart
from kerfwise.postproc.old.unclear import NoNest

from .by_travel import by_travel
from .given import Tell
from .judged_side import judged_by_side
from .kept_burns import BurnWriter, facts_of_burns, plan_order
from .listening import Listener
from .new_order import SLACK_MM, broken_more, read_back, stays
from .old_program import OldJob
from .resequenced import Measured, Resequenced

_CANNOT_ASK = (
    "what some burns cut cannot be told, so that nobody can say whether another order keeps the rules, and nothing is "
    "written; mend what is named below, or take --without-rules (in Python without_rules=True): then only what lies "
    "inside what, and what touches, keeps its turn"
)


def in_best_order(
    job: OldJob, limits: SolveOptions, listener: Listener, tell: Tell, without_rules: bool = False
) -> Resequenced:
    """Put the burns into the best order by the rules of the profile.

    Where they make no nest the rules cannot be asked. Then nothing is done, or `without_rules` what lies inside and
    what touches keeps its turn, and no more than that is kept.

    Raises
    ------
    InputError
        If the program cannot be taken apart, the burns make no nest, or they cannot be read back in their new order.
    """
    apart = taken_apart(job.old, job.name)
    told, unclear = job.told, job.unclear
    if told is not None:
        try:
            return _by_rules(job, told, apart, limits, listener, tell)
        except NoNest as none:
            unclear = none.unclear
    if not without_rules:
        raise InputError(_CANNOT_ASK, file=job.name, line=unclear[0].line, details=tuple(map(str, unclear)))
    return by_travel(job, apart, unclear, limits, listener, tell)


def _by_rules(
    job: OldJob, told: Told, apart: TakenApart, limits: SolveOptions, listener: Listener, tell: Tell
) -> Resequenced:
    facts_of_burns(job, told)  # nothing is judged where burns are not clearly cuts
    job, old = judged_by_side(job, told.nest, job.text, tell)
    kept = facts_of_burns(job, told)
    before = Measured.of(job.program, job.profile, told.nest, old)
    try:
        made = plan_order(job, kept, told, apart, limits, listener)
    except RulesConflict as conflict:  # a lead that crosses another part is in the way of every order
        ends = f"the old order stays: no order of these burns keeps the hard rules ({conflict.message})"
        return stays(job, before, told.nest, False, ends, listener)
    plan = made.plan
    proven = plan.solve.status == "optimal"
    ends = "proven: no order is better by these rules" if proven else "found, not proven"
    order = BurnWriter(told, apart).order(plan)
    program = read_back(made.program, job, apart, order)
    after = Measured.of(program, job.profile, told.nest, made.verdict)
    if worse := broken_more(after.verdict, before.verdict):
        ends = f"the old order stays: the new one would break {', '.join(worse)}"
        return stays(job, before, told.nest, False, ends, listener)
    mended = broken_more(before.verdict, after.verdict)
    if after.idle_mm > before.idle_mm - SLACK_MM and not mended:
        ends = (
            "the old order stays: the best by all rules" + ("" if proven else " that was found") + " has no less travel"
        )
        return stays(job, before, told.nest, proven, ends, listener)
    if after.idle_mm > before.idle_mm:
        ends += f"; it is longer since the old order breaks {', '.join(mended)}"
    old_order = stays(job, before, told.nest, proven, ends, listener)
    return replace(old_order, program=made.program, after=after, plan=plan)
