"""Lines that a drawing shows only in part, through a clipping path of SVG or a clipped block of DXF."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.nest import Note
from kerfwise.encoder.questions import Asking, Choice, Question

from .drawing import DrawnCurve, DrawnText
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
