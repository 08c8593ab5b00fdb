"""From a solution to a plan: cuts with their times, totals, and the reasons for every place."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.compensation import compensated
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.slits import narrow_because
from kerfwise.encoder.small_holes import not_cut_because
from kerfwise.encoder.tabs import off_mm
from kerfwise.models.engines.solution import Solution
from kerfwise.models.physics.timing.choose import feeds_of
from kerfwise.models.physics.timing.constant import Leg, idle_mm, schedule
from kerfwise.models.problem.links import links_on
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import Link
from kerfwise.rules.stating.state_rules import Stated

from .common import common_because
from .excused import excused_and_used
from .plan import Dropped, LeftOut, Plan, PlannedCut, SolveReport, Totals
from .reasons import reasons
from .tabs import tabs_because


def make_plan(facts: Facts, profile: Profile, stated: Stated, solution: Solution, engine: str, seed: int) -> Plan:
    """The whole plan but for what only its program can tell: its times by the profile's model, and the verdicts.

    Until then its times are those at constant feeds, none of them too long.
    """
    nest = facts.nest
    candidates = [facts.candidates[c] for c in solution.route]
    contours = [nest.contours[c.contour] for c in candidates]
    machine, home, feeds = profile.machine, profile.home_on(nest), feeds_of(profile)
    links = links_on(facts.candidates, stated.statements, solution.route, home)
    ways = [_way(c, link) for c, link in zip(candidates, links, strict=True)]
    legs = [
        Leg(way.begin, c.end, way.length_mm, k.kind == "mark", not (c.unpierced or link), k.feed_share, bool(link))
        for c, k, way, link in zip(candidates, contours, ways, links, strict=True)
    ]
    times = schedule(legs, feeds, home)
    excuses, used = excused_and_used(facts, stated, solution.route)
    why = reasons(facts, stated, solution.route, home, links)
    told = (
        (small := not_cut_because(facts.whole_nest, profile.hole_limits())),
        narrow_because(facts.whole_nest, profile.material.kerf_mm),
        tabs_because(facts, profile),
    )
    cuts = tuple(
        PlannedCut(
            replace(
                candidate.as_cut(contour.id, int(facts.zone[candidate.contour])),
                pierce=way.begin,
                lead_in=way.lead_in,
                start_s=begin,
                end_s=end,
                excused=excuses.get(contour.id, ()),
                linked=link is not None,
            ),
            contour.part,
            contour.kind,
            way.length_mm,
            (*(of[contour.id] for of in told if contour.id in of), *common_because(candidate, contour.id), *because),
        )
        for candidate, contour, way, link, (begin, end), because in zip(
            candidates, contours, ways, links, times, why, strict=True
        )
    )
    last = times[-1][1] + math.dist(legs[-1].end, home) / machine.travel_mm_s if times else 0.0
    gap = None
    if solution.bound is not None:
        gap = (solution.objective - solution.bound) / solution.objective if solution.objective > 0 else 0.0
    return Plan(
        nest=_named(nest),
        profile={"name": profile.name, "sha256": profile.sha256, **_charted(profile)},
        made_with=profile.for_one_nest,
        start_side=facts.start_side,
        start_side_because=facts.start_side_because,
        origin=machine.origin,
        zero=profile.frame_on(nest).corner,
        cuts=cuts,
        totals=Totals(
            cut_mm=sum(leg.length_mm for leg in legs),
            idle_mm=idle_mm(legs, home),
            pierces=sum(leg.pierced and not leg.marks for leg in legs),
            time_s=last,
            heat=close_calls(contours),
        ),
        solve=SolveReport(
            engine,
            solution.status,
            solution.objective,
            solution.bound,
            gap,
            solution.seconds,
            seed,
            solution.found_by,
            solution.proved_by,
            used,
        ),
        dropped=(
            *(Dropped(d.rule, d.contours, d.why) for d in stated.dropped),
            *(Dropped(rule, (), f"not priced: {why}") for rule, why in solution.left_out),
        ),
        left_out=tuple(LeftOut(name, small[name]) for name in facts.whole_nest.left_out),
        losses=facts.whole_nest.losses,
        already_cut=tuple(_made(facts, cut, profile.material.kerf_mm) for cut in facts.already_cut),
        broken_off=None if (again := _broken_off(facts)) is None else _made(facts, again, profile.material.kerf_mm),
    )


def _named(nest: Nest) -> dict[str, str]:
    """The file of a nest, its sha256, how near to it arcs were made, where they were, and how a drawing was read."""
    refit = {} if nest.refit_arcs_mm is None else {"refit_arcs_mm": f"{nest.refit_arcs_mm:.9g}"}
    read = {} if nest.reading is None or not nest.reading.taken else {"reading": nest.reading.short()}
    return {"file": nest.file, "sha256": nest.sha256, **refit, **read}


def _charted(profile: Profile) -> dict[str, str]:
    """What a plan says of the material chart: its file, the row, and what lies between two of them."""
    use = profile.chart
    if use is None:
        return {}
    between = ", ".join(f"{one.column} {one.text}" for one in use.interpolated)
    beaten = ", ".join(f"{column} {own}" for column, _, own in use.beaten)
    told = {"chart": use.name, "chart_sha256": use.sha256, "chart_row": use.row}
    told |= {"chart_interpolated": between} if between else {}
    return told | ({"not_of_chart": beaten} if beaten else {})


@dataclass(frozen=True, eq=False, slots=True)
class _Way:
    """How a cut begins: from its pierce along its lead-in, or from the end of the cut before along a link."""

    begin: Point
    lead_in: Curve | None
    length_mm: float


def _way(candidate: Candidate, link: Link | None) -> _Way:
    if link is None:
        return _Way(candidate.pierce, candidate.lead_in, candidate.cut_mm)
    path = Curve.of(list(link.path), closed=False)
    lead_mm = 0.0 if candidate.lead_in is None else candidate.lead_in.length_mm
    return _Way(link.path[0], path, candidate.cut_mm - lead_mm + path.length_mm)


def _broken_off(facts: Facts) -> Cut | None:
    return None if facts.past is None else facts.past.already.broken_off


def _made(facts: Facts, cut: Cut, kerf_mm: float) -> PlannedCut:
    """A cut that an earlier program has made, as a plan lists it; why it came when it did is told there."""
    contour = facts.whole_nest.contour(cut.contour)
    try:
        around_mm = contour.curve.length_mm if contour.kind == "mark" else compensated(contour, kerf_mm).length_mm
    except InputError:  # made with another kerf
        around_mm = contour.curve.length_mm
    around_mm -= sum(off_mm(tab, kerf_mm) for tab in cut.tabs)
    leads_mm = sum(lead.length_mm for lead in (cut.lead_in, cut.lead_out) if lead is not None)
    return PlannedCut(cut, contour.part, contour.kind, around_mm + leads_mm)


def close_calls(contours: list[Contour], radius_mm: float = 50.0) -> float:
    """A quick measure of heat: how many cuts follow a cut of another part less than `radius_mm` away.

    Pristupov and Petunin ask that neighbours not be cut one after the other. `kerfwise heat` measures better: it
    simulates the temperatures.
    """
    through = [c for c in contours if c.shapes_part]
    return float(sum(a.part != b.part and a.line.distance(b.line) < radius_mm for a, b in pairwise(through)))
