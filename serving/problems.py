"""What is wrong with a drawing that cannot be cut, and where, so that it can be drawn; and what repair would mend."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

from kerfwise.encoder.errors import REPAIR, InputError
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers.read import BrokenNest
from kerfwise.encoder.shown import shown
from kerfwise.postproc.report.page_data import page_of

_AT = re.compile(r"\((-?\d+(?:\.\d+)?(?:e-?\d+)?), (-?\d+(?:\.\d+)?(?:e-?\d+)?)\)")
_NEAR_MM = 0.01
Spot = tuple[float, float]


class Unmended(InputError):
    """A drawing that cannot be cut, and the lines of its error that stay where it is repaired."""

    def __init__(self, broken: BrokenNest, left: Sequence[str]) -> None:
        super().__init__(broken.message, file=broken.file, details=broken.details)
        self.broken, self.left = broken, tuple(left)


def left_by(repaired: Callable[[], object]) -> tuple[str, ...]:
    """What is still wrong once a drawing is repaired: what reading it so is refused for."""
    try:
        repaired()
    except InputError as error:
        return (error.message, *error.details)
    return ()


def problems_of(broken: BrokenNest, left: Sequence[str] | None) -> dict[str, Any]:
    """What the page draws: `said`, the nest with the wrong contours in red (`kerfwise-page/1`), and each problem.

    A problem has its sentence, the contours that it names, the point where its mark stands, or null, and whether repair
    mends it: nothing is wrong at its point then, by the lines that are `left`. A sentence about the whole drawing is
    mended where none is left. Where `left` is None it was repaired already.
    """
    stay = None if left is None else {point for text in left for point in _points(text)[-1:]}
    lines = broken.details or (broken.message,)
    return {
        "said": shown(broken.message),
        "page": page_of(broken.nest, [], shown(broken.nest.file or "drawing"), broken.wrong, shown(broken.message)),
        "lines": [
            {
                "text": shown(text).replace(REPAIR, "repair"),
                "contours": (named := _named(broken, text)),
                "at": _place(broken.nest, named, text),
                "mends": stay is not None and (not left or (bool(at := _points(text)[-1:]) and at[0] not in stay)),
            }
            for text in lines
        ],
    }


def _named(broken: BrokenNest, text: str) -> list[str]:
    """The contours that a sentence names, or whose ends it tells."""
    points = _points(text)
    return [
        name
        for name in broken.wrong
        if re.search(rf"(?<!\S){re.escape(name)}(?![\w.])", text) or _has_ends(broken.nest, name, points)
    ]


def _has_ends(nest: Nest, name: str, points: Sequence[Spot]) -> bool:
    curve = nest.contour(name).curve
    if curve.closed or len(points) < 2:
        return False
    ends = [(float(x), float(y)) for x, y in curve.vertices[[0, -1], :2]]
    return all(any(_near(end, point) for point in points) for end in ends)


def _place(nest: Nest, named: Sequence[str], text: str) -> Spot | None:
    """The point that a sentence names last, else one of its contour; None for a sentence about the whole drawing."""
    if points := _points(text):
        return points[-1]
    if not named:
        return None
    x, y = nest.contour(named[0]).curve.point_at(0.0)
    return round(x, 3), round(y, 3)


def _points(text: str) -> list[Spot]:
    return [(float(x), float(y)) for x, y in _AT.findall(text)]


def _near(one: Spot, other: Spot) -> bool:
    return abs(one[0] - other[0]) < _NEAR_MM and abs(one[1] - other[1]) < _NEAR_MM
