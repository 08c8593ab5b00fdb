"""The keys of a profile that set the options of leads, for messages."""

from __future__ import annotations

IN_PROFILE = {
    "kerf_mm": "material.kerf",
    "lead_in_mm": "leads.lead_in",
    "lead_in_min_mm": "leads.lead_in_min",
    "pierce_clearance_mm": "rules.pierce.clearance",
    "under": "small_holes.under",
    "least_mm": "small_holes.min_hole",
    "splash_mm": "rules.pierce.splash",
    "tabs": "rules.hold-small-parts",
    "common": "cuts.common",
    "narrow": "cuts.narrow",
    "corner_mm": "corners.leave",
}
"""What the people who read messages know these options as."""
