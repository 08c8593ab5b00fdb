"""Two copies of a part as one: side by side in the least rectangle, by the method of the defining line."""

from __future__ import annotations

from dataclasses import dataclass

import shapely

from .defining_line import best_beside
from .pose import Pose
from .wanted import PartType

_APART_MM = 2e-3
"""A pair is laid so much wider, as places are rounded to a thousandth of a millimetre."""
_WORTH = 1.03
"""A pair is one where it fills its rectangle so much better than a part alone fills its own."""


@dataclass(frozen=True, eq=False, slots=True)
class Pair:
    """The second copy is turned, then shifted, from where the first lies as it is drawn; `taken` is what both take."""

    turn_deg: float
    shift: tuple[float, float]
    taken: shapely.Polygon
    poses: tuple[Pose, ...]


def pair_of(kind: PartType, taken: shapely.Polygon) -> Pair | None:
    """How two copies lie best, by turns that the type allows; None where pairs do not pay, or would not hang together.

    Parameters
    ----------
    kind
        The part type.
    taken
        What one copy takes, half the gap around it included.
    """
    if kind.quantity < 2:
        return None
    allowed = set(kind.turns_deg)
    turns = sorted({(b - a) % 360.0 for a in allowed for b in allowed})
    outline = shapely.Polygon(taken.exterior).buffer(_APART_MM, join_style="mitre")
    beside = best_beside(outline, outline, turns)
    x0, y0, x1, y1 = outline.bounds
    alone, together = outline.area / ((x1 - x0) * (y1 - y0)), 2 * outline.area / beside.area_mm2
    if together < alone * _WORTH:
        return None
    poses = tuple(Pose(turn) for turn in kind.turns_deg if (turn + beside.turn_deg) % 360.0 in allowed)
    second = shapely.transform(taken, lambda points: Pose(beside.turn_deg).moved(points, *beside.shift))
    both = shapely.union(taken.buffer(_APART_MM, join_style="mitre"), second.buffer(_APART_MM, join_style="mitre"))
    if both.geom_type != "Polygon":
        return None
    return Pair(beside.turn_deg, beside.shift, both, poses)
