import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise import InputError
from kerfwise.encoder.readers.drawing import DEEPEST, LIMIT_MM, MOST_COPIES, check_copies, checked_curve


def test_repeated_vertices_go_and_the_arc_stays() -> None:
    curve = checked_curve([(0, 0, 5), (0, 0, 1), (10, 0), (10, 0), (0, 0)], closed=True)
    assert curve.as_rows() == [[0, 0, 1], [10, 0]]


def test_an_open_curve_may_end_where_it_began() -> None:
    assert len(checked_curve([(0, 0), (10, 0), (0, 0)], closed=False).vertices) == 3


def test_a_curve_of_one_point_keeps_it() -> None:
    for closed in (True, False):
        assert checked_curve([(3, 4), (3, 4)], closed).vertices[:, :2].tolist() == [[3, 4]]


def test_scaling_leaves_bulges_alone() -> None:
    assert checked_curve([(1, 2, 0.5), (3, 4)], False, 25.4).as_rows() == [[25.4, 50.8, 0.5], [76.2, 101.6]]


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("column", [0, 1, 2])
def test_what_is_no_number_is_refused(bad: float, column: int) -> None:
    row = [1.0, 2.0, 0.5]
    row[column] = bad
    with pytest.raises(InputError, match="not a finite number"):
        checked_curve([row, (5, 5)], closed=True)


def test_a_kilometre_is_the_end_of_the_world() -> None:
    assert checked_curve([(0, 0), (LIMIT_MM, 0)], False).length_mm == LIMIT_MM
    with pytest.raises(InputError, match=r"\(1e\+09, 0\) mm lies more than a kilometre"):
        checked_curve([(0, 0), (1e6, 0)], False, scale=1000)
    with pytest.raises(InputError, match=r"bulge 100000 is wider than a kilometre"):
        checked_curve([(0, 0, 1e5), (100, 0)], True)


@given(
    st.lists(st.tuples(*[st.floats(allow_nan=True, allow_infinity=True)] * 3), min_size=1, max_size=5), st.booleans()
)
def test_any_numbers_give_a_finite_curve_or_an_input_error(
    rows: list[tuple[float, float, float]], closed: bool
) -> None:
    try:
        curve = checked_curve(rows, closed)
    except InputError:
        return
    assert np.isfinite(curve.vertices).all()
    assert np.isfinite(curve.flatten(1.0)).all()


def test_an_arc_as_flat_as_a_line_is_one() -> None:
    assert checked_curve([(0, 0, 1e-9), (100, 0)], False).as_rows() == [[0, 0], [100, 0]]
    assert checked_curve([(0, 0, 1e-4), (100, 0)], False).as_rows() == [[0, 0, 1e-4], [100, 0]]


def test_a_bulge_that_is_no_number_between_points_that_are_one_is_straight() -> None:
    rows = [(0, 0, 0), (10, 0, math.nan), (10, 0.0005, 0), (10, 10, 0)]
    assert checked_curve(rows, closed=True).as_rows() == [[0, 0], [10, 0], [10, 0.0005], [10, 10]]
    with pytest.raises(InputError, match="not a finite number"):
        checked_curve([(0, 0, 0), (10, 0, math.nan), (10, 5, 0)], closed=True)


LEVELS = 24


def test_as_many_copies_as_may_be_and_one_more() -> None:
    def drawing(copies: int) -> None:
        check_copies("sheet", {"sheet": (7, [("part", copies // 2)]), "part": (1, [])}.__getitem__, "block")

    drawing(MOST_COPIES)
    with pytest.raises(InputError, match=f"unfolds to {MOST_COPIES + 2:,} copies"):
        drawing(MOST_COPIES + 2)


def test_blocks_within_blocks_are_counted_once_however_often_they_are_used() -> None:
    asked = []

    def made_of(level: int) -> tuple[int, list[tuple[int, int]]]:
        asked.append(level)
        return 1, [(level + 1, 1), (level + 1, 1)] if level < LEVELS else []

    with pytest.raises(InputError, match=f"unfolds to {2 ** (LEVELS + 2) - 4:,} copies"):
        check_copies(0, made_of, "block")
    assert len(asked) <= LEVELS + 2


def test_a_block_that_contains_itself() -> None:
    with pytest.raises(InputError, match=f"over {DEEPEST} deep: a block seems to contain itself"):
        check_copies("a", {"a": (0, [("b", 2)]), "b": (0, [("a", 2)])}.__getitem__, "block")
