"""A torch-on path taken apart where it joins its contour."""

from __future__ import annotations

from collections.abc import Sequence
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
    return split_each([path], [round_mm])[0]


def split_each(paths: Sequence[Curve], rounds_mm: Sequence[float]) -> list[Pieces | None]:
    """As `split` of each; the pairs of many paths are compared together."""
    found: list[Pieces | None] = [None] * len(paths)
    asked = {k: of for k, of in enumerate(map(_pairs_of, paths, rounds_mm)) if of is not None}
    many = [k for k, of in asked.items() if of.count > COMPARED]
    for k in many:
        of = asked.pop(k)
        found[k] = _pieces(paths[k], *(_looked_up(of) or _compared(of)))
    waiting = list(asked)
    while waiting:
        counts = np.cumsum([asked[k].count for k in waiting])
        some = waiting[: max(int(np.searchsorted(counts, COMPARED, side="right")), 1)]
        waiting = waiting[len(some) :]
        for k, best in zip(some, _best_of_each([asked[k] for k in some]), strict=True):
            found[k] = _pieces(paths[k], *best)
    return found


@dataclass(frozen=True, eq=False, slots=True)
class _Pairs:
    """Vertices of a path, how far along it each lies, and the range of others that may go with each."""

    v: Floats
    at_mm: Floats
    first: Ints
    last: Ints
    round_mm: float

    @property
    def count(self) -> int:
        """How many pairs there are."""
        return int((self.last - self.first).sum())


def _pairs_of(path: Curve, round_mm: float) -> _Pairs | None:
    """The pairs of vertices that are half a round to one and a half apart; None where there is none."""
    v, at_mm = path.vertices, path.starts_mm
    if len(at_mm) < len(v):  # vertices that lie on each other
        ends = zip(v.tolist(), v[1:].tolist(), strict=False)
        lengths = [Segment((a[0], a[1]), (b[0], b[1]), a[2]).length_mm for a, b in ends]
        at_mm = np.concatenate([[0.0], np.cumsum(lengths)])
    if at_mm[-1] < _LEAST * round_mm:
        return None
    first = np.searchsorted(at_mm, at_mm + _LEAST * round_mm)
    last = np.searchsorted(at_mm, at_mm + _MOST * round_mm, side="right")
    pairs = _Pairs(v[:, :2], at_mm, first, last, round_mm)
    return pairs if pairs.count else None


def _pieces(path: Curve, gap_mm: float, k: int, m: int) -> Pieces:
    return Pieces(path.piece(0, k), path.piece(k, m), path.piece(m, len(path.vertices) - 1), gap_mm)


def _best_of_each(asked: Sequence[_Pairs]) -> list[tuple[float, int, int]]:
    """The best pair of each path, as its gap and its two vertices, by all pairs of all of them."""
    sizes = np.array([len(p.v) for p in asked])
    since = np.cumsum(sizes) - sizes
    of = np.repeat(np.arange(len(asked)), sizes)
    v, at_mm = np.concatenate([p.v for p in asked]), np.concatenate([p.at_mm for p in asked])
    first, last = np.concatenate([p.first for p in asked]), np.concatenate([p.last for p in asked])
    one = np.repeat(np.arange(len(of)), last - first)
    other = laid_out(first + since[of], last - first)
    gaps_mm, _, one, other = _best(v, at_mm, one, other, of[one], np.array([p.round_mm for p in asked]))
    return list(zip(gaps_mm.tolist(), (one - since).tolist(), (other - since).tolist(), strict=True))


def _compared(of: _Pairs) -> tuple[float, int, int]:
    """The best pair of one path, as its gap and its two vertices; as many rows at once as `COMPARED` allows."""
    counts = of.last - of.first
    until = np.cumsum(counts)
    best: tuple[float, float, int, int] | None = None
    begin = 0
    while begin < len(counts):
        done = int(until[begin - 1]) if begin else 0
        end = max(int(np.searchsorted(until, done + COMPARED, side="right")), begin + 1)
        each = counts[begin:end]
        one = np.repeat(np.arange(begin, end), each)
        other = laid_out(of.first[begin:end], each)
        if len(one):
            found = _best_of(of, one, other)
            best = found if best is None else min(best, found)
        begin = end
    assert best is not None
    return best[0], best[2], best[3]


def _looked_up(of: _Pairs) -> tuple[float, int, int] | None:
    """The same by place, for paths of many vertices: pairs that are near; None where there is no near one."""
    from scipy.spatial import cKDTree

    tree, within_mm = cKDTree(of.v), _NEAR_MM
    reach_mm = float(np.ptp(of.v, axis=0).max())
    while within_mm < reach_mm and tree.count_neighbors(tree, within_mm) <= COMPARED:
        near = tree.query_pairs(within_mm, output_type="ndarray").reshape(-1, 2).astype(np.int64)
        one, other = near.min(axis=1), near.max(axis=1)
        apart = (of.first[one] <= other) & (other < of.last[one])
        if apart.any():
            gap_mm, _, k, m = _best_of(of, one[apart], other[apart])
            if gap_mm + _ROUNDED_MM < within_mm:
                return gap_mm, k, m
        within_mm *= _NEARER
    return None


def _best_of(of: _Pairs, one: Ints, other: Ints) -> tuple[float, float, int, int]:
    """Gap, distance from once round, and vertices of the best of some pairs of one path."""
    same = np.zeros(len(one), dtype=np.int64)
    gap_mm, off_mm, k, m = _best(of.v, of.at_mm, one, other, same, np.array([of.round_mm]))
    return float(gap_mm[0]), float(off_mm[0]), int(k[0]), int(m[0])


def _best(
    v: Floats, at_mm: Floats, one: Ints, other: Ints, of: Ints, round_mm: Floats
) -> tuple[Floats, Floats, Ints, Ints]:
    """Gap, distance from once round, and vertices of the best pair of each path `of`, these being in order."""
    gaps = np.hypot(*(v[other] - v[one]).T).round(3)
    begin = np.flatnonzero(np.diff(of, prepend=-1))
    closest = np.minimum.reduceat(gaps, begin)
    least = np.flatnonzero(gaps == np.repeat(closest, np.diff(begin, append=len(of))))
    one, other, of = one[least], other[least], of[least]
    off = np.abs(at_mm[other] - at_mm[one] - round_mm[of]).round(3)
    order = np.lexsort((other, one, off, of))
    best = order[np.flatnonzero(np.diff(of[order], prepend=-1))]
    return closest, off[best], one[best], other[best]
