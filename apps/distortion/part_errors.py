"""From moved metal to errors of parts: the best rigid fit taken off, the worst place, and the mean square."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.nest import Nest, Part

from .change import change_of
from .cutting import Moved

LEAST_FITTED = 3
"""A part with fewer points than a rigid fit takes away freedoms has no error that could be told."""


@dataclass(frozen=True, eq=False, slots=True)
class PartError:
    """How far a part is off when it is cold, mm: at its worst place `at`, and as root mean square along its contours.

    `contour` (k,), `xy` (k, 2) and `off` (k, 2) are the points that were followed, and where the part's edge lies there
    less where it should, mm, after the fit; `length_mm` (k,) is what they stand for. A part without points has no
    error: None.
    """

    part: str
    max_mm: float | None
    rms_mm: float | None
    at: tuple[float, float] | None
    contour: Ints
    xy: Floats
    off: Floats
    length_mm: Floats


def fit_rigid(xy: Floats, off: Floats, weight: Floats) -> Floats:
    """What of displacements (k, 2) at points (k, 2) no small shift and turn explains, by weighted least squares.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
    >>> turned = 0.01 * np.column_stack([-square[:, 1], square[:, 0]]) + (3.0, -1.0)
    >>> bool(np.abs(fit_rigid(square, turned, np.ones(4))).max() < 1e-12)
    True
    """
    arm = xy - np.average(xy, axis=0, weights=weight)
    moves = np.zeros((len(xy), 2, 3))
    moves[:, 0, 0] = moves[:, 1, 1] = 1.0
    moves[:, 0, 2], moves[:, 1, 2] = -arm[:, 1], arm[:, 0]
    root = np.sqrt(weight)[:, None]
    best = np.linalg.lstsq((moves * root[:, :, None]).reshape(-1, 3), (off * root).ravel(), rcond=None)[0]
    left: Floats = off - moves @ best
    return left


def errors_of(nest: Nest, moved: Moved) -> tuple[PartError, ...]:
    """Every part of a nest, in its order, against the drawing; one that was compensated, against what is wanted.

    Raises InputError if the nest says of a part how it was compensated, and that cannot be understood.
    """
    own = np.array(nest.owners, dtype=np.int64)[moved.contour]
    return tuple(_error(part, moved, np.flatnonzero(own == k)) for k, part in enumerate(nest.parts))


def _error(part: Part, moved: Moved, which: Ints) -> PartError:
    xy, contour, length_mm = moved.xy[which], moved.contour[which], moved.length_mm[which]
    if len(which) < LEAST_FITTED:
        return PartError(part.id, None, None, None, contour, xy, np.zeros_like(xy), length_mm)
    change = change_of(part)
    off = fit_rigid(xy, moved.off[which] + (0.0 if change is None else change.at(xy)), length_mm)
    size = np.hypot(off[:, 0], off[:, 1])
    worst = int(np.argmax(size))
    rms = float(np.sqrt(np.average(size**2, weights=length_mm)))
    at = (float(xy[worst, 0]), float(xy[worst, 1]))
    return PartError(part.id, float(size[worst]), rms, at, contour, xy, off, length_mm)
