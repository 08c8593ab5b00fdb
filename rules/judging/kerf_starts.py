"""Cuts that begin in the kerf of an older one, where there is nothing to pierce."""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.tolerance import tolerance_mm

from .pierce_places import SLACK_MM


def in_older_kerfs(nest: Nest, cuts: CutSequence, kerf_mm: float) -> frozenset[int]:
    """Positions of the cuts along a stretch of a contour that begin on the torch's way round one that is out.

    Examples
    --------
    >>> from kerfwise.encoder.by_hand import nest, part, rect
    >>> from kerfwise.encoder.cut import Span
    >>> two = nest(200, 100, part("A", rect(10, 10, 50, 50)), part("B", rect(61.5, 10, 50, 50)))
    >>> first = Cut("A.outer", (10, 10), "ccw", (4, 4))
    >>> then = Cut("B.outer", (61.5, 10), "ccw", (60.75, 10), span=Span((60.75, 10), (60.75, 60)))
    >>> in_older_kerfs(two, CutSequence((first, then)), 1.5), in_older_kerfs(two, CutSequence((then, first)), 1.5)
    (frozenset({2}), frozenset())
    """
    rows = [(k, cut) for k, cut in enumerate(cuts, 1) if _may_be(cut, kerf_mm)]
    if not rows:
        return frozenset()
    position = cuts.positions()
    older = [(position[c.id], c) for c in nest.contours if c.kind == "outer" and c.id in position]
    points = shapely.points(np.array([cut.pierce for _, cut in rows]))
    tree = shapely.STRtree([contour.line for _, contour in older])
    within_mm = kerf_mm / 2 + tolerance_mm(kerf_mm) + SLACK_MM
    row, met = tree.query(points, "dwithin", distance=within_mm)
    found = zip(row.tolist(), met.tolist(), strict=True)
    return frozenset(rows[r][0] for r, m in found if older[m][0] < rows[r][0] and older[m][1].id != rows[r][1].contour)


def _may_be(cut: Cut, kerf_mm: float) -> bool:
    """Whether a cut follows a stretch of its contour, from where it begins, or from over the kerf beside a corner."""
    leads = (lead for lead in (cut.lead_in, cut.lead_out) if lead is not None)
    return cut.span is not None and not cut.linked and all(lead.length_mm <= 2 * kerf_mm for lead in leads)
