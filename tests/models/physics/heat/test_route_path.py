"""A route of candidates as a timed path is what the plan made of it would be."""

from __future__ import annotations

import pytest

from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.jobs.simulation import path_of_plan
from kerfwise.models.physics.heat.timed_path import RoutePaths
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.pipeline import solve_and_verify
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.profile.load import load_profile


def test_it_agrees_with_the_plan() -> None:
    profile = load_profile()
    plate = nest(
        400,
        200,
        part("A", rect(20, 20, 160, 160), [circle(100, 100, 30)], [[(30, 30), (80, 30)]]),
        part("B", rect(200, 20, 160, 160)),
    )
    facts, machine = facts_of(plate, profile), profile.machine
    limits = options_for(plate, profile, work=1)
    plan = solve_and_verify(make_request(facts, profile), profile, limits).plan
    route = [
        next(
            k
            for k, c in enumerate(facts.candidates)
            if plate.contours[c.contour].id == p.cut.contour
            and (c.pierce, c.direction, c.end) == (p.cut.pierce, p.cut.direction, p.cut.end)
        )
        for p in plan.cuts
    ]
    made = RoutePaths(facts, profile.material.kerf_mm, feeds_of(profile), machine.home).of(route)
    told = path_of_plan(plan, plate, profile)
    assert [b.contour for b in made.burns] == [b.contour for b in told.burns]
    assert "A.mark1" not in [b.contour for b in made.burns]
    for a, b in zip(made.burns, told.burns, strict=True):
        assert (a.at_s[0], a.at_s[-1]) == pytest.approx((b.at_s[0], b.at_s[-1]), abs=0.05)
        assert a.xy[0] == pytest.approx(b.xy[0])
        assert a.xy[-1] == pytest.approx(b.xy[-1], abs=1e-3)
