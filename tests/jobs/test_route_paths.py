"""Routes are simulated at the times of their programs, whatever the process and the model of motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from kerfwise.encoder.facts.facts import Facts
from kerfwise.jobs.heat_path import path_of_plan
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.jobs.route_paths import RoutePaths
from kerfwise.models.physics.heat import TimedPath
from kerfwise.models.plan.plan import Plan
from kerfwise.pipeline import plan_request
from kerfwise.postproc.clock import read_program, time_program
from kerfwise.postproc.nc.program import write_program
from kerfwise.rule_kit import circle, nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.plant_sections import Torches
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import Corners
from kerfwise.rules.profile.time_section import Time

PLATE = nest(
    480,
    240,
    part("A", rect(30, 30, 180, 180), [circle(120, 120, 30)], [[(45, 45), (90, 45)]]),
    part("B", rect(240, 30, 180, 180), [rect(300, 90, 60, 60), circle(270, 180, 9)]),
)
TWICE = nest(480, 240, *(part(n, rect(x, 30, 180, 180), [circle(x + 90, 120, 30)]) for n, x in (("A", 30), ("B", 240))))


@cache
def laser() -> Profile:
    return load_profile("laser-st10kp-2mm")


@cache
def plasma() -> Profile:
    shipped = load_profile("plasma-carbon-steel")
    return replace(shipped, corners=Corners(0.6, 45.0, 3.0), small_holes=replace(shipped.small_holes, under="skip"))


@cache
def oxyfuel() -> Profile:
    shipped = load_profile("oxyfuel-thick-plate")
    return replace(shipped, small_holes=replace(shipped.small_holes, under="skip"))


@cache
def slow_to_start() -> Profile:
    shipped, time = load_profile(), Time("acceleration", acceleration_mm_s2=200.0)
    return replace(shipped, time=time, small_holes=replace(shipped.small_holes, small_hole_feed=1.0))


@cache
def in_passes() -> Profile:
    shipped = load_profile()
    return replace(shipped, cuts=replace(shipped.cuts, pierce_pass="sheet"))


@cache
def two_torches() -> Profile:
    shipped = load_profile()
    return replace(shipped, machine=replace(shipped.machine, dialect="linuxcnc", torches=Torches(2, 210.0, "x")))


PROCESSES = pytest.mark.parametrize("plant", [laser, plasma, oxyfuel, slow_to_start])


@cache
def routed(plant: Callable[[], Profile]) -> tuple[Plan, tuple[int, ...], RoutePaths, Facts]:
    """A plan, its route, what makes paths of routes, and facts."""
    profile = plant()
    sheet = PLATE if profile.machine.torches.count == 1 else TWICE
    asked = make_request(facts_of(profile.as_cut(sheet), profile), profile)
    made = plan_request(asked, profile, options_for(asked.facts.nest, profile, work=0.1))
    return made.plan, made.solution.route, RoutePaths(asked.facts, profile, asked.stated), asked.facts


def spans(path: TimedPath) -> dict[str, tuple[float, float]]:
    return {burn.contour: (float(burn.at_s[0]), float(burn.at_s[-1])) for burn in path.burns}


@PROCESSES
def test_a_route_takes_as_long_cut_by_cut_as_its_program(plant: Callable[[], Profile]) -> None:
    plan, route, paths, _ = routed(plant)
    program = read_program(write_program(plan, PLATE, plant()), PLATE, plant())
    timed, path = time_program(program, PLATE, plant()), paths.of(route)
    found, lit = spans(path), [k for k, burn in enumerate(program.burns) if burn.tool == 0]
    names = [planned.cut.contour for planned in plan.cuts if planned.kind != "mark"]
    assert list(found) == names
    assert len(names) == len(lit) >= 4
    for name, k in zip(names, lit, strict=True):
        begin_s, end_s = timed.times.spans[k]
        assert found[name][1] - found[name][0] == pytest.approx(end_s - begin_s, rel=0.01)
        assert found[name] == pytest.approx((begin_s, end_s), rel=0.01, abs=0.02)
    assert path.end_s == pytest.approx(timed.times.total_s, rel=0.01)


@pytest.mark.parametrize("plant", [laser, plasma, oxyfuel, slow_to_start, in_passes, two_torches])
def test_a_route_burns_where_its_plan_does(plant: Callable[[], Profile]) -> None:
    plan, route, paths, facts = routed(plant)
    told = path_of_plan(plan, facts.whole_nest, plant())
    for one, other in zip(paths.of(route).burns, told.burns, strict=True):
        assert one.contour == other.contour
        assert np.allclose(one.xy, other.xy)
        assert one.at_s == pytest.approx(other.at_s, abs=1e-6)


@PROCESSES
def test_one_cut_after_the_other_takes_as_long_as_the_route(plant: Callable[[], Profile]) -> None:
    _, route, paths, facts = routed(plant)
    at, now_s, found = plant().home_on(PLATE), 0.0, dict[str, tuple[float, float]]()
    for number in route:
        burns, now_s = paths.burn(number, now_s, at)
        at = facts.candidates[number].end
        found |= spans(TimedPath(burns, now_s))
    whole = spans(paths.of(route))
    assert list(found) == list(whole)
    for name, (begin_s, end_s) in found.items():
        assert (begin_s, end_s) == pytest.approx(whole[name], rel=0.01)
