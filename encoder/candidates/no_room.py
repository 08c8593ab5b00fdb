"""Why contours have no lawful lead, in words."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kerfwise.arrays import Floats

from .approaches import ways
from .candidate import LeadOptions
from .joints import Joints, Outline
from .lead_in import lead_ins, least_clearance_mm, shapes
from .lead_shapes import shaped
from .profile_keys import IN_PROFILE
from .search import dense, longest_lead_mm
from .surroundings import Surroundings
from .tried import TriedLeads

ALONE = ("reach", "narrow", "slit")
"""Causes that are told of each contour by itself: how far it is out, or which places of it."""

WITHOUT_ROOM = ("pierce", "lead", "path")
"""Causes that more room in the nest would take away."""

BURNT = "what is already cut leaves no metal to pierce near it: all pierces and leads there would lie in older kerfs"

_LOOKS = 8
"""Entries of a contour that are looked at; some of those that the search has tried."""


@dataclass(frozen=True, slots=True)
class Reason:
    """Why a contour cannot be cut as the options ask: a whole sentence, and the cause alone, which others may share.

    `gap_mm` is how far from everything the best spot for a pierce is, where that is what stands in the way.
    """

    text: str
    cause: str
    gap_mm: float | None = None


def reasons(tried: TriedLeads, around: Surroundings, options: LeadOptions) -> dict[int, Reason]:
    """The reason of every contour at fault, by number."""
    said = {k: Reason(text, "small") for k, text in tried.small.items()}
    said |= {k: Reason(text, "kerf") for k, text in tried.uncut.items()}
    said |= {k: Reason(one.sentence(options), "narrow") for k, one in tried.narrow.items()}
    said |= {k: Reason(text, "reach") for k, text in tried.beyond.items()}
    said |= {k: Reason(text, "slit") for k, text in tried.shut.items()}
    if tried.bare:
        joints = Joints.joined([dense(tried.outlines[k], _LOOKS) for k in tried.bare])
        burnt = _but_for_what_is_cut(tried, around, options)
        for k, (cause, why, gap_mm) in _why(joints, tried.outlines, around, options, tried.bare).items():
            if k in burnt:
                cause, why, gap_mm = "burnt", BURNT, None
            x, y = tried.outlines[k].contour.curve.vertices[0, :2].tolist()
            said[k] = Reason(f"{tried.outlines[k].contour.id} at ({x:.1f}, {y:.1f}): {why}", cause, gap_mm)
    for i in tried.unmet:
        k = int(tried.locked.contour[i])
        x, y = tried.locked.entry[i].tolist()
        cause, why, gap_mm = _why(tried.locked.take(np.array([i])), tried.outlines, around, options, [k])[k]
        said[k] = Reason(
            f"{tried.outlines[k].contour.id} at the entry asked for, ({x:.1f}, {y:.1f}): {why}", cause, gap_mm
        )
    return said


def _but_for_what_is_cut(tried: TriedLeads, around: Surroundings, options: LeadOptions) -> set[int]:
    """Contours that have room for a lead but for metal that a stopped program has burnt away."""
    if around.void is None:
        return set()
    to_try = ways(Joints.joined([dense(tried.outlines[k]) for k in tried.bare]), tried.outlines, options.directions)
    longest_mm = np.array([longest_lead_mm(tried.outlines[k], options) for k in to_try.joints.contour.tolist()])
    found = lead_ins(to_try, longest_mm, replace(around, void=None), options, patient=True)
    return set(found.ways.joints.contour.tolist())


def _why(
    joints: Joints, outlines: Mapping[int, Outline], around: Surroundings, options: LeadOptions, contours: Sequence[int]
) -> dict[int, tuple[str, str, float | None]]:
    """Why there is no room at any of the joints, by contour: the cause, in words, and the widest gap for a pierce."""
    led = options.lead != "none"
    best = _best_pierces(joints, outlines, around, options) if led else {}
    clearance_mm = least_clearance_mm(options)
    found: dict[int, tuple[str, str, float | None]] = {}
    for k in contours:
        if k in best:
            gap_mm, what = around.nearest(best[k])
            gap_mm = math.floor(gap_mm * 100 + 1e-3) / 100
            why = (
                f"the best spot for a pierce near it is {gap_mm:g} mm from {what}, "
                f"{IN_PROFILE['pierce_clearance_mm']} asks for {clearance_mm:g} mm"
            )
            found[k] = "pierce", why, gap_mm
        elif led:
            why = (
                f"no lead from {IN_PROFILE['lead_in_min_mm']}, {options.lead_in_min_mm:g} mm, to "
                f"{IN_PROFILE['lead_in_mm']}, {options.lead_in_mm:g} mm, "
                f"keeps half the kerf, {options.kerf_mm / 2:g} mm, away from what is around it"
            )
            found[k] = "lead", why, None
        else:
            why = (
                "without a lead the pierce lies on the torch's path, and all of that is nearer to others than "
                f"{IN_PROFILE['pierce_clearance_mm']}, {clearance_mm:g} mm"
            )
            found[k] = "path", why, None
    return found


def _best_pierces(
    joints: Joints, outlines: Mapping[int, Outline], around: Surroundings, options: LeadOptions
) -> dict[int, Floats]:
    """Of the leads that are otherwise lawful, the pierce furthest from everything, by contour."""
    best: dict[int, tuple[float, Floats]] = {}
    to_try = ways(joints, outlines, options.directions)
    longest_mm = np.array([longest_lead_mm(outlines[k], options) for k in to_try.joints.contour.tolist()])
    for shape in shapes(replace(options, lead="line"), patient=True):
        leads = shaped(shape, to_try.joints, to_try.along, longest_mm, options.lead_in_min_mm)
        clear = around.clear_leads(leads, to_try.joints.contour, options.kerf_mm / 2) & around.inside_edges(leads)
        gaps_mm = around.gaps_mm(leads.pierce[clear])
        for k, gap_mm, pierce in zip(
            to_try.joints.contour[clear].tolist(), gaps_mm.tolist(), leads.pierce[clear], strict=True
        ):
            if gap_mm > best.get(k, (0.0, pierce))[0]:
                best[k] = (gap_mm, pierce)
    return {k: pierce for k, (_, pierce) in best.items()}
