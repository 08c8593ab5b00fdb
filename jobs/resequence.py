"""An old program in a better order: its burns as they are, or its contours planned afresh."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.models.engines.names import Engine
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.reader.on_machine import moved, old_on_machine, read_on_machine
from kerfwise.postproc.check.reader.program import Burn, NcProgram
from kerfwise.postproc.clock.timed import job_of_program, time_job
from kerfwise.postproc.dialects import fitting_dialect
from kerfwise.postproc.nc.blocks import comment
from kerfwise.postproc.old.contours import NoNest, Told, Unclear
from kerfwise.postproc.old.orders import changes_material_or_tool
from kerfwise.postproc.old.reordered import TakenApart, expect_same, reordered, taken_apart
from kerfwise.postproc.verdict.checking import check_program
from kerfwise.rules.profile.profile import Profile

from .given import Given, ProfileLike, Tell, plant_of, silent
from .kept_burns import BurnWriter, facts_of_burns, plan_order
from .listening import Listener
from .main_job import plan_nest
from .old_program import Asked, OldJob, read_old_job
from .order_only import route
from .solve_options import options_for

Paths = Literal["keep", "new"]
_SLACK_MM = 0.01
_TOLD = 3


@dataclass(frozen=True, eq=False, slots=True)
class Measured:
    """What a program does: mm, s, and each rule's verdict on it, None where there is no nest to judge by."""

    idle_mm: float
    cut_mm: float
    pierces: int
    time_s: float
    verdict: CheckResult | None
    burns: tuple[Burn, ...]


@dataclass(frozen=True, eq=False, slots=True)
class Resequenced:
    """An old program and the new one.

    Attributes
    ----------
    name
        Of the old program's file.
    paths
        "keep" where every burn stays as it is, "new" where contours were planned afresh.
    program
        The new program; the old one's text where nothing was gained.
    before, after
        What both do.
    nest
        Told from the burns; None where they make none.
    plan
        Of the new program, where there is a nest.
    proven
        Whether no order has less travel by the same rules.
    ends
        In a sentence, how the new order was found.
    notes
        What the user should know.
    home
        Where the torch starts, in the coordinates of the drawing that the program states.
    interrupted
        Whether Ctrl-C ended the planning: the order is the best so far.
    """

    name: str
    paths: Paths
    program: str
    before: Measured
    after: Measured
    nest: Nest | None
    plan: Plan | None
    proven: bool
    ends: str
    notes: tuple[str, ...]
    home: Point = (0.0, 0.0)
    interrupted: bool = False

    @property
    def changed(self) -> bool:
        """Whether the new program is another than the old one."""
        return self.before is not self.after

    def __str__(self) -> str:
        from .resequence_table import table

        return table(self)


def resequence(
    path: str | Path,
    profile: ProfileLike = "plasma-carbon-steel",
    *,
    paths: Paths = "keep",
    asked: Asked | None = None,
    work: float = 30.0,
    time_s: float | None = None,
    seed: int = 1,
    engine: Engine = "portfolio",
    listener: Listener | None = None,
    tell: Tell = silent,
) -> Resequenced:
    """Put an old program's burns into the best order, or plan its contours afresh.

    Parameters
    ----------
    path
        File of the program.
    profile
        The plant; its dialect says which control the program is for.
    paths
        "keep" leaves every burn as it is, "new" makes leads and entries new.
    asked
        What the program does not say.
    work, time_s, seed, engine
        As for a plan of a nest.
    listener
        Listens while the plan is made.
    tell
        Told what the user should know.

    Raises
    ------
    InputError
        With file and line, for what cannot be read, or what nobody can be sure of.
    RulesConflict
        If contours are planned afresh, and no plan keeps the hard rules.
    """
    plant, listener = plant_of(profile), listener or Listener()
    job = read_old_job(path, plant, asked, afresh=paths == "new", tell=tell)
    if job.told is not None:
        limits = options_for(job.told.nest, job.profile, work=work, seed=seed, time_s=time_s, engine=engine)
    else:
        limits = SolveOptions(seed, work, time_s)
    if paths == "new":
        return _afresh(job, limits, engine, listener, tell)
    return _kept(job, limits, listener, tell)


def _kept(job: OldJob, limits: SolveOptions, listener: Listener, tell: Tell) -> Resequenced:
    apart = taken_apart(job.old, job.name)
    told, unclear = job.told, job.unclear
    if told is not None and changes_material_or_tool(apart.pieces):
        told, unclear = None, (Unclear(apart.pieces[0].line, "the program changes its material or tool"),)
    if told is not None:
        try:
            return _by_rules(job, told, apart, limits, listener)
        except NoNest as none:
            unclear = none.unclear
    before = _measured(job)
    reasons = "; ".join(map(str, unclear[:3])) + (f"; and {len(unclear) - 3} more" if len(unclear) > 3 else "")
    note = f"rules on contours are not asked, only what lies inside and what touches: {reasons}"
    tell(note)
    job = replace(job, notes=(*job.notes, note))
    with listener:
        routed = route(job, apart, limits, listener)
    ends = routed.why or ("proven: no order has less travel" if routed.proven else "found, not proven")
    if list(routed.order) == list(range(len(apart.pieces))):
        return _stays(job, before, None, routed.proven, ends, listener)
    top = comment(fitting_dialect(job.profile), "RESEQUENCED BY KERFWISE, ORDER AND TRAVEL ONLY")
    text = _same(reordered(apart, routed.order, [top] if top else []), job, apart, list(routed.order))
    after = _measured(job, None, text)
    if after.idle_mm > before.idle_mm - _SLACK_MM:
        return _stays(job, before, None, routed.proven, ends, listener)
    return Resequenced(
        job.name,
        "keep",
        text,
        before,
        after,
        None,
        None,
        routed.proven,
        ends,
        job.notes,
        job.home,
        listener.interrupted,
    )


def _by_rules(job: OldJob, told: Told, apart: TakenApart, limits: SolveOptions, listener: Listener) -> Resequenced:
    facts = facts_of_burns(job, told)
    old = check_program(told.nest, job.text, job.profile, job.name, trusted=job.trusted, side=facts.start_side)
    before = _measured(job, told, None, old)
    try:
        made = plan_order(job, facts, told, apart, limits, listener)
    except RulesConflict as conflict:  # a lead that crosses another part is in the way of every order
        ends = f"the old order stays: no order of these burns keeps the hard rules ({conflict.message})"
        return _stays(job, before, told.nest, False, ends, listener)
    plan = made.plan
    proven = plan.solve.status == "optimal"
    ends = "proven: no order is better by these rules" if proven else "found, not proven"
    order = BurnWriter(told, apart).order(plan)
    text = _same(made.program, job, apart, order)
    after = _measured(job, told, text, made.verdict)
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
    return Resequenced(
        job.name, "keep", text, before, after, told.nest, plan, proven, ends, job.notes, job.home, listener.interrupted
    )


def _afresh(job: OldJob, limits: SolveOptions, engine: Engine, listener: Listener, tell: Tell) -> Resequenced:
    nest = job.nest
    verdict = check_program(nest, job.text, job.profile, job.name, trusted=job.trusted)
    before = _measured(job, job.told, None, verdict)
    extra = next((line.line for line in job.old.lines if "material" in line.state or "tool" in line.state), None)
    notes = list(job.notes)
    if extra is not None:
        notes.append(
            f"line {extra}: what the program chooses on the machine (material, tool) is not in the new program, which "
            "is written for the profile"
        )
        tell(notes[-1])
    done = plan_nest(Given(job.profile.as_cut(nest), job.profile), limits, engine=engine, listener=listener, tell=tell)
    made = done.made
    if not made.verdict.ok:
        broken = (made.verdict.rule(name) for name in made.verdict.broken())
        reasons = tuple(f"{j.id}: {v.text}" for j in broken for v in j.violations[:_TOLD])
        raise RulesConflict(f"{job.name}: the check refuses the new plan; nothing is written", reasons)
    program = read_on_machine(made.program, nest, job.profile)
    after = _of_program(program, job.profile, nest, made.verdict)
    proven = made.plan.solve.status == "optimal"
    ends = "proven: no plan is better within these zones and entries" if proven else "found, not proven"
    return Resequenced(
        job.name,
        "new",
        made.program,
        before,
        after,
        nest,
        made.plan,
        proven,
        ends,
        tuple(notes),
        job.home,
        listener.interrupted,
    )


def _stays(
    job: OldJob, before: Measured, nest: Nest | None, proven: bool, ends: str, listener: Listener
) -> Resequenced:
    return Resequenced(
        job.name,
        "keep",
        job.old.text,
        before,
        before,
        nest,
        None,
        proven,
        ends,
        job.notes,
        job.home,
        listener.interrupted,
    )


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


def _same(text: str, job: OldJob, apart: TakenApart, order: list[int]) -> str:
    """The new program, once it has been read back and every burn found as it was."""
    try:
        written = old_on_machine(text, job.profile, job.trusted)
    except InputError as error:
        line = text.split("\n")[error.line - 1] if error.line else ""
        raise InputError(
            f"the burns in their new order cannot be read back ({line!r}: {error.message}); nothing is written",
            file=job.name,
        ) from None
    expect_same(apart, order, written)
    return text


def _measured(
    job: OldJob, told: Told | None = None, text: str | None = None, verdict: CheckResult | None = None
) -> Measured:
    """What the old program does, or the new one."""
    program = job.program
    if text is not None:
        program = moved(old_on_machine(text, job.profile, job.trusted).program, program.zero or (0.0, 0.0))
    return _of_program(program, job.profile, told.nest if told else None, verdict)


def _of_program(program: NcProgram, profile: Profile, nest: Nest | None, verdict: CheckResult | None) -> Measured:
    made = job_of_program(program, nest, profile if profile.time.model == "constant" else None)
    timed = time_job(made, profile)
    return Measured(program.idle_mm, made.on_mm, made.pierces, timed.times.total_s, verdict, program.burns)
