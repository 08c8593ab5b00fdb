"""What a person may say about how a nest file is to be read."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from ..errors import InputError
from .units import MM_PER


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """How to read a nest file; the defaults suit a drawing that says what it is.

    Parameters
    ----------
    units
        One of mm, cm, m, in, ft; overrides what the file says. None: the file's own, mm where it says nothing.
    sheet_size_mm
        Width and height of the sheet, for a drawing that has no sheet of its own.
    sheet_layer, mark_layer
        Regular expressions, searched in layer names without regard to case: which layers (DXF) or groups (SVG)
        hold the sheet, and which hold lines that are marked and not cut through.
    margin_mm
        Room left around the parts when the sheet has to be their bounding box.
    join_tolerance_mm
        Loose ends up to this far apart are taken to meet.
    repair
        Mend what can be mended, and list each mend in the nest's notes.

    Raises
    ------
    InputError
        For an unknown unit, a size that is not positive, or a pattern that is no regular expression.

    Examples
    --------
    >>> ReadOptions(units="in").join_tolerance_mm
    0.1
    """

    units: str | None = None
    sheet_size_mm: tuple[float, float] | None = None
    sheet_layer: str = "sheet|plate"
    mark_layer: str = "mark|scribe|engrav"
    margin_mm: float = 10.0
    join_tolerance_mm: float = 0.1
    repair: bool = False

    def __post_init__(self) -> None:
        if self.units is not None and self.units not in MM_PER:
            raise InputError(f"unknown units '{self.units}': expected one of {', '.join(MM_PER)}")
        for side in self.sheet_size_mm or ():
            _require(0 < side < math.inf, f"sheet_size_mm has {side}: expected a width and a height over 0")
        _require(0 <= self.margin_mm < math.inf, f"margin_mm is {self.margin_mm}: expected 0 or more")
        _require(
            0 < self.join_tolerance_mm < math.inf,
            f"join_tolerance_mm is {self.join_tolerance_mm}: expected a number over 0",
        )
        for name in ("sheet_layer", "mark_layer"):
            pattern = getattr(self, name)
            try:
                re.compile(pattern)
            except re.error as error:
                raise InputError(f"{name} '{pattern}' is not a regular expression: {error}") from None

    def is_sheet(self, layer: str) -> bool:
        """True for a layer that holds the sheet."""
        return re.search(self.sheet_layer, layer, re.IGNORECASE) is not None

    def is_mark(self, layer: str) -> bool:
        """True for a layer that holds marks."""
        return re.search(self.mark_layer, layer, re.IGNORECASE) is not None


def _require(holds: bool, message: str) -> None:
    if not holds:
        raise InputError(message)
