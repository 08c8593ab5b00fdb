"""Random blocks of parts a kerf apart: every plan's program burns every edge once, and both judges find nothing."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st

from kerfwise.encoder.already_cut import AlreadyCut
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.pipeline import VerifiedPlan, solve_and_verify
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import Common, Cuts
from kerfwise.tests.metal.common_nests import block, grid
from kerfwise.tests.metal.findings import Finding
from kerfwise.tests.metal.plant import plant
from kerfwise.tests.metal.simulate import simulate
from kerfwise.tests.tools.amount import examples, rows

KERFS_MM = (0.2, 0.5, 1.5)


def laser(kerf_mm: float) -> Profile:
    profile = load_profile("laser-st10kp-2mm")
    material = replace(profile.material, kerf_mm=kerf_mm)
    return replace(profile, material=material, cuts=Cuts(common=Common(shortest_mm=20.0)))


def burnt(seed: int, kerf_mm: float, parts: int) -> tuple[VerifiedPlan | None, list[Finding]]:
    """A block planned and burnt; no plan where the rules leave none."""
    sheet, profile = block(np.random.default_rng(seed), parts, kerf_mm, holes=True), laser(kerf_mm)
    try:
        made = solve_and_verify(
            make_request(facts_of(sheet, profile), profile), profile, options_for(sheet, profile, work=0.2)
        )
    except RulesConflict:
        return None, []
    return made, simulate(sheet, made.program, **plant(profile))


@pytest.mark.parametrize(("seed", "kerf_mm"), [(1, 0.2), (4, 0.5), (10, 1.5), (15, 1.5)])
def test_a_block_is_cut_with_every_edge_once(seed: int, kerf_mm: float) -> None:
    made, found = burnt(seed, kerf_mm, 5)
    assert made is not None
    assert made.verdict.ok
    assert found == []
    assert any(planned.cut.span is not None for planned in made.plan.cuts)


@pytest.mark.slow
@examples(40, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 10**6), kerf_mm=st.sampled_from(KERFS_MM), parts=st.integers(2, 7))
def test_no_program_of_any_block_makes_scrap(seed: int, kerf_mm: float, parts: int) -> None:
    made, found = burnt(seed, kerf_mm, parts)
    assert made is None or made.verdict.ok
    assert found == []


def test_a_grid_takes_one_pierce_and_the_length_of_its_lines() -> None:
    kerf_mm, profile = 0.2, laser(0.2)
    sheet = grid(4, 3, kerf_mm)
    made = solve_and_verify(
        make_request(facts_of(sheet, profile), profile), profile, options_for(sheet, profile, work=0.3)
    )
    lines_mm = 4 * 4 * (100 + kerf_mm) + 5 * 3 * (60 + kerf_mm)
    assert made.plan.totals.pierces == 1
    assert made.plan.totals.cut_mm == pytest.approx(lines_mm, abs=8)  # a lead, and corners that are cut round
    assert made.verdict.ok


def test_a_channel_and_the_plate_that_both_its_legs_end_at_are_cut_all_round() -> None:
    """Whichever is cut first leaves two stretches of the other. D and E stand apart from them, and share their edge."""
    channel = [(40, 40), (160, 40), (160, 120), (130, 120), (130, 70), (70, 70), (70, 120), (40, 120)]
    boxes = {"B": (40, 121.5, 120, 60), "C": (161.5, 121.5, 80, 60), "D": (280, 40, 60, 60), "E": (280, 101.5, 60, 60)}
    sheet = nest(400, 260, part("U", channel), *(part(name, rect(*box)) for name, box in boxes.items()))
    profile = laser(1.5)
    found = solve_and_verify(
        make_request(facts_of(sheet, profile), profile), profile, options_for(sheet, profile, work=0.3)
    )
    assert found.verdict.ok
    assert simulate(sheet, found.program, **plant(profile)) == []
    along = [planned.part for planned in found.plan.cuts if planned.cut.span is not None]
    assert along in (["D"], ["E"])


def stopped(seed: int, kerf_mm: float, parts: int) -> Iterator[tuple[Nest, VerifiedPlan, str]]:
    """A block planned, and what is left of it after each of its cuts, planned anew; the old program besides."""
    made, _ = burnt(seed, kerf_mm, parts)
    sheet, profile = block(np.random.default_rng(seed), parts, kerf_mm, holes=True), laser(kerf_mm)
    cuts = () if made is None else tuple(planned.cut for planned in made.plan.cuts)
    for upto in range(1, len(cuts)):
        try:
            facts = facts_of(sheet, profile, AlreadyCut(cuts[:upto]))
            rest = solve_and_verify(make_request(facts, profile), profile, options_for(sheet, profile, work=0.2))
            yield sheet, rest, "" if made is None else made.program
        except RulesConflict:
            continue


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "kerf_mm"), rows([(4, 0.5), (15, 1.5)]))
def test_what_is_left_of_a_block_after_a_stop(seed: int, kerf_mm: float) -> None:
    """Both judges take what the program says is cut, and find every edge that is left burnt once."""
    rests = list(stopped(seed, kerf_mm, 5))
    assert len(rests) > 3
    for sheet, rest, before in rests:
        assert rest.verdict.ok, rest.verdict.broken()
        assert simulate(sheet, rest.program, before=before, **plant(laser(kerf_mm))) == []
        assert check_program(sheet, rest.program, laser(kerf_mm)).ok
    assert any(planned.cut.span is not None for planned in rests[-1][1].plan.cuts)


@pytest.mark.slow
@examples(15, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 10**6), kerf_mm=st.sampled_from(KERFS_MM), parts=st.integers(2, 6))
def test_no_block_makes_scrap_after_a_stop(seed: int, kerf_mm: float, parts: int) -> None:
    for sheet, rest, before in stopped(seed, kerf_mm, parts):
        assert rest.verdict.ok, rest.verdict.broken()
        assert simulate(sheet, rest.program, before=before, **plant(laser(kerf_mm))) == []


@pytest.mark.slow
def test_a_neighbour_that_is_not_told_to_be_out_is_missed() -> None:
    """Without it nobody has cut the edge that both share."""
    *_, (sheet, rest, _) = stopped(15, 1.5, 5)
    gone = next(planned.cut.contour for planned in reversed(rest.plan.already_cut) if planned.kind == "outer")
    order = 1 + [planned.cut.contour for planned in rest.plan.already_cut].index(gone)
    lines = rest.program.split("\n")
    other = "\n".join(line for line in lines if not line.startswith(f"(OUT {order} "))
    verdict = check_program(sheet, other, laser(1.5))
    assert {"every-contour-once"} <= set(verdict.broken())
