"""A cut that broke off, made again as it was: for contours that have no room for a pierce beside the old kerf."""

from __future__ import annotations

import math

import shapely

from kerfwise.encoder.compensation import compensated
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.tabs import off_mm

from .candidate import Candidate
from .tried import TriedLeads


def again_as_it_was(nest: Nest, cut: Cut | None, tried: TriedLeads, kerf_mm: float) -> list[Candidate]:
    """The cut that broke off as the only way to cut its contour, where none was found; marks are made anew anyway."""
    if cut is None or (contour := nest.contour(cut.contour)).kind == "mark":
        return []
    number = nest.index[cut.contour]
    if number not in tried.bare and number not in tried.shut:
        return []
    ring = compensated(contour, kerf_mm)
    entry_mm, _ = contour.curve.project(cut.entry)
    leads_mm = math.fsum(lead.length_mm for lead in (cut.lead_in, cut.lead_out) if lead is not None)
    edge_start = not bool(shapely.contains_xy(nest.sheet.polygon, *cut.pierce))
    return [
        Candidate(
            contour=number,
            entry_mm=entry_mm,
            entry=cut.entry,
            direction=cut.direction,
            pierce=cut.pierce,
            lead_in=cut.lead_in,
            lead_out=cut.lead_out,
            end=cut.end,
            cut_mm=ring.length_mm + leads_mm - math.fsum(off_mm(tab, kerf_mm) for tab in cut.tabs),
            edge_start=edge_start,
            tabs=cut.tabs,
        )
    ]
