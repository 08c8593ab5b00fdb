import itertools

import numpy as np
import pytest

from kerfwise.encoder.readers.join import endpoint_clusters


def numbers(ends: list[tuple[float, float]], lengths: list[float], tolerance: float = 0.1) -> list[int]:
    return endpoint_clusters(np.array(ends, dtype=float), np.array(lengths), tolerance).tolist()


def test_ends_a_rounding_apart_are_one_point_however_many() -> None:
    found = numbers([(0, 0), (9, 0), (9, 1e-4), (9, 9), (9, -1e-4), (0, 9)], [9, 9, 13])
    assert found[1] == found[2] == found[4]
    assert len(set(found)) == 4


@pytest.mark.parametrize(("gap", "meet"), [(0.0, True), (0.05, True), (0.0999, True), (0.11, False)])
def test_lone_ends_meet_within_the_tolerance(gap: float, meet: bool) -> None:
    found = numbers([(0, 0), (10, 0), (10 + gap, 0), (20, 0)], [10, 10])
    assert (found[1] == found[2]) is meet


def test_the_closest_pair_meets_and_the_third_stays_alone() -> None:
    found = numbers([(0, 0), (10, 0), (10.09, 0), (20, 0), (10.03, 0), (10, 20)], [10, 10, 20])
    assert found[1] == found[4] != found[2]


def test_short_chords_do_not_melt_into_one_point() -> None:
    steps = [k * 0.05 for k in range(41)]
    ends = [p for a, b in itertools.pairwise(steps) for p in ((a, 0.0), (b, 0.0))]
    assert len(set(numbers(ends, [0.05] * 40, tolerance=0.1))) == 41


def test_a_long_piece_closes_on_itself_and_a_short_one_does_not() -> None:
    assert len(set(numbers([(0, 0), (0.05, 0)], [100.0]))) == 1
    assert len(set(numbers([(0, 0), (0.05, 0)], [0.05]))) == 2
