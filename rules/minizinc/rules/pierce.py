"""The Python side of `pierce.mzn`."""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Contour
from kerfwise.rules.catalogue.pierce import PierceOptions
from kerfwise.rules.minizinc.dzn import Fields, numbers
from kerfwise.rules.minizinc.twin import Twin, TwinCase


class PierceTwin(Twin[PierceOptions]):
    """Candidates that pierce the waste of holes, or meet kerfs."""

    def data(self, case: TwinCase, options: PierceOptions) -> Fields:
        waste = pierced_waste(case.facts)
        kerfs, leads = met_kerfs(case.facts, options.kerf_mm, options.splash_mm)
        return [
            ("n_pierce_waste", str(len(waste))),
            ("pierce_waste_cand", numbers(c + 1 for c, _ in waste)),
            ("pierce_waste_hole", numbers(hole + 1 for _, hole in waste)),
            ("n_pierce_kerfs", str(len(kerfs))),
            ("pierce_kerf_cand", numbers(c + 1 for c, _ in kerfs)),
            ("pierce_kerf_contour", numbers(k + 1 for _, k in kerfs)),
            ("n_pierce_leads", str(len(leads))),
            ("pierce_lead_later", numbers(c + 1 for c, _ in leads)),
            ("pierce_lead_earlier", numbers(d + 1 for _, d in leads)),
        ]


def pierced_waste(facts: Facts) -> list[tuple[int, int]]:
    """Candidates that pierce inside another contour's hole, and that hole."""
    contours = facts.nest.contours
    holes = [k for k, c in enumerate(contours) if c.kind == "hole"]
    pierced = [k for k, c in enumerate(facts.candidates) if contours[c.contour].kind != "mark"]
    points = shapely.points(np.array([facts.candidates[k].pierce for k in pierced]).reshape(-1, 2))
    rows, inside = shapely.STRtree([contours[h].polygon for h in holes]).query(points, "intersects")
    found = sorted((pierced[row], holes[h]) for row, h in zip(rows.tolist(), inside.tolist(), strict=True))
    return [(c, h) for c, h in found if facts.candidates[c].contour != h]


def met_kerfs(facts: Facts, kerf_mm: float, splash_mm: float) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """Candidates that would meet the kerf of a contour, with that contour; and of a candidate's lead, with that one."""
    kerfs, leads = [], []
    drawn = [c for c in range(len(facts.candidates)) if facts.nest.contours[facts.candidates[c].contour].kind != "mark"]
    for c in drawn:
        own = facts.nest.contours[facts.candidates[c].contour]
        for k, contour in enumerate(facts.nest.contours):
            reach_mm = kerf_mm if contour.encloses else kerf_mm / 2
            if (
                contour.kind != "mark"
                and _beside(own, contour)
                and _meets(facts.candidates[c], contour.line, reach_mm, kerf_mm, splash_mm)
            ):
                kerfs.append((c, k))
        for d in drawn:
            older = facts.candidates[d]
            if _beside(own, facts.nest.contours[older.contour]) and any(
                _meets(facts.candidates[c], lead, kerf_mm / 2, kerf_mm, splash_mm) for lead in _leads(older, 0.0)
            ):
                leads.append((c, d))
    return kerfs, leads


def _beside(one: Contour, other: Contour) -> bool:
    """Whether a contour may be cut after another in the same waste: those of two parts, and one beside a slit.

    A slit never comes after the contour that its slot is of.
    """
    beside = one is not other and one.slot_of != other.id and "slit" in (one.kind, other.kind)
    return one.part != other.part or beside


def _meets(candidate: Candidate, line: shapely.LineString, reach_mm: float, kerf_mm: float, splash_mm: float) -> bool:
    """Whether a pierce or a lead meets the kerf that reaches so far from a line."""
    pierce = shapely.Point(candidate.pierce)
    if not candidate.edge_start and pierce.distance(line) < reach_mm + kerf_mm / 2 + splash_mm - 1e-6:
        return True
    return any(lead.distance(line) < reach_mm - 1e-6 for lead in _leads(candidate, kerf_mm / 2))


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
