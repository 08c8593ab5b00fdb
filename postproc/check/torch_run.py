"""One torch-on path, taken apart: lead-in, once round, lead-out."""

from __future__ import annotations

from dataclasses import dataclass

import shapely

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour

_CHORD_MM = 0.005


@dataclass(frozen=True, eq=False, slots=True)
class TorchRun:
    """What the torch does between on and off.

    `position` counts cuts from 1; `where` says where a person finds it ("cut 3" or "line 40"). `loop` is the path
    around the contour; `marks` says that another tool than the torch was on. A `linked` run follows the one before it
    with the torch on: its lead-in is the link. The loop of a `partial` one is not all of its contour's ring.
    """

    position: int
    where: str
    contour: Contour | None
    lead_in: shapely.LineString | None
    loop: shapely.LineString
    lead_out: shapely.LineString | None
    marks: bool = False
    linked: bool = False
    partial: bool = False

    @property
    def name(self) -> str:
        """The contour's id, or a stand-in where the path matches none."""
        return self.contour.id if self.contour is not None else "an unknown path"

    @property
    def leads(self) -> tuple[shapely.LineString, ...]:
        """Lead-in and lead-out, where there are any."""
        return tuple(lead for lead in (self.lead_in, self.lead_out) if lead is not None)

    @property
    def length_mm(self) -> float:
        """Torch-on length, mm."""
        return float(self.loop.length + sum(lead.length for lead in self.leads))


def line_of(path: Curve | None) -> shapely.LineString | None:
    """An open path as a line; None for one that goes nowhere."""
    return path.line(_CHORD_MM) if path is not None and path.segments else None
