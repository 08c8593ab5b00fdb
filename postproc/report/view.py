"""Where the millimetres of a nest fall on the page, and how fine a pen the picture needs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import ArrayLike

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.curve import Curve, flattened
from kerfwise.encoder.geometry.segment import Point

Window = tuple[float, float, float, float]

PAGE_WIDTH = 1600.0
MARGIN = 28.0
HEADER = 70.0
FOOTER = 62.0
_MAX_DRAWING_HEIGHT = 1240.0
_MIN_PAGE_WIDTH = 1080.0
_CHORD = 0.03  # page units that a flattened line may stray from its curve: not seen at ten times the size


@dataclass(frozen=True, slots=True)
class View:
    """A window of the nest (xmin, ymin, xmax, ymax in mm) on a page; `pitch` is the room a contour has, page units.

    The window begins at `left` and `top` of the page.
    """

    window: Window
    scale: float
    left: float
    width: float
    height: float
    pitch: float
    top: float = HEADER

    @staticmethod
    def of(window: Window, contours: int, used_mm2: float) -> View:
        """Fit the window on a page of usual size; `contours` are seen in it, on a rectangle of `used_mm2`."""
        x0, y0, x1, y1 = window
        wide, high = max(x1 - x0, 1e-6), max(y1 - y0, 1e-6)
        scale = min((PAGE_WIDTH - 2 * MARGIN) / wide, _MAX_DRAWING_HEIGHT / high)
        width = max(wide * scale + 2 * MARGIN, _MIN_PAGE_WIDTH)
        pitch = scale * math.sqrt(used_mm2 / max(contours, 1))
        return View(window, scale, (width - wide * scale) / 2, width, high * scale + HEADER + FOOTER, pitch)

    def xy(self, points: ArrayLike) -> Floats:
        """Points (n, 2) in mm as page points."""
        p = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        x0, _, _, y1 = self.window
        return np.column_stack([(p[:, 0] - x0) * self.scale + self.left, (y1 - p[:, 1]) * self.scale + self.top])

    def point(self, point: Sequence[float]) -> Point:
        """One point in mm as a page point."""
        x0, _, _, y1 = self.window
        return float((point[0] - x0) * self.scale + self.left), float((y1 - point[1]) * self.scale + self.top)

    def path(self, curve: Curve) -> Floats:
        """A curve as page points, no more than the eye can tell; a closed one does not repeat its first."""
        return self.paths([curve])[0]

    def paths(self, curves: Sequence[Curve]) -> list[Floats]:
        """As `path` of each, made together."""
        if not curves:
            return []
        tolerance_mm = _CHORD / self.scale
        points = flattened(curves, tolerance_mm)
        closed = np.array([curve.closed for curve in curves], dtype=np.bool_)
        wide = np.array([len(own) >= 3 for own in points], dtype=np.bool_)
        for some, made in ((wide & closed, shapely.linearrings), (wide & ~closed, shapely.linestrings)):
            chosen = np.flatnonzero(some).tolist()
            if not chosen:
                continue
            own = [points[k] for k in chosen]
            lines = made(np.concatenate(own), indices=np.repeat(np.arange(len(own)), [len(p) for p in own]))
            rows, of = shapely.get_coordinates(shapely.simplify(lines, tolerance_mm), return_index=True)
            last = np.searchsorted(of, np.arange(len(own)), side="right")
            for k, begin, end in zip(chosen, [0, *last.tolist()], last.tolist(), strict=False):
                points[k] = rows[begin : end - bool(closed[k])]
        return np.split(self.xy(np.concatenate(points)), np.cumsum([len(own) for own in points])[:-1])

    @property
    def mm(self) -> float:
        """Millimetres in one page unit."""
        return 1 / self.scale

    @property
    def line_width(self) -> float:
        """Width of a contour line, page units."""
        return min(max(0.014 * self.pitch, 0.4), 1.4)

    @property
    def number_size(self) -> float:
        """Font size of order numbers where there is room for it, page units."""
        return min(max(0.22 * self.pitch, 6.5), 15.0)

    @property
    def dot_radius(self) -> float:
        """Radius of a pierce point, page units."""
        return min(max(0.025 * self.pitch, 0.9), 3.0)

    @property
    def arrow_size(self) -> float:
        """Length of an arrow head, page units."""
        return min(max(0.1 * self.pitch, 3.0), 9.0)
