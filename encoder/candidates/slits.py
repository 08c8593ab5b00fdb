"""Candidates of slits: pierced in the waste before the mouth, led straight in or at an angle, then along the line."""

from __future__ import annotations

import math
from itertools import product

import numpy as np

from kerfwise.arrays import Bools
from kerfwise.encoder.geometry.curve import Curve

from .candidate import Candidate, LeadOptions
from .joints import Joints
from .lead_in import least_clearance_mm, wishes
from .lead_shapes import Leads, LeadShape, shaped
from .surroundings import Surroundings

TURNS_DEG = (0, 20, -20, 40, -40, 65, -65)
"""Leads to a slit, by the angle that they make with it."""
_LENGTHS = 8


def slit_candidates(index: int, around: Surroundings, options: LeadOptions) -> list[Candidate]:
    """The ways to cut a slit, by the angle of the lead, each lead as long as there is room for; none without room.

    As with other contours, leads that keep off the kerfs of other parts are better than longer ones.
    """
    contour = around.contours[index]
    curve = contour.curve
    start, end, ahead = curve.point_at(0.0), curve.point_at(curve.length_mm), np.array([curve.tangent_at(0.0)])
    at, aside = np.array([start]), np.column_stack([-ahead[:, 1], ahead[:, 0]])
    joint = Joints(np.array([index]), np.zeros(1), at, np.zeros(1), at, -ahead)
    off = Curve(np.array([[*end, 0.0]]), closed=False)
    found = []
    if options.lead == "none":
        on_path = Leads(at, at, np.zeros(1), np.zeros(1))
        if _clear(on_path, index, around, options)[0]:
            found.append(Candidate(index, 0.0, start, "ccw", start, None, off, end, curve.length_mm))
        return found
    for turn in TURNS_DEG:
        for asks, shortened in product(wishes(around, options), np.linspace(0, 1, _LENGTHS).tolist()):
            shape = LeadShape("line", shortened, math.radians(turn))
            leads = shaped(shape, joint, aside, np.array([options.lead_in_mm]), options.lead_in_min_mm)
            if _clear(leads, index, around, options)[0] and asks(leads, joint.contour)[0]:
                px, py = leads.pierce[0].tolist()
                lead = Curve.of([(px, py), start], closed=False)
                cut_mm = lead.length_mm + curve.length_mm
                found.append(Candidate(index, 0.0, start, "ccw", (px, py), lead, off, end, cut_mm))
                break
    return found


def no_room(index: int, around: Surroundings, options: LeadOptions) -> str:
    """Why a slit has no candidate, as a sentence."""
    contour = around.contours[index]
    x, y = contour.curve.point_at(0.0)
    clearance_mm = least_clearance_mm(options)
    return (
        f"{contour.slot_of}: the slot with its mouth at ({x:z.1f}, {y:z.1f}) cannot be opened by a slit: the waste "
        f"before it has no room for a pierce {clearance_mm:g} mm from every contour"
    )


def _clear(leads: Leads, index: int, around: Surroundings, options: LeadOptions) -> Bools:
    """Leads that are lawful by themselves."""
    own = np.array([index])
    not_own = np.array([[index, around.around[index]]]) if options.lead == "none" else own
    clear = around.clear_pierces(leads.pierce, least_clearance_mm(options), not_own) & around.in_waste(leads.pierce)
    clear &= around.inside_edges(leads)
    if options.splash_mm is not None:
        clear &= around.off_slits(leads.pierce, options.kerf_mm + options.splash_mm, own)
    if options.lead != "none":
        clear &= around.clear_leads(leads, own, options.kerf_mm / 2)
    return clear
