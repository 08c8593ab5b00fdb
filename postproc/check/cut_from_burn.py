"""One burn that matches a contour, as a cut, with what is wrong with its geometry."""

from __future__ import annotations

import math

import numpy as np
import shapely

from kerfwise.encoder.cut import Cut, Direction
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.distances import beyond_mm
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour
from kerfwise.postproc.check.reader.program import Burn
from kerfwise.rules.rule import Violation

from .matching import Match
from .program_rules import tolerance_mm
from .splitting import Pieces, split
from .torch_run import TorchRun, line_of

CutFound = tuple[Cut, TorchRun, list[Violation]]


def cut_from_burn(
    burn: Burn, path: shapely.LineString, contour: Contour, match: Match, kerf_mm: float, zone: int, position: int
) -> CutFound:
    """The cut that a burn makes of the contour it matches, its path taken apart, and what is wrong with it."""
    marks = burn.tool != 0
    if contour.kind == "slit":
        pieces = _at_mouth(burn.path, contour.curve)
    else:
        pieces = (split(burn.path, match.ring.length) if contour.encloses else None) or _whole(burn.path)
    loop = line_of(pieces.loop) or path
    join = _xy(pieces.loop, 0)
    along_mm, _ = contour.curve.project(join)
    entry = join if not contour.encloses else contour.curve.point_at(along_mm)
    lead_in = pieces.lead_in if pieces.lead_in.segments else None
    cut = Cut(
        contour.id, entry, _direction(contour, pieces.loop), _xy(burn.path, 0), lead_in, pieces.lead_out, zone,
        burn.start_s, burn.end_s,
    )  # fmt: skip
    where = f"line {burn.line}"
    run = TorchRun(position, where, contour, line_of(lead_in), loop, line_of(pieces.lead_out), marks)
    wrong = list(_wrong(contour, match, pieces, loop, kerf_mm, marks))
    return cut, run, [Violation(rule, (contour.id,), f"{where}: {text}", (position,)) for rule, text in wrong]


def _wrong(
    contour: Contour, match: Match, pieces: Pieces, loop: shapely.LineString, kerf_mm: float, marks: bool
) -> list[tuple[str, str]]:
    found = []
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
    off_mm = max(match.deviation_mm, beyond_mm(match.ring, shapely.get_coordinates(loop), allowed))
    if off_mm > allowed:
        found.append(("contour-geometry", f"the torch is up to {off_mm:.2f} mm off where {name} asks for it"))
    again = split(pieces.lead_out, match.ring.length) if contour.encloses else None
    if again is not None and again.gap_mm <= allowed:
        found.append(("contour-geometry", f"the torch goes round {name} more than once"))
    return found


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
    lead_in, along = Curve(path.vertices[: k + 1], closed=False), Curve(path.vertices[k:], closed=False)
    return Pieces(lead_in, along, Curve(path.vertices[-1:], closed=False), 0.0)


def _whole(path: Curve) -> Pieces:
    """A path that does not come apart, as a round without leads."""
    start, end = Curve(path.vertices[:1], closed=False), Curve(path.vertices[-1:], closed=False)
    return Pieces(start, path, end, math.dist(_xy(path, 0), _xy(path, -1)))
