"""A torch-on path taken apart where it joins its contour."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Segment
from kerfwise.encoder.ranges import laid_out

_LEAST, _MOST = 0.5, 1.5
COMPARED = 1 << 18
"""Pairs of vertices that are compared each, at once; where there are more, the near ones are looked up by place."""
_NEAR_MM, _NEARER = 0.01, 10.0
_ROUNDED_MM = 0.0011
"""Gaps to a thousandth that are the same differ by less."""


@dataclass(frozen=True, eq=False, slots=True)
class Pieces:
    """Lead-in, once round, lead-out; `gap_mm` is how far the round ends from where it began."""

    lead_in: Curve
    loop: Curve
    lead_out: Curve
    gap_mm: float


def split(path: Curve, round_mm: float) -> Pieces | None:
    """Take an open path apart into what leads in, one round of about `round_mm`, and what is left.

    A block ends where the torch joins its contour, so that both ends of the round are vertices: of all pairs that are
    half a round to one and a half apart along the path, the one that lies closest together (to a thousandth), then
    the one whose way round is nearest to `round_mm`, then the first. None if there is no such pair.

    Examples
    --------
    >>> square = [(-3, 5), (0, 5), (0, 10), (10, 10), (10, 0), (0, 0), (0, 5), (0, 7)]
    >>> pieces = split(Curve.of(square, closed=False), 40)
    >>> pieces.lead_in.length_mm, pieces.loop.length_mm, pieces.lead_out.length_mm
    (3.0, 40.0, 2.0)
    """
    v = path.vertices
    at_mm = path.starts_mm
    if len(at_mm) < len(v):  # vertices that lie on each other
        ends = zip(v.tolist(), v[1:].tolist(), strict=False)
        lengths = [Segment((a[0], a[1]), (b[0], b[1]), a[2]).length_mm for a, b in ends]
        at_mm = np.concatenate([[0.0], np.cumsum(lengths)])
    if at_mm[-1] < _LEAST * round_mm:
        return None
    first = np.searchsorted(at_mm, at_mm + _LEAST * round_mm)
    last = np.searchsorted(at_mm, at_mm + _MOST * round_mm, side="right")
    pairs = int((last - first).sum())
    if pairs == 0:
        return None
    best = _looked_up(v, at_mm, first, last, round_mm) if pairs > COMPARED else None
    gap_mm, k, m = _compared(v, at_mm, first, last, round_mm) if best is None else best
    return Pieces(path.piece(0, k), path.piece(k, m), path.piece(m, len(v) - 1), gap_mm)


def _compared(v: Floats, at_mm: Floats, first: Ints, last: Ints, round_mm: float) -> tuple[float, int, int]:
    """The best pair of all, as its gap and its two vertices; as many rows at once as `COMPARED` allows."""
    counts = last - first
    until = np.cumsum(counts)
    best: tuple[float, float, int, int] | None = None
    begin = 0
    while begin < len(counts):
        done = int(until[begin - 1]) if begin else 0
        end = max(int(np.searchsorted(until, done + COMPARED, side="right")), begin + 1)
        of = counts[begin:end]
        one = np.repeat(np.arange(begin, end), of)
        other = laid_out(first[begin:end], of)
        if len(one):
            found = _best(v, at_mm, one, other, round_mm)
            best = found if best is None else min(best, found)
        begin = end
    assert best is not None
    return best[0], best[2], best[3]


def _looked_up(v: Floats, at_mm: Floats, first: Ints, last: Ints, round_mm: float) -> tuple[float, int, int] | None:
    """The same by place, for paths of many vertices: pairs that are near; None where there is no near one."""
    from scipy.spatial import cKDTree

    tree, within_mm = cKDTree(v[:, :2]), _NEAR_MM
    reach_mm = float(np.ptp(v[:, :2], axis=0).max())
    while within_mm < reach_mm and tree.count_neighbors(tree, within_mm) <= COMPARED:
        near = tree.query_pairs(within_mm, output_type="ndarray").reshape(-1, 2).astype(np.int64)
        one, other = near.min(axis=1), near.max(axis=1)
        apart = (first[one] <= other) & (other < last[one])
        if apart.any():
            gap_mm, _, k, m = _best(v, at_mm, one[apart], other[apart], round_mm)
            if gap_mm + _ROUNDED_MM < within_mm:
                return gap_mm, k, m
        within_mm *= _NEARER
    return None


def _best(v: Floats, at_mm: Floats, one: Ints, other: Ints, round_mm: float) -> tuple[float, float, int, int]:
    """Gap, distance from once round, and vertices of the best of some pairs."""
    gaps = np.hypot(*(v[other, :2] - v[one, :2]).T).round(3)
    least = np.flatnonzero(gaps == gaps.min())
    one, other = one[least], other[least]
    off = np.abs(at_mm[other] - at_mm[one] - round_mm).round(3)
    at = int(np.lexsort((other, one, off))[0])
    return float(gaps[least[0]]), float(off[at]), int(one[at]), int(other[at])
