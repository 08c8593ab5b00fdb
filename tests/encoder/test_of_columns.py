"""Objects made of columns are those that calls make."""

from __future__ import annotations

import pickle
from dataclasses import FrozenInstanceError
from itertools import repeat

import pytest

from kerfwise.encoder.of_columns import of_columns
from kerfwise.rules.statements import About, Precede

ABOUT = About("r", ("A", "B"), "A is cut before B")


def test_they_are_equal_and_as_frozen() -> None:
    called = [Precede(k, k + 1, ABOUT, 5.0) for k in range(3)]
    made = of_columns(Precede, 3, before=range(3), after=iter([1, 2, 3]), about=repeat(ABOUT), weight=repeat(5.0))
    assert made == called
    assert [hash(one) for one in made] == [hash(one) for one in called]
    assert [repr(one) for one in made] == [repr(one) for one in called]
    assert pickle.loads(pickle.dumps(made)) == called
    with pytest.raises(FrozenInstanceError):
        made[0].before = 7  # type: ignore[misc]


def test_none_are_made_of_no_rows() -> None:
    assert of_columns(Precede, 0, before=[], after=[], about=[], weight=repeat(None)) == []


@pytest.mark.parametrize("after", [[1], [1, 2, 3]])
def test_columns_of_other_lengths_are_refused(after: list[int]) -> None:
    with pytest.raises(ValueError, match=f"^{len(after)} values of after, expected 2$"):
        of_columns(Precede, 2, before=[0, 1], after=after, about=repeat(ABOUT), weight=repeat(None))
