"""Whatever the nest, the plan and the program made of it pass the independent check, and the program burns no scrap."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import kerfwise
from kerfwise import InputError, Nest, Profile, RulesConflict, load_profile
from kerfwise.tests.encoder.facts.random_nests import nests
from kerfwise.tests.metal.clean import assert_clean
from kerfwise.tests.metal.plant import plant
from kerfwise.tests.tools.amount import examples
from kerfwise.tests.tools.shipped import PROFILES


@pytest.mark.slow
@pytest.mark.parametrize("profile_name", PROFILES)
@given(nest=nests(), seed=st.integers(0, 3), budget_kj=st.sampled_from([None, 2.0, 20.0]))
@examples(12)
def test_every_plan_passes_the_check(profile_name: str, nest: Nest, seed: int, budget_kj: float | None) -> None:
    assume(nest.parts)
    profile = load_profile(profile_name)
    # a piece of two contours a zone makes more of the zones of these small nests
    rules = dict(profile.rules)
    zones = rules["zone-order"]
    rules["zone-order"] = replace(zones, options=replace(zones.options, zone_contours=4, zone_heat_kj=budget_kj))
    profile = replace(profile, rules=rules, small_holes=replace(profile.small_holes, under="refuse"))
    try:
        made = kerfwise.solve(nest, profile, seed=seed, work=2.0)
    except RulesConflict:
        assume(not _a_street_without_metal(nest, profile))
        raise
    except InputError as refused:
        assume("cannot be cut" not in refused.message)
        raise
    assert made.verdict.ok, str(made.verdict)
    assert_clean(nest, made.program, **plant(profile))
    assert len(made.plan.cuts) == len(nest.contours)


def _a_street_without_metal(nest: Nest, profile: Profile) -> bool:
    """Whether a pierce has no room in a street between two parts once one of them is cut: no order may help there."""
    asked = profile.settings()["pierce"].options
    least_mm = asked.clearance_mm + 1.5 * profile.material.kerf_mm + asked.splash_mm
    lines = [(c.part, c.line) for c in nest.contours if c.kind != "mark"]
    return any(a != b and one.distance(other) < least_mm for (a, one), (b, other) in combinations(lines, 2))
