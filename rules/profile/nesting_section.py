"""What a profile says of making nests: how far parts lie from each other and from the edge of the sheet."""

from __future__ import annotations

from dataclasses import dataclass, field

from kerfwise.rules.options.by_thickness import LENGTH_BY_THICKNESS, ByThickness, Thicknesses
from kerfwise.rules.options.option import option


@dataclass(frozen=True, slots=True)
class Nesting:
    """How `kerfwise nest` lays parts on sheets."""

    web_mm: ByThickness = field(
        default=Thicknesses(1.0),
        metadata=option(LENGTH_BY_THICKNESS, "metal left between two parts; a kerf comes to it"),
    )
    edge_mm: ByThickness = field(
        default=10.0, metadata=option(LENGTH_BY_THICKNESS, "least distance of parts from the edge of the sheet")
    )
