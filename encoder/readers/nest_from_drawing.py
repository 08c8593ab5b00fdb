"""A drawing becomes a nest: loose lines joined, the sheet found, parts assembled, tabs and bridges added."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.encoder.contour_checks import metal_of
from kerfwise.encoder.cut import Tab
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import TOUCH_MM
from kerfwise.encoder.nest import QUANTITY_KEY, Bridge, Contour, Kind, Nest, Note, Part, Severity, as_scrap
from kerfwise.encoder.questions import Asking
from kerfwise.encoder.validate import coincident

from .by_layer import ByLayer, answered_as_cut, by_layer, nothing_to_cut, sheet_by_name
from .closing import gap_notes, overrun_notes
from .drawing import Drawing, DrawnCurve, OpenLines
from .duplicate_lines import drawn_once, holes_drawn_once, thin_parts, thin_question, with_notches, without_overlaps
from .join import Joined, join
from .json_nest import PART_KEYS
from .layers import counted, setting
from .lettering import engraved, with_marks
from .open_lines import OpenLineDecision, decide_open_lines, ends, open_end_problems
from .options import REPAIR_FACTOR, ReadOptions, doubts
from .reading import reading_of
from .sheet import choose_sheet, frame_note, frame_of_drawing, surrounding, use_of_frame

MOST_NOTES = 100


def nest_of(drawing: Drawing, options: ReadOptions, asking: Asking | None = None) -> Nest:
    """The nest in a drawing, not yet validated, with its reading; what is not decided is put to `asking`.

    Raises InputError when nothing in it can be cut, when several sheets are drawn, or when outlines do not close.
    """
    asking = Asking(dict(options.answers)) if asking is None else asking
    if not drawing.pieces:
        raise InputError(
            "nothing to cut: the drawing holds no line, arc, circle, polyline, ellipse or spline",
            details=tuple(note.text for note in drawing.notes),
        )
    told_apart = sheet_by_name(by_layer(drawing.pieces, options, asking), options, asking)
    if not told_apart.cut:
        raise InputError(nothing_to_cut(drawing.pieces, told_apart.uses))
    bridge_mm = REPAIR_FACTOR * options.join_tolerance_mm if options.repair else 0.0
    cut = join(told_apart.cut, options.join_tolerance_mm, bridge_mm)
    stock = join(told_apart.sheet, options.join_tolerance_mm, bridge_mm)
    marks = join(told_apart.mark, options.join_tolerance_mm)
    joined_notes = [note for joined in (stock, cut) for note in _join_notes(joined, "cut", options)]
    joined_notes += _join_notes(marks, "marked", options)
    sheet_notes = _open_on_the_sheet(stock, options)
    nest = _assembled(cut, stock, bridge_mm, drawing, told_apart, options, asking)
    if not nest.rings:
        raise InputError("nothing to cut: the drawing holds no closed contour")
    texts = engraved(drawing.texts, told_apart, options, asking)
    lines = [*marks.rings, *marks.chains, *nest.thin, *nest.open_lines.marks]
    parts, mark_notes, writings = with_marks(nest.parts, lines, texts.marked)
    scrap, scrap_notes = scrap_of_drawing(told_apart.scrap, options)
    layers = [piece.layer for piece in told_apart.cut]
    parts = with_tabs(parts, told_apart.tab, options, layers)
    bridges = bridges_of_drawing(told_apart.bridge, parts, options, layers)
    sheet, sheet_because, choice_notes = choose_sheet(nest.outline, nest.rings, drawing.page, options, nest.why_sheet)
    notes = [
        *drawing.notes,
        *told_apart.notes,
        *_wide(told_apart.cut),
        *joined_notes,
        *sheet_notes,
        *nest.notes,
        *texts.notes,
        *mark_notes,
    ]
    notes += [*scrap_notes, *choice_notes, *doubts(sheet, drawing.units)]
    taken = (*told_apart.taken(), *texts.taken)
    because = (drawing.units, drawing.because)
    reading = reading_of(because, sheet, sheet_because, taken, notes, asking.used, writings)
    return Nest(sheet, parts, notes=tuple(notes), scrap=scrap, bridges=bridges, reading=reading)


@dataclass(frozen=True, eq=False, slots=True)
class _Assembled:
    """The closed lines and the parts that they make, thin ones that are marked, the sheet's lines and why."""

    rings: tuple[DrawnCurve, ...]
    parts: tuple[Part, ...]
    thin: list[DrawnCurve]
    outline: tuple[DrawnCurve, ...]
    why_sheet: str
    open_lines: OpenLineDecision
    notes: list[Note]


def _assembled(
    cut: Joined,
    stock: Joined,
    bridge_mm: float,
    drawing: Drawing,
    told_apart: ByLayer,
    options: ReadOptions,
    asking: Asking,
) -> _Assembled:
    """The parts of closed lines, once more where open ones are closed as somebody has answered."""
    closed_layers: frozenset[str] = frozenset()
    closed_notes: list[Note] = []
    while True:
        single, doubled_notes = drawn_once(cut.rings, options, asking)
        rings, outline, why_sheet, frame_notes = _frame(single, stock.rings, drawing, told_apart, options, asking)
        rings, overlap_notes = without_overlaps(rings, asking)
        rings, hole_notes = holes_drawn_once(rings, options, asking)
        rings, notch_notes = with_notches(rings, options.join_tolerance_mm)
        ring_notes = [*doubled_notes, *frame_notes, *overlap_notes, *hole_notes, *notch_notes]
        rings, parts, thin, part_notes = _without_thin(rings, options, asking)
        open_lines = decide_open_lines(
            replace(cut, rings=tuple(rings)), parts, outline, bridge_mm, options, told_apart, asking, closed_layers
        )
        if not open_lines.closing:
            notes = [*ring_notes, *closed_notes, *open_lines.notes, *part_notes]
            return _Assembled(rings, parts, thin, outline, why_sheet, open_lines, notes)
        for way in open_lines.closing:
            closed_layers |= {chain.layer for chain in way.chains}
            closed_notes += way.notes
            left = (*(c for c in cut.chains if c not in way.chains), *way.left)
            kept = [r for r in cut.rings if r not in way.replaced]
            cut = replace(cut, rings=tuple(sorted((*kept, *way.rings), key=lambda r: r.order)), chains=left)


WIDE_MM = 1.0
"""A line that is drawn wider is a band, most likely: a groove, a strip, a ring."""


def _wide(cut: Sequence[DrawnCurve]) -> list[Note]:
    """That the middle of a wide line is cut, and neither of its edges."""
    wide = [piece for piece in cut if piece.width_mm > WIDE_MM]
    if not wide:
        return []
    widest = max(piece.width_mm for piece in wide)
    lines = f"drawn up to {widest:.4g} mm wide, and cut along the middle: {counted(piece.layer for piece in wide)}"
    return [Note("warning", lines)]


def taken_apart(drawing: Drawing, options: ReadOptions, asking: Asking) -> tuple[tuple[str, DrawnCurve], ...]:
    """Every line of a drawing with what its layer is taken for."""
    layers = sheet_by_name(by_layer(drawing.pieces, options, asking), options, asking)
    groups = {
        "cut": layers.cut, "mark": layers.mark, "sheet": layers.sheet, "scrap": layers.scrap, "bridge": layers.bridge,
        "tab": layers.tab, "ignore": layers.ignored,
    }  # fmt: skip
    rows = [(purpose, piece) for purpose, pieces in groups.items() for piece in pieces]
    texts = engraved(drawing.texts, layers, options, asking)
    for purpose, those in (("mark", texts.marked), ("ignore", texts.left_out)):
        rows += [(purpose, stroke) for text in those for stroke in text.strokes]
    return tuple(rows)


def _without_thin(
    rings: tuple[DrawnCurve, ...], options: ReadOptions, asking: Asking
) -> tuple[tuple[DrawnCurve, ...], tuple[Part, ...], list[DrawnCurve], list[Note]]:
    """The rings and the parts that they make, without those that are all kerf; and those of them that are marked."""
    parts, notes = assemble(rings)
    thin = thin_parts(parts, options)
    if not thin or len(thin) == len(parts):
        return rings, parts, [], notes
    answer = asking.ask(thin_question(thin, options))
    if answer == "cut":
        return rings, parts, [], notes
    curves = {id(contour.curve) for part in thin for contour in part}
    gone = [ring for ring in rings if id(ring.curve) in curves]
    rings = tuple(ring for ring in rings if id(ring.curve) not in curves)
    parts, notes = assemble(rings)
    marked = gone if answer == "mark" else []
    text = f"left out, as answered (thin): {counted(ring.layer for ring in gone)}"
    return rings, parts, marked, [*notes, *([] if marked else [Note("warning", text)])]


def _frame(
    rings: tuple[DrawnCurve, ...],
    stock: tuple[DrawnCurve, ...],
    drawing: Drawing,
    told_apart: ByLayer,
    options: ReadOptions,
    asking: Asking,
) -> tuple[tuple[DrawnCurve, ...], tuple[DrawnCurve, ...], str, list[Note]]:
    """The rings of parts, those of the sheet and why, where a rectangle around everything may be either."""
    frame = () if stock or not rings else frame_of_drawing(rings)
    if not frame or answered_as_cut(told_apart, frame[0]):
        return rings, stock, "", []
    use, why = use_of_frame(frame, rings, drawing.page, options, asking)
    if use == "part":
        return rings, stock, "", []
    return tuple(p for p in rings if p not in frame), frame, why, [frame_note(frame)]


def _open_on_the_sheet(stock: Joined, options: ReadOptions) -> list[Note]:
    """Open lines on the sheet's layer burn nothing; only where the outline itself is open is there no sheet."""
    if not stock.chains:
        return []
    if not stock.rings:
        raise OpenLines(
            f"the sheet does not close, on layer '{stock.chains[0].layer}'",
            stock.chains,
            tuple(open_end_problems(stock.chains, options)),
        )
    count = len(stock.chains)
    lines = "line" if count == 1 else "lines"
    text = f"{count} open {lines} on the sheet's layer left out, the first {ends(stock.chains[0])}"
    return [Note("warning", text)]


def _join_notes(joined: Joined, done: str, options: ReadOptions) -> list[Note]:
    """What was closed or passed over; gaps within the tolerance are what it is there for, and need no word."""
    severity: Severity = "repaired" if options.repair else "warning"
    notes = gap_notes(joined, options.join_tolerance_mm)
    notes += overrun_notes(joined, options.join_tolerance_mm)
    notes += [Note(severity, f"the line {ends(p)} is drawn twice; it is {done} once") for p in joined.repeats]
    notes += [Note(severity, f"the line {p.place} has no length: left out") for p in joined.specks]
    if len(notes) > MOST_NOTES:
        notes[MOST_NOTES:] = [Note(severity, f"… and {len(notes) - MOST_NOTES} more lines mended or left out")]
    return notes


# Rings and marks become parts by how they lie in each other.

HOLES = re.compile(r"hole|inner|inside|innen|loch|bohr|cut-?outs?$|отверст", re.IGNORECASE)
"""Layers that say that what is drawn on them is the inside of a part."""


def assemble(rings: Sequence[DrawnCurve]) -> tuple[tuple[Part, ...], list[Note]]:
    """Parts P1, P2, … in the order their outer rings are drawn in, and notes on what was left out.

    A ring at even depth is the outside of a part, one at odd depth a hole of the part around it. Where rings overlap,
    so that one at odd depth lies in no part, it is a part, too: the check of the nest tells the overlap. A ring that is
    the same line as an earlier one is dropped.
    """
    if not rings:
        return (), []
    repeats: dict[int, int] = {}
    for first, again in coincident([r.curve for r in rings]):
        repeats.setdefault(again, repeats.get(first, first))
    kept = [k for k in range(len(rings)) if k not in repeats]
    depth, parent = surrounding([rings[k].area for k in kept])
    odd = np.flatnonzero(depth % 2).tolist()
    stray = {n for n in odd if depth[parent[n]] % 2}  # only where rings overlap
    outers = [n for n, d in enumerate(depth.tolist()) if d % 2 == 0 or n in stray]
    holes: dict[int, list[int]] = {n: [] for n in outers}
    for n in odd:
        if n not in stray:
            holes[int(parent[n])].append(n)
    names, parts = {}, []
    for number, n in enumerate(outers, 1):
        part = f"P{number}"
        names[kept[n]] = f"{part}.outer"
        names |= {kept[h]: f"{part}.hole{k}" for k, h in enumerate(holes[n], 1)}
        inner = tuple(_contour(names[kept[h]], part, "hole", rings[kept[h]]) for h in holes[n])
        outer = rings[kept[n]]
        parts.append(Part(part, _contour(names[kept[n]], part, "outer", outer), inner, (), attributes_of(outer)))
    notes = [_repeat(rings[k], rings[first], names[first]) for k, first in sorted(repeats.items())]
    return tuple(parts), notes


def _contour(name: str, part: str, kind: Kind, ring: DrawnCurve) -> Contour:
    return Contour(name, part, kind, ring.curve, source=ring.source)


def _repeat(again: DrawnCurve, first: DrawnCurve, name: str) -> Note:
    """A note on a ring drawn twice; drawn once as a hole, by its layer, and once not, it is given to two parts."""
    text = f"the ring {again.place} is the same line as {name}; it is cut once, as {name}"
    if bool(HOLES.search(again.layer)) == bool(HOLES.search(first.layer)):
        return Note("warning", text, (name,))
    return Note("warning", text, (f"the ring on layer '{again.layer}'", name), common=True)


# What a drawing says of its parts beside their lines.

_WHOLE, _DECIMAL = re.compile(r"0|-?[1-9]\d{0,8}"), re.compile(r"-?(?:0|[1-9]\d{0,8})\.\d{1,6}")


def attributes_of(outer: DrawnCurve) -> dict[str, object]:
    """The attributes of the blocks that the outline of a part lies in, inner ones go first; numbers as such."""
    return {
        tag: int(text) if _WHOLE.fullmatch(text) else float(text) if _DECIMAL.fullmatch(text) else text
        for tag, text in outer.attributes
        if tag and tag.lower() not in PART_KEYS
    }


def with_quantities(nest: Nest, name: str, pattern: str) -> Nest:
    """Parts that the names of their blocks, of their layer or of the file say how many are wanted of, with that.

    `name`: name of the file, without its suffix. `pattern`: see `ReadOptions.quantity`.

    Examples
    --------
    >>> from kerfwise.encoder.readers.options import QUANTITY
    >>> [_quantity(each, QUANTITY) for each in ("LV8_02049_50db_REV7", "Hinge x4", "SHEET_001_QTY_1", "M8x20", "L200")]
    [50, 4, 1, None, None]
    """
    parts = []
    for part in nest.parts:
        source = part.outer.source
        names = (*reversed(source.block.split("/")), source.layer, name)
        found = (_quantity(one, pattern) for one in names if one)
        count = next((one for one in found if one is not None), None)
        if count is not None and not any(key.lower() == QUANTITY_KEY for key in part.attributes):
            part = replace(part, attributes={**part.attributes, QUANTITY_KEY: count})
        parts.append(part)
    return replace(nest, parts=tuple(parts))


def _quantity(name: str, pattern: str) -> int | None:
    for found in re.finditer(pattern, name, re.IGNORECASE):
        for group in found.groups():
            if group and group.isdecimal():
                return int(group)
    return None


# Tabs of a drawing: short lines on the outer contour of a part, or across it.

ALONG = 0.9
"""A line lies along a contour if so much of it is on it: then it is as long as the tab is wide."""


def with_tabs(
    parts: Sequence[Part], pieces: Sequence[DrawnCurve], options: ReadOptions, cut: Sequence[str] = ()
) -> tuple[Part, ...]:
    """The parts with the tabs that are drawn, in the order in which they are drawn.

    The middle of a line says where its tab is. A line along the contour is as long as its tab is wide; of one across
    it, and of anything that closes, the profile says how wide the tab is. `cut` are the layers that are cut. Raises
    InputError if something on their layers touches no outer contour, or those of two parts.
    """
    if not pieces:
        return tuple(parts)
    tabs: dict[int, list[Tab]] = {}
    outlines = np.array([part.outer.line for part in parts], dtype=object)
    tree = shapely.STRtree(outlines)
    for piece in pieces:
        line = piece.curve.line()
        near = sorted(tree.query(line, "dwithin", distance=options.join_tolerance_mm).tolist())
        if not near:
            raise _refused(piece, "lies on no outer contour of a part", cut)
        if len(near) > 1:
            names = " and ".join(parts[k].outer.id for k in near[:2])
            raise _refused(piece, f"lies on two outer contours, {names}", cut)
        (k,) = near
        tabs.setdefault(k, []).append(_tab(line, outlines[k], options.join_tolerance_mm))
    return tuple(replace(part, tabs=tuple(tabs[k])) if k in tabs else part for k, part in enumerate(parts))


def _tab(line: shapely.LineString, outline: shapely.LineString, within_mm: float) -> Tab:
    on = shapely.intersection(line, shapely.buffer(outline, within_mm))
    along = not line.is_ring and on.length > ALONG * line.length
    middle = shapely.line_interpolate_point(line, 0.5, normalized=True) if along else shapely.centroid(on)
    at = shapely.line_interpolate_point(outline, shapely.line_locate_point(outline, middle))
    return Tab((float(at.x), float(at.y)), float(line.length) if along else 0.0)


def _refused(piece: DrawnCurve, why: str, cut: Sequence[str]) -> InputError:
    advice = f"a tab is a short line on one, or across it; to take it for a line: {setting('cut', piece.layer, *cut)}"
    return InputError(f"the tab {piece.place} {why}; {advice}")


# Bridges of a drawing: rectangles, each from one part to another.

SKEW = 0.01
"""How far the sides of a rectangle may be from a right angle, as a share of their length."""


def bridges_of_drawing(
    pieces: Sequence[DrawnCurve], parts: Sequence[Part], options: ReadOptions, cut: Sequence[str] = ()
) -> tuple[Bridge, ...]:
    """The bridges in the order in which they are drawn; `cut` are the layers that are cut.

    Raises InputError if something on their layers is no rectangle, or none whose ends lie in two parts.
    """
    joined = join(pieces, options.join_tolerance_mm)
    for piece in (*joined.chains, *joined.specks):
        raise _refused_bridges(piece, "does not close", cut)
    if not joined.rings:
        return ()
    metal = metal_of(parts)
    return tuple(_bridge(ring, parts, metal, k, cut) for k, ring in enumerate(joined.rings, 1))


def _bridge(
    ring: DrawnCurve, parts: Sequence[Part], metal: NDArray[np.object_], number: int, cut: Sequence[str]
) -> Bridge:
    if (corners := _corners(ring)) is None:
        raise _refused_bridges(ring, "is no rectangle", cut)
    for k in (0, 1):
        start, end = (_middle(corners[at], corners[(at + 1) % 4]) for at in (k, k + 2))
        one, other = (_part_at(at, parts, metal) for at in (start, end))
        if one is not None and other is not None and one != other:
            return Bridge((one, other), start, end, math.dist(corners[k], corners[k + 1]), number)
    raise _refused_bridges(ring, "does not go from one part to another: each end lies in a part, or on its edge", cut)


def _corners(ring: DrawnCurve) -> list[Point] | None:
    """The four corners of a rectangle; None of anything else."""
    segments = ring.curve.segments
    if len(segments) != 4 or any(segment.is_arc for segment in segments):
        return None
    corners = [segment.start for segment in segments]
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = corners
    long_mm = max(segment.length_mm for segment in segments)
    parallel = math.hypot(bx - ax - (cx - dx), by - ay - (cy - dy)) <= SKEW * long_mm
    square = abs(math.dist(corners[0], corners[2]) - math.dist(corners[1], corners[3])) <= SKEW * long_mm
    return corners if parallel and square else None


def _middle(one: Point, other: Point) -> Point:
    return (one[0] + other[0]) / 2, (one[1] + other[1]) / 2


def _part_at(at: Point, parts: Sequence[Part], metal: NDArray[np.object_]) -> str | None:
    point = shapely.Point(at)
    near = [part.id for part, area in zip(parts, metal, strict=True) if shapely.distance(area, point) <= TOUCH_MM]
    return near[0] if near else None


def _refused_bridges(piece: DrawnCurve, why: str, cut: Sequence[str]) -> InputError:
    as_part = setting("cut", piece.layer, *cut)
    advice = f"a bridge is drawn as a rectangle from part to part; to take it for a part: {as_part}"
    return InputError(f"the bridge {piece.place} {why}; {advice}")


# What a drawing holds on layers for lines that cut up scrap: left out, or cut where the planner says so.


def scrap_of_drawing(pieces: Sequence[DrawnCurve], options: ReadOptions) -> tuple[tuple[Contour, ...], list[Note]]:
    """The scrap lines of a drawing in the order in which they are drawn, and a word on what is left out."""
    if not pieces:
        return (), []
    if options.scrap_lines == "ignore":
        layers = counted(p.layer for p in pieces)
        text = f"left out, as lines that cut up scrap: {layers}; drawing: {{scrap_lines: cut}} has them cut"
        return (), [Note("warning", text)]
    joined = join(pieces, options.join_tolerance_mm)
    notes = [Note("warning", f"the scrap line {p.place} is drawn twice; it is cut once") for p in joined.repeats]
    notes += [Note("warning", f"the scrap line {p.place} has no length: left out") for p in joined.specks]
    if joined.rings:
        text = "left out, as a line that cuts up scrap has two ends, and these close"
        notes.append(Note("warning", f"{text}: {counted(p.layer for p in joined.rings)}"))
    return as_scrap((p.curve for p in joined.chains), [p.source for p in joined.chains]), notes
