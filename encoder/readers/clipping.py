"""What of a drawing's lines is seen: clipped ones in part, and of filled shapes the outline of the area filled."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.measures import MOST_MEETINGS, has_too_many_crossings
from kerfwise.encoder.nest import Note
from kerfwise.encoder.questions import Asking, Choice, Question

from .drawing import SNAP_MM, DrawnCurve, DrawnText
from .fit_arcs import FLATTEN_MM, fit_curve
from .layers import counted

NEAR_MM = 0.01
"""A line that reaches no further out of its clipping path is shown whole."""

Clips = tuple[shapely.Geometry, ...]
"""Areas in mm; what is drawn is seen where it lies in all of them."""


def seen_through(pieces: Sequence[tuple[DrawnCurve, Clips]], asking: Asking) -> tuple[list[DrawnCurve], list[Note]]:
    """The pieces that are seen, and a word on those that are not.

    A piece that lies wholly in its clipping paths stays, one that lies outside is left out. One that is seen in part
    raises the question `clip`.
    """
    kept: list[DrawnCurve] = []
    hidden: list[DrawnCurve] = []
    partly: list[tuple[int, DrawnCurve, shapely.Geometry]] = []
    for piece, clips in pieces:
        if not clips:
            kept.append(piece)
            continue
        area, line = shapely.intersection_all(clips), piece.curve.line()
        if shapely.buffer(area, NEAR_MM).covers(line):
            kept.append(piece)
        elif (piece.area if piece.curve.closed else line).intersection(area).is_empty:
            hidden.append(piece)
        elif piece.curve.closed and not line.intersects(area.buffer(NEAR_MM)):
            hidden.append(piece)  # the hole in it is seen, its line nowhere
        else:
            partly.append((len(kept), piece, area))
    notes = [_note(hidden)] if hidden else []
    if not partly:
        return kept, notes
    answer = asking.ask(_question([piece for _, piece, _ in partly]))
    if answer == "ignore":
        return kept, [*notes, _note([piece for _, piece, _ in partly])]
    shown = list(kept)
    for before, piece, area in reversed(partly):
        shown[before:before] = [piece] if answer == "whole" else _inside(piece, area)
    return shown, notes


def texts_seen(texts: Sequence[tuple[DrawnText, Clips]]) -> tuple[tuple[DrawnText, ...], list[Note]]:
    """The texts and points that are seen whole, and a word on those that a clipping path hides, or hides in part."""
    kept: list[DrawnText] = []
    gone: list[DrawnText] = []
    for text, clips in texts:
        lines = [stroke.curve.line() for stroke in text.strokes] or [shapely.Point(text.look.curve.vertices[0, :2])]
        area = shapely.buffer(shapely.intersection_all(clips), NEAR_MM) if clips else None
        (kept if area is None or shapely.covers(area, lines).all() else gone).append(text)
    if not gone:
        return tuple(kept), []
    named = f"left out, as a clipping path hides them, or some of them: {counted(t.look.layer for t in gone)}"
    return tuple(kept), [Note("warning", f"{named}, the first the {gone[0].place}")]


def _question(partly: Sequence[DrawnCurve]) -> Question:
    count = len(partly)
    which = (
        f"the line {partly[0].place} is" if count == 1 else f"{count} lines ({counted(p.layer for p in partly)}) are"
    )
    return Question(
        "clip",
        f"{which} seen only in part, through a clipping path: what is cut?",
        (
            Choice("clipped", "what is seen, closed along the edge of the clipping path"),
            Choice("whole", "the whole, as it is drawn behind the clipping path"),
            Choice("ignore", "nothing of it"),
        ),
    )


def _note(hidden: Sequence[DrawnCurve]) -> Note:
    return Note("warning", f"left out, as a clipping path hides them: {counted(p.layer for p in hidden)}")


def _inside(piece: DrawnCurve, area: shapely.Geometry) -> list[DrawnCurve]:
    """The part of a piece that lies in an area."""
    shape = piece.area if piece.curve.closed else piece.curve.line(FLATTEN_MM)
    found = shapely.intersection(shape, area)
    return [replace(piece, curve=curve) for points in _runs(found) if (curve := fit_curve(points)) is not None]


def _runs(found: shapely.Geometry) -> Iterator[Floats]:
    for one in shapely.get_parts(found):
        if one.geom_type == "Polygon":
            yield from (np.array(ring.coords) for ring in (one.exterior, *one.interiors))
        elif one.geom_type == "LineString":
            yield np.array(one.coords)


def filled_outlines(curves: Sequence[Curve], even_odd: bool) -> list[Curve] | None:
    """The lines round what a shape fills, where its lines cross or run on each other; None where none do.

    Lines that are closed again as they were drawn stay exactly as they were. `curves`: the subpaths of one shape that
    is filled and has no line; open ones are closed, as a filling closes them. `even_odd`: whether its fill rule is
    evenodd; else it is nonzero.

    Examples
    --------
    >>> bars = [Curve.of([(0, 4), (9, 4), (9, 6), (0, 6)]), Curve.of([(4, 0), (6, 0), (6, 9), (4, 9)])]
    >>> [abs(curve.signed_area_mm2) for curve in filled_outlines(bars, False) or []]
    [32.0]
    """
    closed = [Curve(curve.vertices, True) for curve in curves if len(curve.vertices) > 2 or curve.closed]
    rings = np.array([curve.line(FLATTEN_MM) for curve in closed], dtype=object)
    if (
        not closed
        or not _cross(closed, rings)
        or any(has_too_many_crossings(curve.flatten(FLATTEN_MM), closed=True, most=MOST_MEETINGS) for curve in closed)
    ):
        return None
    filled = filled_area(closed, even_odd)
    outlines = [ring for part in shapely.get_parts(filled) for ring in (part.exterior, *part.interiors)]
    return [_as_drawn(ring, closed, rings) for ring in outlines if ring.length > SNAP_MM] or None


def filled_area(curves: Sequence[Curve], even_odd: bool) -> shapely.Geometry:
    """What a fill rule fills of closed curves.

    Examples
    --------
    >>> rings = [Curve.of([(0, 0), (9, 0), (9, 9), (0, 9)]), Curve.of([(4, 4), (6, 4), (6, 6), (4, 6)])]
    >>> filled_area(rings, True).area, filled_area(rings, False).area
    (77.0, 81.0)
    """
    rings = [curve.line(FLATTEN_MM) for curve in curves]
    faces = np.array(shapely.polygonize([shapely.node(shapely.multilinestrings(rings))]).geoms, dtype=object)
    if not len(faces):
        return shapely.Polygon()
    points = shapely.get_coordinates(shapely.point_on_surface(faces))
    turns = np.sum([_turns(curve.flatten(FLATTEN_MM), points) for curve in curves], axis=0)
    return shapely.union_all(faces[turns % 2 == 1 if even_odd else turns != 0])


def unseen_rings(curves: Sequence[Curve]) -> list[int]:
    """Which closed subpaths of a shape that is filled by the rule nonzero are no edges of it, though none cross.

    The same is filled on either side of a ring in a ring that turns the same way.

    Examples
    --------
    >>> rings = [Curve.of([(0, 0), (9, 0), (9, 9), (0, 9)]), Curve.of([(4, 4), (6, 4), (6, 6), (4, 6)])]
    >>> unseen_rings(rings), unseen_rings([rings[0], rings[1].reversed()])
    ([1], [])
    """
    closed = [k for k, curve in enumerate(curves) if curve.closed and len(curve.vertices) > 1]
    if len(closed) < 2:
        return []
    areas = [curves[k].polygon(FLATTEN_MM) for k in closed]
    order = sorted(range(len(closed)), key=lambda k: -areas[k].area)
    unseen = []
    for n, k in enumerate(order):
        point = shapely.Point(curves[closed[k]].vertices[0, :2])
        around = sum(_way(curves[closed[o]]) for o in order[:n] if areas[o].contains(point))
        if around and around + _way(curves[closed[k]]):
            unseen.append(closed[k])
    return sorted(unseen)


def _way(curve: Curve) -> int:
    return 1 if curve.is_ccw else -1


def _cross(curves: Sequence[Curve], rings: Floats) -> bool:
    """Whether a ring crosses itself or another one, or two run on each other; rings may touch at points."""
    if not shapely.is_simple(rings).all():
        return True
    one, other = shapely.STRtree(rings).query(rings, predicate="intersects")
    pairs = one < other
    one, other = one[pairs], other[pairs]
    areas = np.array([curve.polygon(FLATTEN_MM) for curve in curves], dtype=object)
    along_mm = shapely.length(shapely.intersection(rings[one], rings[other]))
    return bool(shapely.overlaps(areas[one], areas[other]).any() or (along_mm > SNAP_MM).any())


def _turns(ring: Floats, points: Floats) -> Ints:
    """How often a closed ring of points (n, 2) winds round each of some points (m, 2), counter-clockwise."""
    x, y = points[:, :1], points[:, 1:]
    (x0, y0), (x1, y1) = ring.T, np.roll(ring, -1, axis=0).T
    left = (x1 - x0) * (y - y0) - (x - x0) * (y1 - y0)
    up = (y0 <= y) & (y1 > y) & (left > 0)
    down = (y0 > y) & (y1 <= y) & (left < 0)
    return np.asarray(up.sum(axis=1) - down.sum(axis=1), dtype=np.int64)


def _as_drawn(ring: shapely.LinearRing, curves: Sequence[Curve], rings: Floats) -> Curve:
    """The subpath that a ring is, else the ring with arcs again."""
    for curve, drawn in zip(curves, rings, strict=True):
        same = abs(drawn.length - ring.length) <= SNAP_MM and shapely.hausdorff_distance(drawn, ring) <= SNAP_MM
        if same:
            return curve
    points = np.array(ring.coords)
    return fit_curve(points) or Curve.of(points[:-1])
