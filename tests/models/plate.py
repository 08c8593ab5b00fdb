"""A small plate to be priced: `from kerfwise.tests.models.plate import …`."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from kerfwise import Profile
from kerfwise.jobs.request import facts_of
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.problem import Problem
from kerfwise.rule_kit import Facts, RuleSetting, circle, nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.stating.state_rules import Stated, state_rules

PLATE = nest(
    330,
    120,
    part("A", rect(20, 20, 80, 80), [circle(60, 60, 20)]),
    part("B", rect(112, 20, 80, 80)),
    part("C", rect(204, 20, 80, 80)),
)


@cache
def plant() -> Profile:
    """The default profile with the rules of holes, entries and directions alone."""
    profile = load_profile()
    keep = ("inner-before-outer", "part-contiguous", "cut-direction", "pierce")
    rules = {k: s if k in keep else RuleSetting("off", None, s.options) for k, s in profile.rules.items()}
    heat = replace(profile.heat, grid_mm=8.0, kerf_band_mm=8.0, limit_c=80.0)
    return replace(profile, rules=rules, heat=heat)


@cache
def facts() -> Facts:
    """Of the plate."""
    return facts_of(PLATE, plant())


@cache
def stated() -> Stated:
    """What the rules state of it."""
    return state_rules(facts(), plant())


@cache
def posed() -> Problem:
    """The problem without prices."""
    profile = plant()
    return make_problem(facts(), stated().statements, profile.machine.home, feeds_of(profile))
