"""What a profile tells the simulation: the kerf, and what the plant allows."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kerfwise import Plan, Profile

CORNER_KERFS = 3.4
"""A round kerf leaves so many kerfs of a corner of 15°; bend reliefs that are cut across are no deeper than two."""
SHARED_METAL = "shared-metal"
"""The rule that keeps parts a kerf apart; where it is off, as in wood, parts may touch."""


def plant(profile: Profile) -> dict[str, Any]:
    """The keywords of `simulate` that a profile decides."""
    shared, pierce = profile.rules.get(SHARED_METAL), profile.settings().get("pierce")
    return {
        "splash_mm": getattr(pierce.options, "splash_mm", 0.0) if pierce else 0.0,
        "kerf_mm": profile.material.kerf_mm,
        "edge_starts": profile.leads.edge_start,
        "touching": shared is not None and shared.strength == "off",
        "slits": profile.cuts.narrow == "slit",
        "features_kerfs": {"leave": math.inf, "refuse": 1.0}.get(profile.cuts.narrow, CORNER_KERFS),
        "pierce_pass": profile.cuts.pierce_pass is not None,
        "torches": [profile.machine.torches.shift(k) for k in range(1, profile.machine.torches.count + 1)],
        "common": profile.cuts.common.shortest_mm is not None or bool(profile.cuts.in_stretches),
    }


def tabs_of(plan: Plan) -> dict[str, list[tuple[float, float, float]]]:
    """The tabs that a plan leaves, or has left before a stop, as `simulate` takes them."""
    cuts = [planned.cut for planned in (*plan.already_cut, *plan.cuts)]
    return {cut.contour: [(*tab.at, tab.width_mm) for tab in cut.tabs] for cut in cuts if cut.tabs}


def hole_limit_mm(profile: Profile) -> float:
    """The widest hole that may be marked or left out: as the plant says, or one in which a pierce has no room."""
    return profile.hole_limits().limit_mm
