"""The facts of some contours of a nest: those of the whole, by numbers of their own. Nothing is measured anew."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.nest import Nest

from .facts import Facing, Facts, Stretch


def numbered(count: int, left: Ints | Sequence[int]) -> Ints:
    """The new number of each of `count` things when those of `left` alone stay, in that order; -1 for others.

    Examples
    --------
    >>> numbered(4, [1, 3]).tolist()
    [-1, 0, -1, 1]
    """
    number = np.full(count, -1, dtype=np.int64)
    number[left] = np.arange(len(left))
    return number


def kept_candidates(whole: Facts, number: Ints) -> list[int]:
    """The candidates of contours that stay."""
    return [k for k, candidate in enumerate(whole.candidates) if number[candidate.contour] >= 0]


def narrowed(whole: Facts, nest: Nest, number: Ints) -> Facts:
    """The facts of a nest that has some contours of the whole one, `number` from theirs to its own.

    Boundary that faces contours which are not there faces neither a neighbour nor solid metal; the start side and the
    zones are those of the whole sheet.
    """
    left = np.flatnonzero(number >= 0)
    kept = kept_candidates(whole, number)
    candidate = numbered(len(whole.candidates), kept)

    def pairs(given: Ints) -> Ints:
        there = (number[given] >= 0).all(axis=1)
        return np.asarray(number[given[there]], dtype=np.int64).reshape(-1, 2)

    def facing(given: Facing, rows: Ints) -> Facing:
        row = rows[given.row]
        there = (number[given.neighbour] >= 0) & (row >= 0)
        return Facing(row[there], number[given.neighbour[there]], given.length_mm[there], given.gap_mm[there])

    def stretch(given: Stretch) -> Stretch:
        faced = facing(given.neighbours, candidate)
        return Stretch(given.total_mm[kept], given.edge_mm[kept], given.solid_mm[kept], faced)

    met = whole.older_kerfs.of_kept(kept, len(whole.candidates))
    there = number[met.rings[:, 1]] >= 0
    parent = whole.parent[left]
    candidates = tuple(replace(whole.candidates[k], contour=int(number[whole.candidates[k].contour])) for k in kept)
    return replace(
        whole,
        nest=nest,
        parent=np.where(parent >= 0, number[parent], -1),
        contains=pairs(whole.contains),
        level_ahead=pairs(whole.level_ahead),
        in_hull=pairs(whole.in_hull),
        neighbours=facing(whole.neighbours, number),
        edge_gap_mm=whole.edge_gap_mm[left],
        edge_length_mm=whole.edge_length_mm[left],
        solid_mm=whole.solid_mm[left],
        long=whole.long[left],
        zone=whole.zone[left],
        torch_heat_kj=whole.torch_heat_kj[left],
        candidates=candidates,
        first=np.searchsorted(np.array([c.contour for c in candidates], dtype=np.int64), np.arange(len(left) + 1)),
        head=stretch(whole.head),
        tail=stretch(whole.tail),
        scrap_framed=whole.scrap_framed[left],
        scrap_beside=pairs(whole.scrap_beside),
        older_kerfs=replace(met, rings=np.column_stack([met.rings[there, 0], number[met.rings[there, 1]]])),
    )
