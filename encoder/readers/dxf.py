"""DXF files, as CAD systems of thirty years write them, to a drawing."""

from __future__ import annotations

import logging
import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
import shapely
from ezdxf import recover
from ezdxf.document import Drawing as Document
from ezdxf.entities.arc import Arc
from ezdxf.entities.dxfgfx import DXFGraphic
from ezdxf.entities.ellipse import Ellipse
from ezdxf.entities.insert import Insert
from ezdxf.entities.point import Point
from ezdxf.filemanagement import readfile
from ezdxf.math import Vec3

from kerfwise.encoder.display import join_names
from kerfwise.encoder.errors import REPAIR, InputError
from kerfwise.encoder.files import read_limited
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Note
from kerfwise.encoder.progress_notice import amount
from kerfwise.encoder.questions import Asking, Choice, Question

from .clipping import Clips, seen_through, texts_seen
from .drawing import (
    FAREST_MM,
    Drawing,
    DrawnCurve,
    DrawnText,
    brought_near,
    check_copies,
    checked_curve,
    checked_stroke,
)
from .dxf_entities import (
    NO_LINES,
    NO_TURN,
    Hidden,
    Looks,
    Placed,
    Unread,
    curve,
    entities,
    is_tilted,
    layer_of,
    points_in_space,
    width_of,
)
from .dxf_text import DXF_ERRORS, cross, is_written, middle_of_point, name_of, written
from .fit_arcs import FIT_MM, FLATTEN_MM
from .layers import counted
from .options import DXF_UNITS, GIVEN, ReadOptions, are_inches, contradicted, dxf_units, mm_of

# its remarks on handles and such are nothing that a planner can act on; without a handler they go to the terminal
logging.getLogger("ezdxf").addHandler(logging.NullHandler())


def read_dxf(path: Path, data: bytes, options: ReadOptions, asking: Asking | None = None) -> Drawing:
    """Every curve of the model space, in mm.

    `path` and `data`: the file and its bytes. `options`: `units` overrides $INSUNITS; with `repair`, a file that breaks
    off is read as far as it goes. `asking`: takes the questions that the file raises; by default nobody answers but the
    options. Raises InputError when the file is no DXF, breaks off, or an entity in it cannot be understood.
    """
    asking = Asking(dict(options.answers)) if asking is None else asking
    notes = _whole(data, options)
    _check_numbers(data)
    document = document_of(path)
    hidden, looks = hidden_layers(document), Looks(document)
    unread = Unread()
    try:
        _check_blocks(document)
        amount(len(document.modelspace()), "entity", "entities")
        shown = list(entities(document.modelspace(), hidden, unread)) or _on_paper(document, hidden, unread, asking)
        insunits = _header(document, data)[0] or 0
        guess = options.units or DXF_UNITS.get(insunits, "mm")
        read = _pieces(shown, mm_of(guess) or 1.0, looks, options.spot_mm)
        units, because = _units(document, data, options, read, guess, asking)
        if units != guess:
            read = _pieces(shown, mm_of(units) or 1.0, looks, options.spot_mm)
    except DXF_ERRORS as error:
        raise InputError(f"an entity of this DXF file is damaged ({error}); save it again in CAD") from error
    for kind, layer in read.unknown:
        unread.types[kind, layer] += 1
    pieces, clip_notes = seen_through(read.pieces, asking)
    texts, hidden_notes = texts_seen(read.texts)
    near, texts, far_notes = brought_near(pieces, texts)
    notes = (*notes, *contradicted(DXF_UNITS.get(insunits), f"$INSUNITS {insunits}", options.units))
    notes = (*notes, *unread.notes(options.layers), *clip_notes, *hidden_notes, *far_notes)
    notes = (*notes, *_doubts(document, shown, mm_of(units) or 1.0))
    if document.modelspace() or not near:
        notes = (*notes, *_paper(document))
    if not near:
        notes = (*notes, *_never_inserted(document))
    return Drawing(near, units, notes, None, because, texts)


@dataclass(frozen=True, slots=True)
class _Read:
    """Pieces and texts with what they are seen through, in mm, and types with layers of what is no curve."""

    pieces: list[tuple[DrawnCurve, Clips]] = field(default_factory=list)
    texts: list[tuple[DrawnText, Clips]] = field(default_factory=list)
    unknown: list[tuple[str, str]] = field(default_factory=list)


def _pieces(shown: Sequence[Placed], scale: float, looks: Looks, spot_mm: float) -> _Read:
    read = _Read()
    for order, placed in enumerate(shown):
        entity, layer = placed.entity, placed.layer
        areas = tuple(shapely.transform(area, lambda points: points * scale) for area in placed.clips)
        look = partial(_looking, placed=placed, order=order, looks=looks)
        if is_written(entity) or isinstance(entity, Point):
            if (text := _text(entity, scale, look, spot_mm)) is not None:
                read.texts.append((text, areas))
        elif (drawn := _curve(entity, layer, scale)) is None:
            read.unknown.append((entity.dxftype(), layer))
        else:
            read.pieces.append((replace(look(drawn), width_mm=scale * width_of(entity)), areas))
    return read


def _looking(curve: Curve, placed: Placed, order: int, looks: Looks) -> DrawnCurve:
    colour, linetype = looks.colour(placed), looks.linetype(placed)
    return DrawnCurve(
        curve, placed.layer, order, None, colour, linetype, blocks=placed.blocks, attributes=placed.attributes
    )


def _text(entity: DXFGraphic, scale: float, look: Callable[[Curve], DrawnCurve], spot_mm: float) -> DrawnText | None:
    """Writing or a point, in mm; None for writing that says nothing."""
    try:
        if isinstance(entity, Point):
            x, y = middle_of_point(entity)
            mark = look(checked_curve(cross(x * scale, y * scale, spot_mm), False))
            return DrawnText("", mark, spot_mm, (mark,))
    except InputError as error:
        raise InputError(f"{error.message} ({_where(entity)})") from error.__cause__
    written_text = written(entity)
    text, trouble, drawn = written_text.text.strip(), written_text.trouble, list[DrawnCurve]()
    place = np.nan_to_num(np.clip(np.array(written_text.at) * scale, -FAREST_MM, FAREST_MM))
    try:
        strokes = (checked_stroke(stroke, scale) for stroke in written_text.strokes)
        drawn = [look(stroke) for stroke in strokes if stroke is not None]
    except InputError as error:
        trouble, drawn = error.message, []
    at = look(checked_curve([place.tolist()] * 2, False))
    return DrawnText(text, at, written_text.height * scale, tuple(drawn), trouble) if text else None


def _paper(document: Document) -> tuple[Note, ...]:
    """What is drawn in paper space: views of the model, frames and title blocks, none of it cut."""
    count = sum(
        entity.dxftype() not in NO_LINES for layout in document.layouts if layout.name != "Model" for entity in layout
    )
    which = "1 entity is" if count == 1 else f"{count} entities are"
    return (Note("warning", f"left out: {which} in paper space, where a drawing is printed from"),) if count else ()


def _doubts(document: Document, shown: Sequence[Placed], scale: float) -> Iterator[Note]:
    """A word on what is read as it is seen from above, and on what no print shows."""
    rising = [(placed, scale * _foreshortening(points_in_space(placed.entity))) for placed in shown]
    if rising := [(placed, lost_mm) for placed, lost_mm in rising if lost_mm > FLATTEN_MM + FIT_MM]:
        most, lost_mm = max(rising, key=lambda one: one[1])
        x, y, _ = points_in_space(most.entity)[0] * scale
        text = f"drawn at heights that vary, and read as seen from above: {counted(p.layer for p, _ in rising)}"
        where = f"the {most.entity.dxftype()} at ({x:.3f}, {y:.3f}), {lost_mm:.3f} mm shorter than it is drawn"
        yield Note("warning", f"{text}; most of all {where}")
    if tilted := [placed.layer for placed in shown if is_tilted(placed.entity)]:
        yield Note("warning", f"drawn on a tilted plane, and read as it is seen from above: {counted(tilted)}")
    if rounds := [placed.layer for placed in shown if _ends_where_it_starts(placed.entity)]:
        said = "arcs with two angles that are one, read as once round, where some CAD systems show a point"
        yield Note("warning", f"{said}: {counted(rounds)}; draw circles, or delete them")
    unprinted = {name_of(str(x.dxf.name)).lower() for x in document.layers if not x.dxf.get("plot", 1)} - {"defpoints"}
    if drawn := [placed.layer for placed in shown if placed.layer.lower() in unprinted]:
        yield Note("warning", f"on layers that are never printed, and read like all others: {counted(drawn)}")


def _ends_where_it_starts(entity: DXFGraphic) -> bool:
    """Whether the angles of an arc are one, and not once round apart."""
    match entity:
        case Arc():
            return math.radians(abs(entity.dxf.end_angle - entity.dxf.start_angle)) < NO_TURN
        case Ellipse():
            return abs(float(entity.dxf.end_param) - float(entity.dxf.start_param)) < NO_TURN
        case _:
            return False


def _foreshortening(points: Sequence[Vec3]) -> float:
    """How much longer a line is than it is seen from above."""
    steps = (b - a for a, b in pairwise(points))
    return sum((step.magnitude - step.vec2.magnitude for step in steps), 0.0)


def _on_paper(document: Document, hidden: Hidden, unread: Unread, asking: Asking) -> list[Placed]:
    """What is drawn in the one layout that holds anything, where somebody wants that read: the model space is empty."""
    drawn = [space for space in document.layouts if any(e.dxftype() not in NO_LINES for e in space)]
    if len(drawn) != 1 or drawn[0].name == "Model":
        return []
    count = sum(e.dxftype() not in NO_LINES for e in drawn[0])
    answer = asking.ask(
        Question(
            "paper",
            f"the model space is empty, and {count} lines are drawn in paper space ('{drawn[0].name}'), where "
            "drawings are printed from, at whatever scale: are they cut?",
            (Choice("read", "read as they are, at full size"), Choice("ignore", "left out: nothing is cut then")),
        )
    )
    return list(entities(drawn[0], hidden, unread)) if answer == "read" else []


def _never_inserted(document: Document) -> tuple[Note, ...]:
    """Blocks that hold something and stand nowhere."""
    stand = {str(e.dxf.name).lower() for block in document.blocks for e in block if isinstance(e, Insert)}
    idle = [b.name for b in document.blocks if len(b) and b.name[:1] not in ("*", "_") and b.name.lower() not in stand]
    named = join_names([f"'{name_of(name)}'" for name in sorted(idle)], 6)
    return (Note("warning", f"the file holds blocks that it inserts nowhere: {named}"),) if idle else ()


def _curve(entity: DXFGraphic, layer: str, scale: float) -> Curve | None:
    """The entity as a curve; what is wrong with it is said with its type and layer."""
    where = _where(entity, layer)
    try:
        return curve(entity, scale)
    except InputError as error:
        raise InputError(f"{error.message} ({where})") from error.__cause__
    except DXF_ERRORS as error:
        raise InputError(f"{where} is damaged ({error}); save the file again in CAD") from error


def _where(entity: DXFGraphic, layer: str | None = None) -> str:
    return f"a {entity.dxftype()} on layer '{layer_of(entity) if layer is None else layer}'"


def _whole(data: bytes, options: ReadOptions) -> tuple[Note, ...]:
    """A DXF file ends with EOF; one that does not has lost contours that nobody would miss until it is cut."""
    if data.startswith((b"AC10", b"AC1.")):
        raise InputError("this is a DWG file under another name; save it as DXF")
    if data.rstrip(b"\0\x1a \t\r\n").endswith(b"EOF"):
        return ()
    if not options.repair:
        raise InputError(f"the DXF file breaks off: its end mark EOF is missing; export it again, or try {REPAIR}")
    return (Note("repaired", "the DXF file breaks off before its end mark EOF: read as far as it goes"),)


def hidden_layers(document: Document) -> Hidden:
    """The layers that are off, and those that are frozen."""
    return Hidden(
        frozenset(name_of(str(x.dxf.name)).lower() for x in document.layers if x.is_off()),
        frozenset(name_of(str(x.dxf.name)).lower() for x in document.layers if x.is_frozen()),
    )


def mm_per_unit(path: Path, document: Document, options: ReadOptions) -> float:
    """Millimetres in a unit of the drawing."""
    return mm_of(read_dxf(path, read_limited(path), options).units) or 1.0


def document_of(path: Path) -> Document:
    """The file as its library reads it, rules of the format broken or not.

    Raises InputError if it is no DXF that can be read.
    """
    try:
        return readfile(path)
    except DXF_ERRORS:
        pass  # real files often break a rule or two of the format: recover reads most of those
    try:
        return recover.readfile(path)[0]
    except DXF_ERRORS as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"not a DXF file that can be read ({reason}); expected an ASCII or binary DXF") from error


def _check_blocks(document: Document) -> None:
    def made_of(name: str) -> tuple[int, list[tuple[str, int]]]:
        drawn = document.blocks.get(name) or ()
        inserts = [e for e in drawn if isinstance(e, Insert)]
        return len(drawn) - len(inserts), [(str(e.dxf.name), e.mcount) for e in inserts]

    check_copies(document.modelspace().block_record_name, made_of, "block")


def _header(document: Document, data: bytes) -> tuple[int | None, int | None, int | None]:
    """$INSUNITS, $MEASUREMENT and $LUNITS, None where the file does not have them: the library fills in its own."""
    names = ("$INSUNITS", "$MEASUREMENT", "$LUNITS")
    values = (document.header.get(name) if name.encode() in data else None for name in names)
    insunits, measurement, lunits = (None if value is None else int(value) for value in values)
    return insunits, measurement, lunits


def _units(
    document: Document, data: bytes, options: ReadOptions, read: _Read, guess: str, asking: Asking
) -> tuple[str, str]:
    """The unit of the drawing, and why."""
    if options.units is not None:
        return options.units, GIVEN
    if not read.pieces:
        return guess, "by default"
    lines = np.array([piece.curve.line(1.0) for piece, _ in read.pieces], dtype=object)
    x0, y0, x1, y1 = shapely.total_bounds(lines).tolist()
    per_unit = mm_of(guess) or 1.0
    points = np.concatenate([piece.curve.vertices[:, :2] for piece, _ in read.pieces]) / per_unit
    return dxf_units(*_header(document, data), max(x1 - x0, y1 - y0) / per_unit, asking, are_inches(points))


# The text of a DXF file before its library reads it: numbers that are none.

_NUMBER = re.compile(rb"[ \t]*[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?[ \t]*")
_READ = (b"ENTITIES", b"BLOCKS")
"""Sections that hold what is drawn; headers and objects are full of other things."""
_MOST_DIGITS = 9
"""Of a group code: Python refuses to read a number of thousands of digits."""


def _is_real(code: int) -> bool:
    """Whether the values of a group code are real numbers."""
    return 10 <= code <= 59 or 110 <= code <= 149 or 210 <= code <= 239 or 1010 <= code <= 1059


def _check_numbers(data: bytes) -> None:
    """Refuse a file with a coordinate that is no number: libraries read as far as it looks like one.

    `120,75` would be 120, and a contour a little smaller than it is drawn. Binary files hold no text. Raises InputError
    with the line of the first one, the layer, and what was expected.
    """
    if data.startswith(b"AutoCAD Binary DXF"):
        return
    lines = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n").split(b"\n")
    section, layer, after_section = b"", b"0", False
    for k in range(0, len(lines) - 1, 2):
        code, value = lines[k].strip(), lines[k + 1]
        if not code.lstrip(b"-").isdigit() or len(code) > _MOST_DIGITS:
            return  # pairs of lines are out of step: the library says what it makes of that
        number = int(code)
        if number == 0:
            after_section, layer = value.strip() == b"SECTION", b"0"
        elif number == 2 and after_section:
            section, after_section = value.strip(), False
        elif number == 8:
            layer = value.strip()
        elif section in _READ and _is_real(number) and not _NUMBER.fullmatch(value):
            text = value.strip().decode("utf-8", "replace")
            on = name_of(layer.decode("utf-8", "surrogateescape"))
            raise InputError(
                f"{text!r} is no number (group code {number}, on layer '{on}'): expected one such as {_meant(text)}, "
                "with a point and without spaces; export the drawing again with such numbers",
                line=k + 2,
            )


def _meant(value: str) -> str:
    """The number as it should have been written, where that is plain."""
    tried = re.sub(r"[dD](?=[-+]?\d+$)", "E", value.replace(",", ".").replace("#", ""))
    return tried if _NUMBER.fullmatch(tried.encode("utf-8", "replace")) else "120.75"
