"""What a profile says of holes that are small for its process."""

from __future__ import annotations

from dataclasses import dataclass, field

from kerfwise.encoder.small_holes import HoleLimits, Under
from kerfwise.rules.options.by_thickness import LENGTH_BY_THICKNESS, ByThickness, Thicknesses, length_at
from kerfwise.rules.options.option import option
from kerfwise.rules.options.plain_values import Choice, Number
from kerfwise.rules.options.quantities import LENGTH, over_zero


@dataclass(frozen=True, slots=True)
class SmallHoles:
    """From which diameter on a hole is cut, what is done with smaller ones, and how fast small ones are cut."""

    min_hole: ByThickness = field(
        default=Thicknesses(1.0),
        metadata=option(LENGTH_BY_THICKNESS, "least diameter, or width, of a hole that is cut"),
    )
    under: Under = field(
        default="refuse",
        metadata=option(
            Choice(("refuse", "spot", "skip")),
            "a hole under min_hole, or where no pierce has room: refuse the nest, mark its middle, or leave it out",
        ),
    )
    full_feed_hole: ByThickness = field(
        default=Thicknesses(5.0),
        metadata=option(LENGTH_BY_THICKNESS, "diameter from which on a hole is cut at the full cut feed"),
    )
    small_hole_feed: float = field(
        default=1.0,
        metadata=option(Number(0.05, 1), "share of the cut feed at min_hole; it rises in a line to full_feed_hole"),
    )
    spot_size_mm: float = field(
        default=2.0, metadata=option(over_zero(LENGTH), "size of the cross that marks the middle of a hole")
    )

    def limits(self, thickness_mm: float, clearance_mm: float) -> HoleLimits:
        """The limits in mm, on a sheet of that thickness, where a pierce keeps `clearance_mm` from every contour."""
        return HoleLimits(
            least_mm=length_at(self.min_hole, thickness_mm),
            under=self.under,
            room_mm=2 * clearance_mm,
            full_feed_mm=length_at(self.full_feed_hole, thickness_mm) if self.small_hole_feed < 1 else 0.0,
            feed_share=self.small_hole_feed,
            spot_mm=self.spot_size_mm,
        )
