"""Questions about many points of a curve are answered as those about one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment_arrays import SegmentArrays
from kerfwise.tests.encoder.geometry.rings import star_rings


@settings(max_examples=40, deadline=None)
@given(star_rings())
def test_points_tangents_and_projections_are_those_of_the_curve(drawn: Curve) -> None:
    arrays = SegmentArrays.of(drawn)
    at_mm = np.linspace(0, drawn.length_mm, 23)[1:-1] + 0.0123
    points, before, after = arrays.frames(at_mm)
    for k, s_mm in enumerate(at_mm.tolist()):
        assert points[k] == pytest.approx(drawn.point_at(s_mm), abs=1e-7)
        assert before[k] == pytest.approx(drawn.tangent_at(s_mm), abs=1e-7)
        assert after[k] == pytest.approx(drawn.tangent_at(s_mm), abs=1e-7)
    asked = np.random.default_rng(len(at_mm)).uniform(-25, 25, (30, 2))
    found_mm, distance_mm = arrays.project(asked)
    for k, point in enumerate(asked.tolist()):
        assert distance_mm[k] == pytest.approx(drawn.project(point)[1], abs=1e-7)
        assert drawn.point_at(found_mm[k]) == pytest.approx(drawn.point_at(drawn.project(point)[0]), abs=1e-4)


def test_at_a_corner_the_tangents_before_and_after_differ() -> None:
    square = SegmentArrays.of(Curve.of([(0, 0), (10, 0), (10, 10), (0, 10)]))
    points, before, after = square.frames(np.array([0.0, 10.0, 40.0]))
    assert points.tolist() == [[0, 0], [10, 0], [0, 0]]
    assert before.tolist() == [[0, -1], [1, 0], [0, -1]]
    assert after.tolist() == [[1, 0], [0, 1], [1, 0]]
    assert square.turn_rad == pytest.approx([np.pi / 2] * 4)
