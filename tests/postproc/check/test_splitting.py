"""Torch paths taken apart where they join their contour."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.postproc.check import cut_from_burn
from kerfwise.postproc.check.cut_from_burn import Pieces, split, split_each


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


def split_plainly(path: Curve, round_mm: float) -> Pieces | None:
    """Every pair, one by one."""
    v = path.vertices
    at_mm = np.concatenate([[0.0], np.cumsum([math.dist(a, b) for a, b in zip(v[:, :2], v[1:, :2], strict=False)])])
    found = [
        (round(math.dist(v[k, :2], v[m, :2]), 3), round(abs(at_mm[m] - at_mm[k] - round_mm), 3), k, m)
        for k in range(len(v))
        for m in range(k, len(v))
        if 0.5 * round_mm <= at_mm[m] - at_mm[k] <= 1.5 * round_mm
    ]
    if not found:
        return None
    gap_mm, _, k, m = min(found)
    return Pieces(*(Curve(rows, closed=False) for rows in (v[: k + 1], v[k : m + 1], v[m:])), gap_mm)


places = st.tuples(st.integers(-8, 8), st.integers(-8, 8)).map(lambda xy: (xy[0] / 4, xy[1] / 4))


@given(st.lists(places, min_size=2, max_size=30), st.integers(1, 160), st.sampled_from([0, 7, 1 << 18]))
def test_near_pairs_looked_up_by_place_give_what_all_pairs_give(
    points: list[tuple[float, float]], length: int, compared: int
) -> None:
    # lengths that no sum of these steps is half or three halves of
    path, round_mm = Curve.of(points, closed=False), length / 4 + 0.0137
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cut_from_burn, "COMPARED", compared)
        found = split(path, round_mm)
    plain = split_plainly(path, round_mm)
    assert (found is None) == (plain is None)
    if found is not None and plain is not None:
        assert found.gap_mm == plain.gap_mm
        assert [len(c.vertices) for c in (found.lead_in, found.loop, found.lead_out)] == [
            len(c.vertices) for c in (plain.lead_in, plain.loop, plain.lead_out)
        ]


@given(
    st.lists(st.tuples(st.lists(places, min_size=1, max_size=12), st.integers(1, 160)), max_size=8),
    st.sampled_from([0, 7, 40, 1 << 18]),
)
def test_paths_taken_apart_together_come_apart_as_each_does(
    drawn: list[tuple[list[tuple[float, float]], int]], compared: int
) -> None:
    paths, rounds_mm = [Curve.of(points, closed=False) for points, _ in drawn], [length / 4 for _, length in drawn]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cut_from_burn, "COMPARED", compared)
        together = split_each(paths, rounds_mm)
    assert list(map(shown, together)) == [shown(split(*row)) for row in zip(paths, rounds_mm, strict=True)]


def shown(pieces: Pieces | None) -> object:
    if pieces is None:
        return None
    return pieces.gap_mm, *(c.as_rows() for c in (pieces.lead_in, pieces.loop, pieces.lead_out))


def test_a_path_of_many_vertices() -> None:
    """With every pair compared it would take minutes."""
    angle = np.linspace(0.0, 2 * np.pi, 20_000, endpoint=False)
    round_ = np.column_stack([100 * np.cos(angle), 100 * np.sin(angle)]) + np.sin(37 * angle)[:, None] / 100
    path = Curve.of([(130.0, 0.0), *round_.tolist(), round_[0].tolist(), round_[1].tolist()], closed=False)
    pieces = split(path, 628.3)
    assert pieces is not None
    assert (len(pieces.lead_in.vertices), len(pieces.lead_out.vertices), pieces.gap_mm) == (2, 2, 0.0)
