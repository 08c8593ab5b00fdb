"""A drawing becomes a nest: layers are told apart, loose lines joined, the sheet found, parts assembled."""

from __future__ import annotations

from ..errors import InputError
from ..nest import Nest, Note, Severity
from ..validate import wrong
from .assemble import assemble
from .drawing import Drawing, Piece
from .join import Joined, join
from .open_ends import ends, open_end_problems
from .options import ReadOptions
from .sheet import choose_sheet
from .units import doubts

REPAIR_FACTOR = 10
"""With `repair`, gaps up to this many times the join tolerance are closed."""

MOST_NOTES = 100


def nest_of(drawing: Drawing, options: ReadOptions) -> Nest:
    """The nest in a drawing, not yet validated.

    Raises
    ------
    InputError
        When nothing in it can be cut, when several sheets are drawn, or when lines do not close.
    """
    sheet_pieces = [p for p in drawing.pieces if options.is_sheet(p.layer)]
    mark_pieces = [p for p in drawing.pieces if options.is_mark(p.layer) and not options.is_sheet(p.layer)]
    cut_pieces = [p for p in drawing.pieces if not options.is_sheet(p.layer) and not options.is_mark(p.layer)]
    if not cut_pieces:
        raise InputError(_nothing(drawing, sheet_pieces, options))
    bridge_mm = REPAIR_FACTOR * options.join_tolerance_mm if options.repair else 0.0
    cut, stock = (join(pieces, options.join_tolerance_mm, bridge_mm) for pieces in (cut_pieces, sheet_pieces))
    marks = join(mark_pieces, options.join_tolerance_mm)
    notes = [*drawing.notes, *(note for joined in (stock, cut, marks) for note in _join_notes(joined, options))]
    open_chains = [*stock.chains, *cut.chains]
    if open_chains and options.repair and cut.rings:
        notes += [Note("repaired", f"the open line {ends(c)} is left out: it does not close") for c in open_chains]
    elif open_chains:
        raise wrong("lines do not close to contours", open_end_problems(open_chains, options))
    if not cut.rings:
        raise InputError("nothing to cut: the drawing holds no closed contour")
    parts, part_notes = assemble(cut.rings, [*marks.rings, *marks.chains])
    sheet, sheet_notes = choose_sheet(stock.rings, cut.rings, drawing.page, options)
    notes += [*part_notes, *sheet_notes, *doubts(sheet, drawing.units)]
    return Nest(sheet, parts, notes=tuple(notes))


def _nothing(drawing: Drawing, on_sheet: list[Piece], options: ReadOptions) -> str:
    if not drawing.pieces:
        return "nothing to cut: the drawing holds no line, arc, circle, polyline, ellipse or spline"
    layers = ", ".join(sorted({f"'{p.layer}'" for p in drawing.pieces}))
    which = "sheet_layer" if on_sheet else "mark_layer"
    pattern = options.sheet_layer if on_sheet else options.mark_layer
    return f"nothing to cut: every line is on a layer that {which}='{pattern}' matches ({layers}); pass another {which}"


def _join_notes(joined: Joined, options: ReadOptions) -> list[Note]:
    """What was closed or passed over; gaps within the tolerance are what it is there for, and need no word."""
    severity: Severity = "repaired" if options.repair else "warning"
    notes = [
        Note("repaired", f"a gap of {g.width_mm:.3f} mm at ({g.at[0]:.3f}, {g.at[1]:.3f}) is closed")
        for g in joined.gaps
        if g.width_mm > options.join_tolerance_mm
    ]
    notes += [Note(severity, f"the line {ends(p)} is drawn twice; it is cut once") for p in joined.repeats]
    notes += [Note(severity, f"the line {p.place} has no length: left out") for p in joined.specks]
    if len(notes) > MOST_NOTES:
        notes[MOST_NOTES:] = [Note(severity, f"… and {len(notes) - MOST_NOTES} more lines mended or left out")]
    return notes
