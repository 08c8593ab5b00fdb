"""The Python side of `pierce.mzn`."""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.minizinc_data import Fields, numbers_from_1
from kerfwise.encoder.nest import Contour
from kerfwise.rules.catalogue.pierce import PierceOptions
from kerfwise.rules.minizinc.twin import Twin, TwinCase


class PierceTwin(Twin[PierceOptions]):
    """Candidates that pierce the waste of holes, or meet kerfs."""

    def data(self, case: TwinCase, options: PierceOptions) -> Fields:
        waste = pierced_waste(case.facts)
        kerfs, leads = met_kerfs(case.facts, options.kerf_mm, options.splash_mm)
        holes = met_holes(case.facts, options.kerf_mm, options.splash_mm)
        return [
            ("n_pierce_waste", str(len(waste))),
            ("pierce_waste_cand", numbers_from_1(c for c, _ in waste)),
            ("pierce_waste_hole", numbers_from_1(hole for _, hole in waste)),
            ("n_pierce_kerfs", str(len(kerfs))),
            ("pierce_kerf_cand", numbers_from_1(c for c, _ in kerfs)),
            ("pierce_kerf_contour", numbers_from_1(k for _, k in kerfs)),
            ("n_pierce_leads", str(len(leads))),
            ("pierce_lead_later", numbers_from_1(c for c, _ in leads)),
            ("pierce_lead_earlier", numbers_from_1(d for _, d in leads)),
            ("n_pierce_holes", str(len(holes))),
            ("pierce_hole_cand", numbers_from_1(c for c, _ in holes)),
            ("pierce_hole_other", numbers_from_1(d for _, d in holes)),
        ]


def pierced_waste(facts: Facts) -> list[tuple[int, int]]:
    """Candidates that pierce inside another contour's hole, and that hole."""
    contours = facts.nest.contours
    holes = [k for k, c in enumerate(contours) if c.kind == "hole"]
    pierced = [k for k, c in enumerate(facts.candidates) if contours[c.contour].shapes_part]
    points = shapely.points(np.array([facts.candidates[k].pierce for k in pierced]).reshape(-1, 2))
    rows, inside = shapely.STRtree([contours[h].polygon for h in holes]).query(points, "intersects")
    found = sorted((pierced[row], holes[h]) for row, h in zip(rows.tolist(), inside.tolist(), strict=True))
    return [(c, h) for c, h in found if facts.candidates[c].contour != h]


def met_kerfs(facts: Facts, kerf_mm: float, splash_mm: float) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """Candidates that would meet the kerf of a contour, with that contour; and of a candidate's lead, with that one."""
    contours = facts.nest.contours
    drawn = [c for c, one in enumerate(facts.candidates) if contours[one.contour].shapes_part and one.span is None]
    met = _Met(facts, drawn, kerf_mm, splash_mm)
    lines = [
        (k, contour.line, kerf_mm if contour.encloses else kerf_mm / 2)
        for k, contour in enumerate(contours)
        if contour.shapes_part
    ]
    leads = [(d, lead, kerf_mm / 2) for d in drawn for lead in _leads(facts.candidates[d], 0.0)]
    owner = [candidate.contour for candidate in facts.candidates]
    return (
        [(c, k) for c, k in met.with_kerfs(lines) if _beside(contours[owner[c]], contours[k])],
        [(c, d) for c, d in met.with_kerfs(leads) if _beside(contours[owner[c]], contours[owner[d]])],
    )


def met_holes(facts: Facts, kerf_mm: float, splash_mm: float) -> list[tuple[int, int]]:
    """Candidates that would meet the hole of another of the same pass, by their own hole or a lead, with that one."""
    in_pass, contours = facts.options.pierce_pass, facts.nest.contours
    if in_pass is None:
        return []
    drawn = [c for c, one in enumerate(facts.candidates) if contours[one.contour].shapes_part and one.span is None]
    pierced = [c for c in drawn if not facts.candidates[c].unpierced]
    holes = np.array([shapely.Point(facts.candidates[c].pierce) for c in pierced], dtype=object)
    found: set[tuple[int, int]] = set()
    for c in drawn:
        one = facts.candidates[c]
        lines = [lead.line() for lead in (one.lead_in, one.lead_out) if lead is not None and lead.length_mm > 0]
        own = shapely.Point(one.pierce)
        for k, d in enumerate(pierced):
            other = facts.candidates[d]
            apart = contours[one.contour].part != contours[other.contour].part
            together = in_pass == "sheet" or facts.zone[one.contour] == facts.zone[other.contour]
            near = any(shapely.distance(line, holes[k]) <= kerf_mm / 2 for line in lines)
            if apart and together and (near or shapely.distance(own, holes[k]) < kerf_mm + splash_mm):
                found.add((c, d))
    return sorted(found)


class _Met:
    """The pierces and leads of candidates, and how far each stays from the edge of a kerf."""

    def __init__(self, facts: Facts, drawn: list[int], kerf_mm: float, splash_mm: float) -> None:
        of, things, away_mm = [], [], []
        for c in drawn:
            candidate = facts.candidates[c]
            pierce = [] if candidate.edge_start else [(shapely.Point(candidate.pierce), kerf_mm / 2 + splash_mm)]
            for thing, room_mm in [*pierce, *((lead, 0.0) for lead in _leads(candidate, kerf_mm / 2))]:
                of.append(c)
                things.append(thing)
                away_mm.append(room_mm)
        self.of, self.away_mm = np.array(of, dtype=np.int64), np.array(away_mm)
        self.things = np.array(things, dtype=object)

    def with_kerfs(self, burns: list[tuple[int, shapely.LineString, float]]) -> list[tuple[int, int]]:
        """Candidates and the numbers of the lines whose kerf, which reaches so far from the line, they meet."""
        if not burns or not len(self.of):
            return []
        lines = np.array([line for _, line, _ in burns], dtype=object)
        number, reach_mm = np.array([k for k, _, _ in burns]), np.array([mm for _, _, mm in burns])
        row, burn = shapely.STRtree(lines).query(self.things, "dwithin", distance=self.away_mm + reach_mm.max())
        near = shapely.distance(self.things[row], lines[burn]) < reach_mm[burn] + self.away_mm[row] - 1e-6
        pairs = np.unique(np.column_stack([self.of[row], number[burn]])[near], axis=0)
        return [(c, k) for c, k in pairs.tolist()]


def _beside(one: Contour, other: Contour) -> bool:
    """Whether a contour may be cut after another in the same waste: those of two parts, and one beside a slit.

    A slit never comes after the contour that its slot is of.
    """
    beside = one is not other and one.slot_of != other.id and "slit" in (one.kind, other.kind)
    return one.part != other.part or beside


def _leads(candidate: Candidate, less_mm: float) -> list[shapely.LineString]:
    """The leads of a candidate without their last bit at the contour."""
    found = []
    if candidate.lead_in is not None and candidate.lead_in.length_mm > less_mm + 1e-6:
        found.append(candidate.lead_in.between(0.0, candidate.lead_in.length_mm - less_mm).line())
    if candidate.lead_out is not None and candidate.leaves:
        last_mm = candidate.lead_out.segments[-1].length_mm - less_mm
        if last_mm > 1e-6:
            found.append(candidate.lead_out.between(candidate.lead_out.length_mm - last_mm, last_mm).line())
    return found
