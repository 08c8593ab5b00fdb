"""What benchmarks of made plates have in common: the plate, profiles without rules, plans by zones, costs in words."""

from __future__ import annotations

import json
from dataclasses import replace

from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.adaptive_zones import ZonedPlan, better_zones, plan_by_rungs, zones_follow
from kerfwise.jobs.plan_without_zones import zoned_by
from kerfwise.jobs.request import Request, facts_of, make_request, options_for
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.solve import solve
from kerfwise.pipeline import VerifiedPlan, solve_and_verify
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import EXEMPTION_MM
from kerfwise.rules.stating.lazy_statements import lazy_statements


def made_plate(contours: int, seed: int) -> Nest:
    """A plate of about so many contours, by examples/gen_sheet.py, without the checks of a reader: it is sound."""
    return read_json(json.dumps(make_sheet(seed, contours)).encode(), ReadOptions())


def default_without(*rules: str) -> Profile:
    """The default profile with these rules off."""
    profile = load_profile()
    off = {name: replace(profile.rules[name], strength="off", weight=None) for name in rules}
    return replace(profile, rules={**profile.rules, **off})


def rest_mm(objective_mm: float) -> float:
    """What a plan costs without the weight of its excuses."""
    return objective_mm % EXEMPTION_MM


def cost(objective_mm: float) -> str:
    """In m, and how many excuses.

    Examples
    --------
    >>> cost(12_340.0), cost(2 * EXEMPTION_MM + 12_340.0)
    ('12.34', '12.34 + 2')
    """
    excuses = int(objective_mm // EXEMPTION_MM)
    return f"{rest_mm(objective_mm) / 1000:.2f}{f' + {excuses}' if excuses else ''}"


def planned_by_zones(request: Request, profile: Profile, limits: SolveOptions) -> ZonedPlan:
    """A plan by zones, moved where that pays, without its program."""
    zoned = zones_follow(request) and zoned_by(request.facts, profile)
    if zoned and (found := plan_by_rungs(request, profile, limits)):
        return found
    looks = lazy_statements(request.facts, profile)
    solution = solve(request.facts, request.stated.statements, limits, None, looks)
    order = [request.facts.candidates[c].contour for c in solution.route]
    return better_zones(request, lazy_statements(request.facts, profile)(order), profile, solution, limits)


def checked_plan(name: str, nest: Nest, profile: Profile, work: float, and_zones: bool = False) -> VerifiedPlan:
    """Plan a nest with so much work, and judge the plan and its program.

    Raises SystemExit if the program does not pass the check; `name` is what the message begins with.
    """
    asked = make_request(facts_of(nest, profile), profile)
    made = solve_and_verify(asked, profile, options_for(nest, profile, work=work), move_zones=and_zones)
    if not made.verdict.ok:
        raise SystemExit(f"{name}: the program fails the check: {', '.join(made.verdict.broken())}")
    return made
