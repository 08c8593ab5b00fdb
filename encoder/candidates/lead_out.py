"""Lead-outs: how the torch leaves a contour after it has gone once round."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal

import numpy as np

from kerfwise.arrays import Bools, Floats
from kerfwise.encoder.geometry.curve import Curve

from .approaches import Approaches, Ways
from .candidate import LeadOptions
from .joints import Joints, Outline
from .lead_shapes import Leads, LeadShape, shaped
from .surroundings import Surroundings


def lead_outs(
    approaches: Approaches, outlines: Mapping[int, Outline], around: Surroundings, options: LeadOptions
) -> tuple[list[Curve], Floats, Bools]:
    """For every approach the open curve from its joint to where the torch goes off, its length, mm, and whether it
    ends with a lead into the waste.

    Holes are cut a little further than once round, then a lead follows where one is asked for and there is room;
    without either the curve is the joint alone.
    """
    ways = approaches.ways
    tails = _overcuts(ways, outlines, options.hole_overcut_mm)
    length_mm = np.array([tail.length_mm for tail in tails])
    if options.lead_out == "none" or not tails:
        return tails, length_mm, np.full(len(tails), False)
    leads = _leads(_ends(ways, tails), around, options)
    for i in np.flatnonzero(leads.length_mm).tolist():
        rows = tails[i].vertices.copy()
        rows[-1, 2] = -leads.bulge[i]  # made as a lead-in and run the other way
        tails[i] = Curve(np.vstack([rows, [*leads.pierce[i], 0.0]]), closed=False)
    return tails, length_mm + leads.length_mm, leads.length_mm > 0


def _overcuts(ways: Ways, outlines: Mapping[int, Outline], overcut_mm: float) -> list[Curve]:
    """What is cut twice, as open curves; the joints alone for outer contours."""
    joints = ways.joints
    alone = np.column_stack([joints.join, np.zeros(len(ways))])[:, None]
    tails = []
    for i, (k, join_mm, ccw) in enumerate(
        zip(joints.contour.tolist(), joints.join_mm.tolist(), ways.ccw.tolist(), strict=True)
    ):
        outline = outlines[k]
        if outline.contour.kind == "outer" or overcut_mm <= 0:
            tails.append(Curve(alone[i], closed=False))
            continue
        path, at_mm = outline.path, join_mm
        if path.is_ccw != ccw:
            path, at_mm = outline.path_reversed, path.length_mm - at_mm
        tails.append(path.between(at_mm, min(overcut_mm, path.length_mm)))
    return tails


def _ends(ways: Ways, tails: list[Curve]) -> Ways:
    """The ends of the overcut as joints, to be left the way that the torch came."""
    joints = ways.joints
    end = np.array([tail.vertices[-1, :2] for tail in tails])
    ahead = np.array(
        [
            tail.segments[-1].tangent_at(1.0) if tail.segments else along
            for tail, along in zip(tails, ways.along, strict=True)
        ]
    )
    waste_left = np.sign(ways.along[:, 0] * joints.out[:, 1] - ways.along[:, 1] * joints.out[:, 0])[:, None]
    out = waste_left * np.column_stack([-ahead[:, 1], ahead[:, 0]])
    moved = Joints(joints.contour, joints.entry_mm, joints.entry, joints.join_mm, end, out)
    return Ways(moved, ways.ccw, -ahead)


def _leads(ends: Ways, around: Surroundings, options: LeadOptions) -> Leads:
    """The first lead-out with room for each end, as if it were a lead-in; of length 0 where there is none."""
    kind: Literal["line", "arc"] = "arc" if options.lead_out == "arc" else "line"
    angles = (90, 60, 45) if kind == "arc" else (45, 30, 60, 0)
    m = len(ends)
    leads = Leads(ends.joints.join.copy(), ends.joints.join, np.zeros(m), np.zeros(m))
    longest_mm = np.full(m, options.lead_out_mm)
    for angle in angles:
        for shortened in (0.0, 1 / 3, 2 / 3, 1.0):
            rows = np.flatnonzero(leads.length_mm == 0)
            if len(rows) == 0:
                return leads
            left, shape = ends.take(rows), LeadShape(kind, shortened, math.radians(angle))
            tried = shaped(shape, left.joints, left.along, longest_mm[rows], options.lead_out_mm / 4)
            clear = around.inside_edges(tried) & around.in_waste(tried.pierce)
            clear[clear] = around.clear_leads(tried.take(clear), left.joints.contour[clear], options.kerf_mm / 2)
            done = rows[clear]
            leads.pierce[done], leads.bulge[done] = tried.pierce[clear], tried.bulge[clear]
            leads.length_mm[done] = tried.length_mm[clear]
    return leads
