"""Every program that a test has planned is burnt by the simulation of `metal` before the test is done."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pytest

from kerfwise.encoder.nest import Nest
from kerfwise.jobs import produce as production
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.metal.plant import plant
from kerfwise.tests.metal.simulate import simulate

Made = list[tuple[Nest, Profile, str, str | None]]


@pytest.fixture(autouse=True)
def programs_made(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Made]:
    """What the test plans, by the command line or by itself; `@pytest.mark.scrap("why")` lets a test make scrap."""
    made: Made = []
    write = production.write_program

    def noted(plan: Plan, nest: Nest, profile: Profile) -> str:
        program = write(plan, nest, profile)
        made.append((nest, profile, program, write(before(plan), nest, profile) if plan.already_cut else None))
        return program

    monkeypatch.setattr(production, "write_program", noted)
    yield made
    if request.node.get_closest_marker("scrap") is None:
        found = [str(f) for nest, profile, program, old in made for f in judged(nest, profile, program, old)]
        assert not found, "this would make scrap:\n" + "\n".join(found)


def before(plan: Plan) -> Plan:
    """What was cut before a program that goes on after a stop, as a plan of its own."""
    return replace(plan, cuts=plan.already_cut, already_cut=(), broken_off=None)


def judged(nest: Nest, profile: Profile, program: str, old: str | None = None) -> list[object]:
    """The findings of a program, which may go on after an `old` one; without a kerf nothing is burnt."""
    if profile.material.kerf_mm <= 0:
        return []
    more = {} if old is None else {"before": old}
    return [*simulate(profile.as_cut(nest), program, **plant(profile), **more)]
