"""Rows without comments, which are most, are read at once: as those with comments are, character by character."""

import re

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.check.reader import controls


def read(text: str) -> tuple[controls.Row | None, tuple[str, int | None] | None]:
    try:
        return controls.row_of(text, 7), None
    except InputError as error:
        return None, (error.message, error.column)


@given(st.text("gGxX10.-\t ()%;ä\x7f\x0b", max_size=12))
@example("g1 x 10.5")
@example(" \t")
@example("")
def test_both_ways_read_the_same(text: str) -> None:
    at_once = read(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(controls, "_COMMENTED", re.compile(""))
        assert read(text) == at_once
