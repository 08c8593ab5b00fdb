"""Plans and programs, old ones without their nest among them: read, judged, timed."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Mapping, Set
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.models.physics.motion import ConstantFeed
from kerfwise.models.physics.time_and_cost import Cost, Job, TimeReport, machine_feeds, times_of
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import expect_named_alike, expect_plan_of, read_plan
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.reader.program import NcProgram
from kerfwise.postproc.check.reader.read_program import (
    OldProgram,
    Trusted,
    old_on_machine,
    shift_program,
    stated_origin,
)
from kerfwise.postproc.clock import Timed, cost_of_sheet, job_of_plan, job_of_program, time_job, time_program
from kerfwise.postproc.old.contours import NestOfBurns, fits_kerf, name_by_comments, nest_of
from kerfwise.postproc.old.loops import AmbiguousNest, Unclear
from kerfwise.postproc.verdict.check_plan import check_plan, check_program, held_to_plan, other_nest_named
from kerfwise.postproc.verdict.dialect_read_back import trusted_dialect
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import Corners, Scrap

from .inputs import Inputs, Tell, differences, expect_one_torch, is_plan_file, program_text, read_program_of, silent

_OF_SHEET = re.compile(r"\(\s*(?:ORIGIN|START SIDE)\b", re.IGNORECASE)

_COMMENT = re.compile(r"^\s*\((?!\s*o\s*=)[^()]*\)\s*$")


@dataclass(frozen=True, slots=True)
class ProgramRequest:
    """What the user says of old programs: mm, mm/min; None for what the program, or else the profile, says."""

    feed_mm_min: float | None = None
    kerf_mm: float | None = None
    sheet_mm: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False, slots=True)
class OldJob:
    """An old program, and what is known of it.

    Attributes
    ----------
    name
        Of its file.
    old
        The program, line by line, in its own coordinates.
    program
        The same in the coordinates of the drawing that it states.
    profile
        The plant's, with the feeds, the pierce time, the origin and the kerf of the program.
    told
        The nest told from the burns; None where they make none.
    unclear
        Then the burns at fault.
    partly
        Then the nest told from the others, where they make one.
    trusted
        What is taken as the program says it.
    text
        What is judged: the program, without comments that name another nest's contours.
    notes
        What the user should know.
    """

    name: str
    old: OldProgram
    program: NcProgram
    profile: Profile
    told: NestOfBurns | None
    unclear: tuple[Unclear, ...]
    partly: NestOfBurns | None
    trusted: Trusted
    text: str
    notes: tuple[str, ...]

    @property
    def home(self) -> Point:
        """Where the torch starts, in the coordinates of the drawing."""
        (x, y), (left, low) = self.profile.machine.home, self.program.zero or (0.0, 0.0)
        return x + left, y + low

    @property
    def nest(self) -> Nest:
        """The nest told from the burns. Raises InputError if they make none, with the lines of those at fault."""
        if self.told is not None:
            return self.told.nest
        first = self.unclear[0]
        raise InputError(
            f"no nest can be told from the program: {_few(len(self.unclear))} cut or mark the contour of a part",
            file=self.name,
            line=first.line,
            details=tuple(map(str, self.unclear)),
        )

    @property
    def given(self) -> Inputs:
        """Nest and profile, for jobs that need both."""
        return Inputs(self.nest, self.profile)


def _few(count: int) -> str:
    return "1 burn does not" if count == 1 else f"{count} burns do not"


def read_old_job(
    path: str | Path,
    profile: Profile,
    request: ProgramRequest | None = None,
    *,
    afresh: bool = False,
    tell: Tell = silent,
) -> OldJob:
    """Read an old program; `afresh` keeps the profile's feeds and the kerf, since all paths will be new.

    Raises InputError with file and line, for what cannot be read or be sure of.
    """
    expect_one_torch(profile, "a program of which there is no nest")
    request, file = request or ProgramRequest(), str(path)
    text = program_text(path)
    trusted = Trusted(request.feed_mm_min or profile.machine.cut_feed_mm_s * 60)
    old = old_on_machine(text, profile, trusted, file)
    if not old.program.burns:
        raise InputError("the program cuts nothing: the torch is never on", file=file)
    notes: list[str] = list(old.notes)
    if old.fed_by and request.feed_mm_min is None:
        notes.append(
            f"the program leaves its feed to the machine's material (line {old.fed_by[0]}): it is taken as the "
            f"profile's {trusted.feed_mm_min:g} mm/min (--feed gives another)"
        )
    origin, zero = stated_origin(old.program)
    program = replace(shift_program(old.program, zero or (0.0, 0.0)), origin=origin, zero=zero)
    profile = profile.at_origin(origin or "drawing")
    kerf_mm = kerf_of(old, profile, request.kerf_mm)
    if not afresh:
        profile = with_program_feeds(profile, program)
    at_corner = zero if origin == "sheet-corner" else None
    open_mm = tab_mm(profile, kerf_mm)

    def told_at(kerf_mm: float, aside: Set[int] = frozenset()) -> NestOfBurns:
        return nest_of(program.burns, kerf_mm, request.sheet_mm, at_corner, Path(path).name, open_mm, aside)

    told, unclear, without_kerf = _told_nest(told_at, kerf_mm, program.step_mm, afresh)
    if without_kerf:
        kerf_mm = 0.0
        notes.append(
            "the burns do not run half a kerf beside contours with round corners: rules are judged on the torch's "
            "path itself, as if the kerf had no width"
        )
    partly: NestOfBurns | None = None
    if told is None and not afresh:
        with suppress(AmbiguousNest):
            partly = told_at(kerf_mm, {one.line for one in unclear})
    profile = replace(profile, material=replace(profile.material, kerf_mm=kerf_mm))
    judged = text
    if told is not None:
        named = name_by_comments(told, program.comments)
        judged, told = (without_comments(text), told) if named is None else (text, named)
        notes += [note.text for note in told.nest.notes]
    for note in notes:
        tell(note)
    return OldJob(file, old, program, profile, told, unclear, partly, trusted, judged, tuple(notes))


def _told_nest(
    told_at: Callable[[float], NestOfBurns], kerf_mm: float, step_mm: float, afresh: bool
) -> tuple[NestOfBurns | None, tuple[Unclear, ...], bool]:
    """The nest that burns make, or what is unclear of it, and whether they run along contours as if without a kerf."""
    beside_kerf: NestOfBurns | None = None
    unclear: tuple[Unclear, ...] = ()
    try:
        beside_kerf = told_at(kerf_mm)
    except AmbiguousNest as none:
        unclear = tuple(none.unclear)
    if afresh or kerf_mm <= 0 or (beside_kerf is not None and fits_kerf(beside_kerf, kerf_mm, step_mm)):
        return beside_kerf, unclear, False
    try:
        return told_at(0.0), (), True
    except AmbiguousNest as still:
        return None, tuple(still.unclear), False


def without_comments(text: str) -> str:
    """The program without comments that name contours of another nest; those on the sheet stay."""
    return "\n".join(row if is_of_sheet(row) else _COMMENT.sub("", row) for row in text.split("\n"))


def is_of_sheet(row: str) -> bool:
    """Whether a row is a comment that says where the sheet lies, or from which side it is cut."""
    return _OF_SHEET.match(row) is not None


# A profile as an old program has it: its feeds, its kerf, and no way to cut but that of each burn.


def tab_mm(profile: Profile, kerf_mm: float) -> float:
    """How far short of its begin a cut may stop for a tab: one about as wide as the profile has them, and the kerf."""
    tabs = profile.tabs()
    return 2 * tabs.width_mm + kerf_mm if tabs is not None and tabs.at_end else 0.0


def kerf_of(old: OldProgram, profile: Profile, asked_mm: float | None) -> float:
    """The kerf that is asked for, else that of the materials that the program describes, else the profile's, mm."""
    if asked_mm is not None:
        return asked_mm
    return max(old.kerfs_mm, default=profile.material.kerf_mm)


def with_program_feeds(profile: Profile, program: NcProgram) -> Profile:
    """The profile with the feeds and the pierce time that most of the program has."""
    machine = profile.machine
    cut: dict[float, float] = defaultdict(float)
    mark: dict[float, float] = defaultdict(float)
    pierce: dict[float, float] = defaultdict(float)
    for burn in program.burns:
        for segment, feed in zip(burn.path.segments, burn.step_feeds_mm_s, strict=False):
            (mark if burn.tool else cut)[feed] += segment.length_mm
        if burn.tool == 0:
            pierce[burn.held_s + burn.pierce_s] += 1
    if cut:
        machine = replace(machine, cut_feed_mm_s=_most(cut))
    if mark:
        machine = replace(machine, mark_feed_mm_s=_most(mark))
    if pierce:
        machine = replace(machine, pierce_time_s=_most(pierce))
    holes = replace(profile.small_holes, under="refuse")
    corners = profile.corners
    if len(cut) < 2:
        holes, corners = replace(holes, small_hole_feed=1.0), Corners()
    # no way to cut but that of each burn
    cuts = replace(profile.cuts, narrow="refuse", scrap=Scrap(), pierce_pass=None)
    return replace(profile, machine=machine, small_holes=holes, corners=corners, cuts=cuts)


def _most(counted: Mapping[float, float]) -> float:
    return max(counted, key=lambda value: (counted[value], -value))


# A plan or a program judged by every rule, independently of whatever made it.


def check_made(
    inputs: Inputs,
    source: Plan | str | Path,
    tell: Tell = silent,
    plan: Plan | str | Path | None = None,
    trusted: Trusted | None = None,
) -> CheckResult:
    """The verdict on a plan, or on the plan or NC program in a file.

    With `plan`, a program has to follow that plan too, which says what the program's own comments do not. What it
    leaves to the machine's material is refused, unless that is `trusted`.

    Raises InputError if the file cannot be read or understood, or the dialect does not fit the profile.
    """
    trusted_dialect(inputs.profile)  # a plan is worth nothing on a machine whose programs would not run
    if not isinstance(source, Plan) and not is_plan_file(source):
        followed = read_plan(plan) if isinstance(plan, str | Path) else plan
        for text in differences(followed, inputs) if followed is not None else ():
            tell(text)
        text = program_text(source)
        if named := other_nest_named(text.split("\n"), inputs.nest):
            tell(f"{named}; it is judged on this nest")
        result = check_program(inputs.nest, text, inputs.profile, str(source), followed, trusted=trusted)
        if followed is None or trusted is not None:
            return result
        return held_to_plan(result, inputs.nest, text, followed, inputs.profile)
    if plan is not None:
        raise InputError("a plan is held against no other plan: expected an NC program, with the plan it was made from")
    judged = source if isinstance(source, Plan) else read_plan(source)
    for text in differences(judged, inputs, judged=True):
        tell(text)
    expect_named_alike(judged, inputs.nest)
    return check_plan(inputs.nest, judged, inputs.profile)


def check_old(job: OldJob) -> CheckResult:
    """The verdict on an old program, on the nest that is told from its burns.

    Raises InputError if they make no nest.
    """
    return check_program(job.nest, job.text, job.profile, job.name, trusted=job.trusted)


# How long a plan or a program takes, on what, and what that costs.

_FEEDS_DIFFER = 0.01
"""Share by which the program's own feeds may differ from the profile's before that is said."""


@dataclass(frozen=True, eq=False, slots=True)
class Times:
    """The times of a plan or a program, s, and what a sheet costs; `cost` is None where the profile has no prices."""

    timed: Timed
    cost: Cost | None

    @property
    def report(self) -> TimeReport:
        """Seconds of cutting, idle travel, piercing and waiting, and the model that they are by."""
        return self.timed.report

    @property
    def total_s(self) -> float:
        """The whole program, s."""
        return self.report.total_s

    def as_json(self) -> dict[str, Any]:
        """The times as `kerfwise time --json` prints them."""
        data = self.report.as_json()
        if self.cost is not None:
            data["cost"] = self.cost.as_json()
        return data

    def __str__(self) -> str:
        job, said, cost = self.timed.job, self.report, self.cost
        rows = [
            ("cut", said.cut_s, f"{job.on_mm / 1000:.3f} m"),
            ("idle", said.idle_s, f"{job.idle_mm / 1000:.3f} m, {said.idle_share:.1%} of the time"),
            ("pierce", said.pierce_s, f"{job.pierces} pierces"),
            *([("wait", said.dwell_s, "for metal to cool, the torch off")] if said.dwell_s else []),
            ("total", said.total_s, f"{said.nc_blocks} NC blocks, {said.model}"),
        ]
        lines = [f"{name:7} {seconds:9.1f} s   {text}" for name, seconds, text in rows]
        if cost is not None:
            parts = ", ".join(f"{name} {amount:.2f}" for name, amount in cost.parts)
            lines.append(f"{'cost':7} {cost.total:9.2f} {cost.currency}, a sheet: {parts}")
        return "\n".join(lines)


def time_made(inputs: Inputs, source: Plan | str | Path, tell: Tell = silent, trusted: Trusted | None = None) -> Times:
    """The times of a plan, or of the plan or NC program in a file, by the time model of the profile.

    What a program leaves to the machine's material is refused, unless that is `trusted`.

    Raises InputError if the file cannot be read or understood, or is one of another nest.
    """
    nest, profile = inputs.nest, inputs.profile
    stock: Nest | None = nest
    if isinstance(source, Plan) or is_plan_file(source):
        plan = source if isinstance(source, Plan) else read_plan(source)
        job = job_of_plan(plan, nest, profile)
        expect_plan_of(plan, nest)
        stock = None if plan.already_cut else nest  # the sheet of a plan that goes on was paid before
        for text in differences(plan, inputs):
            tell(text)
    else:
        program = read_program_of(source, inputs, tell, trusted)
        by_itself = profile.time.model == "constant"
        own, job = (job_of_program(program, nest, profile, own_feeds) for own_feeds in (True, False))
        at_own = profile.time.model == "acceleration"
        model = "the profile's acceleration at its own feeds" if at_own else "the profile's model"
        by = "its own" if by_itself else model
        if _warn_if_times_differ(own, job, profile, by, tell) and at_own:
            job = _at_own_feeds(job, own, profile)
        job = own if by_itself else job
    timed = time_job(job, profile)
    return Times(timed, cost_of_sheet(timed.times, timed.job.pierces, stock, profile))


def time_old(job: OldJob) -> Times:
    """The times of an old program, with or without its nest, by the time model of the profile."""
    nest = job.told.nest if job.told is not None else None
    timed = time_program(job.program, nest, job.profile)
    return Times(timed, cost_of_sheet(timed.times, timed.job.pierces, None, job.profile))


def _at_own_feeds(job: Job, own: Job, profile: Profile) -> Job:
    """The runs at the feeds that the program states, speeding up and slowing down as the profile's machine does."""
    feeds, runs = machine_feeds(profile), []
    for run, stated in zip(job.runs, own.runs, strict=True):
        feed_mm_s = feeds.mark_mm_s if run.marks else feeds.cut_mm_s
        share = run.path.length_mm / (stated.moving_s * feed_mm_s) if stated.moving_s else 1.0
        runs.append(replace(run, feed_share=share if share > 0 else 1.0))
    return replace(job, runs=tuple(runs))


def _warn_if_times_differ(own: Job, job: Job, profile: Profile, taken: str, tell: Tell) -> bool:
    """Tell where a program moves or stands for other times than the profile's feeds make; whether it cuts so."""
    feeds, cuts_so = machine_feeds(profile), False
    own_times, job_times = (times_of(one, ConstantFeed(feeds), feeds) for one in (own, job))
    for does, own_s, set_s in (
        ("cuts", own_times.cut_s, job_times.cut_s),
        ("pierces", own_times.pierce_s, job_times.pierce_s),
    ):
        if abs(own_s - set_s) > _FEEDS_DIFFER * set_s:
            text = f"by its own words the program {does} for {own_s:.1f} s, at the profile's feeds for {set_s:.1f} s"
            tell(f"{text}; the times below are by {taken}")
            cuts_so = cuts_so or does == "cuts"
    return cuts_so
