"""Baselines keep every hard statement; Realtime keeps away from what is hot."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kerfwise.encoder.nest import Nest
from kerfwise.jobs.request import facts_of
from kerfwise.jobs.route_paths import RoutePaths
from kerfwise.models.engines.baselines import random_order, realtime_order
from kerfwise.models.engines.lawful_walk import Walk
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import broken
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import RuleSetting
from kerfwise.rules.stating.state_rules import state_rules

HOST = part("H", rect(10, 10, 180, 180), [rect(30, 30, 140, 140)])
PLATE = nest(
    600,
    200,
    HOST,
    part("N", rect(60, 60, 80, 80), [circle(100, 100, 15)]),
    part("A", rect(210, 10, 80, 180), [circle(250, 50, 15), circle(250, 150, 15)]),
    part("B", rect(310, 10, 80, 180)),
    part("C", rect(410, 10, 170, 180)),
)


def posed(plate: Nest, profile: Profile) -> tuple[Problem, RoutePaths]:
    facts, feeds = facts_of(plate, profile), feeds_of(profile)
    stated = state_rules(facts, profile)
    return make_problem(facts, stated.statements, profile.machine.home, feeds), RoutePaths(facts, profile, stated)


def free() -> Profile:
    """The default profile bound by the rules of Verkhoturov et al. alone."""
    profile = load_profile()
    keep = ("inner-before-outer", "nested-before-host-holes", "part-contiguous", "cut-direction", "pierce")
    rules = {k: s if k in keep else RuleSetting("off", None, s.options) for k, s in profile.rules.items()}
    return replace(profile, rules=rules)


@pytest.mark.parametrize("profile", [load_profile(), free()], ids=["default", "free"])
def test_random_orders_are_lawful_and_differ(profile: Profile) -> None:
    problem, _ = posed(PLATE, profile)
    routes = [random_order(problem, seed) for seed in range(20)]
    assert all(broken(problem, route) == () for route in routes)
    assert random_order(problem, 3) == routes[3]
    assert len(set(routes)) > 10


def test_a_walk_offers_what_the_orders_and_blocks_allow() -> None:
    problem, _ = posed(PLATE, free())
    walk, ids = Walk(problem), problem.ids

    def offered() -> set[str]:
        return {ids[int(problem.site_contour[s])] for s in walk.options()}

    def cut(name: str) -> None:
        walk.take(next(s for s in walk.options() if ids[int(problem.site_contour[s])] == name))

    assert offered() == {"N.hole1", "A.hole1", "A.hole2", "B.outer", "C.outer"}
    cut("A.hole2")
    assert offered() == {"A.hole1"}
    cut("A.hole1")
    assert offered() == {"A.outer"}
    cut("A.outer")
    assert offered() == {"N.hole1", "B.outer", "C.outer"}
    assert not walk.finished


def test_realtime_goes_where_it_is_cool() -> None:
    """Bound by nothing, it does not cut a neighbour while it is warm; with nothing warm it goes to the nearest."""
    strips = nest(640, 220, *(part(n, rect(20 + 100 * k, 10, 90, 200)) for k, n in enumerate("ABCDEF")))
    profile = free()
    problem, paths = posed(strips, profile)
    facts = facts_of(strips, profile)

    def order(power_w: float) -> str:
        heat = replace(profile.heat, absorbed_power_w=power_w)
        route = realtime_order(problem, facts, heat, 6.0, paths.burn)
        assert broken(problem, route) == ()
        return "".join(problem.ids[int(problem.site_contour[s])][0] for s in route)

    assert order(0.0) == "ABCDEF"
    hot = order(6000.0)
    assert sorted(hot) == list("ABCDEF")
    assert abs(ord(hot[0]) - ord(hot[1])) > 1
