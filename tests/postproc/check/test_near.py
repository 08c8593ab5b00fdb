"""The stretch of one chord near another, against many points along it."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.postproc.check.ring_coverage import chords_of_lines, chords_of_paths, near_stretches
from kerfwise.tests.tools.amount import examples

PLACE = st.integers(-40, 40).map(lambda k: k / 4)
CHORD = st.tuples(PLACE, PLACE, PLACE, PLACE).filter(lambda c: c[:2] != c[2:])


@examples(300)
@given(CHORD, CHORD, st.sampled_from([0.05, 0.3, 1.0, 3.0]))
def test_a_stretch_is_what_many_points_say(one: tuple[float, ...], other: tuple[float, ...], within_mm: float) -> None:
    line = shapely.LineString([one[:2], one[2:]])
    ring = shapely.LineString([other[:2], other[2:], other[:2]])  # closed: round caps at both ends
    found = near_stretches(chords_of_lines([line]), chords_of_lines([ring]), within_mm)
    at_mm = np.linspace(0, line.length, 400)
    away_mm = shapely.distance(ring, shapely.line_interpolate_point(line, at_mm))
    covered = np.zeros(400, dtype=bool)
    for low, high in zip(found.low_mm.tolist(), found.high_mm.tolist(), strict=True):
        covered |= (at_mm >= low - 1e-6) & (at_mm <= high + 1e-6)
    clear = np.abs(away_mm - within_mm) > 1e-6
    assert (covered == (away_mm <= within_mm))[clear].all()


def test_nothing_is_covered_beyond_a_free_end() -> None:
    line, burn = shapely.LineString([(0, 0), (10, 0)]), shapely.LineString([(2, 0.1), (5, 0.1), (7, 0.1)])
    found = near_stretches(chords_of_lines([line]), chords_of_lines([burn]), 0.5)
    assert (found.low_mm.min(), found.high_mm.max()) == pytest.approx((2.0, 7.0))
    assert (found.other_low_mm.min(), found.other_high_mm.max()) == pytest.approx((0.0, 5.0))


def test_places_along_arcs_are_true_lengths() -> None:
    path = Curve.of([(0, 0), (3, 0, 1), (3, 8), (0, 8)], closed=False)
    chords = chords_of_paths([Curve.of([(5, 5)], closed=False), path])
    assert set(chords.of.tolist()) == {1}
    assert chords.at_mm[-1] + chords.span_mm[-1] == pytest.approx(path.length_mm)
    assert chords.at_mm[-1] == pytest.approx(3 + 4 * np.pi)
    assert (int(chords.first.sum()), int(chords.last.sum())) == (1, 1)
