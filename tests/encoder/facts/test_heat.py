from __future__ import annotations

import pytest

from kerfwise.encoder.facts.outlines import outlines_of
from kerfwise.encoder.facts.relations import heat
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import circle, nest, part, rect


def heat_of(given: Nest) -> tuple[list[float], list[int]]:
    cut_mm, parts = heat(outlines_of(given), given.sheet.bounds)
    return cut_mm.tolist(), parts.tolist()


def test_cut_length_is_split_exactly_at_the_middle() -> None:
    # 500 | 500: 100 of each long side lie to the left, 50 of them to the right.
    cut_mm, _ = heat_of(nest(1000, 400, part("A", rect(400, 10, 150, 80))))
    assert cut_mm == [100 * 2 + 80, 50 * 2 + 80, 460, 0]


def test_holes_count_and_marks_do_not() -> None:
    hole = circle(100, 100, 10)
    plate = part("A", rect(50, 50, 100, 100), [hole], [[(60, 60), (140, 60)]])
    cut_mm, _ = heat_of(nest(1000, 400, plate))
    assert cut_mm == pytest.approx([400 + 62.83, 0, 400 + 62.83, 0], abs=0.05)


def test_a_line_on_the_middle_counts_half_on_each_side() -> None:
    cut_mm, _ = heat_of(nest(1000, 400, part("A", rect(500, 10, 100, 80))))
    assert cut_mm[:2] == [40, 320]


def test_small_parts_are_counted_by_centroid() -> None:
    parts = part("A", rect(10, 10, 50, 50)), part("B", rect(10, 100, 60, 60)), part("C", rect(600, 10, 300, 300))
    assert heat_of(nest(1000, 400, *parts))[1] == [2, 0, 2, 0]
    assert heat_of(nest(1000, 400, part("A", rect(475, 10, 50, 50))))[1][:2] == [0, 0]
