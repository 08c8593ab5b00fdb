"""Lead-ins: of all that would do, the one to take at each joint."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import product

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints

from .approaches import Approaches, Ways
from .candidate import LEAST_WASTE_MM, LeadOptions
from .lead_shapes import Leads, LeadShape, shaped
from .surroundings import CHORD_MM, Surroundings

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
