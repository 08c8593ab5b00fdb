"""Plans and programs on the clock: what they do, in how many blocks, and how long that takes by the profile's model."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.tolerance import TOLERANCE_MM
from kerfwise.models.physics.timing.choose import machine_feeds, motion_of
from kerfwise.models.physics.timing.clock import RunTimes, times_of
from kerfwise.models.physics.timing.motion import Motion
from kerfwise.models.physics.timing.report import TimeReport, report_times
from kerfwise.models.physics.timing.run import Job, Run
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check.reader.old import Trusted
from kerfwise.postproc.check.reader.on_machine import read_on_machine
from kerfwise.postproc.check.reader.program import NcProgram, at_holes
from kerfwise.postproc.nc.body import blocks_of_plan
from kerfwise.postproc.nc.plan_paths import outside, toolpaths
from kerfwise.rules.profile.profile import Profile


@dataclass(frozen=True, eq=False, slots=True)
class Timed:
    """A job, the motion that it was timed with, and its times."""

    job: Job
    motion: Motion
    times: RunTimes

    @property
    def report(self) -> TimeReport:
        """What a plan, and `kerfwise time`, say of it."""
        return report_times(self.times, self.motion, self.job.nc_blocks)


def time_job(job: Job, profile: Profile) -> Timed:
    """The times of a job by the model of the profile."""
    motion = motion_of(profile, job.nc_blocks)
    return Timed(job, motion, times_of(job, motion, machine_feeds(profile)))


def job_of_plan(plan: Plan, nest: Nest, profile: Profile) -> Job:
    """What the program of a plan will do; its blocks are counted without writing it.

    Raises
    ------
    InputError
        If the plan was made from another nest.
    """
    paths = toolpaths(plan, nest, profile)
    profile = profile.at_origin(plan.origin).at_spacing(plan.sequence().spacing_mm(profile.machine.torches.axis))
    home = profile.home_on(nest)
    runs, at, pierced = [], home, plan.sequence().pierced
    for order, made in enumerate(paths, plan.resumed_after + 1):
        for pierce in pierced.get(order, ()):
            runs.append(Run(_stands(pierce.at), travels_mm=(math.dist(at, pierce.at),)))
            at = pierce.at
        travels_mm = () if made.linked else (math.dist(at, _start(made.path)),)
        runs.append(
            Run(
                made.path,
                made.marks,
                not (made.edge_start or made.pierced),
                travels_mm,
                made.planned.dwell_s,
                standing_s=profile.machine.at_hole_s if made.pierced else None,
                feed_share=made.feed_share,
                linked=made.linked,
                unlit_mm=sum(high - low for low, high in made.unlit),
            )
        )
        at = _end(made.path)
    return Job(tuple(runs), (math.dist(at, home),), blocks_of_plan(plan, nest, profile, paths))


def job_of_program(program: NcProgram, nest: Nest | None, own: Profile | None = None, kerf_starts: bool = False) -> Job:
    """What a program does, as the check reads it; the nest, if there is one, tells which cuts come in from the edge.

    With a profile every path takes as long as the program's own F words and G4 say, and piercing as long as that
    profile's machine does it for, where its dialect leaves that to the machine. With `kerf_starts` nothing is pierced
    where an earlier path has run.
    """
    starts = [_start(burn.path) for burn in program.burns]
    edge_starts = [False] * len(starts) if nest is None else outside(nest, starts)
    if kerf_starts:
        edge_starts = [a or b for a, b in zip(edge_starts, _in_older_kerfs(program, starts), strict=True)]
    runs = []
    holes = at_holes(program)
    for burn, edge_start, hole in zip(program.burns, edge_starts, holes, strict=True):
        pierced = not (edge_start or hole)
        run = Run(burn.path, burn.tool != 0, pierced, burn.travels_mm, burn.wait_s, unlit_mm=burn.unlit_mm)
        run = replace(run, standing_s=0.0) if hole else run
        if own is not None:
            run = replace(run, moving_s=burn.moving_s, standing_s=burn.held_s + burn.pierce_s + burn.paused_s)
        runs.append(run)
    return Job(tuple(runs), program.homing_mm, program.blocks)


def time_program(program: NcProgram, nest: Nest | None, profile: Profile) -> Timed:
    """The times of a program by the model of the profile: by its own words where that is the constant feed."""
    own = profile if profile.time.model == "constant" else None
    return time_job(job_of_program(program, nest, own, profile.kerf_starts), profile)


def read_program(text: str, nest: Nest, profile: Profile, file: str = "", trusted: Trusted | None = None) -> NcProgram:
    """A program as the check reads it, on the profile's machine, in the coordinates of the nest's drawing.

    Raises
    ------
    InputError
        With the line, for what is malformed or not understood.
    """
    return read_on_machine(text, nest, profile, file, trusted)


def with_times(plan: Plan, nest: Nest, profile: Profile) -> Plan:
    """The plan with the times of its program by the model of the profile, which it then states."""
    timed = time_job(job_of_plan(plan, nest, profile), profile)
    spans, pierced = iter(timed.times.spans), plan.sequence().pierced
    cuts, pierces = [], []
    begin = end = 0.0
    for order, planned in enumerate(plan.cuts, plan.resumed_after + 1):
        for pierce in pierced.get(order, ()):
            begin, end = next(spans)
            pierces.append(replace(pierce, start_s=begin, end_s=end))
        begin, end = next(spans) if planned.cut.torch == 1 else (begin, end)
        cuts.append(replace(planned, cut=replace(planned.cut, start_s=begin, end_s=end)))
    totals = replace(plan.totals, time_s=timed.times.total_s)
    return replace(plan, cuts=tuple(cuts), totals=totals, time=timed.report, pierces=tuple(pierces))


def _stands(at: Point) -> Curve:
    """A path that goes nowhere."""
    return Curve.of([at], closed=False)


def _in_older_kerfs(program: NcProgram, starts: Sequence[Point]) -> list[bool]:
    """Whether each burn begins on the path of an earlier one."""
    burnt = [k for k, burn in enumerate(program.burns) if burn.tool == 0]
    tree = shapely.STRtree([program.burns[k].path.line() for k in burnt])
    later, earlier = tree.query(shapely.points(np.array(starts).reshape(-1, 2)), "dwithin", distance=TOLERANCE_MM)
    found = {k for k, row in zip(later.tolist(), earlier.tolist(), strict=True) if burnt[row] < k}
    return [k in found for k in range(len(starts))]


def _start(path: Curve) -> Point:
    x, y = path.vertices[0, :2].tolist()
    return x, y


def _end(path: Curve) -> Point:
    x, y = path.vertices[-1, :2].tolist()
    return x, y
