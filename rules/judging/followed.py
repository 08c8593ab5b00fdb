"""Which stretch of its contour a cut follows: all of it, or what others have left."""

from __future__ import annotations

from dataclasses import dataclass

import shapely

from kerfwise.encoder.cut import Cut
from kerfwise.encoder.nest import Contour

from .facing import ring_of


@dataclass(frozen=True, slots=True)
class Followed:
    """Where a cut begins and ends along its contour as drawn, mm, and how far it follows it: below 0 against it."""

    begin_mm: float
    end_mm: float
    length_mm: float

    def stretch(self, share: float, *, last: bool) -> tuple[float, float]:
        """Where the first or the last share of the cut begins, as seen from its end of the cut, and how long it is."""
        return (self.end_mm, -share * self.length_mm) if last else (self.begin_mm, share * self.length_mm)


def followed(contour: Contour, cut: Cut) -> Followed:
    """The stretch of a closed contour that a cut follows.

    Examples
    --------
    >>> from kerfwise.encoder.by_hand import part, rect
    >>> from kerfwise.encoder.cut import Span
    >>> square = part("A", rect(0, 0, 10, 10)).outer
    >>> followed(square, Cut("A.outer", (10, 0), "cw", (11, 0)))
    Followed(begin_mm=10.0, end_mm=10.0, length_mm=-40.0)
    >>> followed(square, Cut("A.outer", (10, 0), "cw", (11, 0), span=Span((11, 0), (10, 11))))
    Followed(begin_mm=10.0, end_mm=20.0, length_mm=-30.0)
    """
    line = contour.line
    around_mm = line.length
    begin_mm = float(shapely.line_locate_point(line, shapely.Point(cut.entry)))
    as_drawn = (cut.direction == "ccw") == bool(shapely.is_ccw(ring_of(line)))
    if cut.span is None:
        return Followed(begin_mm, begin_mm, around_mm if as_drawn else -around_mm)
    end_mm = float(shapely.line_locate_point(line, shapely.Point(cut.span.end)))
    way_mm = (end_mm - begin_mm if as_drawn else begin_mm - end_mm) % around_mm
    return Followed(begin_mm, end_mm, way_mm if as_drawn else -way_mm)
