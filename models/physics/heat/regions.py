"""The sheet by the contour that lies nearest: where an overheat is says whose order it has to do with."""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.arrays import Ints
from kerfwise.encoder.nest import Nest

from .grid import Grid
from .result import HeatResult


def hot_contours(nest: Nest) -> Ints:
    """Numbers of the contours that heat the sheet: all but marks."""
    return np.array([k for k, contour in enumerate(nest.contours) if contour.kind != "mark"], dtype=np.int64)


class Regions:
    """Points of a grid by the nearest contour that is no mark.

    Parameters
    ----------
    nest
        Sheet and parts.
    grid
        That of `make_grid`.
    """

    def __init__(self, nest: Nest, grid: Grid) -> None:
        self._hot, self._n, self._grid = hot_contours(nest), len(nest.contours), grid
        self._tree = shapely.STRtree([nest.contours[k].line for k in self._hot])

    def count(self, found: HeatResult) -> Ints:
        """Overheats near each contour, (n,), by contour number."""
        grid = self._grid
        i, j = np.nonzero(found.counted & (found.run.peak_c > found.limit_c))
        if not len(i):
            return np.zeros(self._n, dtype=np.int64)
        points = shapely.points(grid.x0_mm + grid.step_mm * i, grid.y0_mm + grid.step_mm * j)
        return np.bincount(self._hot[self._tree.nearest(points)], minlength=self._n).astype(np.int64)
