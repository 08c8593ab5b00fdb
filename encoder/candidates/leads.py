"""Lead-ins and lead-outs: of all that would do, the one to take at each entry."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from itertools import product
from typing import Literal

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.geometry.curve import Curve

from .candidate import LEAST_WASTE_MM, LeadOptions
from .entries import Approaches, Joints, Leads, LeadShape, Outline, Ways, shaped
from .obstacles import CHORD_MM, Surroundings

EDGE_ANGLE_RAD = math.radians(60)
"""An edge start runs straight to the edge of the sheet if that is no further than this from straight off the cut."""


def least_clearance_mm(options: LeadOptions) -> float:
    """How far a pierce keeps from contours and edges: as far as asked for, and more than half the kerf."""
    return max(options.pierce_clearance_mm, options.kerf_mm / 2 + LEAST_WASTE_MM)


def shapes(options: LeadOptions, patient: bool = False) -> list[LeadShape]:
    """The leads to try, best first: as long as possible, then shorter, then turned.

    The patient list is longer, and in it lines stand in where no arc finds room.
    """
    lengths = np.linspace(0, 1, 8 if patient else 6).tolist()
    turns = (0, 20, -20, 40, -40, 65, -65) if patient else (0, 20, -20, 40, -40)
    lines = [LeadShape("line", shortened, math.radians(turn)) for turn in turns for shortened in lengths]
    if options.lead == "line":
        return lines
    arcs = [LeadShape("arc", shortened, math.radians(sweep)) for sweep in (90, 60, 45) for shortened in lengths]
    return arcs + lines if patient else arcs


def lead_ins(
    ways: Ways, longest_mm: Floats, around: Surroundings, options: LeadOptions, patient: bool = False
) -> Approaches:
    """Those of the ways that have a lawful lead-in, with the first of its shapes that is one.

    A lead that keeps to its own half of the street is better than any that does not, for no other of the kind can meet
    it; next best is one that meets no contour's kerf, in whatever order they are cut.
    """
    clearance_mm = least_clearance_mm(options)
    m = len(ways)
    found = np.full(m, False)
    if options.lead == "none":
        at = ways.joints.join
        leads = Leads(at, at, np.zeros(m), np.zeros(m))
        found = around.clear_pierces(at, clearance_mm, not_own=ways.joints.contour)
        # Without a kerf either the pierce is on the contour itself: look a little beside it.
        found &= around.in_waste(at + 2 * CHORD_MM * ways.joints.out)
        found &= _off_slits(at, around, options)
        return Approaches(ways.take(found), leads.take(found), np.full(int(found.sum()), False))
    pierce, bulge, length_mm = np.zeros((m, 2)), np.zeros(m), np.zeros(m)

    def clear_of_contours(leads: Leads, contour: Ints) -> Bools:
        return around.clear_leads(leads, contour, options.kerf_mm / 2)

    tried = shapes(options, patient)
    pierced = np.full((len(tried), m), True)  # whether the pierce of a shape may be lawful, whatever is asked besides
    for asks, (number, shape) in product(wishes(around, options), enumerate(tried)):
        rows = np.flatnonzero(~found & pierced[number])
        if len(rows) == 0:
            continue
        left = ways.take(rows)
        leads = shaped(shape, left.joints, left.along, longest_mm[rows], options.lead_in_min_mm)
        clear = _may_pierce(leads, clearance_mm, around, options)
        pierced[number, rows] = clear
        for grants in (asks, clear_of_contours):
            clear[clear] = grants(leads.take(clear), left.joints.contour[clear])
        if options.tab_places is not None:
            clear[clear] = options.tab_places.beside(leads.take(clear), left.take(clear))
        done = rows[clear]
        found[done] = True
        pierce[done], bulge[done], length_mm[done] = leads.pierce[clear], leads.bulge[clear], leads.length_mm[clear]
    kept = ways.take(found)
    leads = Leads(pierce[found], kept.joints.join, bulge[found], length_mm[found])
    return Approaches(kept, leads, np.full(len(kept), False))


def _may_pierce(leads: Leads, clearance_mm: float, around: Surroundings, options: LeadOptions) -> Bools:
    """Leads whose pierce is on metal to burn away, clear of everything, and that stay on the sheet."""
    clear = np.full(len(leads.pierce), True)
    for grants in (
        lambda some: around.clear_pierces(some.pierce, clearance_mm),
        lambda some: around.in_waste(some.pierce),
        around.inside_edges,
        lambda some: _off_slits(some.pierce, around, options),
    ):
        clear[clear] = grants(leads.take(clear))
    return clear


def _off_slits(points: Floats, around: Surroundings, options: LeadOptions) -> Bools:
    """Pierces that keep from the kerfs of slits as from those of older cuts."""
    if options.splash_mm is None:
        return np.full(len(points), True)
    return around.off_slits(points, options.kerf_mm + options.splash_mm)


def wishes(around: Surroundings, options: LeadOptions) -> list[Callable[[Leads, Ints], Bools]]:
    """What to ask of leads for the sake of older kerfs, the most first and nothing last."""

    def nothing(leads: Leads, contour: Ints) -> Bools:
        return np.full(len(contour), True)

    def own_half(leads: Leads, contour: Ints) -> Bools:
        return around.own_half(leads, contour, kerf_mm + splash_mm)

    def off_kerfs(leads: Leads, contour: Ints) -> Bools:
        return around.off_kerfs(leads, contour, kerf_mm, splash_mm)

    if options.splash_mm is None:
        return [nothing]
    kerf_mm, splash_mm = options.kerf_mm, options.splash_mm
    return [own_half, off_kerfs, nothing]


def edge_starts(ways: Ways, around: Surroundings, options: LeadOptions) -> Approaches:
    """Straight leads from just outside the sheet, for those of the ways that are close to its edge."""
    joints = ways.joints
    to_edge = around.nearest_on_edge(joints.join) - joints.join
    distance_mm = np.hypot(to_edge[:, 0], to_edge[:, 1])
    ray = to_edge / np.maximum(distance_mm, 1e-6)[:, None]
    beyond_mm = max(options.kerf_mm, min(1.0, options.lead_in_mm))
    length_mm = distance_mm + beyond_mm
    leads = Leads(joints.join + length_mm[:, None] * ray, joints.join, np.zeros(len(ways)), length_mm)
    good = (
        (distance_mm <= 2 * options.lead_in_mm)
        & ((ray * joints.out).sum(axis=1) >= math.cos(EDGE_ANGLE_RAD))
        & around.off_sheet(leads.pierce, beyond_mm / 2)
    )
    good[good] = around.clear_leads(leads.take(good), joints.contour[good], options.kerf_mm / 2)
    if options.tab_places is not None:
        good[good] = options.tab_places.beside(leads.take(good), ways.take(good))
    return Approaches(ways.take(good), leads.take(good), np.full(int(good.sum()), True))


# Lead-outs: how the torch leaves a contour after it has gone once round.


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
