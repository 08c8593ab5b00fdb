"""Which burns of a program must stay before which, told from the burns alone, where they make no nest."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.arrays import Ints
from kerfwise.postproc.check.reader.program import Burn

from .pieces import Piece

_KEPT_IN_ROWS = ("material", "tool")
"""What costs time to change, and nobody knows how much: burns keep the order of these."""


def orders_between(burns: Sequence[Burn], pieces: Sequence[Piece], kerf_mm: float) -> Ints:
    """Pairs (before, after) of burns that no new order may turn round, (k, 2), sorted.

    What lies in an area that another burn goes round comes before it. Burns whose kerfs meet stay as they are, since
    the second may need the metal, or the void, that the first has left. So do burns of another material or tool.

    Examples
    --------
    >>> from kerfwise.encoder.geometry.curve import Curve
    >>> def burn(*points):
    ...     return Burn(0, 1, Curve.of(points, closed=False), 0.0, 0.0, "")
    >>> frame = burn((0, 0), (90, 0), (90, 90), (0, 90), (0, 0))
    >>> orders_between([frame, burn((40, 40), (50, 40)), burn((200, 0), (210, 0))], [], 1.5).tolist()
    [[1, 0]]
    """
    lines = [burn.path.line() for burn in burns]
    areas = [shapely.union_all(shapely.get_parts(shapely.polygonize([shapely.node(line)]))) for line in lines]
    pairs: set[tuple[int, int]] = set()
    tree = shapely.STRtree(lines)
    for k, area in enumerate(areas):
        if not area.is_empty:
            inside = {
                j for j in tree.query(area, predicate="intersects").tolist() if j != k and _within(lines[j], area)
            }
            pairs |= {(j, k) for j in inside if not _within(lines[k], areas[j])}
    first, second = tree.query(lines, predicate="dwithin", distance=kerf_mm)
    for a, b in zip(first.tolist(), second.tolist(), strict=True):
        if a < b and (b, a) not in pairs:
            pairs.add((a, b))
    pairs |= in_turn(pieces)
    return np.array(sorted(pairs), dtype=np.int64).reshape(-1, 2)


def _within(line: shapely.LineString, area: shapely.Geometry) -> bool:
    """Whether most of a burn lies in an area."""
    if area.is_empty:
        return False
    if line.length == 0:
        return bool(area.intersects(line))
    return bool(shapely.intersection(line, area).length > line.length / 2)


def in_turn(pieces: Sequence[Piece]) -> set[tuple[int, int]]:
    """Pairs (before, after): all burns of one material and tool before all of the next."""
    rows: list[list[int]] = []
    last = None
    for k, piece in enumerate(pieces):
        now = tuple(piece.before.get(key) for key in _KEPT_IN_ROWS)
        if rows and now == last:
            rows[-1].append(k)
        else:
            rows.append([k])
        last = now
    return {(a, b) for one, then in pairwise(rows) for a in one for b in then}
