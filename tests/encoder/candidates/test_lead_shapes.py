"""Leads as arrays are the lines and arcs they stand for."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.candidates.entries import Joints, Leads, LeadShape, shaped
from kerfwise.encoder.geometry.segment import Segment

NORTH = Joints(*(np.array(a) for a in ([0], [0.0], [[0.0, 0.0]], [0.0], [[3.0, 4.0]], [[0.0, 1.0]])))
EAST = np.array([[1.0, 0.0]])


def test_a_line_is_turned_towards_where_the_torch_comes_from() -> None:
    leads = shaped(LeadShape("line", 0.0, math.radians(30)), NORTH, EAST, np.array([2.0]), 1.0)
    assert leads.pierce[0] == pytest.approx((3 - 1, 4 + math.sqrt(3)))


def test_lengths_run_from_the_longest_to_the_shortest() -> None:
    lengths = [
        shaped(LeadShape("line", s, 0.0), NORTH, EAST, np.array([4.0]), 1.0).length_mm[0] for s in (0.0, 0.5, 1.0)
    ]
    assert lengths == pytest.approx([4, 2, 1])


@given(st.sampled_from([45.0, 60.0, 90.0]), st.floats(1, 9), st.sampled_from([1.0, -1.0]))
def test_an_arc_is_as_long_as_asked_for_and_ends_along_the_cut(sweep: float, length_mm: float, way: float) -> None:
    leads = shaped(LeadShape("arc", 0.0, math.radians(sweep)), NORTH, way * EAST, np.array([length_mm]), 1.0)
    (x, y), (jx, jy) = leads.pierce[0].tolist(), leads.join[0].tolist()
    arc = Segment((x, y), (jx, jy), float(leads.bulge[0]))
    assert arc.length_mm == pytest.approx(length_mm)
    assert arc.tangent_at(1.0) == pytest.approx((way, 0), abs=1e-9)
    assert y > 4


@given(st.floats(-1, 1), st.floats(0, 5))
def test_points_along_a_lead_lie_on_its_arc(bulge: float, left_out_mm: float) -> None:
    drawn = Segment((1.0, 2.0), (5.0, -1.0), 0.0 if abs(bulge) < 1e-3 else bulge)
    one = np.array([drawn.length_mm])
    leads = Leads(np.array([drawn.start]), np.array([drawn.end]), np.array([drawn.bulge]), one)
    until = 1 - min(left_out_mm / drawn.length_mm, 0.5)
    points = leads.points(left_out_mm)[0]
    expected = [drawn.point_at(f) for f in np.linspace(0, until, len(points))]
    assert points == pytest.approx(np.array(expected), abs=1e-9)
