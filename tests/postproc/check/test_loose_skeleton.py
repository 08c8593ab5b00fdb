"""Scrap lines that a program cuts in loose metal: which piece is the frame, whatever leads and webs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely

from kerfwise.encoder.facts.facts import FactOptions
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.scrap import with_scrap
from kerfwise.postproc.check.loose_metal import cuts_in_loose_skeleton
from kerfwise.postproc.check.plan_runs import runs_from_cuts
from kerfwise.rules.case import in_order, nest, part, rect
from kerfwise.rules.catalogue.scrap_last.skeleton import skeleton_of
from kerfwise.rules.judging.holding import bounding, loose_scrap_cuts

KERF_MM = 1.0
A = part("A", rect(90, 6, 8, 8))
ROW = nest(440, 20, A, scrap=[[(x, 0), (x, 20)] for x in (50, 160, 260, 360)])
"""The piece from 50 to 160 is the largest, but only a little, for A lies in it."""


def loose(sheet: Nest, order: str, lead: list[tuple[float, float]] | None = None) -> list[str]:
    """What the check finds, the first cut with a lead."""
    runs = list(runs_from_cuts(sheet, in_order(sheet, order), KERF_MM)[0])
    if lead:
        runs[0] = replace(runs[0], lead_in=shapely.LineString(lead))
    return [v.contours[0] for v in cuts_in_loose_skeleton(sheet, runs, (), KERF_MM)]


@pytest.mark.parametrize("lead", [None, [(60, 17), (120, 17), (120, 3), (60, 3)]])
def test_a_lead_in_the_frame_does_not_make_another_piece_the_frame(lead: list[tuple[float, float]] | None) -> None:
    assert loose(ROW, "A.outer scrap4 scrap3 scrap2 scrap1", lead) == []
    assert loose(ROW, "A.outer scrap2 scrap3 scrap4 scrap1", lead) == ["scrap3", "scrap4"]


def webbed(web_mm: float) -> Nest:
    """Two plates with so much metal between their kerfs, and a grid over the sheet."""
    left = part("A", [(5, 5), (105, 5), (105, 25), (45, 25), (45, 95), (105, 95), (105, 115), (5, 115)])
    right = part("B", rect(107 + web_mm, 5, 40, 110))
    return with_scrap(nest(250, 120, left, right), KERF_MM, 50.0, None)


def test_no_line_is_made_in_a_web_that_the_kerf_would_burn_away() -> None:
    def across(web_mm: float) -> list[float]:
        lines = shapely.bounds([line.line for line in webbed(web_mm).scrap])
        return sorted(lines[(lines[:, 0] > 104) & (lines[:, 2] < 109), 2] - lines[0, 0])

    assert len(across(1.5)) > 0
    assert across(0.3) == []


@pytest.mark.parametrize("web_mm", [0.3, 1.5])
def test_what_only_narrow_webs_hold_is_not_the_frame(web_mm: float) -> None:
    """Between the arms of A lies more than in any piece of the grid."""
    sheet = webbed(web_mm)
    framed, pairs = bounding(sheet, KERF_MM)
    facts, ids = skeleton_of(sheet, FactOptions(kerf_mm=KERF_MM)), [c.id for c in sheet.contours]
    assert {ids[k] for k in np.flatnonzero(facts["scrap_framed"].values)} == framed != set()
    assert {(ids[a], ids[b]) for a, b in facts["scrap_beside"].values.tolist()} == pairs
    done = sorted(framed)[:1]
    while ready := sorted({a for a, b in pairs if b in done} - {*done}):
        done.append(ready[0])
    done += sorted({line.id for line in sheet.scrap} - {*done})
    order = " ".join(["A.outer B.outer", *done[::-1]])
    assert list(loose_scrap_cuts(sheet, in_order(sheet, order), KERF_MM)) == []
    assert loose(sheet, order) == []


def test_a_line_in_a_narrow_web_may_be_cut_at_any_time() -> None:
    plates = (part("A", rect(10, 20, 50, 60)), part("B", rect(62.3, 20, 40, 60)))
    web, upright = [(61, 50), (61.3, 50)], [(150.0, 0.0), (150.0, 100.0)]
    sheet = nest(300, 100, *plates, scrap=[web, upright])
    assert bounding(sheet, KERF_MM)[0] == {"scrap1", "scrap2"}
    framed = skeleton_of(sheet, FactOptions(kerf_mm=KERF_MM))["scrap_framed"]
    assert framed.values.tolist() == [False, False, True, True]
    for order in ("scrap1 scrap2", "scrap2 scrap1"):
        assert loose(sheet, f"A.outer B.outer {order}") == []
        assert list(loose_scrap_cuts(sheet, in_order(sheet, f"A.outer B.outer {order}"), KERF_MM)) == []
