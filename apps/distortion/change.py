"""How a part of a nest was changed so that it comes out as it is wanted, and what its file says of that."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Part

COMPENSATED = "compensated"
"""The attribute of a part that says how it was changed: `along_x` and `along_y`, as `Change` has them."""
POWERS = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
"""Of x and y, in the terms of a change."""


@dataclass(frozen=True, eq=False, slots=True)
class Change:
    """How far points of a part are moved: `by` (2, 5) has mm of x and of y for x, y, x², xy and y².

    These are counted in metres from the `middle` of its bounds. So the first number of x says by how many mm per m the
    part is longer along x.
    """

    middle: Point
    by: Floats

    def at(self, xy: Floats) -> Floats:
        """How far points (k, 2), mm, are moved, mm."""
        x, y = ((xy - self.middle) / 1000.0).T
        found: Floats = np.stack([x**p * y**q for p, q in POWERS], axis=1) @ self.by.T
        return found

    @property
    def share(self) -> float:
        """By how much of itself it makes the part larger along x or y, the greater of the two; less than 0: smaller."""
        return float(max(self.by[0, 0], self.by[1, 1], key=abs)) / 1000.0


def change_of(part: Part) -> Change | None:
    """How a part of a nest was changed from what is wanted; None for one drawn as it is wanted.

    Raises InputError if what the nest says of it cannot be understood.
    """
    said = part.attributes.get(COMPENSATED)
    if said is None:
        return None
    try:
        by = np.array([said["along_x"], said["along_y"]], dtype=np.float64)  # type: ignore[index]
    except (KeyError, TypeError, ValueError):
        by = np.zeros(0)
    if by.shape != (2, len(POWERS)) or not np.isfinite(by).all():
        raise InputError(
            f"{escape_text(part.id)}: {COMPENSATED}: expected along_x and along_y with {len(POWERS)} numbers each, as "
            "kerfwise distort --compensated writes them"
        )
    return Change(middle_of(part), by)


def middle_of(part: Part) -> Point:
    """The middle of its bounds, mm."""
    x0, y0, x1, y1 = part.outer.polygon.bounds
    return (x0 + x1) / 2, (y0 + y1) / 2
