"""Links round a corner: two straight pieces, between parts that no straight link joins."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kerfwise.arrays import Floats, Ints

from .link_lines import LinkLines, Places

_WAYS = 12
"""Ways from one part to another that corners are tried for: the nearest ends and joins."""
_ALONG = (0.5, 1.5, 3.0, 5.0)
_ASIDE = (1.5, 2.5, 4.0, 6.0)
"""Corners near one of the ends: so many kerfs along the straight line, and so many beside it."""
_SHARES = ((0.25, 0.15), (0.25, 0.3), (0.5, 0.15), (0.5, 0.3), (0.5, 0.45), (0.75, 0.15), (0.75, 0.3))
"""Other corners: shares of the straight line, along it and beside it."""
_CLEAR_KERFS = 1.1
"""Both pieces are longer: the first kerf of a link may lie in what was just burnt."""


def round_corners(
    asked: LinkLines,
    straight: LinkLines,
    leave: Places,
    reach: Places,
    longest_mm: float,
    kerf_mm: float,
    free: Callable[[LinkLines], LinkLines],
) -> LinkLines:
    """The shortest free ways round one corner, between contours that have no straight link.

    Parameters
    ----------
    asked, straight
        All straight lines, and those that are free.
    leave, reach
        The places that they join.
    longest_mm, kerf_mm
        The longest link, and the width of the kerf.
    free
        Leaves out the links that something is in the way of.
    """
    pairs = asked.take(_nearest(asked, straight, leave, reach))
    corners = _corners(pairs.points[:, 0], pairs.points[:, 1], kerf_mm)
    way, number = np.nonzero(np.isfinite(corners[..., 0]))
    bent = pairs.take(way).round(corners[way, number])
    short = bent.length_mm <= longest_mm
    found = free(bent.take(short))
    # of each way the shortest; of ways as long the first
    order = np.lexsort((np.arange(len(found)), found.length_mm, found.other, found.one))
    same = (np.diff(found.one[order]) == 0) & (np.diff(found.other[order]) == 0)
    return found.take(np.sort(order[np.append(True, ~same)[: len(order)]]))


def _nearest(asked: LinkLines, straight: LinkLines, leave: Places, reach: Places) -> Ints:
    """The numbers of the lines between contours without a straight link, the nearest few of each two contours."""
    n = int(max(leave.contour.max(initial=0), reach.contour.max(initial=0))) + 1
    of = leave.contour[asked.one] * n + reach.contour[asked.other]
    joined = np.unique(leave.contour[straight.one] * n + reach.contour[straight.other])
    rows = np.flatnonzero(~np.isin(of, joined))
    rows = rows[np.lexsort((rows, asked.length_mm[rows], of[rows]))]
    begins = np.flatnonzero(np.append(True, np.diff(of[rows]) != 0)[: len(rows)])
    rank = np.arange(len(rows)) - np.repeat(begins, np.diff(np.append(begins, len(rows))))
    return np.sort(rows[rank < _WAYS])


def _corners(begin: Floats, end: Floats, kerf_mm: float) -> Floats:
    """Where k links could turn, (k, c, 2): nan where a piece is too short, or the turn more than a right angle."""
    step = end - begin
    gap_mm = np.hypot(*step.T)[:, None]
    along = step / gap_mm
    aside = np.column_stack([-along[:, 1], along[:, 0]])
    near = [(a * kerf_mm, side * b * kerf_mm) for a in _ALONG for b in _ASIDE for side in (1, -1)]
    from_begin, beside = (np.array(values)[None] for values in zip(*near, strict=True))
    shares = [(t, side * h) for t, h in _SHARES for side in (1, -1)]
    share, width = (np.array(values)[None] for values in zip(*shares, strict=True))
    x = np.concatenate([from_begin + 0 * gap_mm, gap_mm - from_begin, share * gap_mm], axis=1)
    y = np.concatenate([beside + 0 * gap_mm, beside + 0 * gap_mm, width * gap_mm], axis=1)
    corners: Floats = begin[:, None] + x[..., None] * along[:, None] + y[..., None] * aside[:, None]
    short = np.minimum(np.hypot(x, y), np.hypot(gap_mm - x, y)) < _CLEAR_KERFS * kerf_mm
    corners[short | (x * (gap_mm - x) < y * y)] = np.nan
    return corners
