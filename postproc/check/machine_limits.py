"""What the machine cannot do: points beyond its travel, starts off the sheet, wrong links, torches too near."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import zip_longest

import numpy as np
import shapely

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Box, Point
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check.reader.program import NcProgram
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.profile.plant_sections import Torches
from kerfwise.rules.profile.values import ProfileValues

from .plan_conformance import PlanClaims
from .result import Judgement
from .torch_run import TorchRun, tolerance_mm, written_from_profile

_RULE = "within-travel"


def paths_beyond_travel(
    nest: Nest, cuts: CutSequence, runs: Sequence[TorchRun], profile: ProfileValues
) -> Iterator[Violation]:
    """Torch paths, pierces and ends of the cuts, and the home, that lie beyond what the machine reaches."""
    reach = profile.reach_on(nest)
    if reach is None:
        return
    corner = profile.frame_on(nest).corner
    if (text := _beyond([cuts.home], reach, corner)) is not None:
        yield Violation(_RULE, (), f"the machine's home is {text}")
    by_position: dict[int, list[Point]] = {k: [cut.pierce, cut.end] for k, cut in enumerate(cuts, 1)}
    for run in runs:
        points = by_position.setdefault(run.position, [])
        points += [(x, y) for line in (run.loop, *run.leads) for x, y in shapely.get_coordinates(line).tolist()]
        if (text := _beyond(points, reach, corner)) is not None:
            yield run.wrong(_RULE, f"the path of {run.name} is {text}")


def rapids_beyond_travel(nest: Nest, program: NcProgram, profile: ProfileValues) -> Iterator[Violation]:
    """Rapids of a program that lead beyond what the machine reaches."""
    reach = profile.reach_on(nest)
    if reach is None:
        return
    corner = profile.frame_on(nest).corner
    for line, at in program.rapids:
        if (text := _beyond([at], reach, corner)) is not None:
            yield Violation(_RULE, (), f"line {line}: the way without torch leads {text}")


def _beyond(points: Iterable[Point], reach: Box, corner: Point) -> str | None:
    """How far, and where, the worst of the points is beyond the reach; None if none is."""
    x0, y0, x1, y1 = reach
    off = [(max(x0 - x, x - x1, y0 - y, y - y1), x, y) for x, y in points]
    off_mm, x, y = max(off, default=(-math.inf, 0.0, 0.0))
    if off_mm <= tolerance_mm():
        return None
    return f"{off_mm:.1f} mm out of the machine's travel, at ({x - corner[0]:.1f}, {y - corner[1]:.1f}) of the machine"


# Starts off the sheet: lawful only where the profile allows them, at an edge that somebody has stated.

_EDGE_START_RULE = "edge-start"


def edge_starts(nest: Nest, runs: Sequence[TorchRun], profile: ProfileValues) -> Iterator[Violation]:
    """Cuts that begin off the sheet although no edge start is allowed there."""
    torch = [run for run in runs if not run.marks and not run.linked]
    why = forbidden(nest, profile)
    if why is None or not torch:
        return
    starts = np.array([(run.lead_in if run.lead_in is not None else run.loop).coords[0][:2] for run in torch])
    sheet = shapely.make_valid(nest.sheet.polygon)
    beyond_mm = shapely.distance(sheet, shapely.points(starts))
    for k in np.flatnonzero(beyond_mm > tolerance_mm()).tolist():
        run, at, off_mm = torch[k], starts[k].tolist(), beyond_mm[k]
        text = f"{run.name} begins {off_mm:.1f} mm off the sheet, at ({at[0]:.2f}, {at[1]:.2f}): {why}"
        yield run.wrong(_EDGE_START_RULE, text)


def forbidden(nest: Nest, profile: ProfileValues) -> str | None:
    """Why no cut may begin off this sheet; None where it may."""
    if not profile.leads.edge_start:
        return "the profile allows no edge start (leads.edge_start)"
    if not nest.sheet.stated:
        return "nobody has stated where the sheet's edge is"
    if None in (profile.machine.travel_x_mm, profile.machine.travel_y_mm):
        return "the profile does not say how far the torch can go (machine.travel_x, machine.travel_y)"
    return None


def run_up_mm(nest: Nest, profile: ProfileValues) -> float:
    """How far off this sheet a cut may begin: as far as the longest lead goes from its kerf; 0 where it may not."""
    if forbidden(nest, profile) is not None:
        return 0.0
    return profile.material.kerf_mm + profile.length_mm(profile.leads.lead_in_mm)


# Cuts that several torches make together: what they are to be, and judgements in which none of them is the first.

_TORCHES_RULE = "torches"
_TIME_S = 0.01
_TOLD = re.compile(r"TORCHES (?P<count>\d+), (?P<spacing>\d+(?:\.\d+)?) MM APART ALONG (?P<axis>[XY])", re.IGNORECASE)


def stricter(one: Sequence[Judgement], *others: Sequence[Judgement]) -> list[Judgement]:
    """Of each judgement the strictest: what is cut at one time counts as cut in whichever order is worse."""
    found = []
    for judgement in one:
        same = (j for more in others for j in more if j.id == judgement.id)
        found.append(max((judgement, *same), key=_weight))
    return found


def _weight(judgement: Judgement) -> tuple[bool, bool, int]:
    return not judgement.holds, judgement.unjudged is not None, len(judgement.excused)


def torch_count(cuts: Sequence[Cut]) -> int:
    """How many torches make cuts together, at the most."""
    return max((cut.torch for cut in cuts), default=1)


def wrong_torch_cuts(cuts: CutSequence, profile: ProfileValues) -> Iterator[Violation]:
    """Cuts of further torches that are not those of the first one, shifted by what the torches are apart."""
    torches, kerf_mm = profile.machine.torches, profile.material.kerf_mm
    first = {cut.contour: (k, cut) for k, cut in enumerate(cuts, 1) if cut.torch == 1}
    for position, cut in enumerate(cuts, 1):
        if cut.torch == 1:
            continue
        text = None
        leader_at, leader = first.get(cut.together, (0, cut))
        between = cuts[leader_at : position - 1]
        if cut.torch > torches.count:
            have = "one torch" if torches.count == 1 else f"{torches.count} torches"
            text = f"is made by torch {cut.torch}, the profile has {have}"
        elif not leader_at:
            text = f"is to be made together with {cut.together or 'nothing'}, which torch 1 does not cut"
        elif any(one.together != cut.together or one.torch >= cut.torch for one in between) or leader_at > position:
            text = f"does not follow {leader.contour}, with which it is made"
        elif (off_mm := _apart_mm(cut, leader, torches)) > tolerance_mm(kerf_mm) or cut.direction != leader.direction:
            x, y = torches.shift(cut.torch)
            text = f"is not the cut of {leader.contour} shifted by ({x:g}, {y:g}): it is {off_mm:.2f} mm off"
        elif max(abs(cut.start_s - leader.start_s), abs(cut.end_s - leader.end_s)) > _TIME_S:
            text = f"has other times than {leader.contour}, with which it is made"
        if text is not None:
            yield Violation(_TORCHES_RULE, (cut.contour,), f"cut {position} of {cut.contour} {text}", (position,))


def _apart_mm(cut: Cut, leader: Cut, torches: Torches) -> float:
    """How far the leads and the entry are from those of the first torch, shifted."""
    rows = zip_longest(_points(cut), _points(leader))
    shift = np.array(torches.shift(cut.torch))
    apart = [
        math.inf if a is None or b is None else float(np.hypot(*(np.array(a) - np.array(b) - shift))) for a, b in rows
    ]
    return max(apart)


def _points(cut: Cut) -> list[tuple[float, float]]:
    def of(lead: Curve | None) -> list[tuple[float, float]]:
        return [] if lead is None else [(x, y) for x, y in lead.vertices[:, :2].tolist()]

    return [cut.entry, cut.pierce, *of(cut.lead_in), *of(cut.lead_out)]


def wrong_spacing(program: NcProgram, profile: ProfileValues, told_by_plan: bool) -> Iterator[Violation]:
    """Where a program does not say that it is for the profile's torches, though it lights several.

    One that says nothing may have a plan, which the program is held against.
    """
    torches = profile.machine.torches
    has = f"{torches.count} {torches.apart}" if torches.several else "one"
    spacing = _told(program)
    for words in spacing:
        spacing_mm, axis = float(words["spacing"]), words["axis"].lower()
        there = profile.at_spacing(spacing_mm).machine.torches
        same = abs(spacing_mm - there.spacing_mm) <= 1e-3 and axis == there.axis and there.up_to_mm is None
        same = same and words["spacing"] == spacing[0]["spacing"]
        if not same or int(words["count"]) != torches.count:
            says = f"{words['count']} torches {spacing_mm:g} mm apart along {axis.upper()}"
            yield Violation(_TORCHES_RULE, (), f"the program is for {says}, the profile has {has}")
    lit = next((burn for burn in program.burns if burn.torches), None)
    if lit is not None and not spacing and not told_by_plan:
        text = f"line {lit.line}: torch {lit.torches[0]} burns too, and no comment says how far it is from the first: "
        yield Violation(_TORCHES_RULE, (), f"{text}expected {_comment(torches)}, or --plan")


def stated_spacing(program: NcProgram, planned: PlanClaims | None, torches: Torches) -> float | None:
    """How far torches stand apart by the program's comment, else by its plan; None where neither says."""
    for words in _told(program):
        return float(words["spacing"])
    return None if planned is None else planned.cuts.spacing_mm(torches.axis)


def _told(program: NcProgram) -> list[re.Match[str]]:
    return [found for found in map(_TOLD.fullmatch, program.comments) if found]


def _comment(torches: Torches) -> str:
    spacing = f"{torches.spacing_mm:g}" if torches.up_to_mm is None else "…"
    return f"(TORCHES {torches.count}, {spacing} MM APART ALONG {torches.axis.upper()})"


# Links: what the torch burns of waste from one contour to the next, without going off.

_LINK_RULE = "links"
_CORNERS_MM = 1.0
"""Leads are longer than the profile says by what their arcs and the places where they meet the ring add."""
_OTHERS_MM = 25.0
"""How much longer leads of programs may be that were not written from the profile: what others do is no fault yet."""


def bad_links(runs: Sequence[TorchRun], kerf_mm: float, longest_mm: float) -> Iterator[Violation]:
    """Links that the profile does not allow, and those that cross a kerf that was burnt before.

    At both ends a link is in the kerf of the contour that it leaves, and of the one that it leads to.
    """
    linked = [k for k, run in enumerate(runs) if run.linked and k]
    if not linked:
        return
    lines = [(k, line) for k, run in enumerate(runs) if not run.marks for line in (run.loop, *run.leads)]
    tree = shapely.STRtree([line for _, line in lines])
    half_mm, within_mm = kerf_mm / 2, tolerance_mm(kerf_mm)
    for k in linked:
        run, before = runs[k], runs[k - 1]
        link = run.lead_in
        if link is None:
            continue
        length_mm = float(link.length)
        way = f"the link from {before.name} to {run.name}"
        place = f"at ({link.coords[0][0]:z.1f}, {link.coords[0][1]:z.1f})"
        names = tuple(dict.fromkeys(r.contour.id for r in (before, run) if r.contour is not None))
        if length_mm > longest_mm + within_mm:
            text = f"{way} {place} is {length_mm:.1f} mm long: the profile allows "
            text += f"{longest_mm:g} mm" if longest_mm > 0 else "no links"
            yield run.wrong(_LINK_RULE, f"{text} (cuts.links.longest)", *names)
            continue
        ends = shapely.buffer(shapely.points([link.coords[0], link.coords[-1]]), kerf_mm)
        left = [before.loop, *(() if before.linked else before.leads)]  # as a lead-out may, beside its own lead-in
        rings = shapely.buffer([*left, run.loop], half_mm + within_mm)
        free = shapely.difference(link, shapely.union_all([*ends, *rings]))
        if free.is_empty:
            continue
        for number in sorted(tree.query(free, "dwithin", distance=half_mm - within_mm).tolist()):
            other, line = lines[number]
            if other < k and all(line is not one for one in left):
                x, y = shapely.get_coordinates(shapely.shortest_line(free, line))[0].tolist()
                text = f"{way} crosses the kerf of {runs[other].name} ({runs[other].where}), at ({x:z.1f}, {y:z.1f})"
                yield run.wrong(_LINK_RULE, text, *names)
                break


def long_leads(
    runs: Sequence[TorchRun], profile: ProfileValues, comments: Iterable[str], run_up_mm: float
) -> Iterator[Violation]:
    """Where the torch stays lit before or behind a contour for longer than a lead or an overcut asks for.

    What it burns there of its own ring again is told as that. `run_up_mm` is how far off the sheet a cut may begin.
    """
    ours = written_from_profile(comments)
    leads, kerf_mm = profile.leads, profile.material.kerf_mm
    more_mm = 2 * kerf_mm + _CORNERS_MM + (0.0 if ours else _OTHERS_MM)
    in_mm = 1.6 * max(profile.length_mm(leads.lead_in_mm), leads.lead_in_min_mm) + run_up_mm + more_mm
    out_mm = max(profile.length_mm(leads.hole_overcut_mm), leads.lead_out_length_mm) + more_mm
    within_mm = tolerance_mm(kerf_mm)
    for run in runs:
        if run.marks or run.contour is None or not run.contour.encloses:
            continue
        for what, lead, most_mm in (("before", run.lead_in, in_mm), ("behind", run.lead_out, out_mm)):
            if lead is None or lead.length <= most_mm or (what == "before" and run.linked):
                continue
            again_mm = float(lead.intersection(shapely.buffer(run.loop, within_mm)).length)
            text = f"the torch is lit for {lead.length:.1f} mm {what} {run.name}"
            if again_mm > most_mm:
                text += f", {again_mm:.1f} mm of them once more along it"
            yield run.wrong(_LINK_RULE, f"{text}; the profile's leads and overcuts ask for {most_mm:.1f} mm")
