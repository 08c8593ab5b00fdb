"""Torch paths taken apart where they join their contour."""

import math

import pytest

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.postproc.check.splitting import split


def lengths(points: list[tuple[float, ...]], round_mm: float) -> tuple[float, float, float, float]:
    pieces = split(Curve.of(points, closed=False), round_mm)
    assert pieces is not None
    return pieces.lead_in.length_mm, pieces.loop.length_mm, pieces.lead_out.length_mm, pieces.gap_mm


def test_no_leads_at_all() -> None:
    assert lengths([(0, 0), (10, 0), (10, 10), (0, 10), (0, 0)], 40) == (0, 40, 0, 0)


def test_an_overcut_past_a_corner_belongs_to_the_lead_out() -> None:
    path = [(5, 5), (8, 0), (10, 0), (10, 10), (0, 10), (0, 0), (8, 0), (10, 0), (10, 4)]
    assert lengths(path, 40) == (pytest.approx(math.sqrt(34)), 40, 6, 0)


def test_a_circle_in_arcs() -> None:
    found = lengths([(0, 0), (10, 0, 1), (-10, 0, 1), (10, 0), (9, 1)], 20 * math.pi)
    assert found == pytest.approx((10, 20 * math.pi, math.sqrt(2), 0))


def test_a_narrow_notch_is_not_taken_for_the_end() -> None:
    # in and out of the notch the path passes within 0.02 mm of itself
    path = [(0, 0), (49.99, 0), (49.99, 90), (50.01, 90), (50.01, 0), (100, 0), (100, 100), (0, 100), (0, 0)]
    assert lengths(path, 580)[1] == pytest.approx(579.98 + 0.02)


def test_a_round_that_does_not_close_has_a_gap() -> None:
    assert lengths([(0, 0), (10, 0), (10, 10), (0, 10), (0, 1)], 40)[3] == 1


def test_far_too_short_a_path() -> None:
    assert split(Curve.of([(0, 0), (10, 0)], closed=False), 40) is None


def test_the_round_is_the_pair_that_closes_not_the_one_of_the_right_length() -> None:
    side = [(k / 2, 0.0) for k in range(20)]
    path = [(-3.0, 0.0), *side, (10, 0), (10, 10), (0, 10), (0, 0), *side[1:5]]
    assert lengths(path, 40.5) == (3, 40, 2, 0)
