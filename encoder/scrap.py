"""Lines that cut up the skeleton: a grid, what saves a remnant, and which lines stay whole."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import get_args

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Box, Point
from kerfwise.encoder.geometry.tolerances import TOUCH_MM

from .cut import Side
from .errors import InputError
from .nest import Nest, Sheet, as_scrap, cached_with_nest

# A grid of lines in a skeleton: straight, and only where there is metal.
#
# Lines up and down go from void to void. Lines across end at them, so that no line crosses another.

_TRIED = 20
"""Places that are tried in each width of the grid."""
MOST_PIECES = 2000
"""Pieces of a sheet that a grid may ask for: each line is a contour of its own."""
_PIERCE_MM = 30.0
"""What a line more costs, in mm of lines."""

Row = list[Point]
Span = tuple[float, float]


def grid_lines(metal: shapely.Geometry, grid_mm: float) -> list[Row]:
    """Lines that cut metal into pieces no larger than the grid, either way, placed where little is cut.

    Examples
    --------
    >>> grid_lines(shapely.box(0, 0, 900, 400), 500)
    [[(400.0, 0.0), (400.0, 400.0)]]
    >>> grid_lines(shapely.box(0, 0, 400, 600).difference(shapely.box(50, 50, 350, 550)), 500)
    [[(0.0, 100.0), (50.0, 100.0)], [(350.0, 100.0), (400.0, 100.0)]]
    """
    if metal.is_empty:
        return []
    x0, y0, x1, y1 = metal.bounds
    shapely.prepare(metal)
    upright = {x: _spans(metal, x, 0) for x in _places(metal, x0, x1, grid_mm, 0)}
    rows: list[Row] = [[(x, a), (x, b)] for x, spans in upright.items() for a, b in spans]
    for y in _places(metal, y0, y1, grid_mm, 1):
        at = [x for x, spans in upright.items() if any(a <= y <= b for a, b in spans)]
        for a, b in _spans(metal, y, 1):
            ends = [a, *(x for x in at if a < x < b), b]
            rows += [[(p, y), (q, y)] for p, q in pairwise(ends) if q - p > TOUCH_MM]
    return rows


def _places(metal: shapely.Geometry, low: float, high: float, grid_mm: float, axis: int) -> list[float]:
    """Where lines stand: no further apart than the grid, and what they cut costs least."""
    if high - low <= grid_mm:
        return []
    steps = int(np.ceil((high - low) / grid_mm * _TRIED))
    at: Floats = np.linspace(low, high, steps + 1)
    price = np.array([0.0, *(_price(_spans(metal, float(v), axis)) for v in at[1:-1]), 0.0])
    most = int(np.floor(grid_mm / (at[1] - at[0]) + 1e-9))
    cost, before = np.full(len(at), np.inf), np.zeros(len(at), dtype=np.int64)
    cost[0] = 0.0
    for k in range(1, len(at)):
        first = max(0, k - most)
        chosen = first + int(np.argmin(cost[first:k]))
        cost[k], before[k] = cost[chosen] + price[k], chosen
    found: list[float] = []
    k = int(before[-1])
    while k > 0:
        found.append(float(at[k]))
        k = int(before[k])
    return found[::-1]


def _price(spans: Sequence[Span]) -> float:
    return sum(b - a + _PIERCE_MM for a, b in spans)


def _spans(metal: shapely.Geometry, at: float, axis: int) -> list[Span]:
    """Where a line upright (axis 0) at x, or across (axis 1) at y, runs over metal, in order."""
    x0, y0, x1, y1 = metal.bounds
    ends = [(at, y0 - 1), (at, y1 + 1)] if axis == 0 else [(x0 - 1, at), (x1 + 1, at)]
    pieces = shapely.get_parts(shapely.intersection(metal, shapely.LineString(ends)))
    bounds = shapely.bounds(pieces)[:, [1 - axis, 3 - axis]] if len(pieces) else np.empty((0, 2))
    return [(a, b) for a, b in sorted(bounds.tolist()) if b - a > TOUCH_MM]


# The largest rectangle along a side of a sheet that no block reaches into.


def remnant_rectangle(
    sheet: Box, blocks: Sequence[Box], side: Side, half_kerf_mm: float
) -> tuple[Box, tuple[Point, ...]]:
    """The rectangle, and the line of the torch's centre round it, from one edge of the sheet to another.

    The line may lie on the border of a block, and the rectangle begins half a kerf beside the line. It is straight
    where the rectangle is as long as the side, else it has one corner or two.

    Examples
    --------
    >>> remnant_rectangle((0, 0, 1000, 400), [(0, 0, 600, 400), (600, 0, 900, 100)], "right", 0.5)
    ((600.5, 100.5, 1000, 400.0), ((600.0, 400.0), (600.0, 100.0), (1000, 100.0)))
    """
    flip = side in ("left", "bottom")
    along = 1 if side in ("left", "right") else 0
    across = 1 - along
    low, high, deepest = sheet[along], sheet[along + 2], sheet[across + 2] - sheet[across]
    edge = sheet[across] if flip else sheet[across + 2]
    begins = np.clip([b[along] for b in blocks], low, high)
    ends = np.clip([b[along + 2] for b in blocks], low, high)
    free = np.array([b[across] - edge if flip else edge - b[across + 2] for b in blocks])
    cuts = np.unique(np.concatenate([[low, high], begins, ends]))
    depth = np.full(len(cuts) - 1, deepest)
    for a, b, room in zip(begins.tolist(), ends.tolist(), np.clip(free, 0.0, deepest).tolist(), strict=True):
        within = (cuts[:-1] >= a) & (cuts[:-1] < b)
        depth[within] = np.minimum(depth[within], room)
    best = (-1.0, 0, 0, 0.0)
    for first in range(len(depth)):
        rooms = np.minimum.accumulate(depth[first:])
        areas = rooms * (cuts[first + 1 :] - cuts[first])
        k = int(np.argmax(areas))
        if areas[k] > best[0] * (1 + 1e-9):
            best = (float(areas[k]), first, first + k + 1, float(rooms[k]))
    a, b, room = float(cuts[best[1]]), float(cuts[best[2]]), best[3]
    inner = edge + room if flip else edge - room
    ways = [*([(edge, b)] if b < high else []), (inner, b), (inner, a), *([(edge, a)] if a > low else [])]
    line = tuple((d, t) if along else (t, d) for d, t in ways)
    near = inner - half_kerf_mm if flip else inner + half_kerf_mm
    t0, t1 = a + half_kerf_mm * (a > low), b - half_kerf_mm * (b < high)
    d0, d1 = min(near, edge), max(near, edge)
    return ((d0, t0, d1, t1) if along else (t0, d0, t1, d1)), line


NO_BOX: Box = (0.0, 0.0, 0.0, 0.0)


def largest_rectangle(sheet: Sheet, parts: Sequence[shapely.Geometry], gap_mm: float) -> Box:
    """The largest rectangle along a side that is `gap_mm` from the boxes around the parts.

    Of a sheet that is no rectangle nothing is said.

    Examples
    --------
    >>> largest_rectangle(Sheet.rectangle(100, 50), [shapely.box(0, 0, 40, 50)], 5.0)
    (45.0, 0.0, 100.0, 50.0)
    """
    x0, y0, x1, y1 = sheet.bounds
    if abs(sheet.polygon.area - (x1 - x0) * (y1 - y0)) > 1e-6 * sheet.polygon.area:
        return NO_BOX
    blocks = [(a - gap_mm, b - gap_mm, c + gap_mm, d + gap_mm) for a, b, c, d in (part.bounds for part in parts)]
    found = [remnant_rectangle((x0, y0, x1, y1), blocks, side, 0.0)[0] for side in get_args(Side)]
    return max(found, key=lambda box: (box[2] - box[0]) * (box[3] - box[1]))


# Scrap lines that stay whole: what is uncut of a line holds all the metal beside it together.
#
# Where other lines end on a line, their kerfs reach through its own. If there is no metal across from there, be it
# that a line ends at the same place from the other side, or that a part has left a void, the line falls into two, and
# the one half no longer holds to the other. As two lines that meet there it can be planned.

_NOWHERE = -1
_SAME_SHARE = 1e-3
"""Pieces that differ by less than this share of the largest are equally large."""
_FINE_MM = 0.01
"""A web may be narrower than a kerf by so much, and still carries."""


def skeleton(sheet: shapely.Geometry, outlines: Sequence[shapely.Geometry], off_mm: float) -> shapely.Geometry:
    """The sheet without its parts and so much around each, mm."""
    gone = shapely.buffer(np.array(outlines, dtype=object), off_mm, quad_segs=16)
    return shapely.make_valid(sheet).difference(shapely.union_all(gone))


def carrying(metal: shapely.Geometry, kerf_mm: float) -> shapely.Geometry:
    """Metal without what is narrower than a kerf: a line along it would burn it all, and it holds nothing.

    Examples
    --------
    Two plates with a web of 0.3 mm between them are two pieces.

    >>> webbed = shapely.union_all([shapely.box(0, 0, 9, 9), shapely.box(9, 4, 20, 4.3), shapely.box(20, 0, 29, 9)])
    >>> sorted(shapely.bounds(shapely.get_parts(carrying(webbed, 1.0))).round(1).tolist())
    [[0.0, 0.0, 9.0, 9.0], [20.0, 0.0, 29.0, 9.0]]
    """
    half_mm = max(kerf_mm / 2 - _FINE_MM, 0.0)
    return shapely.intersection(metal.buffer(-half_mm, quad_segs=4).buffer(half_mm, quad_segs=4), metal)


def pieces_of(metal: shapely.Geometry, kerf_mm: float) -> NDArray[np.object_]:
    """What holds together; crumbs are none."""
    return np.array([piece for piece in shapely.get_parts(metal) if piece.area > kerf_mm**2], dtype=object)


def largest(pieces: NDArray[np.object_]) -> int:
    """The number of the largest piece; of equal ones the lowest, then the leftmost.

    Examples
    --------
    >>> largest(shapely.box([20, 0, 40], [0, 0, 9], [29, 9, 49], [9, 9, 18]))
    1
    """
    area = shapely.area(pieces)
    large = np.flatnonzero(area >= area.max() * (1 - _SAME_SHARE))
    x0, y0 = np.round(shapely.bounds(pieces[large])[:, :2]).T
    return int(large[np.lexsort((x0, y0))[0]])


def severed_lines(
    lines: Sequence[shapely.LineString], metal: shapely.Geometry, kerf_mm: float
) -> dict[int, list[float]]:
    """Lines that others cut in two or more, and where: mm along each, in order.

    `lines`: all scrap lines of a nest. None crosses another; they end at each other. `metal`: the skeleton, without the
    kerfs of the parts.

    Examples
    --------
    Two lines end on a third, one from each side, at the same height; then one of them higher up.

    >>> upright = shapely.LineString([(100, 0), (100, 200)])
    >>> one, other = shapely.LineString([(0, 80), (100, 80)]), shapely.LineString([(100, 80), (200, 80)])
    >>> severed_lines([upright, one, other], shapely.box(0, 0, 200, 200), 1.5)
    {0: [80.0]}
    >>> severed_lines([upright, one, shapely.transform(other, lambda p: p + [0, 9])], shapely.box(0, 0, 200, 200), 1.5)
    {}
    """
    drawn = np.array(lines, dtype=object)
    if len(drawn) < 2:
        return {}
    kerfs = shapely.buffer(drawn, kerf_mm / 2, quad_segs=4)
    tips = np.concatenate([shapely.get_point(drawn, 0), shapely.get_point(drawn, -1)])
    owner = np.tile(np.arange(len(drawn)), 2)
    line, tip = shapely.STRtree(tips).query(drawn, predicate="dwithin", distance=kerf_mm)
    found: dict[int, list[float]] = {}
    for k in np.unique(line).tolist():
        on = tip[(line == k) & (owner[tip] != k)]
        at_mm = np.unique(np.round(shapely.line_locate_point(drawn[k], tips[on]), 3))
        at_mm = at_mm[(at_mm > kerf_mm) & (at_mm < drawn[k].length - kerf_mm)]
        if len(at_mm) and (places := _severed_at(k, at_mm, drawn, kerfs, metal)):
            found[k] = places
    return found


def _severed_at(
    k: int, at_mm: NDArray[np.float64], drawn: NDArray[np.object_], kerfs: NDArray[np.object_], metal: shapely.Geometry
) -> list[float]:
    """Those of some places along line k between which and the next nothing holds, all other lines being cut."""
    left = shapely.get_parts(metal.difference(shapely.union_all(np.delete(kerfs, k))))
    ends_mm = np.concatenate([[0.0], at_mm, [drawn[k].length]])
    middles = shapely.line_interpolate_point(drawn[k], (ends_mm[:-1] + ends_mm[1:]) / 2)
    piece = np.full(len(middles), _NOWHERE)
    stretch, holds = shapely.STRtree(left).query(middles, predicate="intersects")
    piece[stretch] = holds
    return [mm for mm, a, b in zip(at_mm.tolist(), piece[:-1], piece[1:], strict=True) if a != b]


def split_severed(
    lines: Sequence[Sequence[tuple[float, float]]], metal: shapely.Geometry, kerf_mm: float
) -> list[list[tuple[float, float]]]:
    """The same lines, those that others sever as two or more."""
    drawn = [shapely.LineString(row) for row in lines]
    severed = severed_lines(drawn, metal, kerf_mm)
    rows: list[list[tuple[float, float]]] = []
    for k, row in enumerate(lines):
        ends_mm = [0.0, *severed.get(k, ()), drawn[k].length]
        if len(ends_mm) == 2:
            rows.append(list(row))
            continue
        for low, high in pairwise(ends_mm):
            points = shapely.get_coordinates(substring(drawn[k], low, high))
            rows.append([(x, y) for x, y in points.tolist()])
    return rows


LEAST_MM = 50.0
"""A remnant with a shorter side is not worth keeping."""
_CLEAR_MM = 0.01
"""Lines keep so much more than a kerf from parts, whose outlines are chords here."""


@dataclass(frozen=True, slots=True)
class Remnant:
    """The rectangle of unused sheet that is saved, mm in the nest's coordinates, and the line that cuts it off."""

    bounds: Box
    line: tuple[Point, ...]

    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height."""
        x0, y0, x1, y1 = self.bounds
        return x1 - x0, y1 - y0


@cached_with_nest(most=8)
def with_scrap(nest: Nest, kerf_mm: float, grid_mm: float | None, remnant: Side | None) -> Nest:
    """The nest with the lines of a grid, and of a remnant, in its skeleton; it keeps the nest as drawn.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> plate = nest(1000, 400, part("A", rect(50, 50, 300, 300)))
    >>> [c.curve.as_rows() for c in with_scrap(plate, 1.5, None, "right").scrap]
    [[[351.51, 400.0], [351.51, 0.0]]]

    Raises InputError if the nest has scrap lines of its own, the sheet is no rectangle where a remnant is asked for, or
    nothing of it is left there.
    """
    if grid_mm is None and remnant is None:
        return nest
    if nest.scrap:
        raise InputError(
            "the nest has scrap lines of its own, and the profile asks for others (cuts.scrap): leave one of them out",
            file=nest.file or None,
        )
    whole = skeleton(nest.sheet.polygon, [part.outer.polygon for part in nest.parts], kerf_mm + _CLEAR_MM)
    wide = carrying(whole, kerf_mm)
    metal = shapely.intersection(_largest(wide, kerf_mm).buffer(kerf_mm), whole)
    rows: list[list[Point]] = []
    if remnant is not None:
        kept = remnant_of(nest, kerf_mm, remnant)
        rows.append(list(kept.line))
        x0, y0, x1, y1 = kept.bounds
        half = kerf_mm / 2
        metal = metal.difference(shapely.box(x0 - half, y0 - half, x1 + half, y1 + half))
    if grid_mm is not None:
        _expect_few_pieces(nest, grid_mm)
        rows += grid_lines(metal, grid_mm)
        rows = split_severed(rows, wide, kerf_mm)
    lines = as_scrap(Curve.of(row, closed=False) for row in rows)
    return replace(nest, scrap=lines, drawn=nest.drawn or nest) if lines else nest


def _expect_few_pieces(nest: Nest, grid_mm: float) -> None:
    x0, y0, x1, y1 = nest.sheet.bounds
    pieces = np.ceil((x1 - x0) / grid_mm) * np.ceil((y1 - y0) / grid_mm)
    if pieces > MOST_PIECES:
        raise InputError(
            f"cuts.scrap.grid: {grid_mm:g} mm cuts a sheet of {x1 - x0:.6g} x {y1 - y0:.6g} mm into {pieces:,.0f} "
            f"pieces, expected {MOST_PIECES:,} at the most: give a larger grid",
            file=nest.file or None,
        )


@cached_with_nest(most=8)
def remnant_of(nest: Nest, kerf_mm: float, side: Side) -> Remnant:
    """The largest rectangle of unused sheet along a side.

    Raises InputError if the sheet is no rectangle, or the rectangle would have a side under 50 mm.
    """
    x0, y0, x1, y1 = nest.sheet.bounds
    if abs(nest.sheet.polygon.area - (x1 - x0) * (y1 - y0)) > kerf_mm:
        raise InputError(
            f"cuts.scrap.remnant: {side} saves a rectangle of a rectangular sheet, and this sheet is none",
            file=nest.file or None,
        )
    apart_mm = kerf_mm + _CLEAR_MM
    outlines = [part.outer.polygon for part in nest.parts]
    pieces = pieces_of(carrying(skeleton(nest.sheet.polygon, outlines, apart_mm), kerf_mm), kerf_mm)
    gone = [outline.bounds for outline in outlines]
    blocks = [(a - apart_mm, b - apart_mm, c + apart_mm, d + apart_mm) for a, b, c, d in gone]
    blocks += [piece.bounds for k, piece in enumerate(pieces.tolist()) if k != largest(pieces)]
    found = remnant_rectangle((x0, y0, x1, y1), blocks, side, kerf_mm / 2)
    remnant = Remnant(*found)
    width, height = remnant.size_mm
    if min(width, height) < LEAST_MM:
        raise InputError(
            f"cuts.scrap.remnant: {side} leaves nothing to save: the largest unused rectangle there is "
            f"{max(width, 0.0):.0f} × {max(height, 0.0):.0f} mm, and one with a side under {LEAST_MM:g} mm is not kept",
            file=nest.file or None,
        )
    return remnant


def _largest(metal: shapely.Geometry, kerf_mm: float) -> shapely.Geometry:
    """The largest piece of a skeleton: others come loose with the parts."""
    pieces = pieces_of(metal, kerf_mm)
    return pieces[largest(pieces)] if len(pieces) else shapely.Polygon()
