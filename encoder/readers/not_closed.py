"""The error of lines that do not close, with the drawing, so that it can be shown."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import shapely

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Nest, Part, Sheet

if TYPE_CHECKING:
    from .drawing import DrawnCurve


class OpenLines(InputError):
    """Lines that do not close: with them, and with the parts and the sheet's rings beside them, to be drawn."""

    def __init__(
        self,
        message: str,
        lines: Sequence[DrawnCurve],
        details: tuple[str, ...],
        parts: Sequence[Part] = (),
        sheet: Sequence[DrawnCurve] = (),
    ) -> None:
        super().__init__(message, details=details)
        self.lines, self.parts, self.sheet = tuple(lines), tuple(parts), tuple(sheet)

    def nest(self) -> Nest:
        """The parts and the open lines, `open1`, `open2`…; without a sheet on one that is no larger than they are."""
        lines = tuple(Contour(f"open{k}", "", "scrap", line.curve) for k, line in enumerate(self.lines, 1))
        if self.sheet:
            outline, *holes = sorted((ring.curve for ring in self.sheet), key=lambda c: -abs(c.signed_area_mm2))
            return Nest(Sheet(outline, tuple(holes)), self.parts, scrap=lines)
        everything = [*(part.outer.line for part in self.parts), *(line.line for line in lines)]
        x0, y0, x1, y1 = shapely.GeometryCollection(everything).bounds
        corners = [(x0, y0), (max(x1, x0 + 1), y0), (max(x1, x0 + 1), max(y1, y0 + 1)), (x0, max(y1, y0 + 1))]
        return Nest(Sheet(Curve.of(corners), ()), self.parts, scrap=lines)
