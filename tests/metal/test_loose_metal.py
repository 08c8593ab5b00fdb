"""Nothing is cut in metal that has come loose, whatever the rules say: planned so, or refused with the reason."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import read_nest
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.plan.conflict import find_conflict
from kerfwise.models.plan.plan import Plan
from kerfwise.pipeline import VerifiedPlan, solve_and_verify
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan, check_program
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.plant_sections import Torches
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.metal.loose_nests import enclosing
from kerfwise.tests.metal.plant import plant
from kerfwise.tests.metal.simulate import by_kind, simulate

CASES = Path(__file__).parent / "cases"
ORDER_RULES = (
    "inner-before-outer", "nested-before-host-holes", "part-contiguous", "level-ahead", "hull-before", "zone-order",
    "no-islands", "no-narrow-strips", "part-rigidity", "heat-lag", "start-side",
)  # fmt: skip


def laser(*off: str, base: str = "laser-st10kp-2mm") -> Profile:
    profile = load_profile(base)
    rules = {name: replace(profile.settings()[name], strength="off") for name in off if name in profile.settings()}
    return replace(profile, rules={**profile.rules, **rules})


def made(sheet: Nest, profile: Profile, relax: bool = False) -> VerifiedPlan:
    asked = make_request(facts_of(sheet, profile), profile, relax)
    return solve_and_verify(asked, profile, options_for(sheet, profile, work=0.3))


def in_order(plan: Plan, *names: str) -> Plan:
    cuts = {planned.cut.contour: planned for planned in plan.cuts}
    return replace(plan, cuts=tuple(cuts[name] for name in names))


def loose(result: CheckResult) -> list[str]:
    (judged,) = [judgement for judgement in result.rules if judgement.id == "loose-metal"]
    return [violation.text for violation in judged.violations]


def island() -> Nest:
    return read_nest(CASES / "01-loose-island.json")


def test_a_part_among_four_whose_kerfs_meet_is_cut_before_the_last_of_them() -> None:
    profile = load_profile(CASES / "01-loose-island.yaml")
    found = made(island(), profile)
    assert found.verdict.ok
    assert simulate(island(), found.program, **plant(profile)) == []


def test_the_check_sees_it_under_any_rules() -> None:
    """The other order, which the simulation says makes scrap, with the rules that an owner may turn off all off."""
    profile = laser(*ORDER_RULES)
    plan = made(island(), profile).plan
    wrong = in_order(plan, "W.outer", "S.outer", "N.outer", "E.outer", "C.outer")
    program = write_program(wrong, island(), profile)
    assert set(by_kind(simulate(island(), program, **plant(profile)))) == {"loose-part-burnt"}
    for judged in (check_plan(island(), wrong, profile), check_program(island(), program, profile)):
        (text,) = loose(judged)
        assert "C.outer is cut in metal that is loose since" in text
    assert not loose(
        check_plan(island(), in_order(plan, "W.outer", "S.outer", "N.outer", "C.outer", "E.outer"), profile)
    )


def test_a_lock_that_asks_for_it_is_refused_with_the_reason() -> None:
    """With `--relax` the lock gives way: what is promised of the metal never does."""
    profile = load_profile(CASES / "01-loose-island.yaml")
    profile = replace(profile, locks=(Lock(contour="C.outer", position="last"),))
    with pytest.raises(RulesConflict):
        made(island(), profile)
    conflict = find_conflict(facts_of(island(), profile), profile)
    assert conflict is not None
    assert any("their kerfs meet around the metal it is in" in about.sentence for about in conflict.clash)
    found = made(island(), profile, relax=True)
    assert [dropped.rule for dropped in found.plan.dropped] == ["locks"]
    assert simulate(island(), found.program, **plant(profile)) == []


def test_a_hole_after_its_outline_is_no_matter_of_rules() -> None:
    sheet = nest(200, 200, part("A", rect(30, 30, 120, 120), [rect(60, 60, 40, 40)]))
    profile = laser(*ORDER_RULES)
    found = made(sheet, profile)
    assert [planned.cut.contour for planned in found.plan.cuts] == ["A.hole1", "A.outer"]
    wrong = in_order(found.plan, "A.outer", "A.hole1")
    assert loose(check_plan(sheet, wrong, profile))
    assert loose(check_program(sheet, write_program(wrong, sheet, profile), profile))


@pytest.mark.minizinc
def test_a_slip_in_a_plants_own_file_does_not_put_a_hole_after_its_outline(tmp_path: Path) -> None:
    (tmp_path / "inner_before_outer.mzn").write_text(
        "% inner-before-outer: what lies inside another comes before it\n"
        "array[int] of var bool: inner_before_outer_holds =\n"
        "  [before(parent[i], i) | i in CONTOUR where parent[i] != 0];\n"
    )
    (tmp_path / "plant.yaml").write_text(
        "name: plant\nbased_on: plasma-carbon-steel\nmodels: [inner_before_outer.mzn]\n"
        "rules: {part-contiguous: off, zone-order: off}\n"
    )
    sheet = nest(200, 200, part("A", rect(30, 30, 120, 120), [rect(60, 60, 40, 40)]))
    with pytest.raises(RulesConflict) as refused:
        made(sheet, load_profile(tmp_path / "plant.yaml"))
    assert any("cutting A.outer frees the metal it is in" in text for text in refused.value.reasons)


def test_two_torches_cut_no_part_that_their_rounds_have_cut_off() -> None:
    """What is cut at one time has no order: two windmills a step apart, each with a part in its pocket."""
    step = 250.0
    one = [p for p in enclosing(3, 1.5).parts if p.id.startswith("A")]
    assert len(one) > 2
    two = [
        part(
            f"{p.id}{n}",
            p.outer.curve.vertices[:, :2] + [0, n * step],
            [h.curve.vertices[:, :2] + [0, n * step] for h in p.holes],
        )
        for n in range(2)
        for p in one
    ]
    sheet = nest(330, 620, *two)
    profile = laser(*ORDER_RULES, base="plasma-carbon-steel")
    profile = replace(profile, machine=replace(profile.machine, dialect="linuxcnc", torches=Torches(2, step, "y")))
    found = made(sheet, profile)
    assert found.verdict.ok
    assert simulate(sheet, found.program, **plant(profile)) == []


def planned_or_refused(seed: int, kerf_mm: float) -> bool:
    """Whether a nest of a seed, under rules of which some are off, was planned; its program burns no loose metal."""
    rnd = np.random.default_rng(seed)
    off = [name for name in ORDER_RULES if rnd.random() < 0.5]
    base = str(rnd.choice(["laser-st10kp-2mm", "plasma-carbon-steel", "water-jet"]))
    profile = laser(*off, base=base)
    sheet = enclosing(seed, profile.material.kerf_mm)
    try:
        found = made(sheet, profile)
    except (RulesConflict, InputError):
        return False
    assert found.verdict.ok, [(j.id, [v.text for v in j.violations]) for j in found.verdict.rules if not j.holds]
    assert simulate(sheet, found.program, **plant(profile)) == []
    return True


@pytest.mark.parametrize("seed", range(4))
def test_nests_whose_kerfs_meet_are_planned_so_that_nothing_loose_is_cut(seed: int) -> None:
    planned_or_refused(seed, 0.2)


@pytest.mark.full
@pytest.mark.slow
def test_so_are_many() -> None:
    planned = [planned_or_refused(seed, 0.2) for seed in range(100, 140)]
    assert sum(planned) > 30


@pytest.mark.parametrize("kerf_mm", [0.0, 0.05, 0.1, 1.5])
def test_however_thin_the_kerf_a_hole_after_its_outline_is_seen(kerf_mm: float) -> None:
    sheet = nest(200, 200, part("A", rect(30, 30, 120, 120), [rect(60, 60, 40, 40)]))
    profile = laser(*ORDER_RULES)
    profile = replace(profile, material=replace(profile.material, kerf_mm=kerf_mm))
    found = made(sheet, profile)
    assert [planned.cut.contour for planned in found.plan.cuts] == ["A.hole1", "A.outer"]
    assert loose(check_plan(sheet, in_order(found.plan, "A.outer", "A.hole1"), profile))


def test_a_plant_without_leads_pierces_on_the_path() -> None:
    profile = laser("pierce", base="plasma-carbon-steel")
    profile = replace(profile, leads=replace(profile.leads, lead="none"))
    sheet = read_nest(CASES / "11-triangular-hole.json")
    found = made(sheet, profile)
    assert found.verdict.ok
    assert simulate(sheet, found.program, **plant(profile)) == []
