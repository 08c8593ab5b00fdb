"""Offsets of shapes whose answer is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kerfwise.encoder.geometry import offset
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.offset import offset_curve
from kerfwise.rules.case import circle, rect

QUARTER = math.tan(math.pi / 8)


def rows(curve: Curve) -> list[list[float]]:
    """Vertices to 6 decimals."""
    return [[round(v, 6) + 0.0 for v in row] for row in curve.vertices.tolist()]


def test_a_square_grown_has_an_arc_about_each_corner() -> None:
    grown = offset_curve(Curve.of(rect(0, 0, 10, 10)), 1)
    assert rows(grown) == [
        [0, -1, 0], [10, -1, round(QUARTER, 6)], [11, 0, 0], [11, 10, round(QUARTER, 6)],
        [10, 11, 0], [0, 11, round(QUARTER, 6)], [-1, 10, 0], [-1, 0, round(QUARTER, 6)],
    ]  # fmt: skip


def test_a_square_shrunk_is_a_square() -> None:
    assert rows(offset_curve(Curve.of(rect(0, 0, 10, 10)), -2)) == [[2, 2, 0], [8, 2, 0], [8, 8, 0], [2, 8, 0]]


@pytest.mark.parametrize("distance_mm", [0.75, -0.75])
def test_the_way_round_stays(distance_mm: float) -> None:
    drawn = Curve.of(rect(0, 0, 10, 10))
    assert offset_curve(drawn, distance_mm).is_ccw
    assert not offset_curve(drawn.reversed(), distance_mm).is_ccw


@pytest.mark.parametrize(("distance_mm", "radius_mm"), [(0.75, 5.25), (-0.75, 3.75), (-4.4, 0.1)])
def test_a_circle_stays_a_concentric_circle(distance_mm: float, radius_mm: float) -> None:
    moved = offset_curve(Curve.of(circle(7, 8, 4.5)), distance_mm)
    assert [s.radius_mm for s in moved.segments] == pytest.approx([radius_mm] * 2)
    assert [s.centre for s in moved.segments] == [pytest.approx((7, 8))] * 2


def test_a_hollow_corner_is_trimmed_and_the_others_rounded() -> None:
    ell = Curve.of([(0, 0), (20, 0), (20, 10), (10, 10), (10, 20), (0, 20)])
    grown = offset_curve(ell, 1)
    assert [11, 11, 0] in rows(grown)
    assert sum(s.is_arc for s in grown.segments) == 5
    assert [9, 9] not in [row[:2] for row in rows(offset_curve(ell, -1))]
    assert sum(s.is_arc for s in offset_curve(ell, -1).segments) == 1


def test_a_fillet_smaller_than_the_distance_vanishes() -> None:
    hollow = Curve.of([(0, 0), (20, 0), (20, 10), (10.5, 10, -QUARTER), (10, 10.5), (10, 20), (0, 20)])
    assert [11, 11, 0] in rows(offset_curve(hollow, 1))


def test_a_fillet_larger_than_the_distance_stays_concentric() -> None:
    hollow = Curve.of([(0, 0), (20, 0), (20, 10), (13, 10, -QUARTER), (10, 13), (10, 20), (0, 20)])
    fillet = [s for s in offset_curve(hollow, 1).segments if s.bulge < 0]
    assert [(round(s.radius_mm, 6), s.centre) for s in fillet] == [(2, pytest.approx((13, 13)))]


def test_a_slot_barely_wider_than_the_kerf_keeps_its_walls() -> None:
    slotted = Curve.of([(0, 0), (20, 0), (20, 20), (10.76, 20), (10.76, 5), (9.24, 5), (9.24, 20), (0, 20)])
    walls = [row[:2] for row in rows(offset_curve(slotted, 0.75))]
    assert [9.99, 5.75] in walls
    assert [10.01, 5.75] in walls


def test_a_corner_of_a_few_degrees_stays_pointed() -> None:
    a = np.arange(120) * math.tau / 120
    grown = offset_curve(Curve(np.column_stack([50 * np.cos(a), 50 * np.sin(a), 0 * a])), 0.75)
    assert len(grown.segments) == 120
    assert not any(s.is_arc for s in grown.segments)


def test_an_outline_that_touches_itself_at_a_point_can_be_grown() -> None:
    hourglass = Curve.of([(0, 0), (10, 10), (20, 0), (20, 20), (10, 10), (0, 20)])
    grown = offset_curve(hourglass, 1)
    assert grown.polygon().is_valid
    assert grown.polygon().area > 200 + grown.length_mm - 10


@pytest.mark.parametrize("over", [False, True])
def test_an_outline_with_a_spike_of_no_width_goes_around_its_end(over: bool) -> None:
    drawn = Curve.of([(0, 0), (20, 0), (20, 10), (30, 10), (20, 10), (20, 20), (0, 20)])
    grown = offset_curve(drawn.reversed() if over else drawn, 1)
    end = [s for s in grown.segments if s.is_arc and s.centre == pytest.approx((30, 10))]
    assert [abs(s.sweep_rad) for s in end] == [pytest.approx(math.pi)]
    assert len(grown.segments) == 12


@pytest.mark.parametrize("over", [False, True])
def test_an_outline_with_a_slit_of_no_width_goes_around_its_end(over: bool) -> None:
    drawn = Curve.of([(0, 0), (20, 0), (20, 10), (8, 10), (20, 10), (20, 20), (0, 20)])
    shrunk = offset_curve(drawn.reversed() if over else drawn, -1)
    end = [s for s in shrunk.segments if s.is_arc]
    assert [s.centre for s in end] == [pytest.approx((8, 10))]
    assert abs(end[0].sweep_rad) == pytest.approx(math.pi)


def test_distance_nothing_changes_nothing() -> None:
    drawn = Curve.of(rect(0, 0, 10, 10))
    assert offset_curve(drawn, 0.0) is drawn


@pytest.mark.parametrize(
    ("vertices", "distance_mm", "text"),
    [
        (circle(0, 0, 0.7), -0.75, "nothing is left: nowhere is it 1.5 mm wide"),
        (rect(0, 0, 100, 1.5), -0.75, "nothing is left"),
        (rect(0, 0, 1.5, 1.5), -0.75, "nothing is left"),
        ([(0, 0), (3, 0), (1.5, 1.5 * math.sqrt(3))], -math.sqrt(3) / 2, "nothing is left"),
        ([(0, 0), (10, 0)], 1.0, "encloses no area"),
    ],
)  # fmt: skip
def test_what_has_no_offset_says_why(vertices: list[tuple[float, float]], distance_mm: float, text: str) -> None:
    with pytest.raises(ValueError, match=text):
        offset_curve(Curve.of(vertices), distance_mm)


@pytest.mark.parametrize(
    ("vertices", "distance_mm", "area_mm2"),
    [
        # Two chambers of 9 x 9 and 9 x 10 mm with a neck of 1 mm: the larger.
        ([(0, 0), (9, 0), (9, 9), (5, 9), (5, 10), (9, 10), (9, 20), (0, 20), (0, 10), (4, 10), (4, 9), (0, 9)], -0.75,
         7.5 * 8.5),
        # A plate with a pocket behind a mouth of 1 mm: past the mouth.
        ([(0, 0), (20, 0), (20, 20), (10.5, 20), (10.5, 15), (15, 15), (15, 5), (5, 5), (5, 15), (9.5, 15), (9.5, 20),
          (0, 20)], 0.75, 400 + 80 * 0.75 + math.pi * 0.75**2 - 0.15),
    ],
)  # fmt: skip
def test_where_it_falls_apart_the_offset_is_the_largest_piece(
    vertices: list[tuple[float, float]], distance_mm: float, area_mm2: float
) -> None:
    """What is lost of the outline then is found by `encoder.narrow`."""
    ring = offset_curve(Curve.of(vertices), distance_mm)
    assert abs(ring.signed_area_mm2) == pytest.approx(area_mm2, abs=0.2)


def test_an_open_curve_has_no_offset() -> None:
    with pytest.raises(ValueError, match="open"):
        offset_curve(Curve.of([(0, 0), (10, 0), (10, 10)], closed=False), 1.0)


@pytest.mark.slow
def test_where_chords_are_taken_of_a_long_ring_they_are_no_more_than_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every chord is a line of the program: noise in a ring of 20,000 vertices made 120,000 of them."""
    angle = np.arange(2000) * math.tau / 2000
    radius = 40 + np.random.default_rng(1).uniform(-0.05, 0.05, 2000)
    noisy = Curve(np.column_stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle]))
    monkeypatch.setattr(offset, "_joined", lambda *given: [])  # nothing exact is found
    monkeypatch.setattr(offset, "MANY_POINTS", 10**9)
    fine = offset_curve(noisy, 0.75)
    monkeypatch.setattr(offset, "MANY_POINTS", 100)
    few = offset_curve(noisy, 0.75)
    assert len(few.segments) < len(fine.segments) / 2
    assert few.line().hausdorff_distance(fine.line()) < offset.TOLERANCE_MM
