"""Rows that are there once, and work done side by side."""

from __future__ import annotations

import subprocess
import sys
import threading

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.arrays import in_parallel, unique, unique_pairs

pairs = st.lists(st.tuples(st.integers(0, 5), st.integers(0, 9)), max_size=30)


@given(st.lists(st.integers(-9, 9), max_size=30))
def test_numbers(numbers: list[int]) -> None:
    assert unique(np.array(numbers, dtype=np.int64)).tolist() == sorted(set(numbers))


@given(pairs)
def test_pairs(rows: list[tuple[int, int]]) -> None:
    found = unique_pairs(np.array(rows, dtype=np.int64).reshape(-1, 2))
    assert found.tolist() == [list(row) for row in sorted(set(rows))]
    assert found.shape == (len(set(rows)), 2)


@pytest.mark.parametrize("pays", [True, False])
def test_each_answer_is_in_its_place(pays: bool) -> None:
    assert in_parallel(lambda: 1, lambda: "two", pays) == (1, "two")


def test_the_second_step_has_a_thread_of_its_own_where_that_pays() -> None:
    met = threading.Barrier(2, timeout=120)
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


def test_a_tree_of_points_comes_with_the_first_one_in_any_thread() -> None:
    """Points that lie equally far come in the same order as from scipy; threads that begin at one time all have one."""
    program = (
        "import sys, numpy as np\n"
        "from concurrent.futures import ThreadPoolExecutor\n"
        "from threading import Barrier\n"
        "from kerfwise.arrays import point_tree\n"
        "assert not {'scipy.spatial', 'scipy.linalg'} & sys.modules.keys()\n"
        "points = np.random.default_rng(1).integers(0, 9, (200, 2)).astype(float)\n"
        "ready = Barrier(4)\n"
        "def near(_): ready.wait(); return point_tree(points, leafsize=10).query(points, k=20)[1]\n"
        "with ThreadPoolExecutor(4) as threads: found = [*threads.map(near, range(4))]\n"
        "from scipy.spatial import KDTree, cKDTree\n"
        "assert all((KDTree(points).query(points, k=20)[1] == one).all() for one in found)\n"
        "assert type(point_tree(points)) is cKDTree\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
