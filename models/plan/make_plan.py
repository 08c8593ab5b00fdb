"""From a solution to a plan: cuts with their times, totals and excuses, and why each is entered where it is."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass, replace
from itertools import pairwise

from kerfwise.encoder.bevels.cut_nest import bevelled
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.candidates.stretches import run_of
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.display import join_names
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.slits import features_cut_across, narrow_because
from kerfwise.encoder.small_holes import uncut_hole_reasons
from kerfwise.encoder.torch_path import compensated, unlit_length_mm, way_along
from kerfwise.models.engines.solution import Solution
from kerfwise.models.physics.motion import Leg, idle_mm, schedule
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.problem.conditions import Condition, at_least_condition, no_good_condition
from kerfwise.models.problem.problem import links_on
from kerfwise.rules.profile.technique import Technique
from kerfwise.rules.statements import (
    EXEMPTION_MM,
    Link,
    by_kind,
)
from kerfwise.rules.stating.state_rules import Stated

from .plan import LINKED, Dropped, LeftOut, Plan, PlannedCut, SolveReport, Totals


def make_plan(facts: Facts, profile: Technique, stated: Stated, solution: Solution, engine: str, seed: int) -> Plan:
    """The whole plan but for what only its program can tell: its times by the profile's model, and the verdicts.

    Until then its times are those at constant feeds, none of them too long. Why each cut comes where it does is told by
    `with_reasons`.
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
    why = entry_reasons(facts, stated, solution.route, home, links)
    across = features_cut_across(facts.whole_nest, profile.material.kerf_mm)
    bevelling = profile.bevelling_of(nest)
    drawn = {} if bevelling is None else {contour.id: contour for contour in bevelled(nest)}
    told = (
        bevels_because(facts, profile),
        (small := uncut_hole_reasons(facts.whole_nest, profile.hole_limits())),
        narrow_because(facts.whole_nest, profile.material.kerf_mm),
        tabs_because(facts, profile),
    )
    items = tuple(
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
            (
                *(of[contour.id] for of in told if contour.id in of),
                *common_because(facts, candidate, contour.id),
                *because,
            ),
            across=tuple(one.place for one in across.get(contour.id, ())),
            passes=bevelling.passes_of(drawn[contour.id], candidate.as_cut(contour.id))
            if bevelling is not None and contour.id in drawn
            else (),
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
        cuts=tuple(item for item in items if item.kind != "stretch"),
        begun=(
            *_begun_before(facts, profile.material.kerf_mm),
            *_begun(nest, items, profile.material.kerf_mm, len(facts.already_cut)),
        ),
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


def _charted(profile: Technique) -> dict[str, str]:
    """What a plan says of the material chart: its file, the row, and what lies between two of them."""
    use = profile.chart
    if use is None:
        return {}
    between = ", ".join(f"{one.column} {one.text}" for one in use.interpolated)
    beaten = ", ".join(f"{column} {own}" for column, _, own in use.beaten)
    fields = {"chart": use.name, "chart_sha256": use.sha256, "chart_row": use.row}
    fields |= {"chart_interpolated": between} if between else {}
    return fields | ({"not_of_chart": beaten} if beaten else {})


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


def _begun(nest: Nest, items: Sequence[PlannedCut], kerf_mm: float, cuts_made: int) -> Iterator[tuple[int, PlannedCut]]:
    """The stretches of the ways among a plan's items, each with the number of the cut after it."""
    after = cuts_made + 1
    for item in items:
        if item.kind != "stretch":
            after += 1
            continue
        cut, way = item.cut, nest.contour(item.cut.contour)
        along = way.along if cut.direction == "ccw" else tuple(stretch.reversed for stretch in reversed(way.along))
        at, lead, because = cut.pierce, cut.lead_in, item.because
        for k, stretch in enumerate(along):
            contour, (begin, end) = nest.contour(stretch.contour), (stretch.span.begin, stretch.span.end)
            if k:
                lead = Curve.of([at, begin], closed=False) if math.dist(at, begin) > SAME_MM else None
            lead_mm = 0.0 if lead is None else lead.length_mm
            begun = replace(
                cut,
                contour=contour.id,
                entry=contour.curve.point_at(contour.curve.project(begin)[0]),
                direction=stretch.direction,
                pierce=at,
                lead_in=lead,
                lead_out=Curve.of([end], closed=False),
                linked=k > 0,
                span=stretch.span,
                way=way.id,
            )
            length_mm = lead_mm + run_of(contour, stretch, kerf_mm)[1]
            yield after, PlannedCut(begun, contour.part, contour.kind, length_mm, because)
            at, because = end, (f"a stretch of {way.id}",)


def _begun_before(facts: Facts, kerf_mm: float) -> Iterator[tuple[int, PlannedCut]]:
    """The stretches that an earlier program has cut, as a plan lists them."""
    for k, cut in () if facts.past is None else facts.past.already.begun:
        contour = facts.whole_nest.contour(cut.contour)
        lead_mm = 0.0 if cut.lead_in is None else cut.lead_in.length_mm
        along_mm = sum(way.length_mm for way in way_along(contour, cut, kerf_mm))
        yield k, PlannedCut(cut, contour.part, contour.kind, lead_mm + along_mm)


def _broken_off(facts: Facts) -> Cut | None:
    return None if facts.past is None else facts.past.already.broken_off


def _made(facts: Facts, cut: Cut, kerf_mm: float) -> PlannedCut:
    """A cut that an earlier program has made, as a plan lists it; why it came when it did is told there."""
    contour = facts.whole_nest.contour(cut.contour)
    try:
        around_mm = contour.curve.length_mm if contour.kind == "mark" else compensated(contour, kerf_mm).length_mm
    except InputError:  # made with another kerf
        around_mm = contour.curve.length_mm
    around_mm -= sum(unlit_length_mm(tab, kerf_mm) for tab in cut.tabs)
    leads_mm = sum(lead.length_mm for lead in (cut.lead_in, cut.lead_out) if lead is not None)
    return PlannedCut(cut, contour.part, contour.kind, around_mm + leads_mm)


def close_calls(contours: list[Contour], radius_mm: float = 50.0) -> float:
    """A quick measure of heat: how many cuts follow a cut of another part less than `radius_mm` away.

    Pristupov and Petunin ask that neighbours not be cut one after the other. `kerfwise heat` measures better: it
    simulates the temperatures.
    """
    through = [c for c in contours if c.shapes_part]
    return float(sum(a.part != b.part and a.line.distance(b.line) < radius_mm for a, b in pairwise(through)))


_NAMED = 6


# Why a cut is entered where it is: where that is the shortest way on, or the link that leads to it.

SAME_MM = 1e-6


def entry_reasons(
    facts: Facts, stated: Stated, route: Sequence[int], home: Point, links: Sequence[Link | None]
) -> list[tuple[str, ...]]:
    """For every cut of `route` (candidates in order) its entry, where it is the shortest way on, or its link."""
    forbidden = {s.candidate for s in by_kind(stated.statements).forbid if s.weight is None}
    return _entered(facts, forbidden, route, home, links)


def _entered(
    facts: Facts, forbidden: Set[int], route: Sequence[int], home: Point, links: Sequence[Link | None]
) -> list[tuple[str, ...]]:
    """For every cut, that no lawful candidate of its contour makes a shorter way between its neighbours, if so."""
    used = [facts.candidates[c] for c in route]
    names = ["home", *(facts.nest.contours[c.contour].id for c in used), "home"]
    texts: list[tuple[str, ...]] = []
    for k, candidate in enumerate(used):
        if (link := links[k]) is not None:
            texts.append((f"{LINKED}{link.about.sentence}, which takes less time than a pierce",))
            continue
        if k + 1 < len(used) and links[k + 1] is not None:
            texts.append(())
            continue
        leave = used[k - 1].end if k else home
        reach = used[k + 1].pierce if k + 1 < len(used) else home
        rivals = [c for c in facts.candidates_of(candidate.contour) if c not in forbidden]
        ways = [_way_mm(leave, facts.candidates[c].pierce, facts.candidates[c].end, reach) for c in rivals]
        shortest = _way_mm(leave, candidate.pierce, candidate.end, reach) <= min(ways) + SAME_MM
        x, y = candidate.entry
        sentence = f"entered at ({x:.1f}, {y:.1f}): the shortest lawful way from {names[k]} to {names[k + 2]}"
        texts.append((sentence,) if shortest and len(rivals) > 1 else ())
    return texts


def _way_mm(leave: Point, pierce: Point, end: Point, reach: Point) -> float:
    return math.dist(leave, pierce) + math.dist(end, reach)


# Why a cut follows a stretch of its contour alone, in a sentence.


def common_because(facts: Facts, candidate: Candidate, name: str) -> tuple[str, ...]:
    """What the neighbours that are out have left of a contour with common edges; nothing where it is cut all round.

    So of one that a way has begun; and what a way begins.
    """
    if along := facts.nest.contours[candidate.contour].along:
        names = list(dict.fromkeys(stretch.contour for stretch in along))
        return (f"stretches: it begins {join_names(names, _NAMED)}, cut later along what is left of each",)
    if candidate.span is None:
        return ()
    if not {*candidate.out} <= facts.whole_nest.index.keys():
        waits = "" if candidate.kerf_start else ", where the torch waits as for a pierce"
        have = "have" if len(candidate.out) > 1 else "has"
        text = f"{' and '.join(candidate.out)} {have} cut the rest of {name}, which begins in an old kerf{waits}"
        return (f"stretches: {text}",)
    begins = "begins in their kerf" if len(candidate.out) > 1 else "begins in its kerf"
    waits = "" if candidate.kerf_start else ", where the torch waits as for a pierce"
    return (f"common edges: {', '.join(candidate.out)} cut the rest of {name}, which {begins}{waits}",)


# Why parts are held by tabs, and how bevels are cut, in a sentence for each.


def bevels_because(facts: Facts, profile: Technique) -> dict[str, str]:
    """For every contour with a bevel its passes, and what becomes of its sharp corners."""
    bevelling = profile.bevelling_of(facts.nest)
    return {} if bevelling is None else bevelling.reasons(facts.nest)


def tabs_because(facts: Facts, profile: Technique) -> dict[str, str]:
    """For every contour with tabs how many hold its part, how wide they are, and why."""
    options, part_of = profile.tabs(), facts.nest.part_of
    reasons: dict[str, str] = {}
    for candidate in facts.candidates:
        contour = facts.nest.contours[candidate.contour]
        if candidate.tabs and contour.id not in reasons:
            tabs = "a tab" if len(candidate.tabs) == 1 else f"{len(candidate.tabs)} tabs"
            why = None if options is None else options.reason(part_of[contour.part])
            width = f"{candidate.tabs[0].width_mm:g} mm"
            reasons[contour.id] = f"{contour.part} is held by {tabs} of {width}: {why or 'the cut was begun so'}"
    return reasons


# Which hard rules a route could not keep where: what the plan lists as its excuses.


def excuses(facts: Facts, stated: Stated, route: Sequence[int]) -> dict[str, tuple[str, ...]]:
    """Contour id → ids of the rules that are excused there; `route` are candidates in cutting order.

    That is where the route breaks a statement that weighs EXEMPTION_MM, and where a rule is exempt in any order.
    """
    return excused_and_used(facts, stated, route)[0]


def excused_and_used(facts: Facts, stated: Stated, route: Sequence[int]) -> tuple[dict[str, tuple[str, ...]], int]:
    """See `excuses`; and how many statements that weigh EXEMPTION_MM a route breaks: its objective holds each."""
    rules: dict[str, set[str]] = defaultdict(set)
    for about in stated.exempt:
        for name in about.contours:
            rules[name].add(about.rule)
    used = list(_used(facts, stated, route))
    for condition, name in used:
        rules[name].add(condition.about.rule)
    return {name: tuple(sorted(of)) for name, of in rules.items()}, len(used)


def excuses_by_rule(facts: Facts, stated: Stated, route: Sequence[int]) -> Counter[str]:
    """Rule id → how many of its statements that weigh EXEMPTION_MM a route breaks; see `excuses`."""
    return Counter(condition.about.rule for condition, _ in _used(facts, stated, route))


def _used(facts: Facts, stated: Stated, route: Sequence[int]) -> Iterator[tuple[Condition, str]]:
    contour_of = [c.contour for c in facts.candidates]
    excusable = _excusable(stated, contour_of)
    already: set[int] = set()
    for c in route:
        for condition, name in excusable.get(contour_of[c], ()):
            if condition.when in (None, c) and not condition.met(already):
                yield condition, name
        already.add(contour_of[c])


def _excusable(stated: Stated, contour_of: list[int]) -> dict[int, list[tuple[Condition, str]]]:
    """Contour → the conditions on it that may be excused, each with the id of the contour that is excused.

    That is the first that a statement is about; of a no-good, which is seen when the last of `out` is cut, the first
    that is left.
    """
    found: dict[int, list[tuple[Condition, str]]] = defaultdict(list)
    excused = by_kind(s for s in stated.statements if s.weight == EXEMPTION_MM)  # no excusable rule states other kinds
    for no_good in excused.no_good:
        for condition in no_good_condition(no_good, None):
            found[condition.contour].append((condition, no_good.about.contours[len(no_good.out)]))
    for s in excused.at_least:
        if (lowered := at_least_condition(s, contour_of, None)) is not None:
            found[lowered.contour].append((lowered, s.about.contours[0]))
    return found
