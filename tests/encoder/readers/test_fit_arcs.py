"""Arcs of flattened outlines: as near as is asked, with every corner and every other vertex in its place."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import example, given
from hypothesis import strategies as st
from shapely import LineString, hausdorff_distance

from kerfwise import InputError
from kerfwise.arrays import Floats
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.fit_arcs import CORNER_DEG, FIT_MM, fit_arcs, fit_curve, refitted
from kerfwise.rule_kit import Curve
from kerfwise.tests.encoder.readers.drawings import read_drawing
from kerfwise.tests.nest_file import nest_file
from kerfwise.tests.tools.amount import examples


def arc(radius: float, start: float, end: float, n: int = 200) -> Floats:
    a = np.linspace(start, end, n)
    return np.column_stack([radius * np.cos(a), radius * np.sin(a)])


def test_points_of_one_arc_become_one_arc() -> None:
    [first, last] = fit_arcs(arc(50, 0, math.pi / 2)).tolist()
    assert first == pytest.approx([50, 0, math.tan(math.pi / 8)], abs=1e-6)
    assert last == pytest.approx([0, 50, 0], abs=1e-6)


def test_a_clockwise_arc_has_a_negative_bulge() -> None:
    assert fit_arcs(arc(50, math.pi / 2, 0))[0, 2] == pytest.approx(-math.tan(math.pi / 8), abs=1e-6)


def test_points_on_a_line_become_one_line() -> None:
    line = np.column_stack([np.linspace(0, 90, 50), np.linspace(0, 30, 50)])
    assert fit_arcs(line).tolist() == [[0, 0, 0], [90, 30, 0]]


def test_the_corners_of_a_square_are_no_circle() -> None:
    corners = np.array([(0, 0), (10, 0), (10, 10), (0, 10)], dtype=float)
    assert fit_arcs(corners).tolist() == [[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0]]


def test_a_closed_row_gives_a_closed_curve() -> None:
    circle = fit_curve(arc(20, 0, math.tau))
    assert circle is not None
    assert circle.closed
    assert len(circle.segments) <= 3
    assert circle.signed_area_mm2 == pytest.approx(math.pi * 400, rel=1e-4)


def test_one_point_is_no_curve() -> None:
    assert fit_curve(np.array([[1.0, 2.0]])) is None


@examples(60)
@example([(0.0, 0.0), (0.0, 10.0), (0.0, -11.0), (2.0, 0.0)], 156)  # turns back past an end of its arc
@given(st.lists(st.tuples(st.floats(-100, 100), st.floats(-100, 100)), min_size=4, max_size=4), st.integers(20, 200))
def test_the_fit_stays_within_its_tolerance(control: list[tuple[float, float]], n: int) -> None:
    t = np.linspace(0, 1, n)[:, None]
    p0, p1, p2, p3 = (np.array(p) for p in control)
    points = (1 - t) ** 3 * p0 + 3 * t * (1 - t) ** 2 * p1 + 3 * t**2 * (1 - t) * p2 + t**3 * p3
    points = points[np.append(np.hypot(*np.diff(points, axis=0).T) > 1e-9, True)]
    if len(points) < 2:
        return
    rows = fit_arcs(points)
    assert rows[0, :2].tolist() == points[0].tolist()
    assert rows[-1, :2].tolist() == points[-1].tolist()
    drawn = Curve(rows, closed=False).flatten(0.0005)
    # between the points that were tested the arc may bulge off a chord by its own height, itself tested at the middle
    assert hausdorff_distance(LineString(drawn), LineString(points)) <= FIT_MM + 0.001


ROUNDED = Curve.of(
    [(10, 0), (90, 0, math.tan(math.pi / 8)), (100, 10), (100, 50), (0, 50), (0, 10, math.tan(math.pi / 8))]
)


def flattened(curve: Curve, tolerance_mm: float) -> Curve:
    return Curve.of(curve.flatten(tolerance_mm).tolist(), curve.closed)


def apart_mm(one: Curve, other: Curve) -> float:
    """How far apart two curves are, by a thousand points of both."""
    lines = [curve.line(1e-5) for curve in (one, other)]
    return max(
        float(
            shapely.distance(b, shapely.points(shapely.get_coordinates(shapely.segmentize(a, a.length / 1000)))).max()
        )
        for a, b in (lines, lines[::-1])
    )


def corners(curve: Curve) -> set[tuple[float, float]]:
    """Where two lines of a closed curve meet at an angle."""
    rows = curve.vertices
    found = set()
    for k, (x, y, bulge) in enumerate(rows.tolist()):
        a, b = rows[k - 1], rows[(k + 1) % len(rows)]
        turn = math.degrees(math.atan2(b[1] - y, b[0] - x) - math.atan2(y - a[1], x - a[0]))
        if abs((turn + 180) % 360 - 180) > CORNER_DEG and not bulge and not a[2]:
            found.add((x, y))
    return found


@pytest.mark.parametrize("chord_mm", [0.002, 0.01, 0.03])
def test_a_rounded_plate_gets_its_two_arcs_back(chord_mm: float) -> None:
    flat = flattened(ROUNDED, chord_mm)
    made = refitted(flat, 0.05)
    assert made.arcs == 2
    assert made.lines == len(flat.vertices) - 4
    assert made.off_mm <= chord_mm * 1.01
    assert sorted(np.abs(made.curve.vertices[:, 2]).round(6))[-2:] == [round(math.tan(math.pi / 8), 6)] * 2
    assert corners(made.curve) == {(100.0, 50.0), (0.0, 50.0)}
    assert apart_mm(made.curve, ROUNDED) < 1e-3


@given(
    st.floats(0.5, 60),
    st.integers(3, 200),
    st.floats(0, 2),
    st.sampled_from([0.01, 0.05, 0.2]),
    st.integers(0, 2**32),
)
def test_nothing_is_refitted_beyond_the_tolerance(
    radius: float, count: int, noise: float, tolerance: float, seed: int
) -> None:
    rnd = np.random.default_rng(seed)
    turn = np.linspace(0, 2 * math.pi, count + 1)[:-1]
    far = radius + noise * tolerance * rnd.uniform(-1, 1, count)
    ring = Curve.of(np.column_stack([far * np.cos(turn), far * np.sin(turn)]).tolist())
    made = refitted(ring, tolerance)
    assert made.off_mm <= tolerance
    assert apart_mm(ring, made.curve) <= made.off_mm + 1e-4
    kept = {(x, y) for x, y, _ in made.curve.vertices.tolist()}
    assert kept <= {(x, y) for x, y, _ in ring.vertices.tolist()}
    assert corners(ring) <= kept


@given(st.lists(st.tuples(st.integers(0, 30), st.integers(0, 30)), min_size=4, max_size=20, unique=True))
def test_corners_stay_whatever_the_lines(points: list[tuple[int, int]]) -> None:
    for closed in (True, False):
        curve = Curve.of(points, closed)
        made = refitted(curve, 0.05)
        kept = {(x, y) for x, y, _ in made.curve.vertices.tolist()}
        if closed:
            assert corners(curve) <= kept
        assert made.off_mm <= 0.05
        assert apart_mm(curve, made.curve) <= made.off_mm + 1e-4


def test_polygons_stay() -> None:
    for count in (3, 4, 6, 8):
        turn = np.linspace(0, 2 * math.pi, count + 1)[:-1]
        ring = Curve.of(np.column_stack([20 * np.cos(turn), 20 * np.sin(turn)]).tolist())
        assert refitted(ring, 0.05).curve is ring


def test_a_side_beside_an_arc_stays_straight() -> None:
    """A side of 2 mm bows by no more than the tolerance, and is no part of the arc beside it."""
    arc = Curve.of([(0, 0, math.tan(math.pi / 8)), (10, 10)], closed=False).flatten(0.001)
    curve = Curve.of([*arc.tolist(), [10, 12], [0, 12]])
    made = refitted(curve, 0.05)
    assert made.arcs == 1
    assert {(10.0, 10.0), (10.0, 12.0), (0.0, 12.0)} <= {(x, y) for x, y, _ in made.curve.vertices.tolist()}


def test_arcs_that_are_drawn_as_arcs_stay() -> None:
    assert refitted(ROUNDED, 0.05).curve is ROUNDED


def test_the_reader_says_how_near(tmp_path: Path) -> None:
    flat = flattened(ROUNDED.moved(20, 20), 0.01)
    file = nest_file(tmp_path / "flat.json", [{"id": "A", "outer": flat.as_rows()}], (200, 100))
    nest = read_drawing(file, refit_arcs_mm=0.05)
    (note,) = (note.text for note in nest.notes if "arcs" in note.text)
    assert note.startswith(f"{len(flat.vertices) - 4} lines became 2 arcs in 1 contour, at most 0.0")
    off_mm = float(note.split("at most ")[1].split(" mm")[0])
    assert off_mm == pytest.approx(apart_mm(flat, nest.contour("A.outer").curve), abs=1e-4)
    assert sum(segment.is_arc for segment in nest.contour("A.outer").curve.segments) == 2
    assert not any("arcs" in note.text for note in read_drawing(file).notes)
    square = nest_file(tmp_path / "square.json", [{"id": "A", "outer": [[5, 5], [50, 5], [50, 50], [5, 50]]}])
    assert "no flattened arcs" in read_drawing(square, refit_arcs_mm=0.05).notes[-1].text


def test_a_tolerance_that_is_none() -> None:
    with pytest.raises(InputError, match="refit_arcs_mm is 0"):
        ReadOptions(refit_arcs_mm=0)
