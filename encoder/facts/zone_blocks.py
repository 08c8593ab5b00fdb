"""What zones are made of: a part straight on the sheet with everything nested in it never is in two of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest

from .containment import outermost_of
from .facts import FactOptions
from .outlines import Outlines


@dataclass(frozen=True, eq=False, slots=True)
class Blocks:
    """What shares a zone: a part straight on the sheet with everything nested in it.

    `of` (n,) is the block of each contour; `contours` how many it has that are cut through (marks are not), `heat_kj`
    what cutting them leaves in the sheet (0 where nobody knows), `centroid` and `bounds_mm` those of its outer
    contour. Rows (before, after) of `pairs` say which block must not be in a later zone than which.
    """

    of: Ints
    contours: Ints
    heat_kj: Floats
    centroid: Floats
    bounds_mm: Floats
    pairs: Ints


def blocks_of(
    nest: Nest, outlines: Outlines, parent: Ints, respected: Ints, options: FactOptions, heat_kj: Floats
) -> Blocks:
    """The blocks of a nest; `respected` (k, 2) are pairs of contours, (n,) `heat_kj` may be nan.

    Raises
    ------
    InputError
        If `zone_pairs` name an unknown contour.
    """
    tops, of = np.unique(outermost_of(parent), return_inverse=True)
    before, after = of[np.concatenate([respected, locked_pairs(nest, options)])].T
    return Blocks(
        of,
        np.bincount(of[~outlines.is_mark], minlength=len(tops)),
        np.bincount(of, np.nan_to_num(heat_kj)).astype(np.float64),
        outlines.centroid[tops],
        outlines.bounds_mm[tops],
        np.column_stack([before, after])[before != after],
    )


def locked_pairs(nest: Nest, options: FactOptions) -> Ints:
    """The pairs (before, after) of contours that `zone_pairs` name, (k, 2).

    Raises
    ------
    InputError
        If they name an unknown contour.
    """
    pairs = [[_contour(nest, a), _contour(nest, b)] for a, b in options.zone_pairs]
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def _contour(nest: Nest, contour_id: str) -> int:
    if contour_id not in nest.index:
        raise InputError(f"zone_pairs names contour {contour_id!r}, which the nest does not have")
    return nest.index[contour_id]
