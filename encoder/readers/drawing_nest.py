"""A drawing becomes a nest: layers are told apart, loose lines joined, the sheet found, parts assembled."""

from __future__ import annotations

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest, Note, Part, Severity
from kerfwise.encoder.questions import Asking

from .assemble import assemble, with_marks
from .bridges import bridges_of_drawing
from .by_layer import ByLayer, answered_as_cut, by_layer, nothing_to_cut, sheet_by_name
from .doubled import drawn_once, thin_parts, thin_question
from .drawing import Drawing, DrawnCurve
from .drawn_tabs import with_tabs
from .frame import frame_note, frame_of_drawing, use_of_frame
from .join import Joined, join
from .layers import counted
from .not_closed import OpenLines
from .open_ends import REPAIR_FACTOR, ends, open_end_problems
from .open_lines import settled
from .options import ReadOptions
from .reading import reading_of
from .scrap_lines import scrap_of_drawing
from .sheet import choose_sheet
from .units import doubts

MOST_NOTES = 100


def nest_of(drawing: Drawing, options: ReadOptions, asking: Asking | None = None) -> Nest:
    """The nest in a drawing, not yet validated, with its reading; what is not decided is put to `asking`.

    Raises
    ------
    InputError
        When nothing in it can be cut, when several sheets are drawn, or when outlines do not close.
    """
    asking = Asking(dict(options.answers)) if asking is None else asking
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
    single, doubled_notes = drawn_once(cut.rings, options, asking)
    rings, outline, why_sheet, frame_notes = _frame(single, stock.rings, drawing, told_apart, options, asking)
    rings, parts, thin, part_notes = _without_thin(rings, options, asking)
    open_lines = settled(cut.chains, rings, parts, outline, bridge_mm, options, told_apart, asking)
    if not rings:
        raise InputError("nothing to cut: the drawing holds no closed contour")
    parts, mark_notes = with_marks(parts, [*marks.rings, *marks.chains, *thin, *open_lines.marks])
    scrap, scrap_notes = scrap_of_drawing(told_apart.scrap, options)
    parts = with_tabs(parts, told_apart.tab, options)
    bridges = bridges_of_drawing(told_apart.bridge, parts, options)
    sheet, sheet_because, choice_notes = choose_sheet(outline, rings, drawing.page, options, why_sheet)
    notes = [*drawing.notes, *told_apart.notes, *joined_notes, *sheet_notes, *doubled_notes, *frame_notes]
    notes += [*open_lines.notes, *part_notes, *mark_notes, *scrap_notes, *choice_notes, *doubts(sheet, drawing.units)]
    reading = reading_of((drawing.units, drawing.because), sheet, sheet_because, told_apart.taken(), notes, asking.used)
    return Nest(sheet, parts, notes=tuple(notes), scrap=scrap, bridges=bridges, reading=reading)


def taken_apart(drawing: Drawing, options: ReadOptions, asking: Asking) -> tuple[tuple[str, DrawnCurve], ...]:
    """Every line of a drawing with what its layer is taken for."""
    told = sheet_by_name(by_layer(drawing.pieces, options, asking), options, asking)
    groups = {
        "cut": told.cut, "mark": told.mark, "sheet": told.sheet, "scrap": told.scrap, "bridge": told.bridge,
        "tab": told.tab, "ignore": told.ignored,
    }  # fmt: skip
    return tuple((purpose, piece) for purpose, pieces in groups.items() for piece in pieces)


def _without_thin(
    rings: tuple[DrawnCurve, ...], options: ReadOptions, asking: Asking
) -> tuple[tuple[DrawnCurve, ...], tuple[Part, ...], list[DrawnCurve], list[Note]]:
    """The rings and the parts that they make, without those that are all kerf; and those of them that are marked."""
    parts, notes = assemble(rings)
    thin = thin_parts(parts, options)
    if not thin or len(thin) == len(parts):
        return rings, parts, [], notes
    said = asking.ask(thin_question(thin, options))
    if said == "cut":
        return rings, parts, [], notes
    curves = {id(contour.curve) for part in thin for contour in part}
    gone = [ring for ring in rings if id(ring.curve) in curves]
    rings = tuple(ring for ring in rings if id(ring.curve) not in curves)
    parts, notes = assemble(rings)
    marked = gone if said == "mark" else []
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
    notes = [
        Note("repaired", f"a gap of {g.width_mm:.3f} mm at ({g.at[0]:.3f}, {g.at[1]:.3f}) is closed")
        for g in joined.gaps
        if g.width_mm > options.join_tolerance_mm
    ]
    notes += [Note(severity, f"the line {ends(p)} is drawn twice; it is {done} once") for p in joined.repeats]
    notes += [Note(severity, f"the line {p.place} has no length: left out") for p in joined.specks]
    if len(notes) > MOST_NOTES:
        notes[MOST_NOTES:] = [Note(severity, f"… and {len(notes) - MOST_NOTES} more lines mended or left out")]
    return notes
