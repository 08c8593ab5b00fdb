"""How long a plan or a program takes, on what, and what that costs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kerfwise.encoder.nest import Nest
from kerfwise.models.physics.timing.choose import machine_feeds
from kerfwise.models.physics.timing.clock import times_of
from kerfwise.models.physics.timing.constant import ConstantFeed
from kerfwise.models.physics.timing.cost import Cost
from kerfwise.models.physics.timing.report import TimeReport
from kerfwise.models.physics.timing.run import Job
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.reader import read_plan
from kerfwise.postproc.check.reader.old import Trusted
from kerfwise.postproc.clock.timed import Timed, job_of_plan, job_of_program, time_job, time_program
from kerfwise.rules.profile.profile import Profile

from .costs import cost_of_sheet
from .given import Given, Tell, differences, is_plan_file, read_program_of, silent
from .old_program import OldJob

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


def time_made(given: Given, made: Plan | str | Path, tell: Tell = silent, trusted: Trusted | None = None) -> Times:
    """The times of a plan, or of the plan or NC program in a file, by the time model of the profile.

    What a program leaves to the machine's material is refused, unless that is `trusted`.

    Raises
    ------
    InputError
        If the file cannot be read or understood, or is one of another nest.
    """
    nest, profile = given.nest, given.profile
    stock: Nest | None = nest
    if isinstance(made, Plan) or is_plan_file(made):
        plan = made if isinstance(made, Plan) else read_plan(made)
        job = job_of_plan(plan, nest, profile)
        stock = None if plan.already_cut else nest  # the sheet of a plan that goes on was paid before
        for text in differences(plan, given):
            tell(text)
    else:
        program = read_program_of(made, given, tell, trusted)
        by_itself = profile.time.model == "constant"
        own, job = (job_of_program(program, nest, by, profile.kerf_starts) for by in (profile, None))
        _tell_if_its_times_differ(own, job, profile, "its own" if by_itself else "the profile's model", tell)
        job = own if by_itself else job
    timed = time_job(job, profile)
    return Times(timed, cost_of_sheet(timed.times, timed.job.pierces, stock, profile))


def time_old(job: OldJob) -> Times:
    """The times of an old program, with or without its nest, by the time model of the profile."""
    nest = job.told.nest if job.told is not None else None
    timed = time_program(job.program, nest, job.profile)
    return Times(timed, cost_of_sheet(timed.times, timed.job.pierces, None, job.profile))


def _tell_if_its_times_differ(own: Job, job: Job, profile: Profile, taken: str, tell: Tell) -> None:
    """Tell where a program moves or stands for other times than the profile's feeds make."""
    feeds = machine_feeds(profile)
    said, asked = (times_of(made, ConstantFeed(feeds), feeds) for made in (own, job))
    for does, own_s, set_s in (("cuts", said.cut_s, asked.cut_s), ("pierces", said.pierce_s, asked.pierce_s)):
        if abs(own_s - set_s) > _FEEDS_DIFFER * set_s:
            text = f"by its own words the program {does} for {own_s:.1f} s, at the profile's feeds for {set_s:.1f} s"
            tell(f"{text}; the times below are by {taken}")
