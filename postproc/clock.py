"""The clock: how long plans and programs take by the profile's model, what that costs, and the heat of each contour."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.encoder.bevels.tilted_path import one_after_another
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.cut import Pierce
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import TOLERANCE_MM
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.scrap import remnant_of
from kerfwise.encoder.small_holes import with_small_holes
from kerfwise.encoder.torch_path import compensated
from kerfwise.models.physics.motion import Accelerated, ConstantFeed, Motion
from kerfwise.models.physics.time_and_cost import (
    Cost,
    Job,
    Run,
    RunTimes,
    Spent,
    TimeReport,
    cost_of,
    machine_feeds,
    motion_of,
    report_times,
    times_of,
)
from kerfwise.models.plan.plan import Plan, PlannedCut
from kerfwise.postproc.check.matching import Matcher
from kerfwise.postproc.check.reader.program import NcProgram, at_holes
from kerfwise.postproc.check.reader.read_program import Trusted, read_on_machine
from kerfwise.postproc.nc.program import blocks_of_plan, count_blocks
from kerfwise.postproc.nc.toolpaths import Toolpath, outside, toolpaths, torch_path, unlit_on
from kerfwise.rules.profile.plant_sections import MATERIALS
from kerfwise.rules.profile.technique import Technique


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


def time_job(job: Job, profile: Technique) -> Timed:
    """The times of a job by the model of the profile."""
    motion = motion_of(profile, job.nc_blocks)
    return Timed(job, motion, times_of(job, motion, machine_feeds(profile)))


def job_of_plan(plan: Plan, nest: Nest, profile: Technique) -> Job:
    """What the program of a plan will do; its blocks are counted without writing it.

    Raises InputError if the plan was made from another nest.
    """
    paths = toolpaths(plan, nest, profile)
    profile = profile.at_origin(plan.origin).at_spacing(plan.sequence().spacing_mm(profile.machine.torches.axis))
    home = profile.home_on(nest)
    runs, at, pierced = [], home, plan.sequence().pierced
    order = plan.resumed_after + 1
    for toolpath in paths:
        for pierce in pierced.pop(order, ()):
            runs.append(Run(_stands(pierce.at), travels_mm=(math.dist(at, pierce.at),)))
            at = pierce.at
        for one in one_after_another(toolpath.passes):
            path = one.curve if one.tilt_deg or one.aside_mm is not None else toolpath.path
            share = one.feed_share if one.aside_mm is None else min(torch.feed_share for torch in toolpath.passes)
            share *= toolpath.small_hole_share
            runs.append(Run(path, travels_mm=(math.dist(at, path.start),), feed_share=share))
            at = path.end
        if toolpath.passes:
            order += 1
            continue
        travels_mm = () if toolpath.linked else (math.dist(at, toolpath.path.start),)
        runs.append(
            Run(
                toolpath.path,
                toolpath.marks,
                not (toolpath.edge_start or toolpath.pierced),
                travels_mm,
                toolpath.planned.dwell_s,
                standing_s=profile.machine.at_hole_s if toolpath.pierced else None,
                feed_share=toolpath.feed_share,
                linked=toolpath.linked,
                unlit_mm=sum(high - low for low, high in toolpath.unlit),
            )
        )
        at = toolpath.path.end
        order += not toolpath.planned.cut.way
    return Job(tuple(runs), (math.dist(at, home),), blocks_of_plan(plan, nest, profile, paths))


def job_of_program(
    program: NcProgram, nest: Nest | None, profile: Technique | None = None, own_feeds: bool = False
) -> Job:
    """What a program does, as the check reads it; the nest, if there is one, tells which cuts come in from the edge.

    With a profile, small holes are cut as slowly as it has them cut, and where it lets the torch begin in older kerfs
    nothing is pierced there. With `own_feeds` every path takes as long as the program's own F words and G4 say, and
    piercing as long as the profile's machine does it for, where its dialect leaves that to the machine.
    """
    starts = [burn.path.start for burn in program.burns]
    edge_starts = [False] * len(starts) if nest is None else outside(nest, starts)
    if profile is not None and profile.kerf_starts:
        edge_starts = [a or b for a, b in zip(edge_starts, _starts_in_older_kerfs(program, starts), strict=True)]
    shares = [1.0] * len(starts)
    if profile is not None and nest is not None and not own_feeds:
        shares = _small_hole_shares(program, nest, profile)
    runs = []
    holes = at_holes(program)
    for burn, edge_start, hole, share in zip(program.burns, edge_starts, holes, shares, strict=True):
        pierced = not (edge_start or hole)
        share *= burn.lean_share if burn.tilted else 1.0
        run = Run(burn.path, burn.tool != 0, pierced, burn.travels_mm, burn.wait_s, None, None, share)
        run = replace(run, unlit_mm=burn.unlit_mm, standing_s=0.0 if hole else None)
        if own_feeds:
            run = replace(run, moving_s=burn.moving_s, standing_s=burn.held_s + burn.pierce_s + burn.paused_s)
        runs.append(run)
    return Job(tuple(runs), program.homing_mm, program.blocks)


def time_program(program: NcProgram, nest: Nest | None, profile: Technique) -> Timed:
    """The times of a program by the model of the profile: by its own words where that is the constant feed."""
    return time_job(job_of_program(program, nest, profile, own_feeds=profile.time.model == "constant"), profile)


def read_program(
    text: str, nest: Nest, profile: Technique, file: str = "", trusted: Trusted | None = None
) -> NcProgram:
    """A program as the check reads it, on the profile's machine, in the coordinates of the nest's drawing.

    Raises InputError with the line, for what is malformed or not understood.
    """
    return read_on_machine(text, nest, profile, file, trusted)


def with_times(plan: Plan, nest: Nest, profile: Technique) -> Plan:
    """The plan with the times of its program by the model of the profile, which it then states."""
    timed = time_job(job_of_plan(plan, nest, profile), profile)
    spans, pierced = iter(timed.times.spans), plan.sequence().pierced
    cuts: list[PlannedCut] = []
    pierces, begun = [], [row for row in plan.begun if row[0] <= plan.resumed_after]
    begin = end = 0.0
    for planned in plan.burns:
        order = plan.resumed_after + 1 + len(cuts)
        for pierce in pierced.pop(order, ()):
            begin, end = next(spans)
            pierces.append(replace(pierce, start_s=begin, end_s=end))
        begin, end = next(spans) if planned.cut.torch == 1 else (begin, end)
        for _ in one_after_another(planned.passes)[1:]:
            end = next(spans)[1]
        timed_cut = replace(planned, cut=replace(planned.cut, start_s=begin, end_s=end))
        if planned.cut.way:
            begun.append((order, timed_cut))
        else:
            cuts.append(timed_cut)
    totals = replace(plan.totals, time_s=timed.times.total_s)
    return replace(plan, cuts=tuple(cuts), totals=totals, time=timed.report, pierces=tuple(pierces), begun=tuple(begun))


def _stands(at: Point) -> Curve:
    """A path that goes nowhere."""
    return Curve.of([at], closed=False)


def _small_hole_shares(program: NcProgram, nest: Nest, profile: Technique) -> list[float]:
    """The share of the cut feed that the size of its hole allows each burn."""
    as_cut, shares = with_small_holes(nest, profile.hole_limits()), [1.0] * len(program.burns)
    if all(contour.feed_share == 1 for contour in as_cut.contours):
        return shares
    torch = [k for k, burn in enumerate(program.burns) if burn.tool == 0 and not burn.pierces_only]
    lines = [program.burns[k].path.line() for k in torch]
    found = Matcher(as_cut, profile.material.kerf_mm).match(lines, [False] * len(torch), [None] * len(torch))
    for k, match in zip(torch, found, strict=True):
        shares[k] = 1.0 if match is None else as_cut.contours[match.contour].feed_share
    return shares


def _starts_in_older_kerfs(program: NcProgram, starts: Sequence[Point]) -> list[bool]:
    """Whether each burn begins on the path of an earlier one."""
    burnt = [k for k, burn in enumerate(program.burns) if burn.tool == 0]
    tree = shapely.STRtree([program.burns[k].path.line() for k in burnt])
    later, earlier = tree.query(shapely.points(np.array(starts).reshape(-1, 2)), "dwithin", distance=TOLERANCE_MM)
    found = {k for k, row in zip(later.tolist(), earlier.tolist(), strict=True) if burnt[row] < k}
    return [k in found for k in range(len(starts))]


# The heat that cutting each contour leaves in the sheet, known before anything is planned: zones may have a budget.
#
# The torch leaves the profile's absorbed power in the sheet while it is on, as the simulation has it. For how long
# depends on where and how a contour is entered and, by the model `blocks`, on the length of the program: the longest
# time counts.

J_PER_KJ = 1000.0


def contour_heat_kj(nest: Nest, candidates: Sequence[Candidate], profile: Technique) -> NDArray[np.float64]:
    """The most heat that cutting each contour leaves in the sheet, kJ, (n,); none for marks.

    No plan of these candidates, and no program of it, leaves more. At constant feeds it is exact for the entry that
    takes longest, where there are no links; with them a link as long as may be counts, for outer contours.
    """
    motion, machine = _slowest(nest, candidates, profile), profile.machine
    # On an axis that takes time to stop, a path that begins elsewhere stops there instead of where it was timed from.
    law, feed_mm_s = profile.corner_feed(), machine_feeds(profile).cut_mm_s
    if isinstance(motion, ConstantFeed):
        feed_mm_s = motion.feeds.cut_mm_s
    # The corner at which a ring is opened here, and the one that a lead makes with it, which no part of it shows.
    corner_mm = 0.0 if law is None else 4 * law.reach_mm * (1 / law.share - 1)
    stop_s = motion.feeds.cut_mm_s / motion.acceleration_mm_s2 if isinstance(motion, Accelerated) else 0.0
    links = profile.link_options()
    link_s = 0.0 if links is None else motion.run_s(_straight(links.longest_mm), False)
    rounds_s: dict[int, float] = {}
    longest_s = np.zeros(len(nest.contours))
    for candidate in candidates:
        number, contour = candidate.contour, nest.contours[candidate.contour]
        if contour.kind == "mark":
            continue
        if number not in rounds_s:
            ring = compensated(contour, profile.material.kerf_mm)
            corner_s = corner_mm / (feed_mm_s * contour.feed_share)
            rounds_s[number] = motion.run_s(ring.opened_at(0.0), False, contour.feed_share) + stop_s + corner_s
        leads = (lead for lead in (candidate.lead_in, candidate.lead_out) if lead is not None)
        leads_s = sum(motion.run_s(lead, False, contour.feed_share) for lead in leads)
        on_s = rounds_s[number] + leads_s + (machine.unpierced_s if candidate.unpierced else machine.pierce_time_s)
        if contour.kind == "outer" and links is not None:
            out_s = 0.0 if candidate.lead_out is None else motion.run_s(candidate.lead_out, False, contour.feed_share)
            on_s = max(on_s, rounds_s[number] + out_s + link_s / contour.feed_share)
        longest_s[number] = max(longest_s[number], on_s)
    return np.asarray(profile.heat.absorbed_power_w * longest_s / J_PER_KJ)


def _straight(length_mm: float) -> Curve:
    return Curve.of([(0.0, 0.0), (length_mm, 0.0)], closed=False)


def _slowest(nest: Nest, candidates: Sequence[Candidate], profile: Technique) -> Motion:
    """How the machine moves through the longest program that a plan of these candidates may have.

    A program states the feed that was set, and is simulated at that: where it is lower than what the machine would
    reach, it counts.
    """
    feeds, law = machine_feeds(profile), profile.time.feed_by_blocks
    if profile.time.model != "blocks" or law is None:
        return motion_of(profile, 0)
    feed = law.mm_s(_most_blocks(nest, candidates, profile))
    return ConstantFeed(replace(feeds, cut_mm_s=min(feeds.cut_mm_s, feed)))


def _most_blocks(nest: Nest, candidates: Sequence[Candidate], profile: Technique) -> int:
    """How many blocks a program has at the most: an entry may divide a line or arc, and the torch may have to wait."""
    limit = profile.temperature_limit()
    dwells = limit is not None and limit.dwells
    paths = list(_paths(nest, candidates, profile))
    each = profile.cuts.pierce_pass is not None
    pierces = [
        Pierce("", toolpath.planned.cut.pierce, k) for k, toolpath in enumerate(paths, 1) if each and not toolpath.marks
    ]
    return count_blocks(paths, nest, profile, pierces) + (2 if dwells else 1) * len(nest.contours)


def _paths(nest: Nest, candidates: Sequence[Candidate], profile: Technique) -> Iterator[Toolpath]:
    """A path for every contour, of the candidate whose leads have most lines and arcs."""
    chosen: dict[int, Candidate] = {}
    for candidate in candidates:
        if candidate.contour not in chosen or _lead_moves(candidate) > _lead_moves(chosen[candidate.contour]):
            chosen[candidate.contour] = candidate
    for number, candidate in chosen.items():
        contour = nest.contours[number]
        cut = candidate.as_cut(contour.id)
        kerf_mm = profile.material.kerf_mm
        path, unlit = torch_path(contour, cut, kerf_mm), unlit_on(contour, cut, kerf_mm)
        planned = PlannedCut(cut, contour.part, contour.kind, candidate.cut_mm)
        yield Toolpath(planned, path, contour.kind == "mark", candidate.unpierced, contour.feed_share, unlit)


def _lead_moves(candidate: Candidate) -> int:
    return sum(len(lead.segments) for lead in (candidate.lead_in, candidate.lead_out) if lead is not None)


# What a sheet of a nest costs by the prices of the profile: plans, batches, work sheets and comparisons ask here.

_M3_PER_MM3 = 1e-9


def cost_of_plan(plan: Plan, nest: Nest, profile: Technique) -> Cost | None:
    """What one sheet of a plan costs: machine, gas, power, consumables, the sheet less its remnant, and the total.

    Where a plan goes on after a stop, that is what the rest costs: the sheet was paid before.

    Parameters
    ----------
    plan
        With its times; none is worked out again.
    nest
        As the profile has it cut.
    profile
        Whose `prices` count.

    Returns
    -------
    Cost or None
        Of one sheet, in `Cost.currency`; `Cost.total`, `Cost.parts`, `str(cost)`. None where the profile has no prices,
        or the plan says nothing of its times.

    Examples
    --------
    >>> import kerfwise
    >>> from dataclasses import replace
    >>> from kerfwise.rules.profile.plant_sections import Prices
    >>> nest = kerfwise.read_nest("examples/nests/e1x_6.json")
    >>> plan = kerfwise.solve(nest, work=2).plan
    >>> plant = replace(kerfwise.load_profile(), prices=Prices(machine_hour=80, sheet_kg=1.2))
    >>> cost = cost_of_plan(plan, nest, plant)
    >>> [name for name, amount in cost.parts]
    ['machine', 'sheet']
    """
    stock = None if plan.already_cut else nest
    return None if plan.time is None else cost_of_sheet(plan.time, plan.totals.pierces, stock, profile)


def cost_of_sheet(spent: Spent, pierces: int, nest: Nest | None, profile: Technique) -> Cost | None:
    """What one sheet costs that takes so long and so many pierces; without its nest the sheet itself is left out."""
    prices, flow = profile.prices, profile.material.gas_flow_m3_h or 0.0
    sheet, remnant = (0.0, 0.0) if nest is None else _sheet(nest, profile)
    return cost_of(spent, prices, pierces, flow, sheet, remnant)


def _sheet(nest: Nest, profile: Technique) -> tuple[float, float]:
    """What the sheet costs, and what the remnant that the profile saves is still worth."""
    prices, area_mm2 = profile.prices, nest.sheet.polygon.area
    if not (prices.sheet_kg or prices.sheet_each) or not area_mm2:
        return 0.0, 0.0
    if nest.reading is not None and nest.reading.assumed:  # nobody has stated a sheet: it has no price
        return 0.0, 0.0
    kg_per_mm2 = MATERIALS[profile.heat.material].density * profile.material.thickness_mm * _M3_PER_MM3
    whole = prices.sheet_each or area_mm2 * kg_per_mm2 * prices.sheet_kg
    side = profile.cuts.scrap.remnant
    if side is None or not prices.remnant_share:
        return whole, 0.0
    width_mm, height_mm = remnant_of(nest, profile.material.kerf_mm, side).size_mm
    return whole, whole * prices.remnant_share * width_mm * height_mm / area_mm2
