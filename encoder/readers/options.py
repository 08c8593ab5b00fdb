"""What a person may say about how a nest file is to be read."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.questions import Answers

from .layers import DEFAULT, Layers, Purpose
from .units import MM_PER, mm_of

FrameName = Literal["sheet", "part"]
OpenLines = Literal["mark", "ignore", "refuse"]
ScrapLines = Literal["ignore", "cut"]


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """How to read a nest file; the defaults suit a drawing that says what it is.

    Parameters
    ----------
    units
        One of mm, cm, m, in, ft, pt, px, or dots an inch such as 90dpi; overrides what the file says. None: the file's
        own; where it says nothing, that is asked about.
    sheet_size_mm
        Width and height of the sheet, in the place of one that the file has.
    layers
        Which layers (DXF) or groups (SVG) are cut, marked, left out, the sheet, or scrap lines.
    frame
        What one rectangle around everything is, where no layer is the sheet's. None: nobody has said; it is asked.
    open_lines
        What happens to open lines on a layer that `layers.cut` names.
    scrap_lines
        What happens to open lines on a layer that `layers.scrap` names: left out, or cut when all parts are out.
    margin_mm
        Room left around the parts when the sheet has to be their bounding box.
    join_tolerance_mm
        Loose ends up to this far apart are taken to meet.
    refit_arcs_mm
        Outlines that were flattened into short lines become arcs again, which stay this near to the lines. None: they
        stay as they are.
    repair
        Mend what can be mended, and list each mend in the nest's notes.
    answers
        The id of a question that the drawing may raise, and the choice that was made.
    colours, linetypes
        What lines of a colour or of a line type are for, on layers that the plant's patterns do not give to others.
    kerf_mm
        Metal narrower than this is none: lines so near to each other are one line drawn twice.

    Raises
    ------
    InputError
        For an unknown unit, a size that is not positive, or an unknown word for `frame`, `open_lines` or `scrap_lines`.

    Examples
    --------
    >>> ReadOptions(units="in").join_tolerance_mm
    0.1
    """

    units: str | None = None
    sheet_size_mm: tuple[float, float] | None = None
    layers: Layers = DEFAULT
    frame: FrameName | None = None
    open_lines: OpenLines = "mark"
    scrap_lines: ScrapLines = "ignore"
    margin_mm: float = 10.0
    join_tolerance_mm: float = 0.1
    repair: bool = False
    refit_arcs_mm: float | None = None
    answers: Answers = ()
    colours: tuple[tuple[str, Purpose], ...] = ()
    linetypes: tuple[tuple[str, Purpose], ...] = ()
    kerf_mm: float = 0.0

    def __post_init__(self) -> None:
        if self.units is not None and mm_of(self.units) is None:
            raise InputError(
                f"unknown units '{self.units}': expected one of {', '.join(MM_PER)}, pt, px, or dots an inch "
                "such as 90dpi"
            )
        for name, given, words in (
            ("frame", self.frame or "sheet", get_args(FrameName)),
            ("open_lines", self.open_lines, get_args(OpenLines)),
            ("scrap_lines", self.scrap_lines, get_args(ScrapLines)),
        ):
            _require(given in words, f"unknown {name} '{given}': expected one of {', '.join(words)}")
        for side in self.sheet_size_mm or ():
            _require(0 < side < math.inf, f"sheet_size_mm has {side}: expected a width and a height over 0")
        _require(0 <= self.margin_mm < math.inf, f"margin_mm is {self.margin_mm}: expected 0 or more")
        _require(
            0 < self.join_tolerance_mm < math.inf,
            f"join_tolerance_mm is {self.join_tolerance_mm}: expected a number over 0",
        )
        _require(
            self.refit_arcs_mm is None or 0 < self.refit_arcs_mm < math.inf,
            f"refit_arcs_mm is {self.refit_arcs_mm}: expected a number over 0",
        )


def _require(holds: bool, message: str) -> None:
    if not holds:
        raise InputError(message)
