"""The metal over time: one piece at first, then what holds to the sheet's frame and what has come loose."""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.tests.metal.tolerances import CRUMB_MM2, CRUMB_WIDTH_MM, HOLDS_MM, NUMERIC_MM


class Pieces:
    """The pieces of a sheet; each burn takes metal away, and what it cuts off from the frame is loose from then on.

    The frame is the largest piece with some of the sheet's border; a piece with `HOLDS_MM` of the border holds too.
    """

    def __init__(self, sheet: shapely.Polygon) -> None:
        self.bounds = sheet.bounds
        self.border = sheet.exterior.buffer(NUMERIC_MM)
        self.held: list[shapely.Polygon] = [sheet]
        self.loose: list[shapely.Polygon] = []

    def burn(self, kerf: shapely.Geometry) -> None:
        """Take `kerf` away."""
        if self.loose and (hit := np.flatnonzero(shapely.intersects(self.loose, kerf)).tolist()):
            apart = [p for k in hit for p in _polygons(self.loose[k], kerf) if _is_metal(p)]
            self.loose = [piece for k, piece in enumerate(self.loose) if k not in hit] + apart
        touched = shapely.intersects(self.held, kerf).tolist()
        left = [p for piece, hit in zip(self.held, touched, strict=True) if hit for p in _polygons(piece, kerf)]
        untouched = [piece for piece, hit in zip(self.held, touched, strict=True) if not hit]
        if len(left) < 2 and not untouched:
            self.held = left
            return
        largest_first = sorted(untouched + left, key=lambda piece: -piece.area)
        frame = max(largest_first, key=self._on_border) if largest_first else None
        self.held = []
        for piece in largest_first:
            if piece is frame or self._border_mm(piece) >= HOLDS_MM:
                self.held.append(piece)
            elif _is_metal(piece):
                self.loose.append(piece)

    def under(self, line: shapely.Geometry) -> list[tuple[shapely.Polygon, shapely.Geometry]]:
        """Loose pieces that a line (or point) lies on, each with the stretch."""
        if not self.loose:
            return []
        hits = np.flatnonzero(shapely.intersects(self.loose, line)).tolist()
        return [(self.loose[k], self.loose[k].intersection(line)) for k in hits]

    def _on_border(self, piece: shapely.Polygon) -> bool:
        return piece.bounds == self.bounds or self._border_mm(piece) > 0

    def _border_mm(self, piece: shapely.Polygon) -> float:
        """How much of the sheet's border a piece has."""
        return float(piece.exterior.intersection(self.border).length) if piece.intersects(self.border) else 0.0


def _polygons(piece: shapely.Polygon, kerf: shapely.Geometry) -> list[shapely.Polygon]:
    return [p for p in shapely.get_parts(piece.difference(kerf)) if isinstance(p, shapely.Polygon) and not p.is_empty]


def _is_metal(piece: shapely.Polygon) -> bool:
    """Whether a piece is more than dross."""
    return bool(piece.area > CRUMB_MM2 and not piece.buffer(-CRUMB_WIDTH_MM / 2).is_empty)
