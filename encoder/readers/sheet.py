"""The sheet of a drawing: on a layer of its own, given by size, the page, a frame, or the parts' bounding box."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from kerfwise.arrays import Ints
from kerfwise.encoder.contour_checks import flat
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Note, Sheet
from kerfwise.encoder.questions import Asking, Choice, Question
from kerfwise.encoder.validate import coincident

from .drawing import DrawnCurve
from .options import FrameName, ReadOptions

SHEET_GIVEN = "as given (--sheet, in Python sheet_mm=)"
NO_SHEET = "no layer is the sheet's"
"""How a note begins that says what the sheet is taken from."""


def choose_sheet(
    drawn: Sequence[DrawnCurve], parts: Sequence[DrawnCurve], page: Sheet | None, options: ReadOptions, why: str = ""
) -> tuple[Sheet, str, list[Note]]:
    """The sheet, why it is that, and what is to be said about the choice.

    `drawn`: the rings on the sheet's layer. `parts`: the rings of the parts. `page`: the drawing area, for a format
    that has one. `why`: why the drawn ones are the sheet, where no layer says so. Raises InputError when several sheets
    are drawn.
    """
    size = options.sheet_size_mm
    if drawn:
        sheet = drawn_sheet(drawn)
        x0, y0, x1, y1 = sheet.bounds
        if size is None or same_size((x1 - x0, y1 - y0), size):
            return sheet, why or f"drawn on layer '{drawn[0].layer}'", []
        return overridden(sheet, size)
    # chords cut the round side of an arc short, by less than what is rounded here
    lines = np.array([p.curve.line(1e-3) for p in parts], dtype=object)
    x0, y0, x1, y1 = shapely.total_bounds(lines).round(2).tolist()
    if size is not None:
        return _given_sheet(size, (x0, y0, x1, y1), options)
    if page is not None and _is_page_of(page, (x0, y0, x1, y1), options):
        width, height = page.bounds[2], page.bounds[3]
        text = f"{NO_SHEET}: the page, {width:g} × {height:g} mm, is taken for it"
        return replace(page, stated=False), "the page of the drawing", [Note("warning", text)]
    m = options.margin_mm
    sheet = _laid_around(x0 - m, y0 - m, x1 - x0 + 2 * m, y1 - y0 + 2 * m)
    text = (
        f"{NO_SHEET}: the parts' bounding box and {m:g} mm around it, {x1 - x0 + 2 * m:g} × "
        f"{y1 - y0 + 2 * m:g} mm, is taken for it; pass --sheet WxH (in Python: sheet_mm=), or name the sheet's layer "
        "in drawing.layers.sheet"
    )
    return sheet, f"the parts' bounding box and {m:g} mm around it", [Note("warning", text)]


def overridden(sheet: Sheet, size_mm: tuple[float, float]) -> tuple[Sheet, str, list[Note]]:
    """A sheet of the size that was given in the place of the file's own, from its lower left corner on."""
    x0, y0, x1, y1 = sheet.bounds
    width, height = size_mm
    text = (
        f"--sheet (in Python: sheet_mm) takes the place of the file's sheet of {round(x1 - x0, 3):g} × "
        f"{round(y1 - y0, 3):g} mm: {width:g} × {height:g} mm from ({x0:g}, {y0:g})"
    )
    return (
        _rectangle(x0, y0, width, height, stated=True),
        SHEET_GIVEN,
        [Note("warning", text)],
    )


def _is_page_of(page: Sheet, box: tuple[float, float, float, float], options: ReadOptions) -> bool:
    """Whether a page may be the sheet: it holds the parts, and is no page that was fitted to the drawing."""
    room = [abs(one - other) for one, other in zip(page.bounds, box, strict=True)]
    fitted = max(room) <= ALIKE_MM
    return not fitted and bool(page.polygon.buffer(options.join_tolerance_mm).covers(shapely.box(*box)))


def drawn_sheet(drawn: Sequence[DrawnCurve]) -> Sheet:
    """The sheet that closed lines are the outline and the holes of.

    Raises InputError when several sheets are drawn, or a line encloses nothing.
    """
    again = {k for _, k in coincident([p.curve for p in drawn])}
    drawn = [p for k, p in enumerate(drawn) if k not in again]
    if empty := [p for p in drawn if flat(p.curve)]:
        raise InputError(f"the line of the sheet {empty[0].place} encloses nothing: mend or remove it")
    depth, _ = surrounding([p.area for p in drawn])
    outlines = [p for p, d in zip(drawn, depth, strict=True) if d == 0]
    if len(outlines) > 1:
        raise InputError(
            f"{len(outlines)} sheets are drawn; one nest at a time can be read. Keep one, or set a "
            "drawing.layers.sheet that only the sheet's layer matches",
            details=tuple(p.place for p in outlines[:10]),
        )
    return Sheet(outlines[0].curve, tuple(p.curve for p, d in zip(drawn, depth, strict=True) if d == 1))


def _given_sheet(
    size_mm: tuple[float, float], bounds: tuple[float, float, float, float], options: ReadOptions
) -> tuple[Sheet, str, list[Note]]:
    """At the origin if the parts are there, with room to be cut out of it, else around them."""
    width, height = size_mm
    x0, y0, x1, y1 = bounds
    room_mm = max(options.kerf_mm, ALIKE_MM)
    on_it = shapely.box(0, 0, width, height).covers(shapely.box(*bounds))
    at_its_edge = on_it and max(x0, y0) < room_mm
    has_room = width - (x1 - x0) >= 2 * room_mm and height - (y1 - y0) >= 2 * room_mm
    if (on_it and not (at_its_edge and has_room)) or x1 - x0 > width or y1 - y0 > height:
        return Sheet.rectangle(width, height), SHEET_GIVEN, []
    x, y = (
        start - min(options.margin_mm, (size - (end - start)) / 2)
        for start, end, size in ((x0, x1, width), (y0, y1, height))
    )
    why = "touch the edge of" if on_it else "do not lie in"
    text = f"the parts {why} (0, 0)…({width:g}, {height:g}): the sheet is laid around them, from ({x:g}, {y:g})"
    return (
        _laid_around(x, y, width, height),
        f"{SHEET_GIVEN}, laid around the parts",
        [Note("warning", text)],
    )


def _laid_around(x: float, y: float, width: float, height: float) -> Sheet:
    """A sheet whose place nobody has stated."""
    return _rectangle(x, y, width, height, stated=False)


def _rectangle(x: float, y: float, width: float, height: float, *, stated: bool) -> Sheet:
    outline = Curve.of([(x, y), (x + width, y), (x + width, y + height), (x, y + height)])
    return Sheet(outline, stated=stated)


# One rectangle around everything, on no layer of its own: the sheet, or a part with openings? Nobody can tell.

STRAIGHT_MM = 0.05
"""A ring is a rectangle if it leaves its bounding box by less than this, on the average of the box's outline."""

ALIKE_MM = 1.0
"""A frame and a sheet whose sides differ by less are one and the same."""

PACKED = 0.5
"""Openings seldom take more than this share of a part; parts on a sheet do."""

ROUGHLY = 0.8
"""A rectangle with sides of at least this share of those of the sheet that is given may be that sheet's margin."""


def frame_of_drawing(rings: Sequence[DrawnCurve]) -> tuple[DrawnCurve, ...]:
    """The rectangle that holds all other rings, with every copy of it; nothing where there is none."""
    areas = [p.area for p in rings]
    lines = np.array([p.curve.line() for p in rings], dtype=object)  # a ring that encloses nothing has no area to ask
    box = shapely.box(*shapely.total_bounds(lines).tolist())
    largest = max(range(len(rings)), key=lambda k: areas[k].area)
    if box.area - areas[largest].area > STRAIGHT_MM * box.length:
        return ()
    pairs = coincident([p.curve for p in rings])
    around = {largest} | {k for pair in pairs if largest in pair for k in pair}
    return tuple(rings[k] for k in sorted(around)) if len(around) < len(rings) else ()


def use_of_frame(
    frame: Sequence[DrawnCurve],
    rings: Sequence[DrawnCurve],
    page: Sheet | None,
    options: ReadOptions,
    asking: Asking,
) -> tuple[FrameName, str]:
    """What the frame is, and why: as the options say, as the size of the sheet makes plain, or as is answered.

    A sheet that is cut out as a part is scrap, and so is a part that is taken for the sheet.
    """
    if options.frame is not None:
        return options.frame, "as given (--frame, in Python frame=, or drawing.frame)"
    size = _size(frame[0])
    if options.sheet_size_mm is not None:
        if same_size(size, options.sheet_size_mm):
            return "sheet", "a rectangle around everything of the size of --sheet (in Python sheet_mm=)"
        if any(side < ROUGHLY * stated_mm for side, stated_mm in zip(size, options.sheet_size_mm, strict=True)):
            return "part", ""
    holds = _holds_parts(frame, rings)
    on_page = page is not None and same_size(size, _sides(page.bounds))
    as_large = ", as large as the page" if on_page else ""
    choices = (
        Choice("sheet", "the sheet; what is in it is parts"),
        Choice("part", "a part; what is in it is openings"),
    )
    answer = asking.ask(
        Question(
            "frame",
            f"a rectangle of {size[0]:g} × {size[1]:g} mm is drawn around everything{as_large}, {frame[0].place}, and "
            "no layer says whether it is the sheet or a part: what is it?",
            choices if holds else choices[::-1],
        )
    )
    return ("sheet" if answer == "sheet" else "part"), asking.because("frame")


def _holds_parts(frame: Sequence[DrawnCurve], rings: Sequence[DrawnCurve]) -> bool:
    """Whether what is in a frame is parts, most likely: some have holes, or they fill most of it."""
    areas = np.array([p.area for p in rings if p not in frame], dtype=object)
    inner, outer = shapely.STRtree(areas).query(shapely.point_on_surface(areas), predicate="within")
    sizes = shapely.area(areas)
    return bool((sizes[outer] > sizes[inner]).any()) or sizes.sum() > PACKED * frame[0].area.area


def frame_note(frame: Sequence[DrawnCurve]) -> Note:
    """That the frame is taken for the sheet."""
    width, height = _size(frame[0])
    return Note(
        "warning", f"the rectangle around everything, {width:g} × {height:g} mm, {frame[0].place}, is the sheet"
    )


def _size(piece: DrawnCurve) -> tuple[float, float]:
    return _sides(piece.area.bounds)


def _sides(bounds: tuple[float, float, float, float]) -> tuple[float, float]:
    x0, y0, x1, y1 = bounds
    return round(x1 - x0, 3), round(y1 - y0, 3)


def same_size(one: tuple[float, float], other: tuple[float, float]) -> bool:
    """Whether two sizes are those of one sheet."""
    return all(abs(a - b) <= ALIKE_MM for a, b in zip(one, other, strict=True))


# Which ring lies in which: even depth is the outside of a part, odd depth a hole.


def surrounding(areas: Sequence[shapely.Geometry]) -> tuple[Ints, Ints]:
    """The depth of every area, and the number of the smallest one around it (-1 for none).

    The areas may touch but not cross: one that has an inner point in a larger one lies in it.

    Examples
    --------
    >>> depth, parent = surrounding([shapely.box(0, 0, 9, 9), shapely.box(1, 1, 8, 8), shapely.box(2, 2, 3, 3)])
    >>> depth.tolist(), parent.tolist()
    ([0, 1, 2], [-1, 0, 1])
    """
    shapes = np.array(areas, dtype=object)
    size = shapely.area(shapes)
    inside, around = shapely.STRtree(shapes).query(shapely.point_on_surface(shapes), predicate="within")
    larger = size[around] > size[inside]
    inside, around = inside[larger], around[larger]
    parent = np.full(len(shapes), -1, dtype=np.int64)
    from_largest = np.argsort(-size[around], kind="stable")
    parent[inside[from_largest]] = around[from_largest]  # the last to be written is the smallest
    return np.bincount(inside, minlength=len(shapes)).astype(np.int64), parent
