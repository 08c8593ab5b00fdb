"""Coordinates that cannot be of a sheet are refused before any geometry is done with them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve

LIMIT_MM = 1e6
"""No coordinate and no arc reaches further than a kilometre from the origin."""

SNAP_MM = 1e-3
"""Points this close are one: CAD rounds. Wider gaps are closed pair by pair, so that short chords never melt."""

FLAT_MM = 1e-4
"""An arc that leaves its chord by less is a line: its centre would lie further off than numbers reach."""


def checked_curve(rows: Iterable[Sequence[float]] | Floats, closed: bool, scale: float = 1.0) -> Curve:
    """A curve of x, y (times `scale`) and bulge, without repeated vertices and arcs as flat as a line.

    Raises
    ------
    InputError
        When a number is not finite or lies beyond `LIMIT_MM`.

    Examples
    --------
    >>> checked_curve([(0, 0), (0, 0), (1, 0), (1, 1), (0, 0)], closed=True, scale=10).as_rows()
    [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]]
    """
    drawn = rows if isinstance(rows, np.ndarray) else Curve.of(rows).vertices
    if not np.isfinite(drawn).all():
        drawn = _without_lost_bulges(drawn, scale)
    if not np.isfinite(drawn).all():
        raise InputError("a coordinate is not a finite number")
    with np.errstate(over="ignore", invalid="ignore"):
        points, bulge = np.round(drawn[:, :2] * scale, 9) + 0.0, np.abs(drawn[:, 2])
        far = np.abs(points).max(axis=1, initial=0.0)
        steps = np.diff(points, axis=0, append=points[:1])
        chord = np.hypot(steps[:, 0], steps[:, 1])
        wide = (bulge > 1) & (chord * (1 + bulge * bulge) > 4 * bulge * LIMIT_MM)
    if (far > LIMIT_MM).any():
        x, y = points[far.argmax()].tolist()
        raise InputError(
            f"({x:g}, {y:g}) mm lies more than a kilometre from the origin: if the units are wrong, "
            "pass --units (in Python: units=)"
        )
    if wide.any():
        raise InputError(f"an arc of bulge {drawn[wide.argmax(), 2]:g} is wider than a kilometre")
    keep = chord > 1e-9
    keep[-1] |= not closed or not keep.any()
    arc = bulge * chord / 2 > FLAT_MM
    return Curve(np.column_stack([points, np.where(arc, drawn[:, 2], 0.0)])[keep], closed)


def _without_lost_bulges(drawn: Floats, scale: float) -> Floats:
    """The rows with a bulge of 0 where it is no number between points that are one: CAD divides by their distance."""
    with np.errstate(over="ignore", invalid="ignore"):
        steps = np.diff(drawn[:, :2], axis=0, append=drawn[:1, :2])
        near = np.hypot(steps[:, 0], steps[:, 1]) * scale <= SNAP_MM
    return np.column_stack([drawn[:, :2], np.where(near & ~np.isfinite(drawn[:, 2]), 0.0, drawn[:, 2])])
