"""One rectangle around everything, on no layer of its own: the sheet, or a part with openings? Nobody can tell."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from kerfwise.encoder.nest import Note, Sheet
from kerfwise.encoder.questions import Asking, Choice, Question
from kerfwise.encoder.validate import coincident

from .drawing import DrawnCurve
from .options import FrameName, ReadOptions

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
        return options.frame, "as given (--frame, drawing.frame)"
    size = _size(frame[0])
    if options.sheet_size_mm is not None:
        if alike(size, options.sheet_size_mm):
            return "sheet", "a rectangle around everything of the size of --sheet"
        if any(side < ROUGHLY * given for side, given in zip(size, options.sheet_size_mm, strict=True)):
            return "part", ""
    holds = _holds_parts(frame, rings)
    on_page = page is not None and alike(size, _sides(page.bounds))
    as_large = ", as large as the page" if on_page else ""
    choices = (
        Choice("sheet", "the sheet; what is in it is parts"),
        Choice("part", "a part; what is in it is openings"),
    )
    said = asking.ask(
        Question(
            "frame",
            f"a rectangle of {size[0]:g} × {size[1]:g} mm is drawn around everything{as_large}, {frame[0].place}, and "
            "no layer says whether it is the sheet or a part: what is it?",
            choices if holds else choices[::-1],
        )
    )
    return ("sheet" if said == "sheet" else "part"), asking.because("frame")


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


def alike(one: tuple[float, float], other: tuple[float, float]) -> bool:
    """Whether two sizes are those of one sheet."""
    return all(abs(a - b) <= ALIKE_MM for a, b in zip(one, other, strict=True))
