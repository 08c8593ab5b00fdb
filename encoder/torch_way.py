"""The torch's way along a contour: once round it, or along a stretch of it where others have cut the rest."""

from __future__ import annotations

from collections.abc import Iterable

from .cut import Span, Tab
from .geometry.curve import Curve
from .geometry.segment import Point
from .tabs import once_round


def torch_way(
    ring: Curve, join: Point, span: Span | None, tabs: Iterable[Tab], kerf_mm: float
) -> tuple[Curve, tuple[tuple[float, float], ...]]:
    """The torch's way from where it joins to where it leaves or goes off, and the stretches that it makes unlit.

    `ring` is the compensated contour the way the torch goes.

    Examples
    --------
    >>> square = Curve.of([(0, 0), (100, 0), (100, 100), (0, 100)])
    >>> torch_way(square, (0, 60), Span((0, 60), (50, 0)), (), 1.0)[0].as_rows()
    [[0.0, 60.0], [0.0, 0.0], [50.0, 0.0]]
    """
    if span is None:
        return once_round(ring, join, tabs, kerf_mm)
    begin_mm, end_mm = ring.project(join)[0], ring.project(span.end)[0]
    return ring.between(begin_mm, (end_mm - begin_mm) % ring.length_mm), ()
