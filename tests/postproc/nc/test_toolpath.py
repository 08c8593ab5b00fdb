"""The torch's path: by hand, from written plans, and for random candidates."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from kerfwise.encoder.candidates import Candidate, LeadOptions, build_candidates
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.torch_path import compensated
from kerfwise.postproc.nc.toolpaths import torch_path
from kerfwise.rules.case import circle, part, rect
from kerfwise.tests.encoder.candidates.lead_nests import lead_nests, lead_options
from kerfwise.tests.tools.amount import examples

DRAWN = part("A", rect(0, 0, 40, 40), [circle(20, 20, 5)], [[(2, 2), (9, 2, 0.2), (9, 9)]])


def cut_of(plate: Nest, c: Candidate) -> Cut:
    return Cut(plate.contours[c.contour].id, c.entry, c.direction, c.pierce, c.lead_in, c.lead_out)


def written(cut: Cut) -> Cut:
    """The cut as a plan file gives it back: 6 decimals."""

    def rounded(curve: Curve | None) -> Curve | None:
        return None if curve is None else Curve(curve.vertices.round(6), curve.closed)

    def point(p: tuple[float, float]) -> tuple[float, float]:
        return round(p[0], 6), round(p[1], 6)

    return dataclasses.replace(
        cut,
        entry=point(cut.entry),
        pierce=point(cut.pierce),
        lead_in=rounded(cut.lead_in),
        lead_out=rounded(cut.lead_out),
    )


def test_a_square_clockwise_with_an_arc_about_each_corner() -> None:
    lead_in = Curve.of([(20, -6), (20, -1)], closed=False)
    lead_out = Curve.of([(20, -1), (18, -3)], closed=False)
    path = torch_path(DRAWN.outer, Cut("A.outer", (20, 0), "cw", (20, -6), lead_in, lead_out), 2.0)
    rows = [[round(v, 6) + 0.0 for v in row] for row in path.vertices.tolist()]
    corner = -round(math.tan(math.pi / 8), 6)
    assert rows == [
        [20, -6, 0], [20, -1, 0], [0, -1, corner], [-1, 0, 0], [-1, 40, corner], [0, 41, 0], [40, 41, corner],
        [41, 40, 0], [41, 0, corner], [40, -1, 0], [20, -1, 0], [18, -3, 0],
    ]  # fmt: skip
    assert not path.closed


def test_a_hole_stays_two_arcs_and_is_cut_on() -> None:
    hole = DRAWN.holes[0]
    overcut = compensated(hole, 2.0).between(0.0, 1.0)
    lead_in = Curve.of([(20, 20), (16, 20)], closed=False)
    path = torch_path(hole, Cut("A.hole1", (15, 20), "ccw", (20, 20), lead_in, overcut), 2.0)
    assert [s.is_arc for s in path.segments] == [False, True, True, True]
    assert path.length_mm == pytest.approx(4 + math.tau * 4 + 1)


def test_without_leads_it_is_the_round_alone() -> None:
    path = torch_path(DRAWN.outer, Cut("A.outer", (0, 0), "ccw", (0, 0)), 0.0)
    assert path.as_rows() == [[0, 0], [40, 0], [40, 40], [0, 40], [0, 0]]


def test_a_join_at_a_corner_of_the_path_makes_no_speck() -> None:
    hole = part("A", rect(0, 0, 40, 40), [rect(10, 10, 20, 20)]).holes[0]
    lead_in = Curve.of([(20, 20), (11.000001, 10.999999)], closed=False)
    path = torch_path(hole, Cut("A.hole1", (10, 10), "ccw", (20, 20), lead_in), 2.0)
    assert len(path.segments) == 5
    assert min(s.length_mm for s in path.segments) > 1


def test_an_open_mark_is_its_line_either_way() -> None:
    mark = DRAWN.marks[0]
    there = torch_path(mark, Cut("A.mark1", (2, 2), "ccw", (2, 2)), 2.0)
    back = torch_path(mark, Cut("A.mark1", (9, 9), "cw", (9, 9)), 2.0)
    assert there.as_rows() == [[2, 2], [9, 2, 0.2], [9, 9]]
    assert back.as_rows() == [[9, 9, -0.2], [9, 2], [2, 2]]


def test_a_closed_mark_is_followed_round_from_its_entry() -> None:
    mark = Contour("A.mark1", "A", "mark", Curve.of(rect(0, 0, 10, 10)))
    path = torch_path(mark, Cut("A.mark1", (5, 0), "cw", (5, 0)), 2.0)
    assert path.as_rows() == [[5, 0], [0, 0], [0, 10], [10, 10], [10, 0], [5, 0]]


@pytest.mark.slow
@examples(60)
@given(lead_nests(), lead_options(), st.booleans())
def test_the_round_keeps_half_a_kerf_off_its_contour(plate: Nest, options: LeadOptions, from_file: bool) -> None:
    try:
        found = build_candidates(plate, dataclasses.replace(options, entries=2))
    except InputError:
        assume(False)
    for c in found:
        contour, cut = plate.contours[c.contour], cut_of(plate, c)
        path = torch_path(contour, written(cut) if from_file else cut, options.kerf_mm)
        assert path.vertices[0, :2] == pytest.approx(c.pierce, abs=2e-6)
        assert path.vertices[-1, :2] == pytest.approx(c.end, abs=2e-6)
        assert len(path.segments) == len(path.vertices) - 1
        assert min(s.length_mm for s in path.segments) > 1e-6
        assert path.length_mm == pytest.approx(c.cut_mm, abs=1e-3)
        assert c.lead_in is not None
        assert c.lead_out is not None
        once_round = path.between(c.lead_in.length_mm, path.length_mm - c.lead_in.length_mm - c.lead_out.length_mm)
        points = shapely.points(once_round.flatten(0.002))
        off_mm = shapely.distance(points, contour.curve.line(0.0005)) - options.kerf_mm / 2
        assert np.abs(off_mm).max() < 0.01
        ring = Curve(once_round.vertices[:-1])
        assert ring.is_ccw == (c.direction == "ccw")
        assert ring.signed_area_mm2 == pytest.approx(
            compensated(contour, options.kerf_mm).towards(c.direction).signed_area_mm2, abs=1e-2
        )
