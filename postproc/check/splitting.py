"""A torch-on path taken apart where it joins its contour."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Segment

_LEAST, _MOST = 0.5, 1.5


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
    lengths = [
        Segment((a[0], a[1]), (b[0], b[1]), a[2]).length_mm for a, b in zip(v.tolist(), v[1:].tolist(), strict=False)
    ]
    at_mm = np.concatenate([[0.0], np.cumsum(lengths)])
    first = np.searchsorted(at_mm, at_mm + _LEAST * round_mm)
    last = np.searchsorted(at_mm, at_mm + _MOST * round_mm, side="right")
    best: tuple[float, float, int, int] | None = None
    for k, (low, high) in enumerate(zip(first.tolist(), last.tolist(), strict=True)):
        if low == high:
            continue
        gaps = np.hypot(*(v[low:high, :2] - v[k, :2]).T).round(3)
        off = np.abs(at_mm[low:high] - at_mm[k] - round_mm).round(3)
        m = int(np.lexsort((off, gaps))[0])
        found = (float(gaps[m]), float(off[m]), k, low + m)
        best = found if best is None else min(best, found)
    if best is None:
        return None
    gap_mm, _, k, m = best
    return Pieces(_open(v[: k + 1]), _open(v[k : m + 1]), _open(v[m:]), gap_mm)


def _open(vertices: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> Curve:
    return Curve(vertices, closed=False)
