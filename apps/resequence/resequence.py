"""An old program in a better order: its burns as they are, or its contours planned afresh."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Unpack

from kerfwise.encoder.cut import Side
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.outlines import OPPOSITE
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.by_engine import Method
from kerfwise.jobs.inputs import Inputs, ProfileLike, Tell, plant_of, silent
from kerfwise.jobs.programs import OldJob, ProgramRequest, read_old_job
from kerfwise.jobs.progress import Listener
from kerfwise.jobs.request import options_for
from kerfwise.models.engines import Engine
from kerfwise.models.engines.solution import Limits, SolveOptions
from kerfwise.pipeline import Watchers, plan_nest
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.reader.read_program import read_on_machine
from kerfwise.postproc.old.contours import NestOfBurns
from kerfwise.postproc.old.loops import AmbiguousNest
from kerfwise.postproc.old.program_pieces import SplitProgram, split_program
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.rules.profile.load import DEFAULT
from kerfwise.rules.profile.profile import Profile

from .burn_order import (
    SLACK_MM,
    BurnWriter,
    broken_more,
    facts_of_burns,
    no_gain_message,
    order_by_travel,
    plan_order,
    read_back,
    stays,
)
from .result import Measured, Paths, Resequenced

_TOLD = 3


class Reordering(Limits, total=False):
    """How an old program is put into order, and within which limits.

    `paths`: "keep", the default, leaves every burn as it is, "new" makes leads and entries new. `request`: what the
    program does not say. `without_rules`: go on by travel alone where the rules cannot be asked, since nobody can tell
    what the burns cut; with "new" there is nothing to go on with.
    """

    paths: Paths
    request: ProgramRequest
    without_rules: bool


def resequence(
    path: str | Path,
    profile: ProfileLike = DEFAULT,
    listener: Listener | None = None,
    tell: Tell = silent,
    **how: Unpack[Reordering],
) -> Resequenced:
    """Put an old program's burns into the best order, or plan its contours afresh.

    Parameters
    ----------
    path
        File of the program.
    profile
        The plant; its dialect says which control the program is for.
    listener
        Listens while the plan is made.
    tell
        Told what the user should know.
    **how
        See `Reordering`.

    Raises
    ------
    InputError
        With file and line, for what cannot be read, or what nobody can be sure of.
    RulesConflict
        If contours are planned afresh, and no plan keeps the hard rules.
    """
    plant, listener = plant_of(profile), listener or Listener()
    afresh, engine = how.get("paths") == "new", how.get("engine", "portfolio")
    job = read_old_job(path, plant, how.get("request"), afresh=afresh, tell=tell)
    if (hole := next((burn for burn in job.program.burns if burn.pierces_only), None)) is not None:
        raise InputError(
            "the torch is lit here and does not move, as in a pierce pass: in another order cuts could come before "
            "their holes; such a program keeps its order",
            file=job.name,
            line=hole.line,
        )
    within: Any = {name: value for name, value in how.items() if name in ("work", "time_s", "seed")}
    if job.told is not None:
        limits = options_for(job.told.nest, job.profile, **within, engine=engine)
    else:
        limits = SolveOptions(**within)
    if afresh:
        return _afresh(job, limits, engine, listener, tell)
    return order_by_rules(job, limits, listener, tell, how.get("without_rules", False))


def _afresh(job: OldJob, limits: SolveOptions, engine: Engine, listener: Listener, tell: Tell) -> Resequenced:
    nest = job.nest
    job, verdict = infer_start_side(job, nest, job.text, tell)
    before = Measured.of(job.program, job.profile, nest, verdict)
    done = plan_nest(Inputs(job.profile.as_cut(nest), job.profile), limits, Method(engine), Watchers(listener, tell))
    verified = done.made
    if not verified.verdict.ok:
        broken = (verified.verdict.rule(name) for name in verified.verdict.broken())
        reasons = tuple(f"{j.id}: {v.text}" for j in broken for v in j.violations[:_TOLD])
        raise RulesConflict(f"{job.name}: the check refuses the new plan; nothing is written", reasons)
    after = Measured.of(read_on_machine(verified.program, nest, job.profile), job.profile, nest, verified.verdict)
    proven = verified.plan.solve.status == "optimal"
    ends = "proven: no plan is better within these zones and entries" if proven else "found, not proven"
    mended = broken_more(before.verdict, after.verdict)
    if (worse := no_gain_message(before, after, job.profile)) and not mended:
        ends = f"the old program stays: planned afresh it is no better ({worse})"
        return replace(stays(job, before, nest, False, ends, listener), paths="new")
    if worse:
        ends += f"; it is no better otherwise ({worse}), but the old program breaks {', '.join(mended)}"
    notes = list(job.notes)
    extra = next((line.line for line in job.old.lines if "material" in line.state or "tool" in line.state), None)
    if extra is not None:
        notes.append(
            f"line {extra}: what the program chooses on the machine (material, tool) is not in the new program, which "
            "is written for the profile"
        )
        tell(notes[-1])
    old = stays(job, before, nest, proven, ends, listener)
    return replace(old, paths="new", program=verified.program, after=after, plan=verified.plan, notes=tuple(notes))


_CANNOT_ASK = (
    "what some burns cut cannot be told, so that nobody can say whether another order keeps the rules, and nothing is "
    "written; mend what is named below, or take --without-rules (in Python without_rules=True): then only what lies "
    "inside what, and what touches, keeps its turn"
)


def order_by_rules(
    job: OldJob, limits: SolveOptions, listener: Listener, tell: Tell, without_rules: bool = False
) -> Resequenced:
    """Put the burns into the best order by the rules of the profile.

    Where they make no nest the rules cannot be asked. Then nothing is done, or `without_rules` what lies inside and
    what touches keeps its turn, and no more than that is kept. Raises InputError if the program cannot be taken apart,
    the burns make no nest, or they cannot be read back in their new order.
    """
    apart = split_program(job.old, job.name)
    nest_of_burns, unclear = job.told, job.unclear
    if nest_of_burns is not None:
        try:
            return _by_rules(job, nest_of_burns, apart, limits, listener, tell)
        except AmbiguousNest as none:
            unclear = none.unclear
    if not without_rules:
        raise InputError(_CANNOT_ASK, file=job.name, line=unclear[0].line, details=tuple(map(str, unclear)))
    return order_by_travel(job, apart, unclear, limits, listener, tell)


def _by_rules(
    job: OldJob, nest_of_burns: NestOfBurns, apart: SplitProgram, limits: SolveOptions, listener: Listener, tell: Tell
) -> Resequenced:
    facts_of_burns(job, nest_of_burns)  # nothing is judged where burns are not clearly cuts
    job, old = infer_start_side(job, nest_of_burns.nest, job.text, tell)
    kept = facts_of_burns(job, nest_of_burns)
    before = Measured.of(job.program, job.profile, nest_of_burns.nest, old)
    try:
        verified = plan_order(job, kept, nest_of_burns, apart, limits, listener)
    except RulesConflict as conflict:  # a lead that crosses another part is in the way of every order
        ends = f"the old order stays: no order of these burns keeps the hard rules ({conflict.message})"
        return stays(job, before, nest_of_burns.nest, False, ends, listener)
    plan = verified.plan
    proven = plan.solve.status == "optimal"
    ends = "proven: no order is better by these rules" if proven else "found, not proven"
    order = BurnWriter(nest_of_burns, apart).order(plan)
    program = read_back(verified.program, job, apart, order)
    after = Measured.of(program, job.profile, nest_of_burns.nest, verified.verdict)
    if worse := broken_more(after.verdict, before.verdict):
        ends = f"the old order stays: the new one would break {', '.join(worse)}"
        return stays(job, before, nest_of_burns.nest, False, ends, listener)
    mended = broken_more(before.verdict, after.verdict)
    if after.idle_mm > before.idle_mm - SLACK_MM and not mended:
        ends = (
            "the old order stays: the best by all rules" + ("" if proven else " that was found") + " has no less travel"
        )
        return stays(job, before, nest_of_burns.nest, proven, ends, listener)
    if after.idle_mm > before.idle_mm:
        ends += f"; it is longer since the old order breaks {', '.join(mended)}"
    old_order = stays(job, before, nest_of_burns.nest, proven, ends, listener)
    return replace(old_order, program=verified.program, after=after, plan=plan)


# From which side an old program that does not say so is taken to start: the one under which it keeps the rules.


def infer_start_side(job: OldJob, nest: Nest, text: str, tell: Tell) -> tuple[OldJob, CheckResult]:
    """The job with the side that the old program starts from, and the verdict on `text` by it.

    What the program or the profile says holds. Else the side that the nest asks for does, but for a program that breaks
    hard rules from there and none from another one, the opposite first: the job has that in its profile then, and says
    so in a note. Nearly even nests are decided by tenths of a millimetre, others by how large the sheet is.
    """
    side = compute_facts(nest, job.profile.fact_options(nest), ()).start_side
    verdict = _judged(job, nest, text, side)
    name = _left_open(job)
    if name is None or not verdict.broken():
        return job, verdict
    for other_side in (OPPOSITE[side], *(one for one in OPPOSITE if one not in (side, OPPOSITE[side]))):
        other = replace(job, profile=_from_side(job.profile, name, other_side))
        judged = _judged(other, nest, text, other_side)
        if not judged.broken():
            note = (
                "the program does not say from which side cutting starts: both orders are judged from the "
                f"{other_side}, from where the old one breaks no hard rule, as it does from the {side}; for a check "
                f"of the new program, give the profile rules: {{{name}: {{side: {other_side}}}}}"
            )
            tell(note)
            return replace(other, notes=(*job.notes, note)), judged
    return job, verdict


def _judged(job: OldJob, nest: Nest, text: str, side: Side) -> CheckResult:
    return check_program(nest, text, job.profile, job.name, trusted=job.trusted, side=side)


def _left_open(job: OldJob) -> str | None:
    """The rule that decides the side; None where the program or the profile says it, or nothing asks for one."""
    if any("START SIDE" in comment.upper() for comment in job.program.comments):
        return None
    for name, setting in job.profile.rules.items():
        if getattr(setting.options, "side", None) == "auto" and setting.strength != "off":
            return name
    return None


def _from_side(profile: Profile, name: str, side: Side) -> Profile:
    setting = profile.rules[name]
    fixed = replace(setting, options=replace(setting.options, side=side))
    return replace(profile, rules={**profile.rules, name: fixed})
