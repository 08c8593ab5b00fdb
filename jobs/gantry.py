"""What a plan has beside the cuts of its route: those of further torches on a gantry, pierce passes, and its times."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby, pairwise

from kerfwise.encoder.cut import Cut, Pierce, Tab
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.compute import first_torch_facts, with_zones_of_first
from kerfwise.encoder.facts.facts import Copies, Facts
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.identical_parts import Group, copies_of, groups_of, spacings_of
from kerfwise.encoder.nest import Nest
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.engines.tuning import PASS_WORK as WORK
from kerfwise.models.engines.tuning import WORK_SHARE
from kerfwise.models.plan.make_plan import excuses as excused
from kerfwise.models.plan.plan import IN_PASS, Plan, PlannedCut
from kerfwise.postproc.clock import with_times
from kerfwise.postproc.nc.toolpaths import outside
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.stating.state_rules import Stated, too_much_at_once

_LOOKED_AT = 40
"""Distances between copies that are tried for torches, at the most."""


def first_groups(nest: Nest, profile: Profile) -> list[Group]:
    """The contours that torches would cut together by their outlines alone.

    Raises InputError if no part has a copy as far away as the torches are apart.
    """
    torches = profile.machine.torches
    if not torches.several:
        return []
    found = groups_of(nest, copies_of(nest, torches.step, torches.count), torches.step)
    if not found and nest.contours:
        most = "" if torches.up_to_mm is None else f" to {torches.up_to_mm:g}"
        where = f"{torches.spacing_mm:g}{most} mm along {torches.axis}"
        raise InputError(
            f"machine.torches.spacing: no part of {nest.file or 'the nest'} has a copy {where} from it, so that no two "
            "torches could cut together (parts with marks count for none): say another spacing, or count: 1",
            file=profile.file or None,
        )
    return _without_placed(nest, profile, found)


def with_best_spacing(nest: Nest, profile: Profile) -> Profile:
    """The profile with its torches as far apart as leaves the fewest cuts, where they can be moved; the least of such.

    By outlines alone: what rules have cut by itself is not known yet. Of distances those are looked at that most parts
    are apart by.
    """
    torches = profile.machine.torches
    if not torches.several or torches.up_to_mm is None:
        return profile
    best: tuple[int, float] | None = None
    for spacing_mm in spacings_of(nest, torches.axis, torches.spacing_mm, torches.up_to_mm)[:_LOOKED_AT]:
        step = profile.at_spacing(spacing_mm).machine.torches.step
        groups = groups_of(nest, copies_of(nest, step, torches.count), step)
        saved = sum(len(group.contours) - 1 for group in groups)
        best = min(best or (0, spacing_mm), (-saved, spacing_mm))
    return profile if best is None else profile.at_spacing(best[1])


def _without_placed(nest: Nest, profile: Profile, groups: list[Group]) -> list[Group]:
    """The groups without parts that a lock gives a place, or an order: these are cut by themselves."""
    placed = [lock for lock in profile.locks if lock.contour and (lock.before is not None or lock.position is not None)]
    names = {name for lock in placed for name in (lock.contour, lock.before) if name in nest.index}
    parts = {nest.contour(name).part for name in names if name is not None}
    left = [group for group in groups if parts.isdisjoint(nest.parts[k].id for k in group.parts)]
    if groups and not left:
        raise InputError(
            "machine.torches: all parts that torches could cut together have locks of an order or a place, and are cut "
            "one by one: take locks out, or say machine: {torches: {count: 1}}",
            file=profile.file or None,
        )
    return left


def drop_parts(groups: Sequence[Group], without: Sequence[Group]) -> list[Group]:
    """The groups without those of some parts: a part is cut with its copy as a whole, or by itself."""
    gone = {group.parts for group in without}
    return [group for group in groups if group.parts not in gone]


def facts_of_torches(whole: Facts, groups: Sequence[Group], profile: Profile) -> Facts:
    """The facts of what the first torch cuts; groups of which a hard rule asks an order are cut one by one.

    Raises InputError if none is left.
    """
    step = profile.machine.torches.step
    why = ""
    while groups:
        facts = first_torch_facts(with_zones_of_first(whole, groups), groups, step)
        apart = too_much_at_once(facts, profile)
        if not apart:
            return facts
        assert facts.copies is not None
        own = facts.copies.number
        why = next(iter(apart.values())).sentence
        groups = drop_parts(groups, [group for group in groups if int(own[group.contours[0]]) in apart])
    raise InputError(
        "machine.torches: no two parts of the nest can be cut together"
        + (f" by the hard rules ({why})" if why else ": no pierce and lead is lawful for both")
        + ": say another spacing, or count: 1",
        file=profile.file or None,
    )


def with_further_torches(plan: Plan, facts: Facts, stated: Stated, solution: Solution) -> Plan:
    """The plan with the cuts of all torches: those of a further one follow the cut that they are made with."""
    copies = facts.copies
    if copies is None:
        return plan
    nest, excuses = copies.whole.nest, excused(facts, stated, solution.route)
    together = {nest.contours[group.contours[0]].id: group for group in copies.groups}
    cuts: list[PlannedCut] = []
    for planned in plan.cuts:
        group = together.get(planned.cut.contour)
        others = () if group is None else group.contours[1:]
        names = [nest.contours[k].id for k in others]
        because = planned.because
        if names:
            because = (*because, f"cut together with {' and '.join(names)}: by {len(names) + 1} torches")
        cuts.append(replace(planned, because=because))
        cuts += [_of_torch(planned, copies, k, torch, excuses) for torch, k in enumerate(others, 2)]
    ways = (facts.candidates[c] for c in solution.route)
    edge_starts = {facts.nest.contours[way.contour].id for way in ways if way.unpierced}
    further = [planned for planned in cuts if planned.cut.torch > 1]
    totals = replace(
        plan.totals,
        cut_mm=plan.totals.cut_mm + sum(planned.length_mm for planned in further),
        pierces=plan.totals.pierces + sum(planned.cut.together not in edge_starts for planned in further),
    )
    return replace(plan, cuts=tuple(cuts), totals=totals)


def _of_torch(
    planned: PlannedCut, copies: Copies, contour: int, torch: int, excuses: dict[str, tuple[str, ...]]
) -> PlannedCut:
    """The cut of a further torch."""
    of, first = copies.whole.nest.contours[contour], planned.cut
    x, y = copies.step[0] * (torch - 1), copies.step[1] * (torch - 1)

    def moved(lead: Curve | None) -> Curve | None:
        return None if lead is None else lead.moved(x, y)

    cut = Cut(
        of.id,
        (first.entry[0] + x, first.entry[1] + y),
        first.direction,
        (first.pierce[0] + x, first.pierce[1] + y),
        moved(first.lead_in),
        moved(first.lead_out),
        first.zone,
        first.start_s,
        first.end_s,
        excuses.get(of.id, ()),
        tabs=tuple(Tab((tab.at[0] + x, tab.at[1] + y), tab.width_mm) for tab in first.tabs),
        torch=torch,
        together=first.contour,
    )
    text = f"cut by torch {torch}, ({x:g}, {y:g}) mm from the first, together with {first.contour}"
    return replace(planned, cut=cut, part=of.part, kind=of.kind, because=(text,))


def completed(
    plan: Plan, facts: Facts, profile: Profile, stated: Stated, solution: Solution, limits: SolveOptions
) -> Plan:
    """The plan of a solution as its program cuts it, and when; `limits` are those of the ways of pierce passes."""
    plan = with_further_torches(plan, facts, stated, solution)
    plan = with_pierces(plan, facts.whole_nest, profile, limits)
    return with_times(plan, facts.whole_nest, profile)


def with_pierces(plan: Plan, nest: Nest, profile: Profile, limits: SolveOptions) -> Plan:
    """The plan with its pierce passes, where the profile asks for some; the order of its cuts stays.

    Each pass comes right before the first cut that begins at one of its holes. Marks, links, scrap lines, cuts that
    begin in an old kerf, and those that come in from the edge of the sheet have no hole.
    """
    if profile.cuts.pierce_pass is None:
        return plan
    from kerfwise.models.routing import way_through

    home, cuts = profile.home_on(nest), [planned.cut for planned in plan.cuts]
    ends = [home, *(cut.end for cut in cuts)]
    options = SolveOptions(seed=limits.seed, work=min(WORK, WORK_SHARE * limits.work))
    pierces: list[Pierce] = []
    idle_mm, reasons = plan.totals.idle_mm, dict[int, str]()
    for group in _groups(plan, nest, profile):
        points, first = [cuts[k].pierce for k in group], group[0]
        way = way_through(points, ends[first], points[0], options)
        stops = [ends[first], *(points[k] for k in way), points[0]]
        idle_mm += sum(math.dist(a, b) for a, b in pairwise(stops)) - math.dist(ends[first], points[0])
        where = "" if profile.cuts.pierce_pass == "sheet" else f" of zone {cuts[first].zone}"
        for number, k in enumerate(way, 1):
            cut = cuts[group[k]]
            pierces.append(Pierce(cut.contour, cut.pierce, first + 1))
            reasons[group[k]] = f"{IN_PASS}{where} (pierce {number} of {len(way)})"
    planned = tuple(
        replace(one, because=(*one.because, reasons[k])) if k in reasons else one for k, one in enumerate(plan.cuts)
    )
    return replace(plan, cuts=planned, pierces=tuple(pierces), totals=replace(plan.totals, idle_mm=idle_mm))


def _groups(plan: Plan, nest: Nest, profile: Profile) -> Iterator[list[int]]:
    """The numbers, from 0, of the cuts of each pass."""
    off = outside(nest, [planned.cut.pierce for planned in plan.cuts]) if plan.cuts else []
    whole = profile.cuts.pierce_pass == "sheet"
    for _, rows in groupby(enumerate(plan.cuts), key=lambda row: 0 if whole else row[1].cut.zone):
        group = [k for k, planned in rows if _has_hole(planned) and not off[k]]
        if group:
            yield group


def _has_hole(planned: PlannedCut) -> bool:
    return planned.kind not in ("mark", "scrap") and not planned.cut.linked and planned.cut.span is None
