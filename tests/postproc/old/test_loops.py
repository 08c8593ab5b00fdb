"""The rounds of a burn: the longest stretches that close, leads and links apart; what has none is refused."""

import math

import numpy as np
import pytest
import shapely

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.postproc.old.loops import NotRound, round_up_to_tab, rounds_of, simplify_ring
from kerfwise.rules.case import rect


def path(*rows: tuple[float, ...]) -> Curve:
    return Curve.of(rows, closed=False)


def test_a_circle_in_one_block_with_an_overcut_behind_it() -> None:
    (found,) = rounds_of(path((0, 0), (10, 0, 1.0), (-10, 0, 1.0), (10, 0, math.tan(0.025)), (10 * math.cos(0.1), 1.0)))
    assert found.ring.length_mm == pytest.approx(20 * math.pi)
    assert found.lead_in.length_mm == pytest.approx(10)
    assert found.lead_out.length_mm == pytest.approx(1.0, abs=0.01)


def test_a_lead_along_the_contour_ends_within_a_block() -> None:
    (found,) = rounds_of(path((0, 4), (0, 10), (20, 10), (20, 0), (0, 0), (0, 7)))
    assert found.ring.length_mm == pytest.approx(60)
    assert (found.lead_in.length_mm, found.lead_out.length_mm) == (0.0, pytest.approx(3))


@pytest.mark.parametrize(
    ("rows", "why"),
    [
        ([(0, 0), (50, 0)], "does not close"),
        ([(0, 0), (50, 0), (50, 50), (0, 50)], "does not close"),
        ([(0, 0), (50, 0), (0, 0)], "does not close"),
        ([(0, 0), (50, 50), (50, 0), (0, 90), (0, 0)], "crosses itself"),
    ],
)
def test_what_is_no_round(rows: list[tuple[float, float]], why: str) -> None:
    with pytest.raises(NotRound, match=why):
        rounds_of(path(*rows))


def test_a_burn_round_several_contours_is_taken_apart_in_order() -> None:
    small, large = rect(0, 0, 9, 9), rect(20, 0, 40, 40)
    for first, then in ((small, large), (large, small)):
        found = rounds_of(path((5, -3), *first, first[0], *then, then[0], (80, 90)))
        assert [one.ring.length_mm for one in found] == [pytest.approx(4 * (b[1][0] - b[0][0])) for b in (first, then)]
        ends = [(one.ring.vertices[0, 0], one.ring.vertices[0, 1]) for one in found]
        assert ends == [first[0], then[0]]
        assert found[1].lead_in.length_mm == pytest.approx(math.dist(first[0], then[0]))


@pytest.mark.parametrize("gap_mm", [1.0, 3.9])
def test_a_round_up_to_a_tab_is_closed_as_it_would_go_on(gap_mm: float) -> None:
    found = round_up_to_tab(path((50, -6), (50, 0), *rect(0, 0, 100, 80)[1:], (0, 0), (50 - gap_mm, 0)), 4.0)
    assert found.ring.length_mm == pytest.approx(360)
    assert found.lead_in.length_mm == pytest.approx(6)


def test_a_tab_on_a_bend_goes_round_with_it() -> None:
    at = [(50 * math.cos(a), 50 * math.sin(a)) for a in np.linspace(0.0, 2 * math.pi - 0.06, 200)]
    found = round_up_to_tab(path((60, 0), *at), 4.0)
    assert abs(found.ring.signed_area_mm2) == pytest.approx(math.pi * 50**2, rel=1e-3)
    middle = shapely.Point(50 * math.cos(0.03), -50 * math.sin(0.03))
    assert found.ring.line(0.001).distance(middle) < 0.02  # chords turn by half a step less


@pytest.mark.parametrize(
    ("rows", "why"),
    [
        ([(50, -6), (50, 0), (100, 0), (100, 80), (0, 80), (0, 0), (45, 0)], "does not close"),  # 5 mm are open
        ([(50, -6), (50, 0), (100, 0), (100, 80), (0, 80), (0, 3)], "does not close"),  # at a corner
        ([(47, 0), (50, 0), (100, 0), (100, 80), (0, 80), (0, 0), (46.5, 0)], "nobody can be sure"),
    ],
)
def test_what_is_not_open_for_a_tab(rows: list[tuple[float, float]], why: str) -> None:
    with pytest.raises(NotRound, match=why):
        round_up_to_tab(path(*rows), 4.0)


def test_a_pierce_alone_is_no_round() -> None:
    with pytest.raises(NotRound, match="only pierces"):
        rounds_of(path((3, 3), (3, 3)))


def test_arcs_that_go_on_are_joined_up_to_half_a_turn() -> None:
    eighth = math.tan(math.pi / 8)
    ring = Curve.of([(10, 0, eighth), (0, 10, eighth), (-10, 0, eighth), (0, -10, eighth)])
    assert len(simplify_ring(ring).segments) == 2
    assert simplify_ring(ring).length_mm == pytest.approx(ring.length_mm)
