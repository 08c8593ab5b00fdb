"""Made instances: the same for a seed, lawful, solved both ways."""

from __future__ import annotations

import numpy as np
import pytest

from kerfwise.benchmarks.sparse_orders import FAMILIES, Family, by_search, made


def test_equal_seeds_make_equal_instances_and_others_do_not() -> None:
    family = Family(60, share=0.02)
    one, same, other = made(family, 1), made(family, 1), made(family, 2)
    assert np.array_equal(one.cost, same.cost)
    assert np.array_equal(one.orders, same.orders)
    assert not np.array_equal(one.orders, other.orders)
    assert len({str(each) for each in FAMILIES}) == len(FAMILIES)


def test_pairs_are_as_many_as_asked_for_and_share_no_contour() -> None:
    family = Family(50, pairs=20)
    inner = [(a, b) for a, b in made(family, 3).orders.tolist() if a != 0 and b != 51]
    assert len(inner) == 20
    assert len({contour for order in inner for contour in order}) == 40


@pytest.mark.full
def test_chains_and_annealing_are_both_run() -> None:
    instance = made(Family(60, share=0.01), 1)
    annealed, chained = (by_search(instance, 0.05, chains) for chains in (False, True))
    assert chained < annealed
