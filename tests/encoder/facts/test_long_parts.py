from __future__ import annotations

import math

import pytest

from kerfwise.encoder.facts.outlines import outlines_of
from kerfwise.encoder.facts.relations import long_parts
from kerfwise.rules.case import Rows, nest, part, rect


def turned(rows: Rows, degrees: float) -> Rows:
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return [(300 + x * c - y * s, 300 + x * s + y * c) for x, y in rows]


@pytest.mark.parametrize("degrees", [0, 30, 90, 137])
@pytest.mark.parametrize(("length", "is_long"), [(199, False), (200, True), (201, True)])
def test_four_to_one_at_any_angle(degrees: float, length: float, is_long: bool) -> None:
    strip = part("A", turned(rect(0, 0, length, 50), degrees), [turned(rect(10, 10, 40, 2), degrees)])
    assert long_parts(outlines_of(nest(900, 900, strip)), 4.0).tolist() == [False, is_long]
