"""How often a path meets itself: what is found on it takes time that goes with this number, and more."""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.arrays import Floats

MOST_MEETINGS = 10_000
"""No part is drawn so, and no torch runs so."""
_AT_ONCE = 200


def meets_itself_too_often(points: Floats, closed: bool, most: int) -> bool:
    """Whether a path along `points` (n, 2), mm, crosses, touches or runs along itself in more than `most` places.

    Neighbours meet at their common point; that does not count.

    Examples
    --------
    >>> points = np.array([[0.0, 0.0], [9.0, 0.0]] * 100)
    >>> [meets_itself_too_often(along, closed=False, most=10_000) for along in (points, points[:100])]
    [True, False]
    """
    count = len(points) if closed else len(points) - 1
    if count * (count - 1) // 2 <= most:
        return False
    ends = np.roll(points, -1, axis=0)
    chords = np.stack([points, ends], axis=1)[:count]
    lines, met = shapely.linestrings(chords), 0
    tree = shapely.STRtree(lines)
    last = len(lines) - 1 if closed else len(lines)
    for begin in range(0, len(lines), _AT_ONCE):
        one, other = tree.query(lines[begin : begin + _AT_ONCE], predicate="intersects")
        apart = other - one - begin
        met += int(((apart > 1) & (apart < last)).sum())
        if met > most:
            return True
    return False
