"""Offsets of random rings lie where they should."""

from __future__ import annotations

import time

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.offset import offset_curve
from kerfwise.tests.encoder.geometry.rings import flattened_rings, hausdorff_mm, is_simple, star_rings, true_offset
from kerfwise.tests.tools.amount import examples

DISTANCES = st.sampled_from([0.1, -0.1, 0.75, -0.75, 2.0, -2.0])


@pytest.mark.slow
@examples(80)
@given(st.one_of(star_rings(), flattened_rings()), DISTANCES)
def test_an_offset_is_within_a_hundredth_of_the_true_one(drawn: Curve, distance_mm: float) -> None:
    assume(is_simple(drawn))
    wanted = true_offset(drawn, distance_mm)
    try:
        moved = offset_curve(drawn, distance_mm)
    except ValueError:
        pieces = len(shapely.get_parts(wanted)) + int(shapely.get_num_interior_rings(wanted))
        assert pieces != 1 or wanted.area < 0.1
        return
    assert hausdorff_mm(moved.line(0.0005), max(shapely.get_parts(wanted), key=lambda p: p.area).exterior) < 0.01
    assert moved.is_ccw == drawn.is_ccw
    assert moved.polygon(0.0005).buffer(-0.001 * np.sign(distance_mm)).is_valid


@examples(60)
@given(star_rings(), DISTANCES)
def test_lines_stay_lines_and_arcs_concentric_arcs(drawn: Curve, distance_mm: float) -> None:
    assume(is_simple(drawn))
    try:
        moved = offset_curve(drawn, distance_mm)
    except ValueError:
        assume(False)
    centres = np.array([s.centre for s in drawn.segments if s.is_arc] + [s.start for s in drawn.segments])
    arcs = [s for s in moved.segments if s.is_arc and s.length_mm > 0.1]
    for arc in arcs:
        assert np.hypot(*(centres - arc.centre).T).min() < 0.02
    lines = [s for s in moved.segments if not s.is_arc and s.length_mm > 0.2]
    drawn_lines = [s for s in drawn.segments if not s.is_arc]
    for line in lines:
        (ux, uy), found = line.tangent_at(0), [s.tangent_at(0) for s in drawn_lines]
        assert any(abs(ux * vy - uy * vx) < 0.02 for vx, vy in found)


@pytest.mark.slow
def test_thousands_of_tiny_chords_take_little_time() -> None:
    a = np.arange(5000) * 2 * np.pi / 5000
    radius = 200 + 20 * np.cos(9 * a) + 3 * np.cos(40 * a)
    drawn = Curve(np.column_stack([radius * np.cos(a), radius * np.sin(a), 0 * a]))
    began = time.process_time()
    moved = offset_curve(drawn, 0.75)
    assert time.process_time() - began < 4
    chords = shapely.STRtree(shapely.linestrings(np.stack([drawn.flatten(), np.roll(drawn.flatten(), -1, 0)], axis=1)))
    points = shapely.points(shapely.get_coordinates(shapely.segmentize(moved.line(), 0.2)))
    distance = shapely.distance(points, chords.geometries[chords.nearest(points)])
    assert np.abs(distance - 0.75).max() < 0.01


def test_the_comparison_can_fail() -> None:
    drawn = Curve.of([(0, 0), (20, 0), (20, 20), (0, 20)])
    moved = offset_curve(drawn, 0.77)
    assert 0.01 < hausdorff_mm(moved.line(0.0005), true_offset(drawn, 0.75).exterior) < 0.03
