"""The whole path of the torch's centre for one cut, from where it is switched on to where it goes off."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from kerfwise.encoder.compensation import compensated
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour
from kerfwise.encoder.torch_way import torch_way

_SPECK_MM = 3e-6
"""Plans are written to 6 decimals: nothing shorter than this is a move."""


def torch_path(contour: Contour, cut: Cut, kerf_mm: float) -> Curve:
    """Lead-in, once round the kerf-compensated contour in the cut's direction, lead-out; arcs stay arcs.

    A cut with a span goes along that stretch of it alone.

    Parameters
    ----------
    contour
        The contour that `cut` is of.
    cut
        Its leads may be rounded to 6 decimals, as plans are written.
    kerf_mm
        Width of the kerf.

    Returns
    -------
    Open curve without segments of no length. An open mark is followed along its line ("ccw") or against it ("cw"), a
    closed one once round from its entry; a slit along its line from the end of its lead-in. Over tabs the path goes on,
    see `unlit_on`; before one at the end of the round it ends.

    Raises
    ------
    InputError
        If the kerf leaves nothing of the contour to cut.

    Examples
    --------
    >>> hole = Contour("P.hole1", "P", "hole", Curve.of([(0, 0), (10, 0), (10, 10), (0, 10)]))
    >>> lead_in = Curve.of([(5, 4), (5, 1)], closed=False)
    >>> torch_path(hole, Cut("P.hole1", (5, 0), "ccw", (5, 4), lead_in), 2.0).as_rows()
    [[5.0, 4.0], [5.0, 1.0], [9.0, 1.0], [9.0, 9.0], [1.0, 9.0], [1.0, 1.0], [5.0, 1.0]]
    """
    if not contour.curve.closed:
        line = contour.curve if cut.direction == "ccw" else contour.curve.reversed()
        return line if cut.lead_in is None else _joined((cut.lead_in, line))
    ring = compensated(contour, kerf_mm).towards(cut.direction)
    way, _ = torch_way(ring, _join(cut), cut.span, cut.tabs, kerf_mm)
    return _joined(path for path in (cut.lead_in, way, cut.lead_out) if path is not None)


def unlit_on(contour: Contour, cut: Cut, kerf_mm: float) -> tuple[tuple[float, float], ...]:
    """The stretches of the torch's path that it makes unlit, over tabs, mm from where it starts."""
    if not cut.tabs:
        return ()
    ring = compensated(contour, kerf_mm).towards(cut.direction)
    _, gaps = torch_way(ring, _join(cut), cut.span, cut.tabs, kerf_mm)
    before_mm = 0.0 if cut.lead_in is None else cut.lead_in.length_mm
    return tuple((before_mm + low, before_mm + high) for low, high in gaps)


def _joined(paths: Iterable[Curve]) -> Curve:
    """One open path of several that follow each other; from the end of each a line leads to the next."""
    rows: list[list[float]] = []
    for path in paths:
        rows += path.vertices.tolist()
        rows[-1][2] = 0.0
    kept = [a for a, b in pairwise(rows) if math.dist(a[:2], b[:2]) > _SPECK_MM]
    return Curve(np.array([*kept, rows[-1]]), closed=False)


def _join(cut: Cut) -> Point:
    """Where the torch joins the contour: the end of the lead-in, else where it is switched on."""
    if cut.lead_in is None:
        return cut.pierce
    x, y = cut.lead_in.vertices[-1, :2].tolist()
    return x, y
