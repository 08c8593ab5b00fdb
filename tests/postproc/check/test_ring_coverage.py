"""When burns have covered a ring, and what they leave open."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.cut import Tab
from kerfwise.postproc.check.ring_coverage import (
    NONE,
    Covered,
    chords_of_lines,
    chords_of_paths,
    covered,
    near_stretches,
    rounds,
    tab_intervals,
    total_mm,
)
from kerfwise.postproc.check.torch_run import torch_rings
from kerfwise.rule_kit import Curve, part, rect
from kerfwise.tests.tools.amount import examples

SQUARE = shapely.LinearRing([(0, 0), (10, 0), (10, 10), (0, 10)])
A, B, C, D = (0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)


def burnt(*paths: list[tuple[float, float]], free: np.ndarray = NONE) -> Covered:
    (found,) = covered([SQUARE], [free], chords_of_paths(Curve.of(p, closed=False) for p in paths), 0.05)
    return found


def test_once_round_with_leads() -> None:
    found = burnt([(5, -4), (5, 0), B, C, D, A, (5, 0), (7, 0), (7, -1)])
    assert found.out == (0, pytest.approx(44, abs=0.11))
    assert (found.open, found.again) == ((), {})


def test_four_burns_in_any_order_and_the_last_one_finishes() -> None:
    found = burnt([A, B], [C, D], [D, A], [C, B])
    assert found.out == (3, pytest.approx(10, abs=0.06))
    assert {burn: round(total_mm(new)) for burn, new in found.new.items()} == {0: 10, 1: 10, 2: 10, 3: 10}


def test_an_edge_left_out() -> None:
    found = burnt([A, B], [C, D, A])
    assert found.out is None
    assert found.open == ((pytest.approx(10, abs=0.06), pytest.approx(20, abs=0.06)),)
    assert found.open_mm == pytest.approx(10, abs=0.2)


def test_what_is_open_across_the_first_point_is_one_stretch() -> None:
    found = burnt([(4, 0), B, C, D, (0, 4)])
    assert found.open == ((pytest.approx(36, abs=0.06), pytest.approx(44, abs=0.06)),)


def test_an_edge_cut_twice() -> None:
    found = burnt([A, B, C], [B, C, D, A])
    assert found.out == (1, pytest.approx(30, abs=0.06))
    assert total_mm(found.again[1]) == pytest.approx(10, abs=0.2)


def test_a_tab_is_not_open_and_the_contour_is_out_without_it() -> None:
    path = [(5.2, 0), B, C, D, A, (4.8, 0)]
    assert burnt(path).open_mm == pytest.approx(0.4)
    found = burnt(path, free=tab_intervals(SQUARE, [Tab((5, 0), 0.4)], 0.01))
    assert found.out == (0, pytest.approx(39.6, abs=0.06))
    two = burnt(
        [(5.2, 0), B, C, D, A, (1, 0)], [(1.6, 0), (4.8, 0)], free=tab_intervals(SQUARE, [Tab((5, 0), 0.4)], 0.01)
    )
    assert two.open == ((pytest.approx(1), pytest.approx(1.6)),)


def test_a_tab_across_the_first_point_of_a_ring() -> None:
    assert tab_intervals(SQUARE, [Tab((0, 0), 2.0)], 0.0).tolist() == [[0.0, 1.0], [39.0, 40.0]]


def test_a_path_beside_the_ring_covers_nothing() -> None:
    assert burnt([(0, 0.2), (10, 0.2)]).open_mm == pytest.approx(40, abs=0.5)


def test_the_rounds_at_corners_may_be_straight() -> None:
    contour = part("P", rect(0, 0, 100, 50)).outer
    (ring,) = torch_rings([contour], 2.0)
    assert ring is not None
    free = rounds(ring, contour)
    assert len(free) in (4, 5)
    assert total_mm(free) == pytest.approx(2 * np.pi, rel=1e-2)
    mitred = Curve.of([(20, -1), (101, -1), (101, 51), (-1, 51), (-1, -1), (20, -1)], closed=False)
    for already, out in ((NONE, False), (free, True)):
        (found,) = covered([ring], [already], chords_of_paths([mitred]), 0.05)
        assert (found.out is not None) == out


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
