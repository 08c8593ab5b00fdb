"""The torch's path lies in the waste, half a kerf off the contour."""

from __future__ import annotations

import math

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.torch_path import compensated
from kerfwise.rules.case import circle, part, rect

DRAWN = part("A", rect(0, 0, 40, 40), [circle(20, 20, 5)], [[(2, 2), (9, 2)]])


def test_outside_an_outer_contour_and_inside_a_hole() -> None:
    assert compensated(DRAWN.outer, 2.0).length_mm == pytest.approx(160 + math.tau)
    assert compensated(DRAWN.holes[0], 2.0).length_mm == pytest.approx(math.tau * 4)


def test_a_mark_and_a_kerf_of_nothing_change_nothing() -> None:
    assert compensated(DRAWN.marks[0], 2.0) is DRAWN.marks[0].curve
    assert compensated(DRAWN.outer, 0.0) is DRAWN.outer.curve


def test_answers_are_kept() -> None:
    assert compensated(DRAWN.outer, 2.0) is compensated(DRAWN.outer, 2.0)


def test_a_hole_that_the_kerf_fills_is_named() -> None:
    with pytest.raises(InputError, match=r"A\.hole1 at \(15\.0, 20\.0\) .* kerf of 12 mm: .* nothing is left"):
        compensated(DRAWN.holes[0], 12.0)
