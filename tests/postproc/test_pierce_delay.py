"""The pierce delay is there once: in the machine, or in the program; the clock and the check count it so."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kerfwise.postproc.clock import job_of_plan, job_of_program, read_program, time_job
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.rules.profile.plant_sections import PierceDwell
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile

PLATE = plate()


def shop(who: PierceDwell | None, dialect: str = "linuxcnc-qtplasmac") -> Profile:
    return profile(machine=replace(profile().machine, pierce_dwell=who, dialect=dialect))


def written(plant: Profile) -> str:
    return write_program(plan_of(PLATE, good_cuts(PLATE), plant), PLATE, plant)


@pytest.mark.parametrize(
    ("plant", "waits"),
    [
        (shop(None), False),
        (shop("machine"), False),
        (shop("program"), True),
        (shop(None, "linuxcnc"), True),
        (shop("machine", "linuxcnc"), False),
    ],
)
def test_the_dialect_says_who_waits_and_the_profile_may_say_otherwise(plant: Profile, waits: bool) -> None:
    text = written(plant)
    assert ("G4 P0.5" in text) is waits
    assert f"(PIERCE DELAY 0.5 S, HELD BY THE {'PROGRAM' if waits else 'MACHINE'})" in text
    assert check_program(PLATE, text, plant).broken() == ()


def test_a_delay_that_comes_twice_or_never_is_refused() -> None:
    for mine, other, said in (("program", "machine", "asks for 0 s"), ("machine", "program", "asks for 0.5 s")):
        found = check_program(PLATE, written(shop(mine)), shop(other))  # type: ignore[arg-type]
        assert found.broken() == ("pierce-delay",)
        assert said in found.rule("pierce-delay").violations[1].text


def test_the_clock_counts_it_once_either_way() -> None:
    times = set()
    for who in ("machine", "program"):
        plant = shop(who)  # type: ignore[arg-type]
        plan = plan_of(PLATE, good_cuts(PLATE), plant)
        program = read_program(write_program(plan, PLATE, plant), PLATE, plant)
        for job in (job_of_plan(plan, PLATE, plant), job_of_program(program, PLATE, plant)):
            times.add(round(time_job(job, plant).times.total_s, 1))
            assert time_job(job, plant).times.pierce_s == pytest.approx(8 * 0.5 + 0.2)
        assert program.burns[-1].end_s == pytest.approx(plan.cuts[-1].cut.end_s, rel=1e-3)
    assert len(times) == 1
