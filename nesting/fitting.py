"""Parts that fit on no sheet at all, not even on an empty one."""

from __future__ import annotations

from .nofit import allowed
from .room import usable
from .shapes import Shapes
from .wanted import Spacing, Wanted


def too_large(wanted: Wanted, shapes: Shapes, spacing: Spacing) -> list[int]:
    """Numbers of the part types that fit on no empty sheet, however they are turned."""
    grounds = [usable(stock.sheet, spacing) for stock in wanted.stocks]
    return [
        kind
        for kind in range(len(wanted.types))
        if all(
            allowed(ground, shapes.shape((kind, pose)).taken).is_empty
            for ground in grounds
            for pose in shapes.poses(kind)
        )
    ]
