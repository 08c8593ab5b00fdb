"""Lines as readers find them, before they are joined to contours."""

from __future__ import annotations

from collections.abc import Sequence

from kerfwise.encoder.readers.drawing import DrawnCurve
from kerfwise.rule_kit import Curve


def pieces(*rows: Sequence[Sequence[float]], closed: bool = False) -> list[DrawnCurve]:
    """Open pieces (closed on demand) in the order given."""
    return [DrawnCurve(Curve.of(r, closed=closed), "0", k) for k, r in enumerate(rows)]


def segments(points: Sequence[tuple[float, float]]) -> list[list[tuple[float, float]]]:
    """The sides of a polygon, one by one."""
    return [[a, b] for a, b in zip(points, [*points[1:], points[0]], strict=True)]
