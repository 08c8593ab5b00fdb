"""Which entries are offered, and in which order."""

from __future__ import annotations

import numpy as np

from kerfwise.encoder.by_hand import Rows, circle, rect
from kerfwise.encoder.candidates.entries import CORNER, MIDDLE, choose, places
from kerfwise.encoder.candidates.joints import Outline
from kerfwise.encoder.compensation import compensated
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Kind

ELL: Rows = [(0, 0), (20, 0), (20, 10), (10, 10), (10, 20), (0, 20)]


def outline(rows: Rows, kind: Kind = "outer", over: bool = False) -> Outline:
    curve = Curve.of(rows).reversed() if over else Curve.of(rows)
    contour = Contour(f"P.{kind}", "P", kind, curve)
    return Outline.of(0, contour, compensated(contour, 1.5), 0.75)


def points(of: Outline, rank: int) -> set[tuple[float, float]]:
    at_mm, ranks = places(of, 4)
    return {(round(x, 9), round(y, 9)) for x, y in map(of.contour.curve.point_at, at_mm[ranks == rank].tolist())}


def test_corners_that_stick_out_come_first() -> None:
    assert points(outline(ELL), CORNER) == set(ELL) - {(10, 10)}
    assert points(outline(ELL, over=True), CORNER) == set(ELL) - {(10, 10)}


def test_in_a_hole_only_corners_that_stick_into_it_do() -> None:
    assert points(outline(ELL, "hole"), CORNER) == {(10, 10)}
    assert points(outline(rect(0, 0, 20, 20), "hole"), CORNER) == set()


def test_then_come_the_middles_of_edges() -> None:
    assert points(outline(ELL), MIDDLE) == {(10, 0), (20, 5), (15, 10), (10, 15), (5, 20), (0, 10)}
    assert points(outline(circle(0, 0, 9)), MIDDLE) == set()


def test_entries_are_spread_even_where_corners_crowd() -> None:
    at_mm, ranks = np.array([0.0, 1.0, 2.0, 3.0, 50.0]), np.array([CORNER] * 4 + [MIDDLE])
    assert choose(at_mm, ranks, 100.0, 4, np.zeros(0)) == [0, 4]


def test_entries_keep_away_from_those_already_taken() -> None:
    at_mm = np.array([0.0, 25.0, 50.0, 75.0])
    assert choose(at_mm, np.full(4, CORNER), 100.0, 4, np.array([51.0, 98.0])) == [1, 3]


def test_the_way_round_has_no_seam() -> None:
    assert choose(np.array([1.0, 99.0, 50.0]), np.full(3, CORNER), 100.0, 4, np.zeros(0)) == [0, 2]


def test_in_a_hollow_corner_there_is_no_joint_of_its_own() -> None:
    joints, reached = outline(ELL).joints(np.array([15.0, 40.0]))
    assert reached.tolist() == [True, False]
    assert joints.join.round(6).tolist() == [[15, -0.75], [10.75, 10.75]]
