"""One burn that matches a contour, as a cut, with what is wrong with its geometry."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints, concat_ranges, point_tree
from kerfwise.encoder.cut import Cut, Direction
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.measures import beyond_mm
from kerfwise.encoder.geometry.segment import Point, Segment
from kerfwise.encoder.nest import Contour
from kerfwise.postproc.check.reader.program import Burn
from kerfwise.rules.judging.violation import Violation

from .contour_following import surely_beside
from .matching import Match
from .torch_run import TorchRun, every_line_of, tolerance_mm

SLACK_MM = 0.01
"""What the chords of paths and rings may make of a distance between vertices."""
_STEP_MM = 0.1


@dataclass(frozen=True, eq=False, slots=True)
class SplitBurn:
    """The path of a burn taken apart, its round and its leads as lines; `on_ring` says that the round lies on the ring.

    Where it does not, that is not known.
    """

    pieces: Pieces
    lead_in: shapely.LineString | None
    loop: shapely.LineString
    lead_out: shapely.LineString | None
    on_ring: bool = False


CutFound = tuple[Cut, TorchRun, list[Violation]]


def split_burns(
    burns: Sequence[Burn],
    paths: Sequence[shapely.LineString],
    contours: Sequence[Contour],
    matches: Sequence[Match],
    kerf_mm: float,
) -> list[SplitBurn]:
    """What leads to the contours that burns match, once round, and what leads away."""
    apart = _apart(burns, contours, matches)
    rounds = every_line_of([pieces.loop for pieces in apart])
    leads_in, leads_out = every_line_of([p.lead_in for p in apart]), every_line_of([p.lead_out for p in apart])
    loops = [path if line is None else line for line, path in zip(rounds, paths, strict=True)]
    on_ring = surely_beside(loops, [match.ring for match in matches], 0.0, tolerance_mm(kerf_mm))
    return [SplitBurn(*row) for row in zip(apart, leads_in, loops, leads_out, on_ring.tolist(), strict=True)]


def _apart(burns: Sequence[Burn], contours: Sequence[Contour], matches: Sequence[Match]) -> list[Pieces]:
    found = [_at_mouth(b.path, c.curve) if c.kind == "slit" else None for b, c in zip(burns, contours, strict=True)]
    around = [k for k, contour in enumerate(contours) if contour.encloses and found[k] is None]
    rounds = split_each([burns[k].path for k in around], [matches[k].ring.length for k in around])
    for k, pieces in zip(around, rounds, strict=True):
        found[k] = pieces
    return [_whole(burn.path) if pieces is None else pieces for burn, pieces in zip(burns, found, strict=True)]


def cut_from_burn(
    burn: Burn, taken: SplitBurn, contour: Contour, match: Match, kerf_mm: float, zone: int, position: int
) -> CutFound:
    """The cut that a burn makes of the contour it matches, and what is wrong with it."""
    marks, pieces, loop = burn.tool != 0, taken.pieces, taken.loop
    join = _xy(pieces.loop, 0)
    along_mm, _ = contour.curve.project(join)
    entry = join if not contour.encloses else contour.curve.point_at(along_mm)
    lead_in = pieces.lead_in if pieces.lead_in.segments else None
    cut = Cut(
        contour.id, entry, _direction(contour, pieces.loop), _xy(burn.path, 0), lead_in, pieces.lead_out, zone,
        burn.start_s, burn.end_s,
    )  # fmt: skip
    where = f"line {burn.line}"
    follows = match.ring if taken.on_ring else None
    run = TorchRun(position, where, contour, taken.lead_in, loop, taken.lead_out, marks, follows=follows)
    wrong = list(_wrong(contour, match, taken, kerf_mm, marks))
    return cut, run, [Violation(rule, (contour.id,), f"{where}: {text}", (position,)) for rule, text in wrong]


def _wrong(contour: Contour, match: Match, taken: SplitBurn, kerf_mm: float, marks: bool) -> list[tuple[str, str]]:
    found, pieces = [], taken.pieces
    allowed = tolerance_mm(kerf_mm)
    name = contour.id
    if marks and contour.kind != "mark":
        found.append(("every-contour-once", f"{name} is only marked, not cut"))
    if not marks and contour.kind == "mark":
        found.append(("every-contour-once", f"{name} is a mark, but the torch cuts through it"))
    if match.side == "wrong":
        side = "inside" if contour.kind == "outer" else "outside"
        found.append(("kerf-side", f"the torch runs {side} {name}, so that the kerf is on the part's side"))
    elif match.side == "on":
        found.append(("kerf-side", f"the torch runs on {name} itself: the kerf of {kerf_mm:g} mm is not allowed for"))
    if pieces.gap_mm > allowed and contour.curve.closed:
        found.append(("contour-geometry", f"{name} is not closed: {pieces.gap_mm:.3f} mm are left"))
    off_mm = match.deviation_mm
    if not taken.on_ring:
        off_mm = max(off_mm, _off_mm(match.ring, taken.loop, allowed))
    if off_mm > allowed:
        found.append(("contour-geometry", f"the torch is up to {off_mm:.2f} mm off where {name} asks for it"))
    if contour.kind == "mark" and not found and (left_mm := _left_mm(match.ring, taken.loop, allowed)) > allowed:
        found.append(("contour-geometry", f"{left_mm:.2f} mm of {name} are not marked"))
    again = split(pieces.lead_out, match.ring.length) if contour.encloses else None
    if again is not None and again.gap_mm <= allowed:
        found.append(("contour-geometry", f"the torch goes round {name} more than once"))
    return found


def _off_mm(ring: shapely.LineString, loop: shapely.LineString, allowed: float) -> float:
    """How far a path is from a ring at most, mm; 0 where it is nowhere farther than it may be.

    Vertices come first. Between them chords may take a path a little farther, but not somewhere else.
    """
    off_mm = beyond_mm(ring, shapely.get_coordinates(loop), allowed)
    near = shapely.buffer(ring, allowed + SLACK_MM)
    if off_mm > 0 or shapely.covers(near, loop):
        return off_mm
    away = shapely.segmentize(shapely.difference(loop, near), _STEP_MM)
    return beyond_mm(ring, shapely.get_coordinates(away), allowed)


def _left_mm(ring: shapely.LineString, path: shapely.LineString, allowed: float) -> float:
    """How much of a ring a path leaves out, mm. A path through all corners of a ring may go there and back.

    Contours that are cut are held against the metal that is left instead.
    """
    return float(shapely.difference(ring, shapely.buffer(path, allowed + SLACK_MM)).length)


def _direction(contour: Contour, loop: Curve) -> Direction:
    """As seen with y up; along an open line "ccw", against it "cw"."""
    if contour.curve.closed:
        return "ccw" if loop.is_ccw else "cw"
    first, last = _xy(contour.curve, 0), _xy(contour.curve, -1)
    start, end = _xy(loop, 0), _xy(loop, -1)
    along = math.dist(start, first) + math.dist(end, last)
    against = math.dist(start, last) + math.dist(end, first)
    return "ccw" if along <= against else "cw"


def _xy(curve: Curve, k: int) -> Point:
    x, y = curve.vertices[k, :2].tolist()
    return x, y


def _at_mouth(path: Curve, slit: Curve) -> Pieces:
    """A path along a slit, taken apart at its vertex nearest to where the slit begins; all after that is the slit."""
    away_mm = np.hypot(*(path.vertices[:-1, :2] - slit.vertices[0, :2]).T)
    k = int(np.argmin(away_mm))
    last = len(path.vertices) - 1
    return Pieces(path.piece(0, k), path.piece(k, last), path.piece(last, last), 0.0)


def _whole(path: Curve) -> Pieces:
    """A path that does not come apart, as a round without leads."""
    last = len(path.vertices) - 1
    return Pieces(path.piece(0, 0), path, path.piece(last, last), math.dist(_xy(path, 0), _xy(path, -1)))


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
    pairs = {k: of for k, of in enumerate(map(_pairs_of, paths, rounds_mm)) if of is not None}
    many = [k for k, of in pairs.items() if of.count > COMPARED]
    for k in many:
        of = pairs.pop(k)
        found[k] = _pieces(paths[k], *(_looked_up(of) or _compared(of)))
    waiting = list(pairs)
    while waiting:
        counts = np.cumsum([pairs[k].count for k in waiting])
        some = waiting[: max(int(np.searchsorted(counts, COMPARED, side="right")), 1)]
        waiting = waiting[len(some) :]
        for k, best in zip(some, _best_of_each([pairs[k] for k in some]), strict=True):
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


def _best_of_each(pairs: Sequence[_Pairs]) -> list[tuple[float, int, int]]:
    """The best pair of each path, as its gap and its two vertices, by all pairs of all of them."""
    sizes = np.array([len(p.v) for p in pairs])
    since = np.cumsum(sizes) - sizes
    of = np.repeat(np.arange(len(pairs)), sizes)
    v, at_mm = np.concatenate([p.v for p in pairs]), np.concatenate([p.at_mm for p in pairs])
    first, last = np.concatenate([p.first for p in pairs]), np.concatenate([p.last for p in pairs])
    one = np.repeat(np.arange(len(of)), last - first)
    other = concat_ranges(first + since[of], last - first)
    gaps_mm, _, one, other = _best(v, at_mm, one, other, of[one], np.array([p.round_mm for p in pairs]))
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
        other = concat_ranges(of.first[begin:end], each)
        if len(one):
            found = _best_of(of, one, other)
            best = found if best is None else min(best, found)
        begin = end
    assert best is not None
    return best[0], best[2], best[3]


def _looked_up(of: _Pairs) -> tuple[float, int, int] | None:
    """The same by place, for paths of many vertices: pairs that are near; None where there is no near one."""

    tree, within_mm = point_tree(of.v), _NEAR_MM
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
