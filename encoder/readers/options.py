"""How a drawing is to be read: its units, and what a person may say about it."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.encoder.bevels.bevel import Bevel
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Note, Sheet
from kerfwise.encoder.questions import Answers, Asking, Choice, Question

from .layers import DEFAULT, Layers, Purpose

FrameName = Literal["sheet", "part"]
OpenLines = Literal["mark", "ignore", "refuse"]
ScrapLines = Literal["ignore", "cut"]


REPAIR_FACTOR = 10
"""With `repair`, gaps up to this many times the join tolerance are closed."""

QUANTITY = (
    r"(?<![^\W_])(\d{1,5})[ _]?(?:db|stk|st(?:ü|ue)?ck|pcs?|pi[eè]ces?|szt|ks|шт|x|off)(?![^\W_])"
    r"|(?<![^\W_])(?:(?:qty|quantity|anzahl|menge|кол)[ _=-]?|[x×])(\d{1,5})(?![^\W_])"
)
"""How names say how many: `_50db`, `12 pcs`, `x4`, `QTY_3`."""


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """How to read a nest file; the defaults suit a drawing that says what it is.

    Parameters
    ----------
    units
        One of mm, cm, m, in, ft, pt, px, or dots an inch such as 90dpi; overrides what the file says. None: the file's
        own; where it says nothing, that is asked about.
    units_by_profile
        The units are those of a plant's drawings: a nest in JSON that names its own keeps them.
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
    quantity
        A regular expression with groups, of which one is how many of a part are wanted, sought in the names of its
        blocks, of its layer and of the file.
    spot_mm
        How long the arms of the cross are, from end to end, that marks a point.
    bevels
        Which bevel closed lines have, by their layer (a regular expression) or their colour.

    Raises InputError for an unknown unit, a size that is not positive, or an unknown word for `frame`, `open_lines` or
    `scrap_lines`.

    Examples
    --------
    >>> ReadOptions(units="in").join_tolerance_mm
    0.1
    """

    units: str | None = None
    units_by_profile: bool = False
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
    spot_mm: float = 2.0
    quantity: str = QUANTITY
    bevels: tuple[tuple[str, Bevel], ...] = ()

    def __post_init__(self) -> None:
        if self.units is not None and mm_of(self.units) is None:
            raise InputError(
                f"unknown units '{self.units}': expected one of {', '.join(MM_PER)}, pt, px, or dots an inch "
                "such as 90dpi"
            )
        try:
            groups = re.compile(self.quantity).groups
        except re.error as error:
            raise InputError(f"quantity '{self.quantity}' is not a regular expression: {error}") from None
        _require(groups > 0, f"quantity '{self.quantity}' has no group (…) for the number")
        for name, value, words in (
            ("frame", self.frame or "sheet", get_args(FrameName)),
            ("open_lines", self.open_lines, get_args(OpenLines)),
            ("scrap_lines", self.scrap_lines, get_args(ScrapLines)),
        ):
            _require(value in words, f"unknown {name} '{value}': expected one of {', '.join(words)}")
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


# Units of length that drawings come in.

MM_PER = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "ft": 304.8}

RARE_MM_PER = {"dm": 100.0, "yd": 914.4, "mil": 0.0254, "um": 1e-3, "us-ft": 1200 / 3937 * 1e3}
"""Units that only the header of a DXF file names."""

PER_INCH = {"pt": 72.0, "px": 96.0, "72dpi": 72.0, "90dpi": 90.0, "96dpi": 96.0}
"""Units of drawing programs and printers, by how many of them make an inch."""

UNITS = (*MM_PER, *PER_INCH)
"""Every word for a unit that a profile takes; the command line takes any number of dots an inch, such as 300dpi."""

DXF_UNITS = {
    1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 9: "mil", 10: "yd", 13: "um", 14: "dm", 21: "us-ft",
}  # fmt: skip
"""The values of the DXF header's $INSUNITS that a nest can be drawn in."""

SMALLEST_SHEET_MM, LARGEST_SHEET_MM = 20.0, 50_000.0
"""The longer side of any sheet one would cut lies between these."""

SMALLEST_PART_MM = 2.0
"""A drawing that names its unit and is smaller than this in it is in another, most likely."""


INCH_SLACK = 1e-3
"""How far a number times 64 may be from a whole one."""

LONGEST_IN_INCHES = 240.0
"""A drawing of more units than this is none in inches: no sheet is 20 ft long."""


_WORDS = {
    "mm": "millimetres",
    "cm": "centimetres",
    "m": "metres",
    "in": "inches",
    "ft": "feet",
    "pt": "points, 72 an inch",
    "px": "pixels, 96 an inch",
}


def mm_of(units: str) -> float | None:
    """Millimetres in a unit: mm, cm, m, in, ft, pt, px, or dots an inch such as 90dpi; None for any other word.

    Examples
    --------
    >>> mm_of("cm"), mm_of("pt") == mm_of("72 dpi") == 25.4 / 72, mm_of("rod")
    (10.0, True, None)
    """
    if units in MM_PER or units in RARE_MM_PER:
        return MM_PER.get(units) or RARE_MM_PER[units]
    if units in PER_INCH:
        return 25.4 / PER_INCH[units]
    dots = re.fullmatch(r"(\d{1,5}(?:\.\d+)?) ?dpi", units)
    return 25.4 / float(dots[1]) if dots and float(dots[1]) > 0 else None


def units_question(text: str, units: Sequence[str], longest: float) -> Question:
    """Which of these units a drawing is in, the likeliest first; `longest` is its longer side in its own units."""
    sizes = {unit: f"{longest * (mm_of(unit) or 1.0):.6g} mm long" for unit in units}
    return Question("units", text, tuple(Choice(unit, _WORDS.get(unit, unit), sizes[unit]) for unit in units))


def are_inches(points: Floats) -> bool:
    """Whether half of some coordinates or more, from the lowest on, are multiples of 1/64.

    Examples
    --------
    >>> are_inches(np.array([[0.0, 0.0], [3.5, 2.25]])), are_inches(np.array([[0.0, 0.0], [48.0, 2.4]]))
    (True, False)
    """
    off = (points - points.min(axis=0))[points.max(axis=1) > points.min()] * 64
    rest = np.abs(off - np.round(off))[np.abs(off) > INCH_SLACK]
    return bool(rest.size) and float((rest < INCH_SLACK).mean()) > 0.5


def dxf_units(
    insunits: int | None,
    measurement: int | None,
    lunits: int | None,
    longest: float,
    asking: Asking,
    in_inches: bool = True,
) -> tuple[str, str]:
    """The unit of a DXF file and why, from its header; asked about where that says nothing or contradicts itself.

    `insunits`, `measurement`, `lunits`: the header's $INSUNITS, $MEASUREMENT (0 imperial, 1 metric) and $LUNITS
    (3 and 4 are feet and inches), None where the file does not have them. `longest`: longer side of all that is drawn,
    in units of the drawing. `in_inches`: whether the numbers are those of a drawing in inches, whole ones and
    fractions: see `are_inches`.
    """
    says_inches = (("LUNITS", lunits, (3, 4)), ("MEASUREMENT", measurement, (0,)))
    imperial = [f"${name} {value}" for name, value, says in says_inches if value in says]
    long = f"the drawing is {longest:.6g} units long"
    if insunits in DXF_UNITS:
        unit = DXF_UNITS[insunits]
        if lunits in (3, 4) and unit not in ("in", "ft"):  # many programs leave $MEASUREMENT as it was
            against = f"$INSUNITS {insunits} ({unit}) and $LUNITS {lunits} (feet and inches) contradict each other"
            text = f"{against}, {long}: what is it in?"
            return asking.ask(units_question(text, (unit, "in"), longest)), "asked: the header contradicts itself"
        per_unit = mm_of(unit) or 1.0
        if longest > 0 and not SMALLEST_PART_MM <= longest * per_unit <= LARGEST_SHEET_MM:
            fits = [u for u in ("mm", "in", "cm", "m") if SMALLEST_SHEET_MM <= longest * MM_PER[u] <= LARGEST_SHEET_MM]
            if fits and unit not in fits:
                size = f"{longest * per_unit:.6g} mm"
                text = f"$INSUNITS {insunits} says {unit}, in which the drawing is {size} long: what is it in?"
                return asking.ask(units_question(text, (*fits, unit), longest)), "asked: the size is none of a sheet"
        return unit, f"$INSUNITS {insunits}"
    nothing = "the file names no unit" if insunits in (None, 0) else f"$INSUNITS {insunits} is no unit of a nest"
    if insunits not in (None, 0):
        return asking.ask(units_question(f"{nothing}, {long}: what is it in?", ("mm", "in"), longest)), (
            "asked: the header names no unit of a nest"
        )
    if longest > LONGEST_IN_INCHES:
        return "mm", f"{nothing}, and it is too large to be in inches"
    if measurement == 1 and not 0 < longest < SMALLEST_PART_MM:
        return "mm", f"{nothing}, $MEASUREMENT 1 says metric"
    if imperial:
        sentence = f"{' and '.join(imperial)} say{'s' if len(imperial) == 1 else ''} inches"
        text = f"{nothing}, and {sentence}, {long}: what is it in?"
        order = ("in", "mm") if in_inches else ("mm", "in")
        return asking.ask(units_question(text, order, longest)), "asked: the file names no unit"
    order = ("in", "mm") if longest < SMALLEST_SHEET_MM else ("mm", "in")
    return asking.ask(
        units_question(f"{nothing}, {long}: what is it in?", order, longest)
    ), "asked: the file names no unit"


GIVEN = "as given (--units, in Python units=, or drawing.units)"
"""Why a drawing is read in units that it may not name."""


def contradicted(said: str | None, by: str, given: str | None) -> list[Note]:
    """A note where a file is read in other units than it `said`; `by`: where it said so.

    Examples
    --------
    >>> contradicted("mm", "$INSUNITS 4", "in")[0].text
    'the file says mm ($INSUNITS 4), and is read in in, as given (--units, in Python units=, or drawing.units)'
    >>> contradicted("mm", "$INSUNITS 4", None), contradicted(None, "", "in")
    ([], [])
    """
    if None in (said, given) or mm_of(str(said)) == mm_of(str(given)):
        return []
    return [Note("warning", f"the file says {said} ({by}), and is read in {given}, {GIVEN}")]


def doubts(sheet: Sheet, units: str) -> list[Note]:
    """A note on a sheet of a size that no plant would cut; nothing where it is plausible.

    `sheet`: the sheet as read. `units`: what the file was read in.

    Examples
    --------
    >>> doubts(Sheet.rectangle(6000, 1500), "mm")
    []
    >>> doubts(Sheet.rectangle(60_000, 15_000), "mm")[0].text
    'the sheet is 60000 × 15000 mm, too large to be one: if mm is the wrong unit, pass the right units'
    """
    width, height = np.ptp(sheet.outline.flatten(), axis=0).tolist()
    extent = max(width, height)
    if SMALLEST_SHEET_MM <= extent <= LARGEST_SHEET_MM:
        return []
    drawn = extent / (mm_of(units) or 1.0)
    fits = [u for u, mm in MM_PER.items() if u != units and SMALLEST_SHEET_MM <= drawn * mm <= LARGEST_SHEET_MM]
    named = (
        f"--units (in Python: units=) {' or '.join(filter(None, [', '.join(fits[:-1]), fits[-1]]))}"
        if fits
        else "the right units"
    )
    size = "too small" if extent < SMALLEST_SHEET_MM else "too large"
    text = f"the sheet is {width:g} × {height:g} mm, {size} to be one: if {units} is the wrong unit, pass {named}"
    return [Note("warning", text)]
