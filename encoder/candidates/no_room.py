"""Why a contour has no lawful lead, and which option would give it one."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..compensation import compensated
from ..errors import InputError
from ..geometry.curve import FloatArray
from .approaches import Approaches, ways
from .candidate import IN_PROFILE, LeadOptions
from .joints import Joints, Outline
from .lead_in import lead_ins, least_clearance_mm, shapes
from .lead_shapes import shaped
from .search import dense, longest_lead_mm
from .surroundings import Surroundings

_LOOKS = 8
"""Entries of a contour that are looked at; some of those that the search has tried."""

_SHARES = (0.5, 0.25, 0.1)
"""How much smaller an option is tried."""


def no_room(
    found: Approaches, locked: Joints, outlines: Mapping[int, Outline], around: Surroundings, options: LeadOptions
) -> dict[int, str]:
    """A sentence for each contour that has no approach, or none at the entry that is asked for."""
    joints = found.ways.joints
    led = set(zip(joints.contour.tolist(), joints.entry_mm.tolist(), strict=True))
    bare = sorted(set(outlines) - {k for k, _ in led})
    everywhere = [dense(outlines[k], _LOOKS) for k in bare]
    reasons = _reasons(Joints.joined(everywhere), outlines, around, options, bare) if bare else {}
    said = {}
    for k in bare:
        x, y = outlines[k].contour.curve.vertices[0, :2].tolist()
        said[k] = f"{outlines[k].contour.id} at ({x:.1f}, {y:.1f}): {reasons[k]}"
    for i, (k, entry_mm) in enumerate(zip(locked.contour.tolist(), locked.entry_mm.tolist(), strict=True)):
        if k not in said and (k, entry_mm) not in led:
            x, y = locked.entry[i].tolist()
            why = _reasons(locked.take(np.array([i])), outlines, around, options, [k])[k]
            said[k] = f"{outlines[k].contour.id} at the entry asked for, ({x:.1f}, {y:.1f}): {why}"
    return said


def _reasons(
    joints: Joints, outlines: Mapping[int, Outline], around: Surroundings, options: LeadOptions, contours: list[int]
) -> dict[int, str]:
    """Why there is no room at any of the joints, by contour."""
    led = options.lead != "none"
    best = _best_pierces(joints, outlines, around, options) if led else {}
    names = ("lead_in_min_mm" if led else "pierce_clearance_mm", "kerf_mm")
    freed = {name: _freed_by(name, joints, outlines, around, options) for name in names}
    clearance_mm = least_clearance_mm(options)
    reasons = {}
    for k in contours:
        frees = []
        if k in best:
            gap_mm, what = around.nearest(best[k])
            gap_mm = math.floor(gap_mm * 100 + 1e-3) / 100
            why = (
                f"the best spot for a pierce near it is {gap_mm:g} mm from {what}, "
                f"{IN_PROFILE['pierce_clearance_mm']} asks for {clearance_mm:g} mm"
            )
            if gap_mm > options.kerf_mm / 2 + 0.01:
                frees.append(f"{IN_PROFILE['pierce_clearance_mm']} ≤ {gap_mm:g} mm")
        elif led:
            why = (
                f"no lead from {IN_PROFILE['lead_in_min_mm']}, {options.lead_in_min_mm:g} mm, to "
                f"{IN_PROFILE['lead_in_mm']}, {options.lead_in_mm:g} mm, "
                f"keeps half the kerf, {options.kerf_mm / 2:g} mm, away from what is around it"
            )
        else:
            why = (
                "without a lead the pierce lies on the torch's path, and all of that is nearer to others than "
                f"{IN_PROFILE['pierce_clearance_mm']}, {clearance_mm:g} mm"
            )
        frees += [f"{IN_PROFILE[name]} ≤ {values[k]:g} mm" for name, values in freed.items() if k in values]
        remedy = f"{' or '.join(frees)} would free it" if frees else "it needs more room in the nest"
        reasons[k] = f"{why}; {remedy}"
    return reasons


def _best_pierces(
    joints: Joints, outlines: Mapping[int, Outline], around: Surroundings, options: LeadOptions
) -> dict[int, FloatArray]:
    """Of the leads that are otherwise lawful, the pierce furthest from everything, by contour."""
    best: dict[int, tuple[float, FloatArray]] = {}
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


def _freed_by(
    name: str, joints: Joints, outlines: Mapping[int, Outline], around: Surroundings, options: LeadOptions
) -> dict[int, float]:
    """The largest value tried of an option that gives a contour a lead, by contour."""
    freed: dict[int, float] = {}
    for share in _SHARES:
        value = round(getattr(options, name) * share, 3)
        changed = replace(options, **{name: value})
        left = {k: outlines[k] for k in np.unique(joints.contour).tolist() if k not in freed}
        if name == "kerf_mm":
            left = _recut(left, value)
        moved = [left[k].joints(joints.entry_mm[joints.contour == k])[0] for k in left]
        to_try = ways(Joints.joined(moved), left, options.directions)
        longest_mm = np.array([longest_lead_mm(left[k], changed) for k in to_try.joints.contour.tolist()])
        good = lead_ins(to_try, longest_mm, around, changed)
        freed |= dict.fromkeys(np.unique(good.ways.joints.contour).tolist(), value)
    return freed


def _recut(outlines: Mapping[int, Outline], kerf_mm: float) -> dict[int, Outline]:
    """The outlines with another kerf, those that it leaves something of."""
    recut = {}
    for k, outline in outlines.items():
        try:
            recut[k] = Outline.of(k, outline.contour, compensated(outline.contour, kerf_mm), kerf_mm / 2)
        except InputError:
            continue
    return recut
