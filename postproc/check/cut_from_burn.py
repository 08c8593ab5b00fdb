"""One burn that matches a contour, as a cut, with what is wrong with its geometry."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.encoder.cut import Cut, Direction
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.distances import beyond_mm
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour
from kerfwise.postproc.check.reader.program import Burn
from kerfwise.rules.rule import Violation

from .followed_contours import surely_beside
from .matching import Match
from .program_rules import tolerance_mm
from .splitting import Pieces, split, split_each
from .torch_run import TorchRun, every_line_of

SLACK_MM = 0.01
"""What the chords of paths and rings may make of a distance between vertices."""
_STEP_MM = 0.1


@dataclass(frozen=True, eq=False, slots=True)
class Taken:
    """The path of a burn taken apart, its round and its leads as lines; `on_ring` says that the round lies on the ring.

    Where it does not, that is not known.
    """

    pieces: Pieces
    lead_in: shapely.LineString | None
    loop: shapely.LineString
    lead_out: shapely.LineString | None
    on_ring: bool = False


CutFound = tuple[Cut, TorchRun, list[Violation]]


def taken_apart(
    burns: Sequence[Burn],
    paths: Sequence[shapely.LineString],
    contours: Sequence[Contour],
    matches: Sequence[Match],
    kerf_mm: float,
) -> list[Taken]:
    """What leads to the contours that burns match, once round, and what leads away."""
    apart = _apart(burns, contours, matches)
    rounds = every_line_of([pieces.loop for pieces in apart])
    leads_in, leads_out = every_line_of([p.lead_in for p in apart]), every_line_of([p.lead_out for p in apart])
    loops = [path if line is None else line for line, path in zip(rounds, paths, strict=True)]
    on_ring = surely_beside(loops, [match.ring for match in matches], 0.0, tolerance_mm(kerf_mm))
    return [Taken(*row) for row in zip(apart, leads_in, loops, leads_out, on_ring.tolist(), strict=True)]


def _apart(burns: Sequence[Burn], contours: Sequence[Contour], matches: Sequence[Match]) -> list[Pieces]:
    found = [_at_mouth(b.path, c.curve) if c.kind == "slit" else None for b, c in zip(burns, contours, strict=True)]
    around = [k for k, contour in enumerate(contours) if contour.encloses and found[k] is None]
    rounds = split_each([burns[k].path for k in around], [matches[k].ring.length for k in around])
    for k, pieces in zip(around, rounds, strict=True):
        found[k] = pieces
    return [_whole(burn.path) if pieces is None else pieces for burn, pieces in zip(burns, found, strict=True)]


def cut_from_burn(
    burn: Burn, taken: Taken, contour: Contour, match: Match, kerf_mm: float, zone: int, position: int
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


def _wrong(contour: Contour, match: Match, taken: Taken, kerf_mm: float, marks: bool) -> list[tuple[str, str]]:
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
