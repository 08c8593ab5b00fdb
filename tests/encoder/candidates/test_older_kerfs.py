"""What candidates meet of older cuts, by hand."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise import Nest
from kerfwise.encoder.candidates import build_candidates, build_with_older_kerfs
from kerfwise.encoder.candidates.older_kerfs import OlderKerfs, older_kerfs, resolve_lead_conflicts
from kerfwise.rule_kit import Candidate, Curve, LeadOptions, circle, nest, part, rect

TWO = nest(
    400, 200, part("A", rect(50, 50, 100, 100), marks=[[(60, 60), (90, 60)]]), part("B", rect(160, 50, 100, 100))
)
KERF_MM, SPLASH_MM = 1.5, 0.5


def entered(contour: int, pierce: tuple[float, float], join: tuple[float, float], edge: bool = False) -> Candidate:
    """A candidate with a straight lead-in."""
    lead = Curve.of([pierce, join], closed=False)
    return Candidate(contour, 0.0, join, "cw", pierce, lead, None, join, 400.0, edge)


def met(*candidates: Candidate, where: Nest = TWO) -> tuple[list[list[int]], list[list[int]]]:
    """Rows of rings and of leads."""
    found = older_kerfs(where, candidates, KERF_MM, SPLASH_MM)
    return found.rings.tolist(), found.leads.tolist()


A, B = TWO.index["A.outer"], TWO.index["B.outer"]


def test_a_pierce_keeps_half_a_kerf_and_the_splash_from_the_kerf_of_a_neighbour() -> None:
    assert met(entered(A, (157.25, 100), (150.75, 100)))[0] == []
    assert met(entered(A, (157.26, 100), (150.75, 100)))[0] == [[0, B]]


def test_a_lead_does_not_enter_the_kerf_of_a_neighbour() -> None:
    low = (158.4, 40.0)  # the lead passes B's corner (160, 50)
    assert met(entered(A, low, (150.75, 60)))[0] == []
    assert met(entered(A, (166, 40.0), (155, 51.0)))[0] == []
    assert met(entered(A, (166, 44.0), (155, 52.0)))[0] == [[0, B]]


def test_the_last_half_kerf_of_a_lead_lies_beside_its_own_contour() -> None:
    close = nest(400, 200, part("A", rect(50, 50, 100, 100)), part("B", rect(152, 50, 100, 100)))
    # Across the lead's end the kerf of B reaches from 150.5 to 152: only the end of the lead, at 150.75, lies in it.
    assert met(entered(0, (149.0, 46.0), (150.75, 49.99)), where=close)[0] == []


def test_leads_meet_in_both_orders_or_in_one() -> None:
    below, above = entered(A, (154, 100), (150.75, 100)), entered(B, (156, 100.6), (159.25, 100.6))
    assert met(below, above)[1] == []
    near = entered(B, (155.4, 100.6), (159.25, 100.6))
    assert met(below, near)[1] == [[0, 1], [1, 0]]
    passing = entered(B, (156.3, 110), (156.3, 60))  # B's lead passes near A's pierce, but not near A's lead
    assert met(entered(A, (154.5, 100), (150.75, 100)), passing)[1] == [[0, 1]]


def test_own_cuts_marks_and_edge_starts_are_left_out() -> None:
    assert met(entered(A, (51, 49), (51, 49.25)), entered(A, (51.5, 49), (51.5, 49.25))) == ([], [])
    assert met(entered(A, (157.5, 100), (150.75, 100), edge=True))[0] == []
    assert met(entered(TWO.index["A.mark1"], (60, 60), (90, 60))) == ([], [])
    assert older_kerfs(TWO, (), KERF_MM, SPLASH_MM).rings.shape == OlderKerfs.none().leads.shape == (0, 2)


def test_in_a_wide_street_every_lead_keeps_to_its_own_half() -> None:
    for gap in (6.0, 8.0, 12.0, 20.0):
        parts = [part(f"P{k}", rect(20 + (60 + gap) * (k % 3), 20 + (40 + gap) * (k // 3), 60, 40)) for k in range(9)]
        sheet = nest(400, 300, *parts)
        found = older_kerfs(sheet, build_candidates(sheet, LeadOptions()), KERF_MM, SPLASH_MM)
        assert len(found.rings) == len(found.leads) == 0, gap
        assert len(build_candidates(sheet, LeadOptions())) == 9 * 16, gap


def test_in_a_narrow_street_no_two_leads_meet_either() -> None:
    for gap in (4.0, 4.5, 5.0):
        parts = [part(f"P{k}", rect(20 + (60 + gap) * (k % 3), 20 + (40 + gap) * (k // 3), 60, 40)) for k in range(9)]
        sheet = nest(400, 300, *parts)
        ways = build_candidates(sheet, LeadOptions(pierce_clearance_mm=1.5, edge_start=False))
        found = older_kerfs(sheet, ways, KERF_MM, SPLASH_MM)
        assert len(found.leads) == 0, gap
        free = {c.contour for k, c in enumerate(ways) if k not in set(found.rings[:, 0].tolist())}
        assert free == set(range(9)), gap


def test_without_the_rule_nothing_is_asked() -> None:
    parts = [part(f"P{k}", rect(20 + 64 * k, 20, 60, 40)) for k in range(3)]
    sheet = nest(300, 100, *parts, part("D", circle(240, 50, 20)))
    plain = build_candidates(sheet, LeadOptions(splash_mm=None, edge_start=False))
    assert len(older_kerfs(sheet, plain, KERF_MM, SPLASH_MM).leads) > 0
    assert np.array_equal([c.contour for c in plain], sorted(c.contour for c in plain))


@pytest.mark.parametrize(("gap_mm", "rings", "leads"), [(2.5, True, False), (4.0, False, True), (5.0, False, False)])
def test_what_is_known_from_thinning_is_what_is_measured_anew(gap_mm: float, rings: bool, leads: bool) -> None:
    """Two entries that face each other are asked for, so that in a street of 4 mm both stay."""
    squares = [part(f"P{k}", rect(10 + k % 3 * (50 + gap_mm), 10 + k // 3 * (50 + gap_mm), 50, 50)) for k in range(6)]
    asked = {"P0.outer": (60.0, 35.0), "P1.outer": (60.0 + gap_mm, 35.0)} if gap_mm == 4.0 else {}
    options = LeadOptions(entries=2, lead_in_mm=4.0, lead_in_min_mm=1.0, splash_mm=SPLASH_MM, entry_points=asked)
    street = nest(250, 200, *squares, part("M", rect(200, 10, 30, 30), marks=[[(205, 20), (220, 20)]]))
    candidates, known = build_with_older_kerfs(street, options)
    assert known is not None
    anew = older_kerfs(street, candidates, options.kerf_mm, SPLASH_MM)
    assert (known.rings.tolist(), known.leads.tolist()) == (anew.rings.tolist(), anew.leads.tolist())
    assert (len(known.rings) > 0, len(known.leads) > 0) == (rings, leads)


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
