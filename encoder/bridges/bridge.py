"""A bridge as it is drawn: which parts it joins, from where to where, and how wide it is."""

from __future__ import annotations

import math
from dataclasses import dataclass

import shapely

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point


@dataclass(frozen=True, slots=True)
class Bridge:
    """A strip of metal, `width_mm` wide, around the line from `start` in one of two parts to `end` in the other.

    `number` counts from 1 in the order of the file; `line` is where it stands there, if that is known.
    """

    parts: tuple[str, str]
    start: Point
    end: Point
    width_mm: float
    number: int
    line: int | None = None

    @property
    def name(self) -> str:
        """What messages call it.

        Examples
        --------
        >>> Bridge(("A", "B"), (0, 0), (9, 0), 4, 1).name
        'bridge 1 (A to B)'
        """
        return f"bridge {self.number} ({self.parts[0]} to {self.parts[1]})"

    @property
    def length_mm(self) -> float:
        """How long it is as drawn, what lies in the parts included."""
        return math.dist(self.start, self.end)

    def side(self, left: bool, beyond_mm: float = 0.0) -> tuple[Point, Point]:
        """One long side, seen from `start` to `end`, and so much longer at both ends.

        Examples
        --------
        >>> Bridge(("A", "B"), (0, 0), (9, 0), 4, 1).side(left=True)
        ((0.0, 2.0), (9.0, 2.0))
        """
        (x0, y0), (x1, y1) = self.start, self.end
        ux, uy = (x1 - x0) / self.length_mm, (y1 - y0) / self.length_mm
        half_mm = self.width_mm / 2 if left else -self.width_mm / 2
        return (
            (x0 - uy * half_mm - ux * beyond_mm, y0 + ux * half_mm - uy * beyond_mm),
            (x1 - uy * half_mm + ux * beyond_mm, y1 + ux * half_mm + uy * beyond_mm),
        )

    @property
    def strip(self) -> shapely.Polygon:
        """The rectangle that it is."""
        return shapely.Polygon([*self.side(left=False), *self.side(left=True)[::-1]])

    def refused(self, why: str) -> InputError:
        """The error for a bridge that cannot be made, with its line."""
        return InputError(f"{self.name} {why}", line=self.line)
