"""What the facts say of older kerfs is what the check finds, for two cuts in either order."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import pytest

from kerfwise.encoder.candidates import Candidate, LeadOptions, build_candidates
from kerfwise.encoder.candidates.older_kerfs import older_kerfs
from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.judging.pierces import leads_over_older_kerfs
from kerfwise.tests.tools.amount import few

KERF_MM, SPLASH_MM = 1.5, 0.5
SHEETS = {
    "street of 3.3 mm": nest(200, 120, part("A", rect(20, 20, 60, 60)), part("B", rect(83.3, 30, 60, 60))),
    "street of 4.1 mm": nest(200, 120, part("A", rect(20, 20, 60, 60)), part("B", rect(84.1, 30, 60, 60))),
    "discs": nest(
        200, 120, part("A", circle(50, 60, 30)), part("B", circle(113.7, 60, 30)), part("C", circle(82, 98, 13))
    ),
    "guest": nest(200, 200, part("H", rect(20, 20, 120, 120), [rect(40, 40, 60, 60)]), part("G", rect(44, 44, 52, 51))),
}
LEADS = {
    "lines": LeadOptions(entries=6, splash_mm=None, edge_start=False),
    "arcs in and out": LeadOptions(entries=5, lead="arc", lead_out="arc", splash_mm=None, edge_start=False),
    "lines out": LeadOptions(entries=5, lead_out="line", hole_overcut_mm=3.0, splash_mm=None, edge_start=False),
}


def cut_of(sheet: Nest, candidate: Candidate) -> Cut:
    name = sheet.contours[candidate.contour].id
    return Cut(name, candidate.entry, candidate.direction, candidate.pierce, candidate.lead_in, candidate.lead_out)


@pytest.mark.slow
@pytest.mark.parametrize("sheet", few(SHEETS))
@pytest.mark.parametrize("leads", LEADS)
def test_two_cuts_in_either_order(leads: str, sheet: str) -> None:
    where = SHEETS[sheet]
    options = replace(LEADS[leads], pierce_clearance_mm=1.2)
    ways = build_candidates(where, options)
    met = older_kerfs(where, ways, KERF_MM, SPLASH_MM)
    rings, pairs = set(map(tuple, met.rings.tolist())), set(map(tuple, met.leads.tolist()))
    assert rings or pairs
    slack = {row for mm in (SPLASH_MM - 0.07, SPLASH_MM + 0.07) for row in _rows(where, ways, mm)} - {
        row for row in _rows(where, ways, SPLASH_MM - 0.07) if row in _rows(where, ways, SPLASH_MM + 0.07)
    }
    compared = 0
    for (e, earlier), (k, later) in permutations(enumerate(ways), 2):
        if earlier.contour == later.contour or (k, e) in slack:
            continue
        cuts = CutSequence((cut_of(where, earlier), cut_of(where, later)))
        found = list(leads_over_older_kerfs(where, cuts, KERF_MM, SPLASH_MM))
        assert bool(found) == ((k, earlier.contour) in rings or (k, e) in pairs), (e, k, found)
        compared += 1
    assert compared > 50


def _rows(where: Nest, ways: tuple[Candidate, ...], splash_mm: float) -> set[tuple[int, int]]:
    """Pairs (later, earlier) of candidates that meet, the one way or the other, with this splash."""
    met = older_kerfs(where, ways, KERF_MM, splash_mm)
    of_rings = {(k, e) for k, c in met.rings.tolist() for e, other in enumerate(ways) if other.contour == c}
    return of_rings | set(map(tuple, met.leads.tolist()))


@pytest.mark.parametrize("length_mm", [KERF_MM / 2 - 1e-9, KERF_MM / 2, KERF_MM / 2 + 1e-9])
def test_a_lead_of_half_a_kerf_lies_wholly_beside_its_own_contour(length_mm: float) -> None:
    where = nest(200, 120, part("A", rect(20, 20, 60, 60)), part("B", rect(110, 30, 60, 60)))

    def entered(name: str, x: float, y: float) -> Cut:
        join = (x, y - KERF_MM / 2)
        pierce = (x, join[1] - length_mm)
        return Cut(name, (x, y), "cw", pierce, Curve.of([pierce, join], closed=False))

    cuts = CutSequence((entered("A.outer", 50, 20), entered("B.outer", 140, 30)))
    assert list(leads_over_older_kerfs(where, cuts, KERF_MM, SPLASH_MM)) == []
