"""Points and lengths of curves, made for all segments at once, are those of the segments one by one."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.rule_kit import Curve

places = st.one_of(st.integers(-3, 3).map(float), st.floats(-50, 50))
bulges = st.one_of(st.just(0.0), st.floats(0.01, 2), st.floats(-2, -0.01))
curves = st.builds(Curve.of, st.lists(st.tuples(places, places, bulges), max_size=8), st.booleans())


@given(curves, st.sampled_from([0.002, 0.01, 0.5]))
def test_points_are_those_of_the_segments(curve: Curve, tolerance_mm: float) -> None:
    if not curve.segments:
        assert curve.flatten(tolerance_mm).tolist() == curve.vertices[:1, :2].tolist()
        return
    parts = [np.array([curve.segments[0].start]), *(s.flatten(tolerance_mm) for s in curve.segments)]
    points = np.concatenate(parts).tolist()
    assert curve.flatten(tolerance_mm).tolist() == (points[:-1] if curve.closed else points)


@given(curves)
def test_lengths_are_those_of_chords_and_arcs(curve: Curve) -> None:
    for s in curve.segments:
        assert s.length_mm == (s.radius_mm * abs(s.sweep_rad) if s.is_arc else math.dist(s.start, s.end))


@given(curves)
def test_a_curve_is_as_long_as_its_segments_together(curve: Curve) -> None:
    assert curve.length_mm == np.cumsum([0.0, *(s.length_mm for s in curve.segments)])[-1]
    assert tuple(curve.made_anew()) == curve.segments


@pytest.mark.parametrize("bulge", [0.0, 0.3, -1.0])
@pytest.mark.parametrize("end", [(3.1, 4.7), (1e-10, 0.0), (0.0, 0.0)])
def test_the_length_of_a_single_line_or_arc_is_that_of_its_segment(end: tuple[float, float], bulge: float) -> None:
    lead = Curve.of([(0.0, 0.0, bulge), (*end, 0.5)], closed=False)
    assert lead.length_mm == sum(s.length_mm for s in lead.made_anew())
    assert "segments" not in vars(lead)


def between_plainly(curve: Curve, start_mm: float, length_mm: float) -> list[list[float]]:
    """The vertices of a piece, every line and arc of it made by `Segment.between`."""
    k, f = curve.locate(start_mm)
    rows, end, left = [], curve.segments[k].point_at(f), length_mm
    while left > 1e-9:
        segment = curve.segments[k]
        take = min(left, segment.length_mm * (1 - f))
        if take > 1e-9:
            piece = segment.between(f, f + take / segment.length_mm)
            rows.append([*piece.start, piece.bulge])
            end, left = piece.end, left - take
        k, f = (k + 1) % len(curve.segments), 0.0
    return [*rows, [*end, 0.0]]


@given(curves.filter(lambda curve: bool(curve.segments)), st.floats(0, 1), st.floats(0, 2.5))
def test_pieces_of_curves_are_those_of_their_segments(curve: Curve, begin: float, long: float) -> None:
    start_mm = begin * curve.length_mm
    length_mm = long * curve.length_mm if curve.closed else min(long, 1 - begin) * curve.length_mm
    assert curve.between(start_mm, length_mm).vertices.tolist() == between_plainly(curve, start_mm, length_mm)
