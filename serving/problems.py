"""What is wrong with a drawing that cannot be cut, and where, so that it can be drawn; and what repair would mend."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from itertools import product
from typing import Any

from kerfwise.encoder.errors import REPAIR, InputError
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers.read import BrokenNest
from kerfwise.encoder.shown import shown
from kerfwise.postproc.report.page_data import page_of

_AT = re.compile(r"\((-?\d+(?:\.\d+)?(?:e-?\d+)?), (-?\d+(?:\.\d+)?(?:e-?\d+)?)\)")
_BEGIN, _END = r"(?<!\S)", r"(?![\w.])"
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
    lines, wrong = broken.details or (broken.message,), _Wrong(broken)
    return {
        "said": shown(broken.message),
        "page": page_of(broken.nest, [], shown(broken.nest.file or "drawing"), broken.wrong, shown(broken.message)),
        "lines": [
            {
                "text": shown(text).replace(REPAIR, "repair"),
                "contours": (named := wrong.named(text)),
                "at": _place(broken.nest, named, text),
                "mends": stay is not None and (not left or (bool(at := _points(text)[-1:]) and at[0] not in stay)),
            }
            for text in lines
        ],
    }


class _Wrong:
    """The wrong contours of a drawing, found by what a sentence says: thousands of either are told in seconds."""

    def __init__(self, broken: BrokenNest) -> None:
        self._names = {name: k for k, name in enumerate(broken.wrong)}
        self._of_words = [name for name in broken.wrong if len(name.split()) > 1]
        self._ends: dict[str, tuple[Spot, Spot]] = {}
        self._at: dict[tuple[int, int], list[str]] = defaultdict(list)
        for name in broken.wrong:
            curve = broken.nest.contour(name).curve
            if not curve.closed:
                (ax, ay), (bx, by) = curve.vertices[[0, -1], :2].tolist()
                self._ends[name] = (ax, ay), (bx, by)
                self._at[_square(ax, ay)].append(name)

    def named(self, text: str) -> list[str]:
        """The contours that a sentence names, or whose ends it tells."""
        found = {name for name in self._of_words if name in text and re.search(_BEGIN + re.escape(name) + _END, text)}
        begun = (word[:k] for word in text.split() for k in range(1, len(word) + 1) if re.match(_END, word[k:]))
        found |= {name for name in begun if name in self._names}
        points = _points(text)
        if len(points) > 1:
            found |= {
                name
                for x, y in points
                for name in self._begun_near(x, y)
                if all(any(_near(end, point) for point in points) for end in self._ends[name])
            }
        return sorted(found, key=self._names.__getitem__)

    def _begun_near(self, x: float, y: float) -> Iterator[str]:
        """Open lines whose first end is in the square of a point, or in one beside it."""
        i, j = _square(x, y)
        for square in product((i - 1, i, i + 1), (j - 1, j, j + 1)):
            yield from self._at.get(square, ())


def _square(x: float, y: float) -> tuple[int, int]:
    return math.floor(x / _NEAR_MM), math.floor(y / _NEAR_MM)


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
