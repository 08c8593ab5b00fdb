"""The round of a burn: the longest stretch that closes, leads apart; what is no single round is refused."""

import math

import pytest

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.postproc.old.loops import NoRound, round_of, tidied


def path(*rows: tuple[float, ...]) -> Curve:
    return Curve.of(rows, closed=False)


def test_a_circle_in_one_block_with_an_overcut_behind_it() -> None:
    found = round_of(path((0, 0), (10, 0, 1.0), (-10, 0, 1.0), (10, 0, math.tan(0.025)), (10 * math.cos(0.1), 1.0)))
    assert found.ring.length_mm == pytest.approx(20 * math.pi)
    assert found.lead_in.length_mm == pytest.approx(10)
    assert found.lead_out.length_mm == pytest.approx(1.0, abs=0.01)


def test_a_lead_along_the_contour_ends_within_a_block() -> None:
    found = round_of(path((0, 4), (0, 10), (20, 10), (20, 0), (0, 0), (0, 7)))
    assert found.ring.length_mm == pytest.approx(60)
    assert (found.lead_in.length_mm, found.lead_out.length_mm) == (0.0, pytest.approx(3))


@pytest.mark.parametrize(
    ("rows", "why"),
    [
        ([(0, 0), (50, 0)], "does not close"),
        ([(0, 0), (50, 0), (50, 50), (0, 50)], "does not close"),
        ([(0, 0), (50, 0), (0, 0)], "does not close"),
        ([(0, 0), (50, 50), (50, 0), (0, 90), (0, 0)], "crosses itself"),
        ([(0, 0), (9, 0), (9, 9), (0, 9), (0, 0), (20, 0), (60, 0), (60, 40), (20, 40), (20, 0)], "several contours"),
    ],
)
def test_what_is_no_single_round(rows: list[tuple[float, float]], why: str) -> None:
    with pytest.raises(NoRound, match=why):
        round_of(path(*rows))


def test_a_pierce_alone_is_no_round() -> None:
    with pytest.raises(NoRound, match="only pierces"):
        round_of(path((3, 3), (3, 3)))


def test_arcs_that_go_on_are_joined_up_to_half_a_turn() -> None:
    eighth = math.tan(math.pi / 8)
    ring = Curve.of([(10, 0, eighth), (0, 10, eighth), (-10, 0, eighth), (0, -10, eighth)])
    assert len(tidied(ring).segments) == 2
    assert tidied(ring).length_mm == pytest.approx(ring.length_mm)
