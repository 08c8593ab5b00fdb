"""How a program has the machine run: feeds, corners, waits, and the heat that this brings into the sheet."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import ops

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import Cut, CutSequence, HotSpot
from kerfwise.encoder.geometry.segment import Point, Segment
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.torch_path import chords
from kerfwise.postproc.check.reader.controls import Control
from kerfwise.postproc.check.reader.program import Burn, NcProgram, at_holes, expand_torches
from kerfwise.postproc.check.reader.read_program import control_of
from kerfwise.postproc.dialects import fitting_dialect, pierce_dwell_of
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.options.quantities import length_at
from kerfwise.rules.profile.technique import Technique

from .result import Judgement
from .small_features import Shares
from .torch_run import TorchRun, judgement, step_mm, tolerance_mm, written_from_profile

_FEED_SHARE, _WAIT_S, _POWER = 1e-3, 2e-3, 0.51


def judge_running(
    nest: Nest,
    program: NcProgram,
    profile: Technique,
    runs: Sequence[TorchRun] = (),
    shares: Mapping[str, Shares] | None = None,
    in_kerfs: Collection[tuple[str, int]] = (),
) -> list[Judgement]:
    """What a program does with the machine.

    `runs` say which contour each burn follows, `shares` at which shares of the cut feed a small hole may be cut. Burns
    that are `in_kerfs` ("line 40", and the torch) begin in the kerf of an older one, where there is nothing to pierce.
    """
    control, _ = control_of(profile)
    found = {
        "torch-off-travel": [
            (hot.line, f"the torch is on during a rapid of {hot.length_mm:.1f} mm") for hot in program.hot_rapids
        ],
        "program-state": [],
        "feeds": list(_feeds(program, profile, control, runs, shares or {})),
        "pierce-delay": list(_waits(nest, program, profile, in_kerfs, control)),
        "returns-home": list(_home(program, profile.home_on(nest))),
    }
    corner = profile.frame_on(nest).corner
    if program.zero is not None and math.dist(program.zero, corner) > tolerance_mm():
        said, is_at = (f"({x:g}, {y:g})" for x, y in (program.zero, corner))
        text = f"it says that its zero is at {said} of the drawing, by its origin it is at {is_at}"
        found["program-state"].append((0, text))
    found["program-state"] += _powers(program, profile, control)
    for fault in program.faults:
        found[fault.rule].append((fault.line, fault.text))
    return [
        judgement(rule, [Violation(rule, (), f"line {line}: {text}" if line else text) for line, text in sorted(lines)])
        for rule, lines in found.items()
    ]


def _feeds(
    program: NcProgram,
    profile: Technique,
    control: Control,
    runs: Sequence[TorchRun],
    shares: Mapping[str, Shares],
) -> Iterator[tuple[int, str]]:
    machine, slack = profile.machine, control.feed_step_mm_min / 120
    rounded = _share_of_steps(profile)
    names: dict[str, list[str]] = defaultdict(list)
    for run in runs:
        names[run.where].append(run.contour.id if run.contour is not None else "")
    for burn in program.burns:
        cuts, cut = burn.tool == 0, names[f"line {burn.line}"] or [""]
        name = cut[0]
        feed_mm_s = machine.cut_feed_mm_s if cuts else machine.mark_feed_mm_s
        allowed = [shares.get(one, (1.0, 1.0)) if cuts else (1.0, 1.0) for one in cut]
        low, high = feed_mm_s * min(least for least, _ in allowed), feed_mm_s * max(most for _, most in allowed)
        if low < feed_mm_s:
            low, high = max(low - rounded * feed_mm_s, 0.0), min(high + rounded * feed_mm_s, feed_mm_s)
        if cuts and slow_at_corners(profile):
            for text in wrong_at_corners(burn, (low, high), profile, slack):
                yield burn.line, text
            continue
        for feed in burn.feeds_mm_s:
            if not low * (1 - _FEED_SHARE) - slack <= feed <= high * (1 + _FEED_SHARE) + slack:
                where = f" in {name}" if high < feed_mm_s else ""
                says = f"the profile says {high * 60:.0f} mm/min{where}"
                yield burn.line, f"it {'cuts' if cuts else 'marks'} at {feed * 60:.0f} mm/min, {says}"
    ours = written_from_profile(program.comments) and not fitting_dialect(profile).travels_as_line
    for slow in program.slow_travel if ours else ():  # in a program of somebody else it is travel
        yield slow.line, f"it travels {slow.length_mm:.1f} mm at cutting feed with the torch off"


def _share_of_steps(profile: Technique) -> float:
    """By how much the share of the feed in a small hole may be off, whose diameter is known to two steps only."""
    limits = profile.hole_limits()
    span_mm = limits.full_feed_mm - limits.least_mm
    return 2 * step_mm() * (1 - limits.feed_share) / span_mm if span_mm > 0 else 0.0


def _powers(program: NcProgram, profile: Technique, control: Control) -> Iterator[tuple[int, str]]:
    """Powers of a laser that are not the profile's, where that says one; else the dialect's, in programs from it."""
    material, full = profile.material, control.full_power
    if not full:
        return
    pierces = material.power if material.pierce_power is None else material.pierce_power
    own = fitting_dialect(profile).powers if written_from_profile(program.comments) else None
    words: Mapping[str, float] = {} if own is None else {"cut": own.cut, "pierce": own.pierce, "mark": own.mark}
    for burn in program.burns:
        cuts = burn.tool == 0
        asked = (
            ("cuts", "cut", burn.powers, material.power)
            if cuts
            else ("marks", "mark", burn.powers, material.mark_power),
            ("pierces", "pierce", burn.pierce_powers, pierces)
            if cuts
            else ("starts to mark", "mark", burn.pierce_powers, material.mark_power),
        )
        for does, kind, powers, share in asked:
            right = words.get(kind) if share is None else full * share / 100
            for power in powers if right is not None else ():
                if abs(power - (right or 0.0)) > _POWER:
                    by = "the dialect has" if share is None else f"the profile says {share:g} %,"
                    yield burn.line, f"it {does} with S{power:g}, {by} S{right:g}"


def _waits(
    nest: Nest, program: NcProgram, profile: Technique, in_kerfs: Collection[tuple[str, int]], control: Control
) -> Iterator[tuple[int, str]]:
    """Pierces too short or too long, of each torch: one may be over metal where another is off the sheet's edge.

    A torch that comes in from the edge pierces nothing, but may preheat. The dialect's own words may wait, too.
    """
    program = expand_torches(program, profile.machine.torches.shift)
    burns = program.burns
    if not burns:
        return
    machine = profile.machine
    waits = pierce_dwell_of(profile) == "program"
    cooling_s, flame = longest_dwell_s(profile) + control.rests_s, machine.process == "oxyfuel"
    preheat_s = machine.edge_preheat_s or (machine.pierce_time_s if flame else 0.0)
    points = shapely.points(np.array([burn.path.vertices[0, :2] for burn in burns]))
    sheet = shapely.make_valid(nest.sheet.polygon)
    inside, near = (shapely.contains(shapely.buffer(sheet, by), points) for by in (-tolerance_mm(), tolerance_mm()))
    passes = profile.cuts.pierce_pass is not None
    holes = at_holes(program) if passes else [False] * len(burns)
    for burn, pierced, maybe, hole in zip(burns, inside.tolist(), near.tolist(), holes, strict=True):
        marks, in_kerf = burn.tool != 0, (f"line {burn.line}", burn.torch) in in_kerfs
        start_s = {machine.pierce_time_s} if pierced and not in_kerf else {preheat_s}
        start_s |= {machine.pierce_time_s} if maybe and not in_kerf else set()
        start_s = {preheat_s if flame else 0.0} if hole else start_s
        allowed = ({machine.mark_time_s} if marks else start_s) if waits else {0.0 if marks else control.stands_s}
        if all(abs(burn.pierce_s - s) > _WAIT_S for s in allowed):
            says, torch = " or ".join(f"{s:g} s" for s in sorted(allowed)), _torch(burn)
            yield burn.line, f"{torch} stands for {burn.pierce_s:g} s before it moves, the profile asks for {says}"
        if burn.torch > 1:  # it waits with the first
            continue
        if burn.wait_s > cooling_s + _WAIT_S:
            most = f"{cooling_s:g} s at most" if cooling_s else "no such wait"
            yield burn.line, f"the torch waits for {burn.wait_s:g} s before it is lit, the profile allows {most}"
        if burn.paused_s > 0:
            yield burn.line, f"the torch stands still for {burn.paused_s:g} s in the middle of its path"


def _torch(burn: Burn) -> str:
    return "the torch" if burn.torch == 1 else f"torch {burn.torch}"


def longest_dwell_s(profile: Technique) -> float:
    """How long the torch may wait for metal to cool, off, s."""
    limit = profile.temperature_limit()
    return 0.0 if limit is None else limit.allowed_dwell_s


def _home(program: NcProgram, home: Point) -> Iterator[tuple[int, str]]:
    if math.dist(program.end, home) > tolerance_mm():
        x, y = program.end
        yield 0, f"the program ends at ({x:.3f}, {y:.3f}), the machine's home is ({home[0]:g}, {home[1]:g})"


# Feeds at corners, as the check finds them: in the lines and arcs of a program, without the planner's own stretches.
#
# Where a program's digits leave open whether a path turns far enough, or where exactly a stretch ends, both feeds may
# stand.

_LEAST_MM, _MOST_MM = 0.01, 0.03
"""Shorter lines and arcs make no corners; what lies between the two may."""
_ANGLE_DEG, _ROUNDED_MM = 1.0, 0.005
_PLACE_MM, _STEP_MM = 0.15, 0.5
_CORNER_FEED_SHARE = 1e-3


def slow_at_corners(profile: Technique) -> bool:
    """Whether the profile has corners cut more slowly."""
    return profile.corners.corner_feed < 1 and _reach_mm(profile) > 0


def wrong_at_corners(
    burn: Burn, asked_mm_s: tuple[float, float], profile: Technique, slack_mm_s: float = 0.0
) -> Iterator[str]:
    """What is wrong with the feeds of a burn, `asked_mm_s` being the least and the greatest away from corners.

    A control of whole feeds rounds them by `slack_mm_s`.
    """
    segments, feeds = burn.path.segments, burn.step_feeds_mm_s
    ends_mm = np.concatenate([[0.0], np.cumsum([s.length_mm for s in segments])])
    sure, maybe = (np.array(list(found)) for found in _corners(segments, ends_mm, profile.corners.corner_angle))
    share, reach_mm = profile.corners.corner_feed, _reach_mm(profile)
    place_mm = _PLACE_MM + 2 * step_mm()
    low, high = asked_mm_s[0] * (1 - _CORNER_FEED_SHARE), asked_mm_s[1] * (1 + _CORNER_FEED_SHARE)
    for k, feed in enumerate(feeds):
        at_mm = _samples(ends_mm[k], ends_mm[k + 1])
        slow = low * share - slack_mm_s <= feed <= high * share + slack_mm_s
        full = low - slack_mm_s <= feed <= high + slack_mm_s
        if slow and full:
            continue
        if full:
            bad = at_mm[_apart_mm(at_mm, sure) < reach_mm - place_mm]
            says = f"{high / (1 + _CORNER_FEED_SHARE) * share * 60:.0f} mm/min near this corner"
        elif slow:
            bad = at_mm[_apart_mm(at_mm, maybe) > reach_mm + place_mm]
            says = f"{high / (1 + _CORNER_FEED_SHARE) * 60:.0f} mm/min, no corner being near"
        else:
            bad, says = at_mm[:1], f"{low * 60:.0f} mm/min, {share:g} of it at corners"
        if len(bad):
            x, y = burn.path.point_at(float(bad[0]))
            yield f"it cuts at {feed * 60:.0f} mm/min at ({x:.2f}, {y:.2f}), the profile says {says}"
            return


def slowness_of(points: Floats, profile: Technique) -> Floats | None:
    """How many times longer each step (k - 1,) of a plan's path of chords (k, 2) takes; None where all are alike."""
    if not slow_at_corners(profile) or len(points) < 3:
        return None
    steps_mm = np.hypot(*np.diff(points, axis=0).T)
    ends_mm = np.concatenate([[0.0], np.cumsum(steps_mm)])
    lines = [Segment(*pair) for pair in pairwise((x, y) for x, y in points.tolist())]
    known = [(line, end) for line, end in zip(lines, ends_mm.tolist(), strict=False) if line.length_mm > _MOST_MM]
    limit = profile.corners.corner_angle
    at_mm = np.array([end for (a, _), (b, end) in pairwise(known) if _turn_deg(a, b) >= limit - _ANGLE_DEG])
    if not len(at_mm):
        return None
    reach_mm = _reach_mm(profile)  # a long step is partly near a corner at each of its ends
    near_mm = np.zeros(len(steps_mm))
    for at in at_mm.tolist():
        near_mm += np.clip(np.minimum(ends_mm[1:], at + reach_mm) - np.maximum(ends_mm[:-1], at - reach_mm), 0.0, None)
    slow = np.clip(near_mm / np.maximum(steps_mm, 1e-12), 0.0, 1.0)
    return np.asarray(1.0 + slow * (1.0 / profile.corners.corner_feed - 1.0))


def _reach_mm(profile: Technique) -> float:
    return length_at(profile.corners.corner_reach, profile.material.thickness_mm)


def _corners(segments: tuple[Segment, ...], ends_mm: Floats, limit_deg: float) -> tuple[set[float], set[float]]:
    """Where the path surely turns as far as a corner does, and where it may, mm along it."""
    found = []
    rounded_mm = max(_ROUNDED_MM, step_mm() / math.sqrt(2))
    for least_mm in (_LEAST_MM, _MOST_MM + 2 * step_mm()):
        sure: set[float] = set()
        maybe: set[float] = set()
        known = [(s, at) for s, at in zip(segments, ends_mm.tolist(), strict=False) if s.length_mm > least_mm]
        for (before, _), (after, at) in pairwise(known):
            turn_deg = _turn_deg(before, after)
            shortest_mm = min(before.length_mm, after.length_mm)
            off_deg = _ANGLE_DEG + math.degrees(2 * rounded_mm / shortest_mm)
            if turn_deg >= limit_deg + off_deg:
                sure.add(at)
            if turn_deg >= limit_deg - off_deg:
                maybe.add(at)
        found.append((sure, maybe))
    (sure_a, maybe_a), (sure_b, maybe_b) = found
    return sure_a & sure_b, maybe_a | maybe_b


def _samples(begin_mm: float, end_mm: float) -> Floats:
    """Places along a line or arc, its ends among them."""
    return np.linspace(begin_mm, end_mm, max(3, math.ceil((end_mm - begin_mm) / _STEP_MM) + 1))


def _apart_mm(at_mm: Floats, corners_mm: Floats) -> Floats:
    """How far each place is from the nearest corner along the path."""
    if not len(corners_mm):
        return np.full(len(at_mm), np.inf)
    return np.asarray(np.abs(at_mm[:, None] - corners_mm[None, :]).min(axis=1))


def _turn_deg(before: Segment, after: Segment) -> float:
    (ax, ay), (bx, by) = before.tangent_at(1.0), after.tangent_at(0.0)
    return math.degrees(abs(math.atan2(ax * by - ay * bx, ax * bx + ay * by)))


# What the torch does to the sheet, as the check has read it: for whoever simulates temperatures.
#
# The check judges t-max without a line of the models: it hands its own reading of the plan or program to a
# thermometer and takes back temperatures, as a shop measures a sheet that it did not plan. The physics behind the
# thermometer is that of `kerfwise heat`. A second heat equation would prove nothing: the limit is meant for the
# figures of this one, which has tests of its own against solutions in closed form and against its energies.

_CHORD_MM = 0.05


@dataclass(frozen=True, eq=False, slots=True)
class Heating:
    """One stretch with the torch on: it stands at the first of `points` (k, 2), mm, for `pierce_s`, then moves evenly.

    Where `slowness` (k - 1,) is given, each step takes so many times longer. `cut_s` is when the cut that it belongs to
    begins by the plan's, or the program's, own clock.
    """

    name: str
    points: NDArray[np.float64]
    begin_s: float
    end_s: float
    pierce_s: float
    cut_s: float
    slowness: NDArray[np.float64] | None = None


Thermometer = Callable[[Sequence[Heating]], tuple[HotSpot, ...] | None]
"""Simulates the sheet: the hottest place of each stretch, None where times contradict each other."""


def measured(cuts: CutSequence, heatings: Iterator[Heating], thermometer: Thermometer | None) -> CutSequence:
    """The cuts with the temperatures that they lead to, where there is a thermometer."""
    if thermometer is None:
        return cuts
    stretches = list(heatings)
    spots = thermometer(stretches)
    if spots is None:
        return cuts
    timed = (replace(spot, at_s=stretch.cut_s) for spot, stretch in zip(spots, stretches, strict=True))
    return replace(cuts, hot_spots=tuple(timed))


def heatings_of_cuts(
    nest: Nest, cuts: CutSequence, runs: Sequence[TorchRun], profile: Technique, unpierced: Collection[int] = ()
) -> Iterator[Heating]:
    """The stretches of a plan, at the times that it states; marks heat nothing worth speaking of.

    The cuts at the positions `unpierced` begin in an old kerf, where the torch does not stand for a pierce.
    """
    machine, pierced = profile.machine, cuts.pierced
    holes = {hole.contour for hole in cuts.pierces}
    for run in runs:
        for hole in pierced.get(run.position, ()):
            yield Heating(hole.contour, np.array([hole.at]), hole.start_s, hole.end_s, 0.0, hole.start_s)
        if run.marks or run.contour is None:
            continue
        cut = cuts[run.position - 1]
        points = np.concatenate([shapely.get_coordinates(line) for line in _in_order(run, cut)])
        pierced_here = run.position not in unpierced and bool(shapely.contains_xy(nest.sheet.polygon, *cut.pierce))
        pierce_s = machine.pierce_time_s if pierced_here else _preheat_s(profile)
        cold = profile.machine.process == "oxyfuel"
        pierce_s = _preheat_s(profile) * cold if cut.contour in holes else pierce_s
        pierce_s = 0.0 if cut.linked else pierce_s
        end_s = max(cut.start_s, cut.end_s)
        yield Heating(run.name, points, cut.start_s, end_s, pierce_s, cut.start_s, slowness_of(points, profile))


def heatings_of_program(program: NcProgram) -> Iterator[Heating]:
    """The stretches of a program at its own feeds, with the waits that it makes or leaves to the machine."""
    for burn in program.burns:
        if burn.tool == 0:
            points, slowness = chords(burn.path, burn.paced, _CHORD_MM)
            stood_s = burn.held_s + burn.pierce_s
            yield Heating(f"line {burn.line}", points, burn.start_s, burn.end_s, stood_s, burn.start_s, slowness)


def _preheat_s(profile: Technique) -> float:
    """How long the torch stands where it pierces nothing: a flame heats the edge at least as long as for a pierce."""
    machine = profile.machine
    return machine.edge_preheat_s or (machine.pierce_time_s if machine.process == "oxyfuel" else 0.0)


def _in_order(run: TorchRun, cut: Cut) -> Iterator[shapely.LineString]:
    """Lead-in, the ring once round from where the torch joins it, the way the cut goes, lead-out."""
    if run.lead_in is not None:
        yield run.lead_in
    ring = run.loop
    if run.partial or (run.contour is not None and not run.contour.curve.closed):
        yield ring
        yield from () if run.lead_out is None or not run.partial else (run.lead_out,)
        return
    if shapely.is_ccw(shapely.LinearRing(ring)) != (cut.direction == "ccw"):
        ring = ring.reverse()
    first = shapely.get_point(run.lead_in, -1) if run.lead_in is not None else shapely.Point(cut.pierce)
    along_mm = ring.project(first)
    yield from (ops.substring(ring, a, b) for a, b in ((along_mm, ring.length), (0.0, along_mm)) if b > a)
    if run.lead_out is not None:
        yield run.lead_out
