"""A program heats the sheet at its own F words and for its own G4, a plan at the times that it states."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from kerfwise.jobs.simulation import path_of_plan, path_of_program
from kerfwise.models.physics.heat import TimedPath
from kerfwise.postproc.clock import job_of_program, read_program, time_job, with_times
from kerfwise.postproc.nc.program import write_program
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile

SHEET, PLANT = plate(), profile()
PLAN = with_times(plan_of(SHEET, good_cuts(SHEET), PLANT), SHEET, PLANT)
PROGRAM = write_program(PLAN, SHEET, PLANT)
PIERCE_S = PLANT.machine.pierce_time_s


def path(text: str = PROGRAM, plant: Profile = PLANT) -> TimedPath:
    return path_of_program(read_program(text, SHEET, plant))


def edited(pattern: str, change: Callable[[float], float]) -> str:
    """The program with every number that follows the pattern changed."""
    return re.sub(rf"({pattern})([\d.]+)", lambda found: f"{found[1]}{change(float(found[2])):g}", PROGRAM)


def standing(of: TimedPath) -> list[float]:
    """How long the torch stands at the start of each burn, s."""
    return [float(b.at_s[1] - b.at_s[0]) if np.array_equal(b.xy[0], b.xy[1]) else 0.0 for b in of.burns]


def moving(of: TimedPath) -> list[float]:
    return [b.seconds - stood for b, stood in zip(of.burns, standing(of), strict=True)]


def test_plan_and_program_heat_the_same_contours_at_the_same_times() -> None:
    planned, written = path_of_plan(PLAN, SHEET, PLANT), path()
    assert [b.contour for b in planned.burns] == [b.contour for b in written.burns]
    for a, b in zip(planned.burns, written.burns, strict=True):
        assert (a.at_s[0], a.at_s[-1]) == pytest.approx((b.at_s[0], b.at_s[-1]), abs=0.02)


def test_f_words_decide_how_long_a_path_is_heated() -> None:
    slow = path(edited(" F", lambda feed: feed / 2))
    assert moving(slow) == pytest.approx([2 * s for s in moving(path())])
    assert standing(slow) == pytest.approx(standing(path()))


def test_g4_decides_how_long_the_torch_stands() -> None:
    assert max(standing(path())) == PIERCE_S
    long = path(edited("G4 P", lambda seconds: seconds + 3))
    assert standing(long) == pytest.approx([s + 3 if s else 0.0 for s in standing(path())])
    assert moving(long) == pytest.approx(moving(path()))


def test_a_wait_with_the_torch_off_lets_the_sheet_cool() -> None:
    before_third = [m.start() for m in re.finditer(r"N\d+ M3 \$0", PROGRAM)][2]
    waiting, plain = path(PROGRAM[:before_third] + "G4 P40\n" + PROGRAM[before_third:]), path()
    later = [float(a.at_s[0] - b.at_s[0]) for a, b in zip(waiting.burns, plain.burns, strict=True)]
    assert later == pytest.approx([0.0, 0.0] + [40.0] * (len(plain.burns) - 2))
    assert [b.seconds for b in waiting.burns] == pytest.approx([b.seconds for b in plain.burns])


def test_pierces_that_the_dialect_leaves_to_the_machine_are_as_profiled() -> None:
    shop = replace(PLANT, machine=replace(PLANT.machine, pierce_dwell=None))
    text = write_program(PLAN, SHEET, shop)
    assert "G4 P" not in text
    silent = path(text, shop)
    assert standing(silent) == pytest.approx(standing(path()))
    assert [float(b.at_s[0]) for b in silent.burns] == pytest.approx([float(b.at_s[0]) for b in path().burns], abs=0.02)


def test_the_clock_counts_a_programs_own_words_too() -> None:
    def times(text: str) -> tuple[float, float, float]:
        found = time_job(job_of_program(read_program(text, SHEET, PLANT), SHEET, PLANT), PLANT).times
        return found.cut_s, found.pierce_s, found.total_s

    cut_s, pierce_s, total_s = times(PROGRAM)
    assert times(edited(" F", lambda feed: feed / 2)) == pytest.approx((2 * cut_s, pierce_s, total_s + cut_s))
    assert times(edited("G4 P", lambda s: 2 * s)) == pytest.approx((cut_s, 2 * pierce_s, total_s + pierce_s))
    assert (cut_s, pierce_s) == pytest.approx((PLAN.time.cut_s, PLAN.time.pierce_s), rel=2e-3) if PLAN.time else False
