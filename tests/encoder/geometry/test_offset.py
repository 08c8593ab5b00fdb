"""Curves beside curves: by hand, many at once, and of any ring."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from kerfwise.encoder.geometry import offset
from kerfwise.encoder.geometry.offset import offset_curve, offset_together
from kerfwise.encoder.geometry.offset_batch import offset_curves
from kerfwise.rule_kit import Curve, circle, rect
from kerfwise.tests.encoder.geometry.rings import flattened_rings, hausdorff_mm, is_simple, star_rings, true_offset
from kerfwise.tests.tools.amount import examples

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


DISTANCES_MM = (0.75, -0.75, 2.0, -2.0)


def angular(seed: int) -> Curve:
    """The largest of what some rectangles cover together, turned."""
    rng = np.random.default_rng(seed)
    at, size = rng.uniform(0, 30, (4, 2)), rng.uniform(4, 30, (4, 2))
    covered = shapely.union_all(shapely.box(*at.T, *(at + size).T))
    ring = max(shapely.get_parts(covered), key=lambda p: float(p.area)).exterior
    (x, y), turn = shapely.get_coordinates(ring)[:-1].T, rng.uniform(0, math.tau)
    turned = x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn)
    return Curve(np.column_stack([*turned, 0 * x]))


def comb(mouth_mm: float) -> Curve:
    wide_mm = 20 + mouth_mm
    walls = [(wide_mm, 0), (wide_mm, 30), (10 + mouth_mm, 30), (10 + mouth_mm, 10), (10, 10), (10, 30)]
    return Curve.of([(0, 0), *walls, (0, 30)])


def made(curve: Curve, distance_mm: float) -> bytes | str:
    try:
        return offset_curve(curve, distance_mm).vertices.tobytes()
    except ValueError as error:
        return str(error)


@pytest.mark.slow
def test_what_neighbours_tell_is_what_areas_give(monkeypatch: pytest.MonkeyPatch) -> None:
    told = 0
    for seed in range(30):
        curve = angular(seed)
        for distance_mm in DISTANCES_MM:
            beside = offset_curves([curve], [distance_mm])[0]
            if beside is None or len(curve.vertices) < 6:  # of convex curves areas may begin elsewhere
                continue
            told += 1
            with monkeypatch.context() as areas:
                areas.setattr(offset, "offset_curves", lambda curves, _: [None] * len(curves))
                assert made(Curve(curve.vertices), distance_mm) == beside.vertices.tobytes()
            wanted = max(shapely.get_parts(true_offset(curve, distance_mm)), key=lambda p: float(p.area)).exterior
            assert hausdorff_mm(beside.line(0.0005), wanted) < 0.01
    assert told > 20


def test_many_together_are_as_one_by_one() -> None:
    curves = [angular(seed) for seed in range(30)] + [Curve.of([(-9, 0, 1), (9, 0, 1)]), comb(1.0)]
    distances_mm = [DISTANCES_MM[k % 4] for k in range(len(curves))]
    alone = [made(Curve(c.vertices), mm) for c, mm in zip(curves, distances_mm, strict=True)]
    offset_together(curves, distances_mm)
    assert sum(curve.beside[mm] is not None for curve, mm in zip(curves, distances_mm, strict=True)) > 10
    assert [made(c, mm) for c, mm in zip(curves, distances_mm, strict=True)] == alone


@pytest.mark.parametrize(("mouth_mm", "told"), [(1.0, False), (1.4999, False), (1.5001, False), (1.6, True)])
def test_a_neck_about_as_wide_as_the_kerf_is_left_to_areas(mouth_mm: float, told: bool) -> None:
    assert (offset_curves([comb(mouth_mm)], [0.75])[0] is not None) == told


def test_curves_without_area_or_offset_are_passed_over() -> None:
    flat, square = Curve.of([(0, 0), (9, 0)]), Curve.of([(0, 0), (9, 0), (9, 9), (0, 9)])
    offset_together([flat, square], [1.0, 0.0])
    assert not flat.beside
    assert not square.beside
    assert offset_curves([], []) == []


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
