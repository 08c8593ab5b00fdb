"""A plan that looks like one, made without a solver, so that there is something to draw."""

from __future__ import annotations

import math

import shapely

from kerfwise import Nest, Plan
from kerfwise.models.plan.plan import PlannedCut, SolveReport, Totals
from kerfwise.rule_kit import Contour, Curve, Cut, Direction, Part, Point, circle, part, rect
from kerfwise.rule_kit import nest as nest_of

LEAD_MM = 5.0


def plate() -> Nest:
    """Two parts, one with a hole and a mark."""
    return nest_of(
        600,
        300,
        part("A", rect(20, 20, 200, 200), [circle(120, 120, 60)], [[(30, 30), (90, 30)]]),
        part("B", rect(300, 20, 100, 250)),
    )


def plausible_plan(nest: Nest, zone_contours: int = 12) -> Plan:
    """Zones are strips along x, inside a zone the nearest part follows; nested parts before their hosts."""
    here: Point = (0.0, 0.0)
    clock_s = 0.0
    idle_mm = 0.0
    planned: list[PlannedCut] = []
    for zone, parts in enumerate(_zones(nest, zone_contours), 1):
        while parts:
            ready = [p for p in parts if not (p.holes and any(_lies_in(q, p) for q in parts if q is not p))]
            chosen = min(ready, key=lambda p: p.outer.polygon.distance(shapely.Point(here)))
            parts.remove(chosen)
            for contour in chosen:
                cut = _cut(contour, here)
                travel_mm = math.dist(here, cut.pierce)
                length_mm = contour.curve.length_mm
                start_s = clock_s + travel_mm / 250 + 0.8
                clock_s = start_s + length_mm / 40
                idle_mm += travel_mm
                timed = Cut(
                    cut.contour, cut.entry, cut.direction, cut.pierce, cut.lead_in, cut.lead_out, zone, start_s, clock_s
                )
                because = (f"zone {zone}", "the nearest of its zone")
                planned.append(PlannedCut(timed, chosen.id, contour.kind, length_mm, because))
                here = timed.end
    idle_mm += math.dist(here, (0.0, 0.0))
    cut_mm = sum(p.length_mm for p in planned)
    pierces = sum(p.kind != "mark" for p in planned)
    return Plan(
        {"file": nest.file, "sha256": ""},
        {"name": "plasma-carbon-steel", "sha256": ""},
        "left",
        "heat",
        tuple(planned),
        Totals(cut_mm, idle_mm, pierces, clock_s, 0.0),
        SolveReport("portfolio", "feasible", idle_mm, 0.9 * idle_mm, 0.1, 1.0, 0),
    )


def _zones(nest: Nest, zone_contours: int) -> list[list[Part]]:
    """Parts from left to right in groups; what is nested goes with its outermost host."""
    holed = [p for p in nest.parts if p.holes]
    hosts = {p.id: next((q for q in holed if q is not p and _lies_in(p, q)), p) for p in nest.parts}
    zones: list[list[Part]] = [[]]
    for p in sorted(nest.parts, key=lambda p: (hosts[p.id].outer.polygon.centroid.x, hosts[p.id].id)):
        if sum(1 for q in zones[-1] for _ in q) >= zone_contours and hosts[p.id] is p:
            zones.append([])
        zones[-1].append(p)
    return zones


def _lies_in(inner: Part, host: Part) -> bool:
    x0, y0, x1, y1 = host.outer.polygon.bounds
    a0, b0, a1, b1 = inner.outer.polygon.bounds
    if not (x0 < a0 and y0 < b0 and a1 < x1 and b1 < y1):
        return False
    return any(h.polygon.contains(inner.outer.polygon.representative_point()) for h in host.holes)


def _cut(contour: Contour, here: Point) -> Cut:
    if contour.kind == "mark":
        start = contour.curve.point_at(0.0)
        return Cut(contour.id, start, "ccw", start, None, Curve.of([contour.curve.vertices[-1, :2]], False))
    direction: Direction = "cw" if contour.kind == "outer" else "ccw"
    curve = contour.curve.towards(direction)
    entry_mm, _ = curve.project(here)
    entry, (tx, ty) = curve.point_at(entry_mm), curve.tangent_at(entry_mm)
    # Metal to keep is on the right of a clockwise outer contour, waste on the left of both.
    lead_mm = min(LEAD_MM, 0.4 * math.sqrt(contour.polygon.area))
    pierce = (entry[0] - ty * lead_mm, entry[1] + tx * lead_mm)
    out = (entry[0] - ty * 0.3 * lead_mm + tx * 0.3 * lead_mm, entry[1] + tx * 0.3 * lead_mm + ty * 0.3 * lead_mm)
    return Cut(contour.id, entry, direction, pierce, Curve.of([pierce, entry], False), Curve.of([entry, out], False))
