"""Two steps side by side: both answers, in their places, and errors of either."""

from __future__ import annotations

import threading

import pytest

from kerfwise.arrays import in_parallel


@pytest.mark.parametrize("pays", [True, False])
def test_each_answer_is_in_its_place(pays: bool) -> None:
    assert in_parallel(lambda: 1, lambda: "two", pays) == (1, "two")


def test_the_second_step_has_a_thread_of_its_own_where_that_pays() -> None:
    met = threading.Barrier(2, timeout=20)
    assert in_parallel(met.wait, met.wait) in {(0, 1), (1, 0)}
    here = threading.get_ident()
    assert in_parallel(threading.get_ident, threading.get_ident, False) == (here, here)


@pytest.mark.parametrize("pays", [True, False])
def test_an_error_of_either_is_raised(pays: bool) -> None:
    def wrong() -> int:
        raise ValueError("wrong")

    with pytest.raises(ValueError, match="wrong"):
        in_parallel(lambda: 1, wrong, pays)
    with pytest.raises(ValueError, match="wrong"):
        in_parallel(wrong, lambda: 1, pays)
