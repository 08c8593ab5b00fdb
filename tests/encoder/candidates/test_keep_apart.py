"""Candidates are thinned out until none meets another's lead."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.candidates import Candidate
from kerfwise.encoder.candidates.older_kerfs import OlderKerfs, resolve_lead_conflicts


def ways(*contours: int) -> list[Candidate]:
    """A candidate a contour number, told apart by where they enter."""
    return [Candidate(c, float(k), (k, 0.0), "cw", (k, 0.0), None, None, (k, 0.0), 1.0) for k, c in enumerate(contours)]


def meetings(leads: Sequence[tuple[int, int]], rings: Sequence[tuple[int, int]] = ()) -> OlderKerfs:
    return OlderKerfs(np.array(rings, dtype=np.int64).reshape(-1, 2), np.array(leads, dtype=np.int64).reshape(-1, 2))


def kept(contours: Sequence[int], met: OlderKerfs, locked: Sequence[int] = ()) -> list[int]:
    return list(resolve_lead_conflicts(ways(*contours), met, locked))


def test_what_meets_nothing_stays() -> None:
    assert kept((0, 0, 1), meetings([])) == [0, 1, 2]


def test_of_two_that_meet_the_contour_with_fewer_others_keeps_its_own() -> None:
    assert kept((0, 0, 1), meetings([(1, 2)])) == [0, 2]
    assert kept((0, 1, 1), meetings([(1, 0)])) == [0, 2]


def test_of_its_own_a_contour_keeps_what_meets_no_kerf() -> None:
    assert kept((0, 0, 1, 1), meetings([(0, 2), (1, 2), (0, 3)], rings=[(0, 1)])) == [1, 3]


def test_what_an_operator_asks_for_stays() -> None:
    assert kept((0, 0, 1), meetings([(1, 2)]), locked=[1]) == [0, 1, 2]


def test_a_contour_that_would_have_nothing_keeps_all() -> None:
    assert kept((0, 1), meetings([(0, 1)])) == [0, 1]


@given(
    st.lists(st.integers(0, 4), min_size=1, max_size=14).map(sorted),
    st.lists(st.tuples(st.integers(0, 13), st.integers(0, 13)), max_size=30),
)
def test_none_that_meet_are_left_but_where_a_contour_would_have_nothing(
    contours: list[int], pairs: list[tuple[int, int]]
) -> None:
    n = len(contours)
    met = sorted({(a, b) for a, b in pairs if a < n and b < n and contours[a] != contours[b]})
    left = kept(contours, meetings(met))
    assert {contours[k] for k in left} == set(contours)
    assert set(range(n)) - {k for pair in met for k in pair} <= set(left)
    whole = Counter(contours)
    untouched = {c for c, count in Counter(contours[k] for k in left).items() if count == whole[c]}
    for a, b in met:
        if a in left and b in left:
            assert untouched & {contours[a], contours[b]}
