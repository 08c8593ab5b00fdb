"""What is meant: the sheet, the parts' metal and the contours, as polygons of this judge's own making."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import shapely

from kerfwise.tests.metal.arcs import bulged

if TYPE_CHECKING:  # only the shape of it is used, so that nothing of the project comes along
    from kerfwise import Nest
    from kerfwise.rule_kit import Contour


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
    """The sheet, its contours in file order, the metal of each part, and of each bridge the two parts as drawn."""

    sheet: shapely.Polygon
    contours: tuple[Meant, ...]
    parts: dict[str, shapely.Polygon]
    bridged: tuple[tuple[str, shapely.Polygon, shapely.Polygon], ...] = ()

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

    def without_holes(self, names: Collection[str]) -> Drawing:
        """The same, where these holes are none: the metal in them stays, and is the part's."""
        if not names:
            return self
        kept = tuple(c for c in self.contours if c.id not in names)
        solid = {part: [c.area for c in self.contours if c.id in names and c.part == part] for part in self.parts}
        whole = {part: shapely.union_all([metal, *solid[part]]) for part, metal in self.parts.items()}
        return replace(self, contours=kept, parts=whole)


def drawing_of(nest: Nest) -> Drawing:
    """The drawing of a nest, flattened anew from its vertices and bulges."""
    contours, parts = [], {}
    groups = joined(nest)
    for part in nest.parts:
        own = [_meant(c) for c in (*part.marks, *part.holes, part.outer)]
        if part not in (nest.apart or nest.parts):
            own = _as_joined(own, groups)
        contours += own
        holes = [c.area.exterior for c in own if c.kind == "hole" and c.area is not None]
        outer = own[-1].area
        assert outer is not None
        parts[part.id] = shapely.Polygon(outer.exterior, holes)
    if nest.apart:
        _expect_every_hole(nest, [c for c in contours if c.kind == "hole"], groups)
    contours += [_meant(c) for c in nest.scrap]
    outline = bulged(nest.sheet.outline.vertices, True)
    sheet = shapely.Polygon(outline, [bulged(h.vertices, True) for h in nest.sheet.holes])
    apart = {p.id: _polygon(p.outer).difference(shapely.union_all([*map(_polygon, p.holes)])) for p in nest.apart}
    bridged = tuple((b.name, apart[b.parts[0]], apart[b.parts[1]]) for b in nest.bridges)
    return Drawing(sheet, tuple(contours), parts, bridged)


def joined(nest: Nest) -> list[shapely.Polygon]:
    """The areas, waste that is enclosed left out, of parts as they are drawn and the strips that join them."""
    apart, groups = {part.id: part for part in nest.apart}, list[set[str]]()
    for bridge in nest.bridges:
        hit = [group for group in groups if group & set(bridge.parts)]
        groups = [group for group in groups if group not in hit] + [set(bridge.parts).union(*hit)]
    found = []
    for group in groups:
        lines = [(b.start, b.end, b.width_mm) for b in nest.bridges if set(b.parts) <= group]
        strips = [shapely.LineString(_longer(*line[:2])).buffer(line[2] / 2, cap_style="flat") for line in lines]
        found.append(shapely.union_all([*(_polygon(apart[name].outer) for name in sorted(group)), *strips]))
    return found


def _expect_every_hole(nest: Nest, holes: Sequence[Meant], groups: Sequence[shapely.Polygon]) -> None:
    """Joined parts have the holes that they were drawn with, and those that their bridges enclose: no other."""
    drawn = [_polygon(hole) for part in nest.apart for hole in part.holes]
    pockets = [shapely.Polygon(ring) for group in groups for ring in group.interiors]
    there = shapely.union_all([hole.area for hole in holes])
    assert shapely.symmetric_difference(there, shapely.union_all([*drawn, *pockets])).area < 0.01, "holes got lost"


def _longer(start: Sequence[float], end: Sequence[float]) -> list[tuple[float, float]]:
    """A strip that ends on an edge, a little into the part."""
    (x0, y0), (x1, y1) = start, end
    share = 0.02 / math.dist(start, end)
    dx, dy = (x1 - x0) * share, (y1 - y0) * share
    return [(x0 - dx, y0 - dy), (x1 + dx, y1 + dy)]


def _as_joined(own: list[Meant], groups: list[shapely.Polygon]) -> list[Meant]:
    """The contours of a joined part, its outline and the waste that its bridges enclose put together here."""
    outer = own[-1].area
    assert outer is not None
    area = max(groups, key=lambda group: group.intersection(outer).area - group.symmetric_difference(outer).area)
    pockets = [shapely.Polygon(ring) for ring in area.interiors]
    made = []
    for one in own[:-1]:
        pocket = max(pockets, key=lambda p: p.intersection(one.area).area, default=None) if one.area else None
        if pocket is not None and pocket.intersects(one.area.representative_point()):
            one = Meant(one.id, one.part, one.kind, shapely.LineString(pocket.exterior), pocket)
        made.append(one)
    whole = shapely.Polygon(area.exterior)
    return [*made, Meant(own[-1].id, own[-1].part, "outer", shapely.LineString(whole.exterior), whole)]


def _polygon(contour: Contour) -> shapely.Polygon:
    return shapely.Polygon(bulged(contour.curve.vertices, True))


def _meant(contour: Contour) -> Meant:
    closed = contour.curve.closed
    points = bulged(contour.curve.vertices, closed)
    area = shapely.Polygon(points) if contour.kind not in ("mark", "scrap") else None
    line = shapely.LineString(points) if len(points) > 1 else shapely.Point(points[0])
    return Meant(contour.id, contour.part, contour.kind, line, area)
