"""What the first and the last stretch of every candidate's path face (Petunin 2009, section 2.1).

The path runs once round the contour from the entry, or along a stretch of it, so its head and tail are stretches of
the boundary; leads and overcut are left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.ranges import laid_out

from .facts import Facing, Stretch
from .neighbours import Outlook
from .outlines import Outlines
from .rays import NOTHING
from .sums import summed_by, summed_by_pair


@dataclass(frozen=True, eq=False, slots=True)
class Runs:
    """Longest stretches of boundary that face one thing, solid ones left out; those of contour i from `first[i]`."""

    from_mm: Floats
    to_mm: Floats
    faces: Ints
    first: Ints


def runs_of(outlook: Outlook) -> Runs:
    """Join the cells that follow each other and face the same."""
    cells, faces = outlook.cells, outlook.faces
    new = (np.diff(cells.contour, prepend=-1) != 0) | (np.diff(faces, prepend=NOTHING - 1) != 0)
    begin = np.flatnonzero(new)
    last = np.append(begin[1:], len(faces)) - 1 if len(faces) else begin
    facing = faces[begin] != NOTHING
    begin, last = begin[facing], last[facing]
    return Runs(
        from_mm=cells.from_mm[begin],
        to_mm=cells.from_mm[last] + cells.length_mm[last],
        faces=faces[begin],
        first=np.searchsorted(cells.contour[begin], np.arange(outlook.n + 1)),
    )


def stretch_of(
    outlines: Outlines, runs: Runs, candidates: Sequence[Candidate], share: float, part: Literal["head", "tail"]
) -> Stretch:
    """What the first or last `share` of each candidate's path faces; everything but edges and neighbours is solid."""
    m, n = len(candidates), outlines.n
    contour = np.fromiter((c.contour for c in candidates), np.int64, m)
    entry_mm = np.fromiter((c.entry_mm for c in candidates), np.float64, m)
    is_ccw = np.fromiter((c.direction == "ccw" for c in candidates), np.bool_, m)
    as_drawn = is_ccw == outlines.is_ccw[contour]
    around_mm = outlines.length_mm[contour]
    way_mm = np.array([np.nan if c.along_mm is None else c.along_mm for c in candidates], dtype=np.float64)
    total_mm = share * np.where(np.isnan(way_mm), around_mm, way_mm)
    after_entry = as_drawn if part == "head" else ~as_drawn
    begin_mm = np.where(after_entry, entry_mm, entry_mm - total_mm)
    if part == "tail":  # once round it ends where it begins
        begin_mm += np.nan_to_num(np.where(as_drawn, way_mm, -way_mm))
    begin_mm %= around_mm

    count = (runs.first[1:] - runs.first[:-1])[contour]
    run = laid_out(runs.first[contour], count)
    row = np.repeat(np.arange(m), count)
    low, high = begin_mm[row], (begin_mm + total_mm)[row]
    faced_mm = np.zeros(len(run))
    for lap_mm in (0.0, around_mm[row]):  # a stretch that passes the contour's first point goes on in a second lap
        overlap_mm = np.minimum(high, runs.to_mm[run] + lap_mm) - np.maximum(low, runs.from_mm[run] + lap_mm)
        faced_mm += np.maximum(overlap_mm, 0.0)

    touched = faced_mm > 0
    row, faces, faced_mm = row[touched], runs.faces[run[touched]], faced_mm[touched]
    at_edge = faces >= n
    edge_mm = summed_by(row[at_edge], faced_mm[at_edge], m)
    row, neighbour, length_mm = summed_by_pair(row[~at_edge], faces[~at_edge], faced_mm[~at_edge], n)
    solid_mm = total_mm - edge_mm - summed_by(row, length_mm, m)
    gap_mm = np.full(len(row), np.nan)
    return Stretch(total_mm, edge_mm, np.maximum(solid_mm, 0.0), Facing(row, neighbour, length_mm, gap_mm))
