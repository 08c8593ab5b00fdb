"""Slower corners from profile to program: in its F words, on the clock, in the heat; the check finds each wrong one."""

from __future__ import annotations

import dataclasses
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from kerfwise.encoder.nest import Nest
from kerfwise.jobs.heat_path import path_of_plan, path_of_program
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.physics.time_and_cost import machine_feeds
from kerfwise.pipeline import VerifiedPlan, solve_and_verify
from kerfwise.postproc.clock import job_of_plan, job_of_program, read_program, time_job
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.nc.toolpaths import toolpaths
from kerfwise.postproc.verdict.check_plan import check_plan, check_program
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import Corners
from kerfwise.tests.commands.run_cli import kerfwise

PLATE = nest(
    400,
    240,
    part("A", rect(50, 50, 120, 120), [circle(80, 80, 9), rect(100, 120, 40, 30)]),
    part("B", [(200, 60), (300, 60, 0.3), (300, 160), (240, 160), (230, 120)], [circle(260, 100, 20)]),
)


def plant(**changes: object) -> Profile:
    """The shipped plasma profile with corners at 0.6 of the feed, 3 mm before and behind."""
    shipped = load_profile("plasma-carbon-steel")
    return dataclasses.replace(shipped, corners=Corners(0.6, 45.0, 3.0), **changes)


@cache
def made() -> VerifiedPlan:
    return solve_and_verify(
        make_request(facts_of(PLATE, plant()), plant()), plant(), options_for(PLATE, plant(), work=2)
    )


def wrong_feeds(program: str, profile: Profile, plate: Nest = PLATE) -> list[str]:
    return [v.text for v in check_program(plate, program, profile).rule("feeds").violations]


def test_the_program_is_slow_at_corners_and_the_check_agrees() -> None:
    feeds = set(re.findall(r"F(\d+)", made().program))
    assert {"2500", "1500"} <= feeds
    verdict = check_program(PLATE, made().program, plant())
    assert verdict.ok, verdict
    assert check_plan(PLATE, made().plan, plant()).ok


def test_clock_program_and_heat_have_the_same_times() -> None:
    program = read_program(made().program, PLATE, plant())
    planned = time_job(job_of_plan(made().plan, PLATE, plant()), plant()).times
    stated = time_job(job_of_program(program, PLATE, plant()), plant()).times
    assert stated.cut_s == pytest.approx(planned.cut_s, rel=1e-3)
    without = dataclasses.replace(plant(), corners=Corners())
    feeds, law = machine_feeds(plant()), plant().corner_feed()
    assert law is not None
    more_mm = sum(law.more_mm(one.path) / one.feed_share for one in toolpaths(made().plan, PLATE, plant()))
    plain = time_job(job_of_plan(made().plan, PLATE, without), without).times
    assert planned.cut_s - plain.cut_s == pytest.approx(more_mm / feeds.cut_mm_s, rel=1e-6)
    of_plan, of_program = path_of_plan(made().plan, PLATE, plant()), path_of_program(program)
    for one, other in zip(of_plan.burns, of_program.burns, strict=True):
        for share in (0.2, 0.5, 0.8):
            at_s = one.at_s[0] + share * one.seconds
            where = [np.array([np.interp(at_s, b.at_s, b.xy[:, k]) for k in (0, 1)]) for b in (one, other)]
            assert np.hypot(*(where[0] - where[1])) < 0.5


def test_acceleration_has_the_slower_feeds_too() -> None:
    def cut_s(profile: Profile) -> float:
        timed = dataclasses.replace(profile, time=dataclasses.replace(profile.time, model="acceleration"))
        return time_job(job_of_plan(made().plan, PLATE, timed), timed).times.cut_s

    assert cut_s(plant()) > cut_s(dataclasses.replace(plant(), corners=Corners())) + 0.5


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (" F1500\n", " F2500\n", "at 2500 mm/min"),  # full feed round a corner
        (" F1500\n", " F1000\n", "at 1000 mm/min"),
        (" F2500\n", " F2400\n", "at 2400 mm/min"),
    ],
)
def test_a_changed_feed_is_found(old: str, new: str, said: str) -> None:
    for at in [m.start() for m in re.finditer(old, made().program)][:6]:
        damaged = made().program[:at] + new + made().program[at + len(old) :]
        texts = wrong_feeds(damaged, plant())
        assert any(said in text for text in texts), (at, texts)


def test_a_stretch_that_begins_too_late_is_found() -> None:
    shorter = dataclasses.replace(plant(), corners=Corners(0.6, 45.0, 2.0))
    assert any("near this corner" in text for text in wrong_feeds(written(shorter), plant()))
    assert any("no corner being near" in text for text in wrong_feeds(written(plant()), shorter))
    assert wrong_feeds(written(shorter), shorter) == []


def written(profile: Profile) -> str:
    return write_program(made().plan, PLATE, profile)


def test_a_program_without_slow_corners_is_refused_and_the_other_way_round() -> None:
    flat = dataclasses.replace(plant(), corners=Corners())
    assert wrong_feeds(written(flat), plant())
    assert wrong_feeds(written(plant()), flat)


def test_an_old_program_keeps_its_slow_corners(tmp_path: Path) -> None:
    (tmp_path / "old.nc").write_text(made().program)
    (tmp_path / "shop.yaml").write_text(
        "based_on: plasma-carbon-steel\ncorners: {corner_feed: 0.6, corner_reach: 3 mm}\n"
    )
    words = ("-p", tmp_path / "shop.yaml", "--sheet", "400x240", "-o", tmp_path / "new.nc", "--work", 1)
    ended = kerfwise("resequence", tmp_path / "old.nc", *words)
    assert ended.code == 0, ended.err
    assert re.search(r"^hard feeds +holds +holds$", ended.out, re.MULTILINE)
    moves = [
        re.findall(r"^(?:N\d+ )?(G[123] .*)", text, re.MULTILINE) for text in (made().program, written_in(tmp_path))
    ]
    assert sorted(moves[0]) == sorted(moves[1])


def written_in(folder: Path) -> str:
    return (folder / "new.nc").read_text()
