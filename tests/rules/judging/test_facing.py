"""Spots are looked at some at a time: what each faces does not depend on how many."""

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from kerfwise.encoder.nest import Nest
from kerfwise.rules.judging import facing
from kerfwise.rules.judging.facing import Facing, Spots, spots_along
from kerfwise.tests.rules.test_statements_agree import sheets


@settings(deadline=None, max_examples=20)
@given(sheets(), st.integers(1, 90))
def test_spots_face_the_same_some_at_a_time(sheet: Nest, some: int) -> None:
    assume(sheet.parts)
    spots = Spots.joined(
        [spots_along(k, p.outer.line, 0.0, p.outer.line.length, 40) for k, p in enumerate(sheet.parts)]
    )
    outlines = Facing(sheet, 25.0, 25.0)
    all_at_once = outlines.faced(spots)
    assert len(all_at_once) == 40 * len(sheet.parts)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(facing, "AT_ONCE", some)
        assert outlines.faced(spots).tolist() == all_at_once.tolist()
    assert outlines.faced(Spots.joined([])).tolist() == []
