"""Which stretch of its contour a cut follows: all of it, or what others have left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.encoder.cut import Cut
from kerfwise.encoder.nest import Contour


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
    return every_followed([(contour, cut)])[0]


def every_followed(rows: Sequence[tuple[Contour, Cut]]) -> list[Followed]:
    """As `followed` of each, in less time."""
    if not rows:
        return []
    lines = np.array([contour.line for contour, _ in rows], dtype=object)
    begin_mm = shapely.line_locate_point(lines, shapely.points([cut.entry for _, cut in rows]))
    points, of = shapely.get_coordinates(lines, return_index=True)
    ccw = shapely.is_ccw(shapely.linearrings(points, indices=of))
    told = zip(rows, lines, begin_mm.tolist(), shapely.length(lines).tolist(), ccw.tolist(), strict=True)
    return [
        _followed(cut, line, begin, around, (cut.direction == "ccw") == turns)
        for (_, cut), line, begin, around, turns in told
    ]


def _followed(cut: Cut, line: shapely.LineString, begin_mm: float, around_mm: float, as_drawn: bool) -> Followed:
    if cut.span is None:
        return Followed(begin_mm, begin_mm, around_mm if as_drawn else -around_mm)
    end_mm = float(shapely.line_locate_point(line, shapely.Point(cut.span.end)))
    way_mm = (end_mm - begin_mm if as_drawn else begin_mm - end_mm) % around_mm
    return Followed(begin_mm, end_mm, way_mm if as_drawn else -way_mm)
