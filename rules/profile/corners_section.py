"""What a profile says of corners: feeds there, and how much of them a round kerf may leave."""

from __future__ import annotations

from dataclasses import dataclass, field

from kerfwise.encoder.corner_feed import CornerFeed
from kerfwise.rules.options.by_thickness import LENGTH_BY_THICKNESS, ByThickness, Thicknesses, length_at
from kerfwise.rules.options.option import option
from kerfwise.rules.options.plain_values import Number
from kerfwise.rules.options.quantities import LENGTH, OrWord


@dataclass(frozen=True, slots=True)
class Corners:
    """How much slower the torch goes round corners, and how much of an inner corner it may leave."""

    corner_feed: float = field(
        default=1.0, metadata=option(Number(0.05, 1), "share of the cut feed near a corner; 1 for all of it")
    )
    corner_angle: float = field(
        default=45.0, metadata=option(Number(10, 180), "from how many degrees on a turn of the path is a corner")
    )
    corner_reach: ByThickness = field(
        default=Thicknesses(0.5),
        metadata=option(LENGTH_BY_THICKNESS, "how far before and behind a corner it goes slower"),
    )
    leave_mm: float | None = field(
        default=None,
        metadata=option(OrWord(LENGTH, "any"), "how much of an inner corner the round kerf may leave; more is refused"),
    )

    def law(self, thickness_mm: float) -> CornerFeed | None:
        """The feeds on a sheet of that thickness; None where corners are cut like the rest."""
        reach_mm = length_at(self.corner_reach, thickness_mm)
        if self.corner_feed >= 1 or reach_mm <= 0:
            return None
        return CornerFeed(self.corner_feed, self.corner_angle, reach_mm)
