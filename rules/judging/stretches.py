"""What the first and the last stretch of each cut face, and each outline as a whole, by plain geometry."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest

from .facing import EDGE, SOLID, Stretch, facing, spots_along_each
from .followed import every_followed

STEP_MM, LEAST_SPOTS, MOST_SPOTS = 0.5, 200, 2000
"""A stretch is looked at this far apart, in no less and no more spots than these."""


@dataclass(frozen=True, eq=False, slots=True)
class Faced:
    """A stretch of an outer contour: its length, how much of it faces the sheet's edge and solid metal, and the rest:

    contour number → length that faces it.
    """

    total_mm: float
    edge_mm: float
    solid_mm: float
    contours_mm: Mapping[int, float]


def faced_by_cuts(
    nest: Nest, cuts: CutSequence, share: float, web_mm: float, edge_band_mm: float, *, last: bool
) -> dict[int, Faced]:
    """Contour number → what the first (or `last`) share of its cut faces, for each outer contour that is cut."""
    of_cuts = ((nest.contour(cut.contour), cut) for cut in cuts)
    outers = [(contour, cut) for contour, cut in of_cuts if contour.kind == "outer"]
    ways = zip(outers, every_followed(outers), strict=True)
    asked = [(nest.index[contour.id], *way.stretch(share, last=last)) for (contour, _), way in ways]
    return _faced(nest, asked, web_mm, edge_band_mm)


def faced_all_round(nest: Nest, web_mm: float, edge_band_mm: float) -> dict[int, Faced]:
    """Contour number → what the whole outline faces, for each outer contour."""
    outers = [part.outer for part in nest.parts]
    return _faced(nest, [(nest.index[c.id], 0.0, c.line.length) for c in outers], web_mm, edge_band_mm)


def _faced(nest: Nest, asked: list[tuple[int, float, float]], web_mm: float, edge_band_mm: float) -> dict[int, Faced]:
    """What stretches of contours (number, where they begin, how long they are) face."""
    part = {p.id: k for k, p in enumerate(nest.parts)}
    outer = [nest.index[p.outer.id] for p in nest.parts]
    stretches: list[Stretch] = []
    for number, begin_mm, length_mm in asked:
        contour = nest.contours[number]
        count = min(max(math.ceil(abs(length_mm) / STEP_MM), LEAST_SPOTS), MOST_SPOTS)
        stretches.append((part[contour.part], contour.line, begin_mm, length_mm, count))
    met = facing(nest, web_mm, edge_band_mm).faced(spots_along_each(stretches))
    counts = [count for *_, count in stretches]
    found: dict[int, Faced] = {}
    for (number, _, length_mm), own in zip(asked, np.split(met, np.cumsum(counts)[:-1]), strict=True):
        each_mm = abs(length_mm) / len(own)
        values, times = np.unique(own, return_counts=True)
        mm = {int(value): float(count * each_mm) for value, count in zip(values, times, strict=True)}
        edge_mm, solid_mm = mm.pop(EDGE, 0.0), mm.pop(SOLID, 0.0)
        found[number] = Faced(abs(length_mm), edge_mm, solid_mm, {outer[k]: v for k, v in mm.items()})
    return found
