"""Which entries are offered, and in which order."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.candidates.entries import (
    CORNER,
    MIDDLE,
    Joints,
    Leads,
    LeadShape,
    Outline,
    choose,
    choose_each,
    joints_at,
    places,
    shaped,
)
from kerfwise.encoder.geometry.segment import Segment
from kerfwise.encoder.torch_path import compensated
from kerfwise.rule_kit import Contour, Curve, Kind, circle, rect
from kerfwise.rules.case import Rows
from kerfwise.tests.tools.amount import examples

ELL: Rows = [(0, 0), (20, 0), (20, 10), (10, 10), (10, 20), (0, 20)]


def outline(rows: Rows, kind: Kind = "outer", over: bool = False) -> Outline:
    curve = Curve.of(rows).reversed() if over else Curve.of(rows)
    contour = Contour(f"P.{kind}", "P", kind, curve)
    return Outline.of({0: (contour, compensated(contour, 1.5))}, 0.75)[0]


def points(of: Outline, rank: int) -> set[tuple[float, float]]:
    at_mm, ranks, _ = places([of], 4)
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


def test_a_long_edge_in_pieces_that_hardly_turn_is_one() -> None:
    bowed: Rows = [(40, 0), (40, 20), (0, 20), (0, 0), (7, -0.02), (20, -0.03), (33, -0.02)]
    middles = {(40, 10), (20, 20), (0, 10)}
    for begun in range(len(bowed)):
        rows = [*bowed[begun:], *bowed[:begun]]
        assert points(outline(rows), MIDDLE) == points(outline(rows, over=True), MIDDLE) == middles | {(20, -0.03)}
    turned = [(round(20 * math.sin(a), 9), round(20 * math.cos(a), 9)) for a in map(math.radians, range(0, -360, -1))]
    assert points(outline(turned), MIDDLE) == set()


def test_entries_are_spread_even_where_corners_crowd() -> None:
    at_mm, ranks = np.array([0.0, 1.0, 2.0, 3.0, 50.0]), np.array([CORNER] * 4 + [MIDDLE])
    assert choose(at_mm, ranks, 100.0, 4, np.zeros(0)) == [0, 4]


def test_entries_keep_away_from_those_already_taken() -> None:
    at_mm = np.array([0.0, 25.0, 50.0, 75.0])
    assert choose(at_mm, np.full(4, CORNER), 100.0, 4, np.array([51.0, 98.0])) == [1, 3]


def test_the_way_round_has_no_seam() -> None:
    assert choose(np.array([1.0, 99.0, 50.0]), np.full(3, CORNER), 100.0, 4, np.zeros(0)) == [0, 2]


def chosen_by_hand(at_mm: list[float], ranks: list[int], around_mm: float, count: int, taken: list[float]) -> list[int]:
    """One contour, rank by rank: the place farthest from all before it, while that is far enough."""
    chosen: list[int] = []

    def apart_mm(k: int) -> float:
        held = [*taken, *(at_mm[c] for c in chosen)]
        return min((min(abs(at_mm[k] - h), around_mm - abs(at_mm[k] - h)) for h in held), default=math.inf)

    for rank in sorted(set(ranks)):
        of_rank = [k for k in range(len(at_mm)) if ranks[k] == rank]
        while len(chosen) < count:
            farthest_mm = max(apart_mm(k) for k in of_rank)
            if farthest_mm <= around_mm / (4 * count) + 1e-6:
                break
            chosen.append(next(k for k in of_rank if apart_mm(k) >= farthest_mm - 1e-6))
    return chosen


@st.composite
def contours(draw: st.DrawFn) -> tuple[list[float], list[int], list[float], int]:
    """Places, their ranks, those that are taken, and how many are wanting."""
    whole = st.integers(0, 59).map(float)  # many are equally far from each other
    at_mm = draw(st.lists(whole, max_size=9))
    ranks = draw(st.lists(st.integers(0, 2), min_size=len(at_mm), max_size=len(at_mm)))
    return at_mm, ranks, draw(st.lists(whole, max_size=3)), draw(st.integers(0, 4))


@examples(150)
@given(st.lists(contours(), min_size=1, max_size=4))
def test_contours_side_by_side_choose_as_each_alone(
    drawn: list[tuple[list[float], list[int], list[float], int]],
) -> None:
    at_mm, ranks, taken_mm = (np.array([x for one in drawn for x in one[column]]) for column in (0, 1, 2))
    of, taken_of = (np.repeat(np.arange(len(drawn)), [len(one[k]) for one in drawn]) for k in (0, 2))
    wanting = np.array([one[3] for one in drawn])
    found = choose_each(at_mm, ranks, of, np.full(len(drawn), 60.0), 4, wanting, taken_mm, taken_of)
    first = np.searchsorted(of, np.arange(len(drawn)))
    expected = []
    for k, (at, rank, taken, want) in enumerate(drawn):
        expected += [int(first[k]) + c for c in chosen_by_hand(at, rank, 60.0, 4, taken)[:want]]
    assert found.tolist() == expected


def test_places_and_joints_of_several_contours_are_those_of_each() -> None:
    several = [outline(ELL), outline(circle(0, 0, 9)), outline(rect(0, 0, 20, 20), "hole"), outline(ELL, over=True)]
    at_mm, ranks, of = places(several, 4)
    joints, reached = joints_at(several, at_mm, of)
    for k, one in enumerate(several):
        alone_mm, alone_ranks, _ = places([one], 4)
        assert (at_mm[of == k].tolist(), ranks[of == k].tolist()) == (alone_mm.tolist(), alone_ranks.tolist())
        alone, alone_reached = one.joints(alone_mm)
        assert reached[of == k].tolist() == alone_reached.tolist()
        for column in ("entry", "join_mm", "join", "out"):
            assert getattr(joints, column)[of == k].tolist() == getattr(alone, column).tolist()


def test_in_a_hollow_corner_there_is_no_joint_of_its_own() -> None:
    joints, reached = outline(ELL).joints(np.array([15.0, 40.0]))
    assert reached.tolist() == [True, False]
    assert joints.join.round(6).tolist() == [[15, -0.75], [10.75, 10.75]]


NORTH = Joints(*(np.array(a) for a in ([0], [0.0], [[0.0, 0.0]], [0.0], [[3.0, 4.0]], [[0.0, 1.0]])))
EAST = np.array([[1.0, 0.0]])


def test_a_line_is_turned_towards_where_the_torch_comes_from() -> None:
    leads = shaped(LeadShape("line", 0.0, math.radians(30)), NORTH, EAST, np.array([2.0]), 1.0)
    assert leads.pierce[0] == pytest.approx((3 - 1, 4 + math.sqrt(3)))


def test_lengths_run_from_the_longest_to_the_shortest() -> None:
    lengths = [
        shaped(LeadShape("line", s, 0.0), NORTH, EAST, np.array([4.0]), 1.0).length_mm[0] for s in (0.0, 0.5, 1.0)
    ]
    assert lengths == pytest.approx([4, 2, 1])


@given(st.sampled_from([45.0, 60.0, 90.0]), st.floats(1, 9), st.sampled_from([1.0, -1.0]))
def test_an_arc_is_as_long_as_asked_for_and_ends_along_the_cut(sweep: float, length_mm: float, way: float) -> None:
    leads = shaped(LeadShape("arc", 0.0, math.radians(sweep)), NORTH, way * EAST, np.array([length_mm]), 1.0)
    (x, y), (jx, jy) = leads.pierce[0].tolist(), leads.join[0].tolist()
    arc = Segment((x, y), (jx, jy), float(leads.bulge[0]))
    assert arc.length_mm == pytest.approx(length_mm)
    assert arc.tangent_at(1.0) == pytest.approx((way, 0), abs=1e-9)
    assert y > 4


@given(st.floats(-1, 1), st.floats(0, 5))
def test_points_along_a_lead_lie_on_its_arc(bulge: float, left_out_mm: float) -> None:
    drawn = Segment((1.0, 2.0), (5.0, -1.0), 0.0 if abs(bulge) < 1e-3 else bulge)
    one = np.array([drawn.length_mm])
    leads = Leads(np.array([drawn.start]), np.array([drawn.end]), np.array([drawn.bulge]), one)
    until = 1 - min(left_out_mm / drawn.length_mm, 0.5)
    points = leads.points(left_out_mm)[0]
    expected = [drawn.point_at(f) for f in np.linspace(0, until, len(points))]
    assert points == pytest.approx(np.array(expected), abs=1e-9)
