"""What is meant: the sheet, the parts' metal and the contours, as polygons of this judge's own making."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import shapely

from kerfwise.tests.metal.arcs import bulged

if TYPE_CHECKING:  # only the shape of it is used, so that nothing of the project comes along
    from kerfwise.encoder.nest import Contour, Nest


@dataclass(frozen=True, eq=False)
class Meant:
    """One contour: `line` as drawn, `area` inside it (None for a mark or a scrap line)."""

    id: str
    part: str
    kind: str
    line: shapely.LineString
    area: shapely.Polygon | None

    def path(self, kerf_mm: float) -> shapely.Geometry:
        """The line or lines on which the torch's centre burns exactly up to this contour; a scrap line is its own."""
        if self.kind == "scrap":
            return self.line
        assert self.area is not None
        return self.area.buffer(kerf_mm / 2 if self.kind == "outer" else -kerf_mm / 2, quad_segs=32).boundary

    def reachable(self, kerf_mm: float) -> shapely.Geometry:
        """The edge that is left when a round torch has burnt all it can without touching the part."""
        assert self.area is not None
        r = kerf_mm / 2 if self.kind == "outer" else -kerf_mm / 2
        return self.area.buffer(r, quad_segs=32).buffer(-r, quad_segs=32).boundary


@dataclass(frozen=True, eq=False)
class Drawing:
    """The sheet, its contours in file order, and the metal of each part."""

    sheet: shapely.Polygon
    contours: tuple[Meant, ...]
    parts: dict[str, shapely.Polygon]

    @cached_property
    def closed(self) -> tuple[Meant, ...]:
        """The contours that are cut through."""
        return tuple(c for c in self.contours if c.area is not None)

    @cached_property
    def marks(self) -> tuple[Meant, ...]:
        """The contours that are only marked."""
        return tuple(c for c in self.contours if c.kind == "mark")

    @cached_property
    def scrap(self) -> tuple[Meant, ...]:
        """The lines that cut up the skeleton."""
        return tuple(c for c in self.contours if c.kind == "scrap")


def drawing_of(nest: Nest) -> Drawing:
    """The drawing of a nest, flattened anew from its vertices and bulges."""
    contours, parts = [], {}
    for part in nest.parts:
        own = [_meant(c) for c in (*part.marks, *part.holes, part.outer)]
        contours += own
        holes = [c.area.exterior for c in own if c.kind == "hole" and c.area is not None]
        outer = own[-1].area
        assert outer is not None
        parts[part.id] = shapely.Polygon(outer.exterior, holes)
    contours += [_meant(c) for c in nest.scrap]
    outline = bulged(nest.sheet.outline.vertices, True)
    sheet = shapely.Polygon(outline, [bulged(h.vertices, True) for h in nest.sheet.holes])
    return Drawing(sheet, tuple(contours), parts)


def _meant(contour: Contour) -> Meant:
    closed = contour.curve.closed
    points = bulged(contour.curve.vertices, closed)
    area = shapely.Polygon(points) if contour.kind not in ("mark", "scrap") else None
    line = shapely.LineString(points) if len(points) > 1 else shapely.Point(points[0])
    return Meant(contour.id, contour.part, contour.kind, line, area)
