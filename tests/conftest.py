"""Every program that a test has planned is burnt by the simulation of `metal` before the test is done."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from kerfwise.encoder.nest import Nest
from kerfwise.models.plan import Plan
from kerfwise.postproc import produce as production
from kerfwise.rules.profile import Profile
from kerfwise.tests.metal.clean import faults
from kerfwise.tests.metal.plant import plant

Made = list[tuple[Nest, Profile, str]]


@pytest.fixture(autouse=True)
def programs_made(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Made]:
    """What the test plans, by the command line or by itself; `@pytest.mark.scrap("why")` lets a test make scrap."""
    made: Made = []
    write = production.write_program

    def noted(plan: Plan, nest: Nest, profile: Profile) -> str:
        program = write(plan, nest, profile)
        made.append((nest, profile, program))
        return program

    monkeypatch.setattr(production, "write_program", noted)
    yield made
    if request.node.get_closest_marker("scrap") is None:
        found = [str(f) for nest, profile, program in made for f in judged(nest, profile, program)]
        assert not found, "this would make scrap:\n" + "\n".join(found)


def judged(nest: Nest, profile: Profile, program: str) -> list[object]:
    """The findings of a program; without a kerf nothing is burnt that could be judged."""
    return [*faults(profile.as_cut(nest), program, **plant(profile))] if profile.material.kerf_mm > 0 else []
