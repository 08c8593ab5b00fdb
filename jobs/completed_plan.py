"""What a plan has beside the cuts of its route: those of further torches, pierce passes, and when it all happens."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import groupby, pairwise

from kerfwise.encoder.cut import Pierce
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.engines.tuning import PASS_WORK as WORK
from kerfwise.models.engines.tuning import WORK_SHARE
from kerfwise.models.plan.plan import IN_PASS, Plan, PlannedCut
from kerfwise.postproc.clock import with_times
from kerfwise.postproc.nc.toolpaths import outside
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.stating.state_rules import Stated

from .gantry import with_further_torches


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
