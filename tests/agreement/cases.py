"""Random nests of 5 to 9 contours, under rules whose every price the check can see, small enough to try every plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import prod

import numpy as np

from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.nest import Nest
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.plan.make import feeds_of
from kerfwise.rules.catalogue.heat_lag import HeatLagOptions
from kerfwise.rules.catalogue.no_narrow_strips import NoNarrowStripsOptions
from kerfwise.rules.catalogue.part_rigidity import PartRigidityOptions
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import RuleSetting
from kerfwise.tests.models.engines.minizinc.cases import Case, lead_options, random_nest, random_profile

ROUTES = {5: 256, 6: 128, 7: 64, 8: 16, 9: 4}
"""Contours → the most ways to pick entries and directions that are tried along each order."""
FIRM = ("inner-before-outer", "level-ahead", "zone-order")
"""Rules that are always hard on the larger nests, so that few enough orders are left to judge one by one."""


def judged_case(seed: int) -> Case:
    """A nest of 5 to 9 contours under a random mixture of rules; the same for the same seed."""
    rng = np.random.default_rng([seed, 3])
    contours = 5 + seed % 5
    drawn = random_nest(rng, contours, contours)
    profile = _visible(rng, random_profile(rng, drawn))
    if contours > 7:
        profile = replace(profile, rules=dict(profile.rules) | {rule: _hard(profile, rule) for rule in FIRM})
    candidates = _thinned(rng, drawn, build_candidates(drawn, lead_options(profile, seed)), ROUTES[contours])
    facts = compute_facts(drawn, profile.fact_options(drawn), candidates)
    return Case(facts, profile, SolveOptions(work=10, home_mm=profile.machine.home, feeds=feeds_of(profile)))


def _visible(rng: np.random.Generator, profile: Profile) -> Profile:
    """The profile without prices that no violation shows.

    The wish where a cut begins is never judged; what soft strips cost hangs on which of them geometry was shown; and
    seconds that are missing of a soft lag are not counted by violations. All three are compared by statements alone, in
    `tests/models/engines/minizinc`.
    """
    rules = dict(profile.rules)
    strips, heat, rigidity = rules["no-narrow-strips"], rules["heat-lag"], rules["part-rigidity"]
    narrow = NoNarrowStripsOptions(strip_mm=float(rng.choice([60, 100, 140])))
    rules["no-narrow-strips"] = RuleSetting("off" if strips.strength == "off" else "hard", None, narrow)
    assert isinstance(heat.options, HeatLagOptions)
    if heat.strength == "soft":
        rules["heat-lag"] = replace(heat, options=replace(heat.options, lag_s=0.0))
    assert isinstance(rigidity.options, PartRigidityOptions)
    rigid_min = float(rng.choice([0.35, 0.6, 0.8]))
    rules["part-rigidity"] = replace(
        rigidity, options=replace(rigidity.options, rigid_min=rigid_min, head_weight_mm=0.0)
    )
    return replace(profile, rules=rules)


def _hard(profile: Profile, rule: str) -> RuleSetting:
    return RuleSetting("hard", None, profile.rules[rule].options)


def _thinned(
    rng: np.random.Generator, drawn: Nest, candidates: Sequence[Candidate], most: int
) -> tuple[Candidate, ...]:
    """Some of the candidates of every contour, so that no more than `most` ways are left to pick one of each."""
    kept = [[c for c in candidates if c.contour == i] for i in range(len(drawn.contours))]
    while prod(len(own) for own in kept) > most:
        widest = max(range(len(kept)), key=lambda i: (len(kept[i]), rng.random()))
        kept[widest].pop(int(rng.integers(len(kept[widest]))))
    return tuple(c for own in kept for c in own)
