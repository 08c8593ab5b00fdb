"""The metal of parts whose rings may not lie as they should."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.encoder.nest import Part

from .rings import enclosed, flat


def metal_of(parts: Sequence[Part]) -> NDArray[np.object_]:
    """The area of each part as a valid shape: of its outer contour, less all that its holes enclose."""
    return np.array([_metal(p) for p in parts], dtype=object)


def _metal(part: Part) -> shapely.Geometry:
    if not any(flat(c.curve) for c in (part.outer, *part.holes)) and part.polygon.is_valid:
        return part.polygon
    return enclosed(part.outer.curve).difference(shapely.union_all([enclosed(h.curve) for h in part.holes]))
