"""Metal that a stopped program has already burnt away: no pierce, and no lead, goes there.

The kerf of every cut that is made, its leads included, is void: a strip of the kerf's width along the torch's path.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.already_cut import AlreadyCut
from kerfwise.encoder.compensation import compensated
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest

from .near import Lines, nearer

CHORD_MM = 0.01
NOBODY = -1


@dataclass(frozen=True, eq=False, slots=True)
class Void:
    """The paths of a torch that have been burnt, `kerf_mm` wide; a pierce keeps half a kerf and `splash_mm` from that.

    `round_of` names the contour whose leads may join a path: the round of a cut that broke off, and is made again.
    """

    paths: shapely.STRtree
    round_of: Ints
    kerf_mm: float
    splash_mm: float = 0.0

    @staticmethod
    def of(nest: Nest, already: AlreadyCut, kerf_mm: float, splash_mm: float = 0.0) -> Void | None:
        """The paths of all that is cut, and of what broke off; marks burn nothing away. None where nothing is burnt."""
        lines: list[shapely.LineString] = []
        round_of: list[int] = []
        burnt = already.cuts if already.broken_off is None else (*already.cuts, already.broken_off)
        for cut in burnt:
            if nest.contour(cut.contour).kind == "mark":
                continue
            own = nest.index[cut.contour] if cut is already.broken_off else NOBODY
            for path, joined in ((cut.lead_in, NOBODY), (_round(nest, cut, kerf_mm), own), (cut.lead_out, NOBODY)):
                if path is not None and path.segments:
                    lines.append(path.line(CHORD_MM))
                    round_of.append(joined)
        return Void(shapely.STRtree(lines), np.array(round_of, dtype=np.int64), kerf_mm, splash_mm) if lines else None

    def clear_pierces(self, points: Floats) -> Bools:
        """Points (m, 2) where a pierce, as wide as the kerf, has metal all around it, and so much to the next kerf.

        Examples
        --------
        >>> void = Void(shapely.STRtree([shapely.LineString([(0, 0), (10, 0)])]), np.array([NOBODY]), 1.5)
        >>> void.clear_pierces(np.array([[5, 1.4], [5, 1.6]])).tolist()
        [False, True]
        """
        clear = np.full(len(points), True)
        clear[nearer(self.paths, shapely.points(points), self.kerf_mm + self.splash_mm)[0]] = False
        return clear

    def clear_leads(self, lines: Lines, contour: Ints) -> Bools:
        """Leads of contours, as lines without the last half kerf before they join, that stay on metal."""
        clear = np.full(len(lines), True)
        row, path = nearer(self.paths, lines, self.kerf_mm / 2)
        clear[row[self.round_of[path] != contour[row]]] = False
        return clear


def _round(nest: Nest, cut: Cut, kerf_mm: float) -> Curve:
    contour = nest.contour(cut.contour)
    try:
        return compensated(contour, kerf_mm)
    except InputError:  # cut with a narrower kerf than today's, which leaves nothing of it
        return contour.curve
