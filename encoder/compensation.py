"""Where the torch's centre runs around a contour: half the kerf into the waste."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.offset import offset_curve, offset_together

from .errors import InputError
from .nest import Contour


@lru_cache(maxsize=1 << 15)
def compensated(contour: Contour, kerf_mm: float) -> Curve:
    """The path of the torch's centre: half the kerf outside an outer contour, inside a hole, on marks and slits.

    Runs the same way round as the contour is drawn. Answers are kept, since candidates, plans and programs all ask.

    Raises
    ------
    InputError
        If the kerf leaves nothing of the contour to cut.

    Examples
    --------
    >>> hole = Contour("P.hole1", "P", "hole", Curve.of([(0, 0), (9, 0), (9, 9), (0, 9)]))
    >>> compensated(hole, 2.0).as_rows()
    [[1.0, 1.0], [8.0, 1.0], [8.0, 8.0], [1.0, 8.0]]
    """
    if not contour.encloses or kerf_mm == 0:
        return contour.curve
    try:
        return offset_curve(contour.curve, _outwards_mm(contour, kerf_mm))
    except ValueError as error:
        x, y = contour.curve.vertices[0, :2].tolist()
        raise InputError(
            f"{contour.id} at ({x:.1f}, {y:.1f}) cannot be cut with a kerf of {kerf_mm:g} mm: {error}; "
            "it needs another process, or another drawing"
        ) from None


def compensate_together(contours: Iterable[Contour], kerf_mm: float) -> None:
    """Look for the paths beside contours in one go, so that `compensated` finds most of them made."""
    rings = [c for c in contours if c.encloses]
    offset_together([c.curve for c in rings], [_outwards_mm(c, kerf_mm) for c in rings])


def _outwards_mm(contour: Contour, kerf_mm: float) -> float:
    return kerf_mm / 2 if contour.kind == "outer" else -kerf_mm / 2
