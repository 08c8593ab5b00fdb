"""Starts off the sheet: lawful only where the profile allows them, at an edge that somebody has stated."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import Violation

from .program_rules import tolerance_mm
from .torch_run import TorchRun

_RULE = "edge-start"


def edge_starts(nest: Nest, runs: Sequence[TorchRun], profile: Profile) -> Iterator[Violation]:
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
        contours = () if run.contour is None else (run.contour.id,)
        text = f"{run.where}: {run.name} begins {off_mm:.1f} mm off the sheet, at ({at[0]:.2f}, {at[1]:.2f}): {why}"
        yield Violation(_RULE, contours, text, (run.position,) if run.position else ())


def forbidden(nest: Nest, profile: Profile) -> str | None:
    """Why no cut may begin off this sheet; None where it may."""
    if not profile.leads.edge_start:
        return "the profile allows no edge start (leads.edge_start)"
    if not nest.sheet.stated:
        return "nobody has stated where the sheet's edge is"
    if None in (profile.machine.travel_x_mm, profile.machine.travel_y_mm):
        return "the profile does not say how far the torch can go (machine.travel_x, machine.travel_y)"
    return None


def run_up_mm(nest: Nest, profile: Profile) -> float:
    """How far off this sheet a cut may begin: as far as the longest lead goes from its kerf; 0 where it may not."""
    if forbidden(nest, profile) is not None:
        return 0.0
    return profile.material.kerf_mm + profile.length_mm(profile.leads.lead_in_mm)
