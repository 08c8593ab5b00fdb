"""Snakes: rows of neighbours, cut out along one side of each with the torch on, and back along the other."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import Direction, Span, Stretch
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import tolerance_mm
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.torch_path import compensated

from .candidate import Candidate, CommonOptions, LeadOptions
from .common_edges import FacingEdge, facing_edges
from .stretches import way_of

# A row runs along the normals of the edges by which its parts face each other. The way out begins at one end of it,
# follows the side of each part that lies to the right of the row (or to the left), and crosses each gap straight: in
# line with the sides, where these are in one line, else square to the edges that face each other, a kerf from the end
# of what faces. Rows beside each other may follow each other in one way: out along one, back along the next. What is
# left of each part is one stretch, from where the way leaves it round to where it came to it.

_TURN = math.sin(math.radians(0.2))
_CHORD_MM = 0.01
_OTHERS_KERFS = 1.5
"""A link keeps so many kerfs from contours that it does not join, from the middle of its own."""
_LEAST_SHARE = 0.1
"""At the ends of a row a stretch is between this share of its ring and the rest of it."""


Link = tuple[Point, Point]


@dataclass(frozen=True, slots=True)
class SnakeOptions:
    """Neighbours in a row are `gap_mm` apart at the most, and `parts` in number at the least; so are `rows` of a snake.

    Those a kerf apart share the edge between them, as `shared` says, if they `may_share` it.
    """

    gap_mm: float
    parts: int
    shared: CommonOptions
    may_share: bool = True
    rows: int = 1


@dataclass(frozen=True, eq=False, slots=True)
class Row:
    """Contours that follow each other in a direction (a unit vector), and which side the way out takes.

    `links` lead from each to the next, from ring to ring; the side is to the right of the row, or to the left. Where
    one row follows another, `of` are these rows, and the last goes in the direction `last_along`.
    """

    name: str
    contours: tuple[Contour, ...]
    along: Point
    right: bool
    links: tuple[Link, ...]
    last_along: Point
    of: tuple[Row, ...] = ()

    @property
    def direction(self) -> Direction:
        """The way round its contours that the way out goes, from the first to the last."""
        return "ccw" if self.right else "cw"

    @property
    def members(self) -> frozenset[str]:
        """Ids of its contours."""
        return frozenset(contour.id for contour in self.contours)


def rows_of(
    nest: Nest, kerf_mm: float, options: SnakeOptions, left: Collection[str], directions: Sequence[Direction]
) -> list[Row]:
    """The rows of neighbours among the contours that are `left`, longest first, each contour in one of them.

    Parts that stand within two kerfs of one that is not in the row are in none, nor are those in holes.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> plate = nest(400, 100, *(part(name, rect(10 + 90 * k, 10, 80, 60)) for k, name in enumerate("ABC")))
    >>> names = [contour.id for contour in plate.contours]
    >>> rows = rows_of(plate, 1.5, SnakeOptions(20.0, 2, CommonOptions(0.0, 0.05)), names, ("cw", "ccw"))
    >>> [([contour.part for contour in row.contours], row.direction, row.links[0]) for row in rows]
    [(['A', 'B', 'C'], 'ccw', ((90.0, 9.25), (100.0, 9.25)))]
    """
    outers = [(nest.index[part.outer.id], part.outer) for part in nest.parts if part.outer.id in {*left}]
    if len(outers) < options.parts or kerf_mm <= 0 or not directions:
        return []
    apart = _Apart.of(nest, kerf_mm)
    within_mm = (options.gap_mm - kerf_mm) / 2 + _CHORD_MM
    found = list(facing_edges(outers, kerf_mm + within_mm - _CHORD_MM, within_mm)) if within_mm > 0 else []
    taken: set[str] = set()
    rows: list[Row] = []
    chains = [chain for group in _by_direction(found) for chain in _chains(nest, group)]
    for chain in sorted(chains, key=lambda chain: (-len(chain), [edge.contour for edge in chain])):
        for part in _split(nest, chain, taken, apart, kerf_mm, options):
            names = {nest.contours[k].id for edge in part for k in (edge.contour, edge.other)}
            if len(names) < options.parts or apart.crowded(names):
                continue
            if (row := _row(nest, part, apart, len(rows) + 1, options)) is not None:
                rows.append(row)
                taken |= row.members
    return rows if options.rows < 2 else _stacked(nest, rows, found, apart, options)


def _stacked(
    nest: Nest, rows: Sequence[Row], edges: Sequence[FacingEdge], apart: _Apart, options: SnakeOptions
) -> list[Row]:
    """Rows beside each other as one: out along the first, back along the next, and so on, all the same way round."""
    facing = {(edge.contour, edge.other): edge for edge in sorted(edges, key=lambda edge: edge.length_mm)}
    left, found = list(rows), list[Row]()
    while left:
        tried = [
            _grid(nest, first, onwards, left, facing, apart, options) for first in left for onwards in (True, False)
        ]
        best = max((left[0], *tried), key=lambda row: len(row.of))
        found.append(best)
        left = [row for row in left if row not in (best, *best.of)]
    return found


def _grid(
    nest: Nest,
    first: Row,
    onwards: bool,
    rows: Sequence[Row],
    facing: Mapping[tuple[int, int], FacingEdge],
    apart: _Apart,
    options: SnakeOptions,
) -> Row:
    """A row with those that follow it: each begins at a part that the last part of the row before faces.

    The first goes along its outer side, so do all others: between two rows the metal hangs to the sheet at one end.
    """
    up = np.array([-first.along[1], first.along[0]])
    grid, back = _towards(nest, first, onwards, onwards, facing, apart, options), not onwards
    while grid is not None and len(grid.of) < options.rows:
        end, outside = grid.contours[-1], onwards == (len(grid.of) % 2 == 1)
        longer = None
        for row in rows:
            edge = facing.get((nest.index[end.id], nest.index[row.contours[0 if back else -1].id]))
            level = abs(first.along[0] * row.along[1] - first.along[1] * row.along[0]) <= _TURN
            if row in grid.of or edge is None or not level or float(_normal(edge) @ up) < 1 - _TURN:
                continue
            over = _links(nest, [edge], up, outside, apart, options)
            more = _towards(nest, row, back, onwards, facing, apart, options)
            if over is not None and more is not None:
                longer = replace(
                    grid,
                    contours=(*grid.contours, *more.contours),
                    links=(*grid.links, *over, *more.links),
                    last_along=more.along,
                    of=(*grid.of, row),
                )
                break
        if longer is None:
            break
        grid, back = longer, not back
    return first if grid is None or len(grid.of) < 2 else grid


def _towards(
    nest: Nest,
    row: Row,
    onwards: bool,
    right: bool,
    facing: Mapping[tuple[int, int], FacingEdge],
    apart: _Apart,
    options: SnakeOptions,
) -> Row | None:
    """The row the same way, or backwards, with its way on this side; None where a link there is not free."""
    contours = row.contours if onwards else row.contours[::-1]
    edges = [facing[nest.index[one.id], nest.index[other.id]] for one, other in pairwise(contours)]
    along = row.along if onwards else (-row.along[0], -row.along[1])
    if any(float(_normal(edge) @ np.array(along)) < 1 - _TURN for edge in edges):
        return None
    if (links := _links(nest, edges, np.array(along), right, apart, options)) is None:
        return None
    return replace(row, contours=contours, along=along, right=right, links=links, last_along=along, of=(row,))


def _by_direction(edges: Sequence[FacingEdge]) -> list[list[FacingEdge]]:
    """Edges whose normals are the same within 0.2°, those that look to the right or up alone."""
    groups: list[tuple[Floats, list[FacingEdge]]] = []
    for edge in edges:
        normal = _normal(edge)
        if normal[0] < -_TURN or (abs(normal[0]) <= _TURN and normal[1] < 0):
            continue
        for of, group in groups:
            if abs(of[0] * normal[1] - of[1] * normal[0]) <= _TURN:
                group.append(edge)
                break
        else:
            groups.append((normal, [edge]))
    return [group for _, group in groups]


def _normal(edge: FacingEdge) -> Floats:
    """Out of the part of a facing edge, which runs counter-clockwise round it."""
    (x0, y0), (x1, y1) = edge.begin, edge.end
    return np.array([y1 - y0, x0 - x1]) / edge.length_mm


def _chains(nest: Nest, edges: Sequence[FacingEdge]) -> Iterator[list[FacingEdge]]:
    """Facing edges that follow each other from part to part; each part has one neighbour before and one behind."""
    onward: dict[int, FacingEdge] = {}
    back: dict[int, FacingEdge] = {}
    for edge in sorted(edges, key=lambda e: (-e.length_mm, e.contour, e.other)):
        if edge.contour not in onward and edge.other not in back:
            onward[edge.contour] = edge
            back[edge.other] = edge
    for first in sorted(onward.keys() - back.keys()):
        chain = [onward[first]]
        while (after := onward.get(chain[-1].other)) is not None:
            chain.append(after)
        yield chain


def _split(
    nest: Nest,
    chain: Sequence[FacingEdge],
    taken: Collection[str],
    apart: _Apart,
    kerf_mm: float,
    options: SnakeOptions,
) -> Iterator[list[FacingEdge]]:
    """The pieces of a chain that are free of parts that are taken, and of neighbours that are too near or far."""
    piece: list[FacingEdge] = []
    for edge in chain:
        pair = nest.contours[edge.contour].id, nest.contours[edge.other].id
        gap_mm = float(shapely.distance(nest.contours[edge.contour].line, nest.contours[edge.other].line))
        common = abs(gap_mm - kerf_mm) <= tolerance_mm(kerf_mm)
        fits = (common and options.may_share) or 2 * kerf_mm + 2 * _CHORD_MM <= gap_mm <= options.gap_mm + _CHORD_MM
        if not fits or {*pair} & {*taken}:
            if piece:
                yield piece
            piece = []
        else:
            piece.append(edge)
    if piece:
        yield piece


@dataclass(frozen=True, eq=False, slots=True)
class _Apart:
    """Which contours stand within two kerfs of others or lie in holes, and what a link must keep off."""

    nest: Nest
    kerf_mm: float
    near: Mapping[str, frozenset[str]]
    hosted: frozenset[str]
    metal: shapely.Geometry
    sheet: shapely.Geometry
    rings: shapely.STRtree

    @staticmethod
    def of(nest: Nest, kerf_mm: float) -> _Apart:
        lines = [contour.line for contour in nest.contours]
        reach_mm = max(kerf_mm + 2 * tolerance_mm(kerf_mm), 2 * kerf_mm) + _CHORD_MM
        tree = shapely.STRtree(lines)
        near: dict[str, set[str]] = {}
        for a, b in tree.query(lines, "dwithin", distance=reach_mm).T.tolist():
            if nest.contours[a].part != nest.contours[b].part:
                near.setdefault(nest.contours[a].id, set()).add(nest.contours[b].id)
        holes = [contour for contour in nest.contours if contour.kind == "hole"]
        held = shapely.STRtree([hole.polygon for hole in holes]).query(lines, "within").T.tolist() if holes else []
        hosted = frozenset(nest.contours[k].id for k, h in held if nest.contours[k].part != holes[h].part)
        metal = shapely.union_all([shapely.make_valid(part.polygon) for part in nest.parts])
        sheet = shapely.buffer(shapely.make_valid(nest.sheet.polygon), -kerf_mm / 2)
        return _Apart(nest, kerf_mm, {k: frozenset(of) for k, of in near.items()}, hosted, metal, sheet, tree)

    def crowded(self, names: Collection[str]) -> bool:
        """Whether one of these contours lies within two kerfs of another part that is none of them, or in a hole."""
        near = frozenset[str]().union(*(self.near.get(name, frozenset()) for name in names))
        return not self.hosted.isdisjoint(names) or not near <= {*names}

    def free(self, link: Link, joined: Collection[str]) -> bool:
        """Whether a link burns no part, stays on the sheet, and keeps off the contours that it does not join."""
        line = shapely.LineString(link)
        if not shapely.covers(self.sheet, line):
            return False
        if line.length > 0 and shapely.distance(self.metal, line) < self.kerf_mm / 2 - _CHORD_MM:
            return False
        met = self.rings.query(line, "dwithin", distance=_OTHERS_KERFS * self.kerf_mm)
        return {self.nest.contours[k].id for k in met.tolist()} <= {*joined}


def _row(nest: Nest, chain: Sequence[FacingEdge], apart: _Apart, number: int, options: SnakeOptions) -> Row | None:
    """A row of the parts of a chain along the side that lies nearer to the sheet's edge; None where no link is free."""
    contours = [nest.contours[edge.contour] for edge in chain] + [nest.contours[chain[-1].other]]
    along = _normal(chain[0])
    around = shapely.union_all([contour.line for contour in contours])
    edge = shapely.boundary(nest.sheet.polygon)

    def room_mm(right: bool) -> float:
        side = (along[1], -along[0]) if right else (-along[1], along[0])
        x0, y0, x1, y1 = around.bounds
        middle = np.array([(x0 + x1) / 2, (y0 + y1) / 2])
        far = middle + (x1 - x0 + y1 - y0) * np.array(side)
        look = shapely.LineString([middle, far + 1e5 * np.array(side)])
        met = shapely.intersection(look, edge)
        return float(shapely.distance(met, around)) if not met.is_empty else math.inf

    for right in sorted((True, False), key=lambda right: (round(room_mm(right), 3), not right)):
        if (links := _links(nest, chain, along, right, apart, options)) is not None:
            at = (float(along[0]), float(along[1]))
            return Row(f"snake{number}", tuple(contours), at, right, links, at)
    return None


def _links(
    nest: Nest, chain: Sequence[FacingEdge], along: Floats, right: bool, apart: _Apart, options: SnakeOptions
) -> tuple[Link, ...] | None:
    """The ways over all gaps of a row on one side; None where one is not free, or too long."""
    found = [_link(nest, edge, along, right, apart) for edge in chain]
    fit = [link for link in found if link is not None and math.dist(*link) <= options.gap_mm + _CHORD_MM]
    return tuple(fit) if len(fit) == len(found) else None


def _link(nest: Nest, edge: FacingEdge, along: Floats, right: bool, apart: _Apart) -> Link | None:
    """The way over one gap: in line with the sides of both, else square to the edges that face each other."""
    kerf_mm = apart.kerf_mm
    one, other = nest.contours[edge.contour], nest.contours[edge.other]
    joined = one.id, other.id
    beside, ahead = _side(one, along, right, kerf_mm), _side(other, along, right, kerf_mm)
    if beside is not None and ahead is not None:
        link = (beside[1], ahead[0])
        step = np.array(link[1]) - np.array(link[0])
        gap_mm = float(np.hypot(*step))
        straight = gap_mm > 0 and abs(step[0] * along[1] - step[1] * along[0]) <= _CHORD_MM
        if straight and float(step @ along) > 0 and apart.free(link, joined):
            return link
    gap_mm = float(shapely.distance(one.line, other.line))
    if gap_mm < 2 * kerf_mm or edge.length_mm < 3 * kerf_mm:
        return None
    begin, end = np.array(edge.begin), np.array(edge.end)  # counter-clockwise: its right end comes first
    at, inwards = (begin, end - begin) if right else (end, begin - end)
    at = at + inwards / edge.length_mm * kerf_mm + along * kerf_mm / 2
    look = shapely.LineString([at, at + along * (gap_mm + 2 * kerf_mm + edge.length_mm)])
    met = shapely.intersection(look, compensated(other, kerf_mm).line(_CHORD_MM))
    if met.is_empty:
        return None
    to = shapely.get_coordinates(shapely.shortest_line(shapely.Point(at), met))[-1]
    link = compensated(one, kerf_mm).nearest(at.tolist()), compensated(other, kerf_mm).nearest(to.tolist())
    return link if math.dist(*link) >= kerf_mm - _CHORD_MM and apart.free(link, joined) else None


def _side(contour: Contour, along: Floats, right: bool, kerf_mm: float) -> tuple[Point, Point] | None:
    """The straight piece of a ring that lies furthest to a side of the row and runs along it: from where to where."""
    ring = compensated(contour, kerf_mm).towards("ccw" if right else "cw")
    aside = np.array([along[1], -along[0]]) * (1 if right else -1)
    far_mm = max(float(np.array(point) @ aside) for point in ring.flatten(_CHORD_MM).tolist())
    for segment in ring.segments:
        if segment.is_arc:
            continue
        step = (np.array(segment.end) - np.array(segment.start)) / segment.length_mm
        if abs(step @ aside) <= _TURN and float(np.array(segment.start) @ aside) >= far_mm - _CHORD_MM:
            return segment.start, segment.end
    return None


# The ways of rows: their ends are where candidates of the first and the last contour have leads.


def snake_of(nest: Nest, row: Row, candidates: Sequence[Candidate], options: LeadOptions) -> Contour | None:
    """The way out along a row, from where a lead joins its first contour to where one joins its last.

    None where neither has a lead that fits.
    """
    kerf_mm, directions = options.kerf_mm, options.directions["outer"]
    back: Direction = "cw" if row.direction == "ccw" else "ccw"
    first, first_led = _end(row, row.contours[0], row.links[0][0], candidates, nest, row.direction, -1, kerf_mm)
    last, last_led = _end(row, row.contours[-1], row.links[-1][1], candidates, nest, back, 1, kerf_mm)
    if not (row.direction in directions and first_led) and not (back in directions and last_led):
        return None
    joins = [first, *(to for _, to in row.links)]
    leaves = [*(at for at, _ in row.links), last]
    along = [
        Stretch(contour.id, Span(begin, end), row.direction)
        for contour, begin, end in zip(row.contours, joins, leaves, strict=True)
    ]
    return way_of(nest, row.name, along, kerf_mm)


def _end(
    row: Row,
    contour: Contour,
    link: Point,
    candidates: Sequence[Candidate],
    nest: Nest,
    direction: Direction,
    sign: int,
    kerf_mm: float,
) -> tuple[Point, bool]:
    """Where the way begins, or ends: where a candidate joins, as near as may be to the corner at the end of the row.

    And whether one does.
    """
    ring = compensated(contour, kerf_mm).towards(row.direction)
    along = np.array(row.along if sign < 0 else row.last_along)
    aside = np.array([along[1], -along[0]]) * (1 if row.right else -1)
    points = ring.flatten(_CHORD_MM)
    corner = points[np.argmax(points @ (sign * along + aside))]
    link_mm = ring.project(link)[0]

    def length_mm(at: Sequence[float]) -> float:
        """How much of the ring lies between a place and the link, the way the torch goes out."""
        at_mm = ring.project(at)[0]
        return float((link_mm - at_mm if sign < 0 else at_mm - link_mm) % ring.length_mm)

    wanted_mm, number = length_mm(corner.tolist()), nest.index[contour.id]
    lead = [c for c in candidates if c.contour == number and c.direction == direction and c.span is None and not c.tabs]
    low, high = _LEAST_SHARE * ring.length_mm, (1 - _LEAST_SHARE) * ring.length_mm
    fit = [(abs(mm - wanted_mm), k) for k, c in enumerate(lead) if low <= (mm := length_mm(c.join)) <= high]
    return (lead[min(fit)[1]].join, True) if fit else (ring.nearest(corner.tolist()), False)
