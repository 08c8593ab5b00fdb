"""How much rigid metal the end of a cut faces, by plain geometry: the judging half of rule part-rigidity."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.kept import kept_with_nest
from kerfwise.encoder.nest import Contour, Nest

from .facing import EDGE, Stretch, facing, spots_along, spots_along_each
from .followed import every_followed

STEP_MM, LEAST_SPOTS, MOST_SPOTS = 1.0, 100, 200
"""The end of a cut is looked at a millimetre apart, in no less and no more spots than these."""
ROUND = 400
"""Spots on a whole contour."""


def rigid_at_the_end(
    nest: Nest, cuts: CutSequence, tail_share: float, web_mm: float, edge_band_mm: float
) -> Iterator[tuple[int, float]]:
    """Position of the cut of each outer contour, and the share of its end that faces solid metal or parts still in."""
    cut_at = np.full(len(nest.parts), len(cuts) + 1)
    judged: list[tuple[int, int]] = []
    asked: list[tuple[Contour, Cut]] = []
    for k, cut in enumerate(cuts, 1):
        contour = nest.contour(cut.contour)
        if contour.kind != "outer":
            continue
        part = nest.owners[nest.index[cut.contour]]
        cut_at[part] = k
        judged.append((k, part))
        asked.append((contour, cut))
    tails: list[Stretch] = []
    for (_, part), (contour, _), way in zip(judged, asked, every_followed(asked), strict=True):
        end_mm, tail_mm = way.stretch(tail_share, last=True)
        count = min(max(math.ceil(abs(tail_mm) / STEP_MM), LEAST_SPOTS), MOST_SPOTS)
        tails.append((part, contour.line, end_mm, tail_mm, count))
    faced = facing(nest, web_mm, edge_band_mm).faced(spots_along_each(tails))
    begin = 0
    for (k, _), (*_, count) in zip(judged, tails, strict=True):
        met = faced[begin : begin + count]
        begin += count
        still_in = cut_at[np.maximum(met, 0)] > k
        yield k, float(np.where(met >= 0, still_in, met != EDGE).mean())


@kept_with_nest(most=2)
def _rounds(nest: Nest, web_mm: float, edge_band_mm: float) -> dict[int, Ints]:
    """Part number → what it faces in `ROUND` spots all the way round, for the parts that were asked about."""
    return {}


def rigid_at_best(
    nest: Nest, contour: str, out: frozenset[str], tail_share: float, web_mm: float, edge_band_mm: float
) -> float:
    """The greatest share of rigid metal at the end of any way round from any entry, once the contours `out` are cut."""
    part, rounds = nest.owners[nest.index[contour]], _rounds(nest, web_mm, edge_band_mm)
    if part not in rounds:
        line = nest.parts[part].outer.line
        rounds[part] = facing(nest, web_mm, edge_band_mm).faced(spots_along(part, line, 0.0, line.length, ROUND))
    faced = rounds[part]
    free = [EDGE, *(k for k in np.unique(faced[faced >= 0]).tolist() if nest.parts[k].outer.id in out)]
    rigid = np.concatenate([[0], np.cumsum(np.tile(~np.isin(faced, free), 2))])
    tail = max(1, round(tail_share * ROUND))
    return float((rigid[tail:] - rigid[:-tail]).max() / tail)
