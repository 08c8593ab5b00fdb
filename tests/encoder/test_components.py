"""Connected components: the same without the library as with it."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.arrays import Ints
from kerfwise.encoder.graphs import strong_components, weak_components

LINKS = st.lists(st.tuples(st.integers(0, 7), st.integers(0, 7)), max_size=14)


def _same_groups(one: Ints, other: Ints) -> bool:
    return bool(((one[:, None] == one) == (other[:, None] == other)).all())


@given(LINKS)
def test_by_plain_python_as_by_the_library(links: list[tuple[int, int]]) -> None:
    pairs = np.array(links, dtype=np.int64).reshape(-1, 2)
    assert _same_groups(strong_components(8, pairs), strong_components(8, pairs, few=-1))
    assert weak_components(8, pairs).tolist() == weak_components(8, pairs, few=-1).tolist()


def test_no_nodes() -> None:
    none = np.empty((0, 2), dtype=np.int64)
    assert len(strong_components(0, none)) == len(weak_components(0, none)) == 0
