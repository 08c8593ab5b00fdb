"""What a plan has beside the cuts of its route: those of further torches, pierce passes, and when it all happens."""

from __future__ import annotations

from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.clock import with_times
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.stating.state_rules import Stated

from .gantry import with_further_torches
from .pierce_pass import with_pierces


def completed(
    plan: Plan, facts: Facts, profile: Profile, stated: Stated, solution: Solution, limits: SolveOptions
) -> Plan:
    """The plan of a solution as its program cuts it, and when; `limits` are those of the ways of pierce passes."""
    plan = with_further_torches(plan, facts, stated, solution)
    plan = with_pierces(plan, facts.whole_nest, profile, limits)
    return with_times(plan, facts.whole_nest, profile)
