"""Scrap lines that stay whole: what is uncut of a line holds all the metal beside it together.

Where other lines end on a line, their kerfs reach through its own. If there is no metal across from there, be it that a
line ends at the same place from the other side, or that a part has left a void, the line falls into two, and the one
half no longer holds to the other. As two lines that meet there it can be planned.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

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


def where_severed(
    lines: Sequence[shapely.LineString], metal: shapely.Geometry, kerf_mm: float
) -> dict[int, list[float]]:
    """Lines that others cut in two or more, and where: mm along each, in order.

    Parameters
    ----------
    lines
        All scrap lines of a nest. None crosses another; they end at each other.
    metal
        The skeleton, without the kerfs of the parts.
    kerf_mm
        Width of the kerf.

    Examples
    --------
    Two lines end on a third, one from each side, at the same height; then one of them higher up.

    >>> upright = shapely.LineString([(100, 0), (100, 200)])
    >>> one, other = shapely.LineString([(0, 80), (100, 80)]), shapely.LineString([(100, 80), (200, 80)])
    >>> where_severed([upright, one, other], shapely.box(0, 0, 200, 200), 1.5)
    {0: [80.0]}
    >>> where_severed([upright, one, shapely.transform(other, lambda p: p + [0, 9])], shapely.box(0, 0, 200, 200), 1.5)
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


def taken_apart(
    lines: Sequence[Sequence[tuple[float, float]]], metal: shapely.Geometry, kerf_mm: float
) -> list[list[tuple[float, float]]]:
    """The same lines, those that others sever as two or more."""
    drawn = [shapely.LineString(row) for row in lines]
    severed = where_severed(drawn, metal, kerf_mm)
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
