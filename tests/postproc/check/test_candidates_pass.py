"""Whatever way of cutting is offered for a contour, the check finds its geometry right, as a plan and as a program."""

from collections.abc import Sequence
from itertools import groupby

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.candidates.candidate import Candidate, LeadKind, LeadOptions
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check import CheckResult, report
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan, check_program
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.tests.postproc.plans import plan_of, plate, profile
from kerfwise.tests.tools.amount import examples

GEOMETRY = (
    "every-contour-once",
    "contour-geometry",
    "kerf-side",
    "on-sheet",
    "no-gouging",
    "torch-off-travel",
    "totals",
)


def broken_geometry(sheet: Nest, cuts: list[Cut], kerf_mm: float) -> list[CheckResult]:
    plant = profile(material=type(profile().material)(kerf_mm=kerf_mm))
    plan = plan_of(sheet, cuts, plant)
    results = [check_plan(sheet, plan, plant), check_program(sheet, write_program(plan, sheet, plant), plant)]
    return [r for r in results if set(r.broken()) & set(GEOMETRY)]


def one_of_each(sheet: Nest, candidates: Sequence[Candidate], choose: int) -> list[Cut]:
    """A cut of every contour: of its ways, the one numbered `choose` (counted round and round)."""
    cuts = []
    for index, group in groupby(candidates, key=lambda candidate: candidate.contour):
        ways = list(group)
        way = ways[choose % len(ways)]
        cuts.append(Cut(sheet.contours[index].id, way.entry, way.direction, way.pierce, way.lead_in, way.lead_out))
    return cuts


@pytest.mark.slow
@pytest.mark.parametrize(("lead", "lead_out"), [("line", "none"), ("line", "line"), ("arc", "arc"), ("none", "none")])
def test_on_the_plate(lead: LeadKind, lead_out: LeadKind) -> None:
    sheet = plate()
    found = build_candidates(sheet, LeadOptions(lead=lead, lead_out=lead_out, kerf_mm=1.5))
    for choose in range(6):
        for result in broken_geometry(sheet, one_of_each(sheet, found, choose), 1.5):
            pytest.fail(report(result))


@st.composite
def sheets(draw: st.DrawFn) -> Nest:
    """A row of parts, some with a hole, some rounded, at gaps from almost nothing to wide."""
    x, parts = draw(st.floats(4, 20)), []
    for k in range(draw(st.integers(1, 4))):
        w, h = draw(st.floats(15, 120)), draw(st.floats(15, 120))
        size = min(w, h)
        holes = [circle(x + w / 2, 10 + h / 2, size / 4)] if draw(st.booleans()) else []
        if draw(st.booleans()):
            parts.append(part(f"P{k}", circle(x + w / 2, 10 + h / 2, size / 2), holes))
        else:
            parts.append(part(f"P{k}", rect(x, 10, w, h), holes))
        x += w + draw(st.floats(4, 30))
    return nest(x, 140, *parts)


@pytest.mark.slow
@examples(20)
@given(sheets(), st.sampled_from([0.0, 0.1, 0.7, 1.5, 3.0]), st.integers(0, 30))
def test_on_any_row_of_parts(sheet: Nest, kerf_mm: float, choose: int) -> None:
    cuts = one_of_each(sheet, build_candidates(sheet, LeadOptions(kerf_mm=kerf_mm)), choose)
    assert broken_geometry(sheet, cuts, kerf_mm) == []
