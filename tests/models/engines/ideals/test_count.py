"""Counting the sets that can occur, on orders whose numbers are known, and what a proof may spend."""

from __future__ import annotations

import math

import pytest

from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals import count_sets
from kerfwise.models.engines.ideals.lattice import TooLarge, expect
from kerfwise.models.engines.ideals.sets import Growth
from kerfwise.models.engines.solution import TABLE_BYTES
from kerfwise.tests.models.engines.ideals.chains import chains
from kerfwise.tests.models.problems import problem, scattered


def test_any_of_ten_contours_may_be_out_where_nothing_is_ordered() -> None:
    count = count_sets(scattered(1, contours=10, sites=3), math.inf)
    assert (count.sets, count.entries, count.states) == (2**10 - 1, 10 * 2**9, 3 * 10 * 2**9)
    # from each of the 2^10 sets k of which are out, 3k last sites to 3 (10 - k) next ones, and from home
    assert count.additions == 9 * 10 * 9 * 2**8 + 30
    assert count.whole
    assert count.fits(TABLE_BYTES)
    assert not count.fits(100)


def test_two_chains_of_more_contours_than_a_word_has_bits() -> None:
    count = count_sets(chains(2, 35), math.inf)
    assert count.sets == 36 * 36 - 1
    assert (count.stretches, count.longest) == (1, 70)


@pytest.mark.parametrize("slots", [1, 64])
def test_a_table_that_gets_too_small_is_made_anew(slots: int, monkeypatch: pytest.MonkeyPatch) -> None:
    wide = scattered(2, contours=12, sites=2, pairs=4, blocks=[(0, 1, 2)])
    known = count_sets(wide, math.inf)
    monkeypatch.setattr("kerfwise.models.engines.ideals.sets.SLOTS_AT_FIRST", slots)
    assert count_sets(wide, math.inf) == known


def test_contours_kept_together_are_counted_as_they_can_be_cut() -> None:
    apart = scattered(1, contours=4, sites=1)
    together = scattered(1, contours=4, sites=1, blocks=[(0, 1), (2, 3)])
    assert count_sets(apart, math.inf).sets == 15
    # one pair whole, and the other empty, half (two ways) or whole, either way round; or but half of the first
    assert count_sets(together, math.inf).sets == 4 + 2 + 4 + 1


def test_zones_are_counted_one_after_the_other() -> None:
    line = problem([[(float(x), 0.0)] for x in range(6)], pairs=[(i, j) for i in range(6) for j in range(i + 1, 6)])
    count = count_sets(line, math.inf)
    assert (count.sets, count.stretches, count.longest) == (6, 6, 1)


def test_it_gives_up_early_where_sets_are_bound_to_be_too_many() -> None:
    count = count_sets(scattered(1, contours=60, sites=1), 1e5)
    assert not count.whole
    assert not count.fits(TABLE_BYTES)
    assert count.sets < 1e5
    assert str(count).startswith("more than ")


def test_counting_ends_where_nobody_wants_it_any_more() -> None:
    layers = iter([True, True, False])
    count = count_sets(scattered(1, contours=10, sites=3), math.inf, lambda entries: next(layers))
    assert not count.whole
    assert 0 < count.sets < count_sets(scattered(1, contours=10, sites=3), math.inf).sets


def test_a_layer_that_does_not_fit_is_not_begun() -> None:
    layer = Growth(entries=1000, states=8000, additions=1e6)

    def begin(additions: float, free: float, going: bool) -> None:
        expect(Deadline(additions, listener=lambda *_: going), layer, 500, 1, 4, free)

    with pytest.raises(TooLarge):
        begin(1e12, 1e4, going=True)
    with pytest.raises(TooLarge):
        begin(1e6, 1e9, going=True)
    with pytest.raises(TooLarge):
        begin(1e12, 1e9, going=False)
    begin(1e12, 1e9, going=True)
