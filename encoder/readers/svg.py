"""SVG files to a drawing: groups are its layers."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import shapely
import svgelements

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Note
from kerfwise.encoder.questions import Asking, Choice, Question
from kerfwise.encoder.still_going import so_much
from kerfwise.encoder.validate.rings import enclosed

from .clipped import Clips, seen_through
from .drawing import Drawing, DrawnCurve
from .foreign import FOREIGN_ERRORS
from .layers import Layers, Purpose, counted
from .options import ReadOptions
from .svg_page import page_of
from .svg_paths import curves
from .svg_seen import CLIP, MASK, SHAPE, Seen, hidden_told
from .svg_sound import sound
from .writing import writing_note

NUMBERED = re.compile(
    "(path|rect|circle|ellipse|line|polyline|polygon|g|group|use|text|tspan|image|layer|svg)[-_]?[0-9][-_0-9]*"
)
"""Ids that a drawing program numbers on by itself: `text12` says nothing of what a shape is for."""
DRAWN = (svgelements.Shape, svgelements.Text, svgelements.Image)
LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"


def read_svg(data: bytes, options: ReadOptions, asking: Asking | None = None) -> Drawing:
    """Every shape that is shown, in mm with y up; writing and images are passed over, and that is said.

    Parameters
    ----------
    data
        The file's bytes.
    options
        `units` says what a user unit (of the viewBox) is, `layers` what the groups are for.

    Raises
    ------
    InputError
        When the file is no SVG or a shape in it cannot be understood.
    """
    asking = Asking(dict(options.answers)) if asking is None else asking
    plain, seen = sound_svg(data)
    svg = _parsed(plain)
    try:
        page = page_of(svg, options, data, asking)
        shown = list(shown_elements(svg))
        so_much(len(shown), "shape", "shapes")
        areas = _clip_areas(svg, page.to_mm)
        drawn = [
            (c, s) for s in shown if isinstance(s.element, svgelements.Shape) for c in curves(s.element, page.to_mm)
        ]
    except FOREIGN_ERRORS as error:
        raise InputError(f"a shape of this SVG file is damaged ({error}); save it again as plain SVG") from error
    pieces = [
        (DrawnCurve(c, s.layer, order, s.names, *_look(s.element)), tuple(areas[clip] for clip in s.clips))
        for order, (c, s) in enumerate(drawn)
    ]
    masked = {order for order, (_, s) in enumerate(drawn) if s.masked}
    pieces, mask_notes = _through_masks(pieces, masked, asking)
    kept, clip_notes = seen_through(pieces, asking)
    notes = [*_unread(shown, options.layers), *(Note("warning", text) for text in hidden_told(seen))]
    if not kept and seen.hidden:
        raise InputError(f"nothing to cut: {next(hidden_told(seen)).removeprefix('left out, as the ')}")
    notes += [*mask_notes, *clip_notes]
    return Drawing(tuple(kept), page.units, tuple(notes), page.sheet, page.because)


def _look(element: Any) -> tuple[str, str, bool]:
    """Colour of the line, else of the fill; whether the line is dashed; and whether there is a fill alone."""
    stroke, fill = (_colour(paint) for paint in (element.stroke, element.fill))
    dashes = str(element.values.get("stroke-dasharray") or "none").strip()
    dashed = stroke and dashes not in ("none", "0") and any(sign in "123456789" for sign in dashes)
    return stroke or fill, "dashed" if dashed else "", not stroke and bool(fill)


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
    said = asking.ask(
        Question(
            "mask",
            f"{counted(p.layer for k, (p, _) in enumerate(pieces) if k in masked)} lie under a mask, which may hide "
            "them or parts of them: what is cut?",
            (Choice("whole", "all of it, as if there were no mask"), Choice("ignore", "nothing of it")),
        )
    )
    if said == "whole":
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
            rings = [c for s in shapes for c in curves(s, to_mm)]
            found[name.removeprefix(SHAPE)] = shapely.union_all(
                [enclosed(Curve(c.vertices, True)) for c in rings if len(c.vertices) > 1]
            )
        else:
            found |= _clip_areas(element, to_mm)
    return found


def sound_svg(data: bytes) -> tuple[bytes, Seen]:
    """The file as it is shown, and what of it is not.

    Raises
    ------
    InputError
        If it is no XML, or holds what cannot be read.
    """
    try:
        return sound(data)
    except FOREIGN_ERRORS as error:
        raise InputError(f"not an SVG file that can be read: {error}") from error


def parsed_svg(data: bytes) -> Any:
    """The root of a file, as its library has it.

    Raises
    ------
    InputError
        If it is no SVG that can be read.
    """
    return _parsed(sound_svg(data)[0])


def _parsed(plain: bytes) -> Any:
    try:
        svg = svgelements.SVG.parse(io.BytesIO(plain), reify=True, ppi=96)
    except FOREIGN_ERRORS as error:
        raise InputError(f"not an SVG file that can be read: {error}") from error
    if not isinstance(svg, svgelements.SVG):
        raise InputError("not an SVG file: its root is no <svg> element")
    return svg


@dataclass(frozen=True, slots=True)
class Shown:
    """A shape or a text with the layer it is said to be on, every name that says what it is for, what is over it."""

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
    """Each shown shape and text. Its names are the ids and labels of the groups around it, then its own."""
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


def _unread(shown: Sequence[Shown], layers: Layers) -> list[Note]:
    found: dict[tuple[str, Purpose | None], list[str]] = {}
    for one in shown:
        if isinstance(one.element, svgelements.Text) and (text := str(one.element.text or "").strip()):
            found.setdefault((one.layer, layers.use(one.names).purpose), []).append(text)
    notes = [writing_note(texts, layer, use) for (layer, use), texts in found.items() if use != "ignore"]
    if images := sum(isinstance(one.element, svgelements.Image) for one in shown):
        count = "1 image is" if images == 1 else f"{images} images are"
        notes.append(Note("warning", f"{count} left out: trace to paths what is to be cut"))
    return notes
