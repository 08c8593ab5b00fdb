"""Different numbers and pairs are those of a set, in order."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.arrays import unique, unique_pairs

pairs = st.lists(st.tuples(st.integers(0, 5), st.integers(0, 9)), max_size=30)


@given(st.lists(st.integers(-9, 9), max_size=30))
def test_numbers(numbers: list[int]) -> None:
    assert unique(np.array(numbers, dtype=np.int64)).tolist() == sorted(set(numbers))


@given(pairs)
def test_pairs(rows: list[tuple[int, int]]) -> None:
    found = unique_pairs(np.array(rows, dtype=np.int64).reshape(-1, 2))
    assert found.tolist() == [list(row) for row in sorted(set(rows))]
    assert found.shape == (len(set(rows)), 2)
