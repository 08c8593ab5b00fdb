"""SVG files to a drawing: groups are its layers."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
import svgelements

from kerfwise.arrays import Floats
from kerfwise.encoder.contour_checks import enclosed
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Note, Sheet
from kerfwise.encoder.progress_notice import amount
from kerfwise.encoder.questions import Asking, Choice, Question

from .clipping import Clips, filled_area, filled_outlines, seen_through, texts_seen, unseen_rings
from .drawing import (
    FAREST_MM,
    FOREIGN_ERRORS,
    WRONG_UNITS,
    Drawing,
    DrawnCurve,
    DrawnText,
    brought_near,
    checked_curve,
)
from .fit_arcs import FLATTEN_MM, fit_arcs
from .layers import counted
from .options import ReadOptions
from .svg_text import TEXT, TROUBLE
from .svg_validate import validate_svg
from .svg_viewports import page_of
from .svg_visible import CLIP, FILLED, MASK, SHAPE, Seen, hidden_told

NUMBERED = re.compile(
    "(path|rect|circle|ellipse|line|polyline|polygon|g|group|use|text|tspan|image|layer|svg)[-_]?[0-9][-_0-9]*"
)
"""Ids that a drawing program numbers on by itself: `text12` says nothing of what a shape is for."""
DRAWN = (svgelements.Shape, svgelements.Image)
LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"


def read_svg(data: bytes, options: ReadOptions, asking: Asking | None = None) -> Drawing:
    """Every shape that is shown, in mm with y up, and what is written; images are passed over, and that is said.

    `data`: the file's bytes. `options`: `units` says what a user unit (of the viewBox) is, `layers` what the groups are
    for. Raises InputError when the file is no SVG or a shape in it cannot be understood.
    """
    asking = Asking(dict(options.answers)) if asking is None else asking
    plain, seen = sound_svg(data)
    svg = _parsed(plain)
    try:
        page = page_of(svg, options, data, asking)
        shown = list(shown_elements(svg))
        amount(len(shown), "shape", "shapes")
        areas = _clip_areas(svg, page.to_mm)
        shapes = [s for s in shown if isinstance(s.element, svgelements.Shape)]
        texts = [_text(s, order, page.to_mm) for order, s in enumerate(shapes) if TEXT in s.element.values]
        paths = [(s, curves(s.element, page.to_mm)) for s in shapes if TEXT not in s.element.values]
        outlines, fill_notes = _as_filled(paths, asking)
        drawn = [(c, s) for s, of in outlines for c in of]
    except FOREIGN_ERRORS as error:
        raise InputError(f"a shape of this SVG file is damaged ({error}); save it again as plain SVG") from error
    pieces = [
        (
            DrawnCurve(c, s.layer, order, s.names, *_look(s.element), width_mm=_width_mm(s.element, page.to_mm)),
            tuple(areas[clip] for clip in s.clips),
        )
        for order, (c, s) in enumerate(drawn)
    ]
    masked = {order for order, (_, s) in enumerate(drawn) if s.masked}
    pieces, mask_notes = _through_masks(pieces, masked, asking)
    kept, clip_notes = seen_through(pieces, asking)
    covers = [((EMPTY,) if s.masked else tuple(areas[clip] for clip in s.clips)) for _, s in texts]
    seen_texts, text_notes = texts_seen([(text, over) for (text, _), over in zip(texts, covers, strict=True)])
    notes = [*_unread(shown), *(Note("warning", text) for text in hidden_told(seen)), *text_notes]
    if not kept and seen.hidden:
        raise InputError(f"nothing to cut: {next(hidden_told(seen)).removeprefix('left out, as the ')}")
    kept, page_notes = _on_page(kept, page.sheet, asking)
    near, near_texts, far_notes = brought_near(kept, seen_texts)
    notes += [*page.notes, *page_notes, *fill_notes, *mask_notes, *clip_notes, *far_notes]
    sheet = None if far_notes else page.sheet
    return Drawing(near, page.units, tuple(notes), sheet, page.because, near_texts)


EMPTY = shapely.Polygon()


def _on_page(pieces: list[DrawnCurve], page: Sheet | None, asking: Asking) -> tuple[list[DrawnCurve], list[Note]]:
    """Without what lies wholly off the page, as no viewer shows it, or with it, where somebody wants that."""
    if page is None:
        return pieces, []
    off = shapely.disjoint(page.outline.polygon(), np.array([piece.curve.line() for piece in pieces], dtype=object))
    if not off.any() or off.all():  # a drawing beside its page is all that there is
        return pieces, []
    kept = [piece for piece, is_off in zip(pieces, off, strict=True) if not is_off]
    beside = [piece.layer for piece, is_off in zip(pieces, off, strict=True) if is_off]
    gone, choices = counted(beside), (Choice("ignore", "left out"), Choice("cut", "cut, too"))
    if {piece.layer for piece in kept}.issuperset(beside):  # most likely the page is too small
        choices = choices[::-1]
    text = f"beside the page, where no viewer shows anything, more is drawn ({gone}): is that cut?"
    answer = asking.ask(Question("off-page", text, choices))
    if answer == "cut":
        return pieces, []
    return kept, [Note("warning", f"left out, as it lies beside the page: {gone}")]


def _text(shown: Shown, order: int, to_mm: Any) -> tuple[DrawnText, Shown]:
    """What a path of strokes writes; see `svg_text`."""
    values = shown.element.values
    layer = "" if NUMBERED.fullmatch(shown.layer) else shown.layer
    trouble = str(values.get(TROUBLE) or "")
    try:
        drawn = curves(shown.element, to_mm)
        trouble = trouble if drawn else "it has no height"
    except InputError as error:
        drawn, trouble = [], error.message
    drawn = drawn or [Curve.of([(0, 0), (0, 1)], closed=False)]
    stem, *strokes = (DrawnCurve(curve, layer, order, shown.names, *_look(shown.element)) for curve in drawn)
    return DrawnText(str(values[TEXT]), stem, stem.curve.length_mm, tuple(strokes), trouble), shown


def _look(element: Any) -> tuple[str, str, bool]:
    """Colour of the line, else of the fill; whether the line is dashed; and whether there is a fill alone."""
    stroke, fill = (_colour(paint) for paint in (element.stroke, element.fill))
    dashes = str(element.values.get("stroke-dasharray") or "none").strip()
    dashed = stroke and dashes not in ("none", "0") and any(sign in "123456789" for sign in dashes)
    return stroke or fill, "dashed" if dashed else "", not stroke and bool(fill)


def _width_mm(element: Any, to_mm: Any) -> float:
    """How wide the line of a shape is drawn."""
    if not _colour(element.stroke):
        return 0.0
    width = 1.0 if element.stroke_width is None else float(element.stroke_width)
    matrix = element.transform * to_mm
    return width * math.sqrt(abs(matrix.a * matrix.d - matrix.b * matrix.c))


def _as_filled(
    shapes: list[tuple[Shown, list[Curve]]], asking: Asking
) -> tuple[list[tuple[Shown, list[Curve]]], list[Note]]:
    """The shapes with the outlines of what they fill, where they have no line and their subpaths cross.

    A filling closes what it fills. Rings that do not cross, and of which it shows nothing, raise the question `fill`.
    Where nobody has said how a shape is drawn, it is filled by default only: its lines are what counts.
    """
    pieces: list[tuple[Shown, list[Curve]]] = []
    notes = []
    unseen: list[tuple[list[Curve], list[int], str]] = []
    for shape, own in shapes:
        is_filled = _look(shape.element)[2]
        even_odd = str(shape.element.values.get("fill-rule") or "").strip() == "evenodd"
        filled = filled_outlines(own, even_odd) if is_filled else None
        if filled is None and is_filled and shape.element.values.get(FILLED):  # by its own words, not by default
            own = [Curve(c.vertices, True) if len(c.vertices) > 2 and not c.closed else c for c in own]
            if not even_odd and (rings := unseen_rings(own)):
                unseen.append((own, rings, shape.layer))
        pieces.append((shape, own if filled is None else filled))
        if filled is not None:
            rule = "evenodd" if even_odd else "nonzero"
            which = f"a filled shape on layer '{shape.layer}' crosses itself"
            became = f"its {len(own)} lines became {len(filled)} round what its fill rule, {rule}, fills"
            notes.append(Note("repaired", f"{which}: {became}"))
    if unseen and asking.ask(_fill_question(unseen)) == "ignore":
        gone = counted(layer for _, rings, layer in unseen for _ in rings)
        notes.append(Note("warning", f"left out, as their fill shows nothing of them: {gone}"))
        for own, rings, _ in unseen:
            own[:] = [curve for k, curve in enumerate(own) if k not in rings]
    return pieces, notes


def _fill_question(unseen: Sequence[tuple[list[Curve], list[int], str]]) -> Question:
    own, [k, *_], layer = unseen[0]
    count = sum(len(rings) for _, rings, _ in unseen)
    x, y = own[k].start
    which = "a ring lies" if count == 1 else f"{count} rings lie"
    return Question(
        "fill",
        f"{which} in a filled shape that its fill rule, nonzero, fills on both sides of the ring, so that it is not "
        f"seen, the first at ({x:.3f}, {y:.3f}) on layer '{layer}': is it cut?",
        (Choice("cut", "cut, as lines are"), Choice("ignore", "left out, as it is not seen")),
    )


_NAMES = {
    "#ff0000": "red", "#0000ff": "blue", "#00ff00": "lime", "#008000": "green", "#000000": "black", "#ffffff": "white",
    "#ffff00": "yellow", "#ff00ff": "magenta", "#00ffff": "cyan", "#808080": "grey",
}  # fmt: skip


def _colour(paint: Any) -> str:
    if paint is None or paint.value is None:
        return ""
    text = str(paint.hexrgb)
    return _NAMES.get(text, text)


def _through_masks(
    pieces: list[tuple[DrawnCurve, Clips]], masked: set[int], asking: Asking
) -> tuple[list[tuple[DrawnCurve, Clips]], list[Note]]:
    """Without what a mask may hide, or with it: how much of it is seen depends on how bright the mask is."""
    if not masked:
        return pieces, []
    answer = asking.ask(
        Question(
            "mask",
            f"{counted(p.layer for k, (p, _) in enumerate(pieces) if k in masked)} lie under a mask, which may hide "
            "them or parts of them: what is cut?",
            (Choice("whole", "all of it, as if there were no mask"), Choice("ignore", "nothing of it")),
        )
    )
    if answer == "whole":
        return pieces, []
    gone = counted(p.layer for k, (p, _) in enumerate(pieces) if k in masked)
    return [row for k, row in enumerate(pieces) if k not in masked], [Note("warning", f"left out, as masked: {gone}")]


def _clip_areas(group: Any, to_mm: Any) -> dict[str, shapely.Geometry]:
    """The areas of clipping paths in mm, by number; the whole of what one is made of."""
    found: dict[str, shapely.Geometry] = {}
    for element in group:
        if not isinstance(element, svgelements.Group | svgelements.Use):
            continue
        name = str(element.id or "")
        if name.startswith(SHAPE):
            shapes = [s for s in element.select() if isinstance(s, svgelements.Shape)]
            found[name.removeprefix(SHAPE)] = shapely.union_all([_clip_area(s, to_mm) for s in shapes])
        else:
            found |= _clip_areas(element, to_mm)
    return found


def _clip_area(shape: Any, to_mm: Any) -> shapely.Geometry:
    rings = [Curve(c.vertices, True) for c in curves(shape, to_mm) if len(c.vertices) > 1]
    if len(rings) == 1:
        return enclosed(rings[0])
    return filled_area(rings, str(shape.values.get("clip-rule") or "").strip() == "evenodd")


def sound_svg(data: bytes) -> tuple[bytes, Seen]:
    """The file as it is shown, and what of it is not.

    Raises InputError if it is no XML, or holds what cannot be read.
    """
    try:
        return validate_svg(data)
    except FOREIGN_ERRORS as error:
        raise InputError(f"not an SVG file that can be read: {error}") from error


def parsed_svg(data: bytes) -> Any:
    """The root of a file, as its library has it. Raises InputError if it is no SVG that can be read."""
    return _parsed(sound_svg(data)[0])


def _parsed(plain: bytes) -> Any:
    try:
        svg = svgelements.SVG.parse(io.BytesIO(plain), reify=False, ppi=96)
    except FOREIGN_ERRORS as error:
        raise InputError(f"not an SVG file that can be read: {error}") from error
    if not isinstance(svg, svgelements.SVG):
        raise InputError("not an SVG file: its root is no <svg> element")
    return svg


@dataclass(frozen=True, slots=True)
class Shown:
    """A shape or an image with the layer it is said to be on, every name that says what it is for, what is over it."""

    element: Any
    layer: str
    names: tuple[str, ...]
    clips: tuple[str, ...] = ()
    masked: bool = False


def shown_elements(
    group: Any,
    layers: tuple[str, ...] = (),
    names: tuple[str, ...] = (),
    clips: tuple[str, ...] = (),
    masked: bool = False,
) -> Iterator[Shown]:
    """Each shown shape and image. Its names are the ids and labels of the groups around it, then its own."""
    for element in group:
        name = str(element.id or "")
        if name.startswith(SHAPE):
            continue
        if name.startswith((CLIP, MASK)):
            inside = (*clips, name.removeprefix(CLIP)) if name.startswith(CLIP) else clips
            yield from shown_elements(element, layers, names, inside, masked or name.startswith(MASK))
            continue
        label = element.values.get(LABEL)
        label = None if label in layers else label  # svgelements hands on the label of the group around
        known = [n for n in (element.id, label) if n is not None and not NUMBERED.fullmatch(str(n))]
        own = tuple(dict.fromkeys(str(n) for n in known if n not in names))
        called = [str(n) for n in (label, element.id) if n is not None][:1]
        if isinstance(element, svgelements.Group | svgelements.Use):
            yield from shown_elements(element, (*layers, *called), (*names, *own), clips, masked)
        elif isinstance(element, DRAWN) and element.values.get("visibility") != "hidden":
            yield Shown(element, "/".join(layers or called), (*names, *own), clips, masked)


def _unread(shown: Sequence[Shown]) -> list[Note]:
    images = sum(isinstance(one.element, svgelements.Image) for one in shown)
    if not images:
        return []
    count = "1 image is" if images == 1 else f"{images} images are"
    return [Note("warning", f"{count} left out: trace to paths what is to be cut")]


# SVG shapes as curves: circular arcs stay arcs, everything bent otherwise becomes arcs again.

ROUND = 1e-6
"""An elliptical arc whose radii differ by less than this share is circular."""


def curves(shape: Any, to_mm: Any) -> list[Curve]:
    """The subpaths of a shape in mm, y up.

    `shape`: any svgelements.Shape. `to_mm`: the svgelements.Matrix from its coordinates to mm.
    """
    found = []
    path = svgelements.Path(shape)
    matrix = path.transform * to_mm
    for subpath in path.as_subpaths():
        rows: list[Floats] = []
        end, shut = None, False
        for segment in svgelements.Path(subpath):
            if isinstance(segment, svgelements.Move):
                continue
            shut = shut or isinstance(segment, svgelements.Close)
            if segment.start is not None and segment.end is not None and segment.start != segment.end:
                vertices = _vertices(segment, matrix)
                rows.append(vertices[:-1])
                end = vertices[-1:]
        if end is not None:
            vertices = np.concatenate([*rows, end])
            closed = shut or bool(np.hypot(*(vertices[0] - vertices[-1])[:2]) < 1e-6)
            found.append(checked_curve(vertices, closed))
    return found


def _vertices(segment: Any, matrix: Any) -> Floats:
    """The vertices of one segment under a matrix, the last with bulge 0."""
    match segment:
        case svgelements.Arc():
            return _arc(segment, matrix)
        case svgelements.CubicBezier() | svgelements.QuadraticBezier():
            return _bezier(segment * matrix)
    return np.array([(*(segment.start * matrix), 0.0), (*(segment.end * matrix), 0.0)])


def _arc(arc: Any, matrix: Any) -> Floats:
    """An arc of an ellipse. svgelements takes its axes for those of the ellipse that it becomes, which skews change."""
    by = np.array([[matrix.a, matrix.c], [matrix.b, matrix.d]])
    axes = by @ np.array([arc.prx - arc.center, arc.pry - arc.center]).T  # conjugate radii, one in each column
    largest, least = np.linalg.svd(axes, compute_uv=False).tolist()
    if largest - least < ROUND * largest:
        start, middle, end = (_at(arc, matrix, share) for share in (0, 0.5, 1))
        halves = [(start, _at(arc, matrix, 0.25), middle), (middle, _at(arc, matrix, 0.75), end)]
        whole = [(start, middle, end)]
        rows = [(*a, _bulge(a, m, b)) for a, m, b in (halves if abs(arc.sweep) > math.pi else whole)]
        return np.array([*rows, (*end, 0.0)])
    centre = arc.center * matrix
    _refuse_far([centre.x, centre.y, largest])
    step = 2 * math.sqrt(2 * FLATTEN_MM / max(largest, FLATTEN_MM))
    points = np.array([_at(arc, matrix, k) for k in np.linspace(0, 1, max(8, math.ceil(abs(arc.sweep) / step)) + 1)])
    return _arcs_through(points)


def _bezier(curve: Any) -> Floats:
    """Points at equal steps of the parameter, as many as Wang's formula asks for.

    The chords of a Bézier curve of degree d, cut in n, stay within d (d - 1) L / (8 n²) of it, L the largest second
    difference of its control points (Wang 1984).
    """
    control = np.array([(p.x, p.y) for p in curve])
    _refuse_far(control.ravel().tolist())
    degree = len(control) - 1
    bend = float(np.hypot(*np.diff(control, 2, axis=0).T).max())
    pieces = max(2, math.ceil(math.sqrt(degree * (degree - 1) * bend / (8 * FLATTEN_MM))))
    points = np.array(curve.npoint(np.arange(pieces + 1) / pieces))
    points[0], points[-1] = curve.start, curve.end  # exact, so that neighbours still meet
    return _arcs_through(points)


def _arcs_through(points: Floats) -> Floats:
    return fit_arcs(points[np.append(np.hypot(*np.diff(points, axis=0).T) > 1e-9, True)])


def _at(arc: Any, matrix: Any, share: float) -> Point:
    """A point of an arc under a matrix; its ends are exact, so that neighbours still meet."""
    ends = {0.0: arc.start, 1.0: arc.end}
    point = (ends[share] if share in ends else arc.point(share)) * matrix
    return float(point.x), float(point.y)


def _bulge(start: Point, middle: Point, end: Point) -> float:
    """The bulge of the arc through three points, the second half-way along."""
    across = (end[0] - start[0]) * (middle[1] - start[1]) - (end[1] - start[1]) * (middle[0] - start[0])
    return -2 * across / math.dist(start, end) ** 2


def _refuse_far(numbers: list[float]) -> None:
    """Flattening a curve of astronomic size would never end."""
    if not all(abs(x) <= FAREST_MM for x in numbers):
        raise InputError(f"a curve reaches more than 10,000 kilometres from the origin: {WRONG_UNITS}")
