"""What is kept of answers about orders: the last, and that about the largest array, as long as these live."""

from __future__ import annotations

import gc

import numpy as np
import pytest

from kerfwise.arrays import Bools
from kerfwise.models.problem.bitsets import LastAnswer


def orders(n: int) -> Bools:
    return np.zeros((n, n), dtype=np.bool_)


def test_questions_about_small_arrays_leave_the_answer_about_the_largest() -> None:
    last, large, small = LastAnswer[str](), orders(5), [orders(2), orders(3)]
    last.keep(large, b"", "large")
    for one in small:
        last.keep(one, b"", f"small {len(one)}")
    assert last.known(large, b"") == "large"
    assert last.known(small[1], b"") == "small 3"
    assert last.known(small[0], b"") is None


def test_a_larger_array_takes_the_place_of_the_largest() -> None:
    last, large, larger, small = LastAnswer[str](), orders(5), orders(6), orders(2)
    for one in (large, larger, small):
        last.keep(one, b"", str(len(one)))
    assert last.known(large, b"") is None
    assert last.known(larger, b"") == "6"
    assert last.known(small, b"") == "2"


def test_another_question_about_the_same_array_takes_the_place_of_its_answer() -> None:
    last, large = LastAnswer[str](), orders(5)
    last.keep(large, b"one", "1")
    last.keep(large, b"other", "2")
    assert last.known(large, b"one") is None
    assert last.known(large, b"other") == "2"


@pytest.mark.slow
def test_an_answer_goes_with_its_array() -> None:
    last, large, small = LastAnswer[list[int]](), orders(5), orders(2)
    last.keep(large, b"", [1])
    last.keep(small, b"", [2])
    del large
    gc.collect()
    assert len(last._kept) == 1
    assert last.known(small, b"") == [2]
    del small
    gc.collect()
    assert last._kept == []
