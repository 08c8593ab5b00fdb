import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from shapely import LineString, hausdorff_distance

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.readers.fit_arcs import FIT_MM, fit_arcs, fit_curve
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
