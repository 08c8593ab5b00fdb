from __future__ import annotations

import numpy as np
import pytest

from kerfwise.encoder.facts.outlines import outlines_of
from kerfwise.encoder.facts.relations import edge_gaps, offcuts
from kerfwise.rules.case import nest, part, rect


def test_gaps_are_to_left_right_bottom_top() -> None:
    given = nest(1000, 500, part("A", rect(10, 20, 300, 400), [rect(100, 100, 50, 50)]))
    gaps = edge_gaps(outlines_of(given), given.sheet.bounds)
    assert gaps.tolist() == [[100, 850, 100, 350], [10, 690, 20, 80]]


@pytest.mark.parametrize(("gap", "large"), [(149, False), (150, False), (151, True)])
def test_an_offcut_is_large_over_its_share_of_the_extent_that_way(gap: float, large: bool) -> None:
    depth, is_large = offcuts(np.array([[gap, 10.0, 10.0, 10.0], [400.0, 500.0, 10.0, 10.0]]), (0, 0, 1000, 500), 0.15)
    assert depth.tolist() == [gap, 10, 10, 10]
    assert is_large.tolist() == [large, False, False, False]


def test_an_empty_sheet_is_all_offcut() -> None:
    depth, large = offcuts(np.empty((0, 4)), (0, 0, 1000, 500), 0.15)
    assert depth.tolist() == [1000, 1000, 500, 500]
    assert large.all()
