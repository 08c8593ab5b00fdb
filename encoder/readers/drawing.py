"""What a drawing holds before anyone knows which line is a part's: the common ground of DXF and SVG."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import shapely

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Note, Sheet
from kerfwise.encoder.validate.rings import enclosed


@dataclass(frozen=True, eq=False)
class DrawnCurve:
    """One drawn curve in mm, open or closed, on its layer; `order` counts in the order of the file.

    `within` are the names it can be known by, outermost first, where those are more than its layer's: groups of groups.
    `colour` and `linetype` are how it is drawn, "" where the file does not say; `filled` that it is an area without a
    line round it.
    """

    curve: Curve
    layer: str
    order: int
    within: tuple[str, ...] | None = None
    colour: str = ""
    linetype: str = ""
    filled: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """The names that say what it is for, outermost first."""
        return (self.layer,) if self.within is None else self.within

    @cached_property
    def area(self) -> shapely.Geometry:
        """The area inside a closed piece, made valid where the ring crosses itself."""
        return enclosed(self.curve)

    @property
    def place(self) -> str:
        """Where it is, for messages: its first vertex and its layer."""
        x, y = self.curve.vertices[0, :2].tolist()
        return f"at ({x:.3f}, {y:.3f}) on layer '{self.layer}'"


@dataclass(frozen=True, eq=False)
class Drawing:
    """The pieces of a drawing in mm, y up, with what its reader wants said.

    `units` is what it was read in, `because` why; `page` the drawing area, for a format that has one.
    """

    pieces: tuple[DrawnCurve, ...]
    units: str
    notes: tuple[Note, ...] = ()
    page: Sheet | None = None
    because: str = ""
