"""What a profile tells the simulation: the kerf, and what the plant allows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kerfwise.rules.profile.profile import Profile

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
    }
