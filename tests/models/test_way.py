"""The way of a pierce pass against every order of its points."""

from __future__ import annotations

import math
from itertools import pairwise, permutations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.geometry.segment import Point
from kerfwise.models import routing
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.routing import way_through
from kerfwise.tests.tools.amount import examples

PLACE = st.tuples(st.integers(0, 60), st.integers(0, 60)).map(lambda at: (float(at[0]), float(at[1])))


def length_mm(points: list[Point], order: list[int], start: Point, end: Point) -> float:
    return sum(math.dist(a, b) for a, b in pairwise([start, *(points[k] for k in order), end]))


@given(points=st.lists(PLACE, max_size=5, unique=True), start=PLACE, end=PLACE)
@examples(25)
def test_it_is_the_shortest(points: list[Point], start: Point, end: Point) -> None:
    order = way_through(points, start, end, SolveOptions(work=0.1))
    assert sorted(order) == list(range(len(points)))
    best = min(length_mm(points, list(other), start, end) for other in permutations(range(len(points))))
    assert length_mm(points, order, start, end) <= best + 0.01


def test_many_points_are_taken_in_strips(monkeypatch: pytest.MonkeyPatch) -> None:
    points = [(float(10 * (k % 6)), float(10 * (k // 6))) for k in range(18)]
    monkeypatch.setattr(routing, "MOST_AT_ONCE", 6)
    order = way_through(points, (60.0, 0.0), (0.0, 0.0), SolveOptions(work=0.1))
    assert sorted(order) == list(range(18))
    columns = [{points[k][0] for k in order[at : at + 6]} for at in (0, 6, 12)]
    assert columns == [{50.0, 40.0}, {30.0, 20.0}, {10.0, 0.0}]
