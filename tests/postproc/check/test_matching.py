"""Which contour a path cuts, where it passes along something small besides."""

from __future__ import annotations

import shapely

from kerfwise.postproc.check.matching import Matcher
from kerfwise.rules.case import nest, part, rect


def test_a_burn_whose_lead_runs_along_a_tiny_scrap_line_cuts_its_part_all_the_same() -> None:
    """It stops short of its tab, so that it does not cover its ring all round, but does cover the line."""
    sheet = nest(120, 120, part("A", rect(20, 20, 60, 60)), scrap=[[(10, 50), (10.2, 50)]])
    burn = shapely.LineString([(9, 50), (19.5, 50), (19.5, 80.5), (80.5, 80.5), (80.5, 19.5), (19.5, 19.5), (19.5, 48)])
    (match,) = Matcher(sheet, 1.0).match([burn], [False], [None])
    assert match is not None
    assert sheet.contours[match.contour].id == "A.outer"
    (match,) = Matcher(sheet, 1.0).match([sheet.scrap[0].line], [False], [None])
    assert match is not None
    assert sheet.contours[match.contour].id == "scrap1"
