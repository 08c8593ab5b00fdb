"""Where nothing was found, solve says what was tried and what to try; who follows any of it has a plan."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.tests.commands.run_cli import Ended, kerfwise

WORK = r"\n  try: (--work [\d.]+), which counts work and not the clock"
LIMIT = r"(?:try|;) (--time-limit [\d.]+) \(in Python time_limit=\)"
ENGINE = r"; all engines, without (--engine) \(in Python engine=\)"
RELAX = r"; or (--relax) \(in Python relax=True\), which lets the cheapest hard rules give way"


@pytest.fixture
def base(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[object, ...]:
    """The words that solve a nest under a hard lag of two cuts."""
    monkeypatch.chdir(tmp_path)
    nest, profile = tmp_path / "nest.json", tmp_path / "plant.yaml"
    sheet = {"format": "kerfwise-nest/1", "units": "mm", **make_sheet(7, 24)}
    nest.write_text(json.dumps(sheet), encoding="utf-8")
    profile.write_text(
        "based_on: plasma-carbon-steel\nrules:\n  heat-lag: {strength: hard, lag_cuts: 2, heat_radius: 30 mm}\n",
        encoding="utf-8",
    )
    return ("solve", nest, "-p", profile, "-o", tmp_path / "nest.nc")


def advised(done: Ended, advice: str) -> list[str]:
    """What to say in place of the limit, in the words that were told."""
    assert done.code == 1, done.out
    assert not Path("nest.nc").exists()
    said = re.search(advice, done.err)
    assert said is not None, done.err
    return said[1].split()


def test_the_advice_after_nothing_was_found_leads_to_a_plan(base: tuple[object, ...]) -> None:
    done = kerfwise(*base, "--work", "0.001")
    assert "\n  tried: all engines within work 0.001, then for a contradiction among the hard rules" in done.err
    assert advised(done, RELAX) == ["--relax"]
    followed = kerfwise(*base, *advised(done, WORK))
    assert followed.code == 0, followed.err
    assert "ok: every hard rule holds" in followed.out


@pytest.mark.full
@pytest.mark.slow
def test_with_rules_relaxed_there_is_a_plan(base: tuple[object, ...]) -> None:
    done = kerfwise(*base, "--work", "0.001", "--relax")
    if done.code:  # the limit was too short for that as well, and it says so
        assert "work 0.001, with the cheapest hard rules relaxed" in done.err
        assert not re.search(RELAX, done.err)
        assert kerfwise(*base, *advised(done, WORK), "--relax").code == 0


@pytest.mark.slow
def test_a_longer_time_limit_leads_to_a_plan(base: tuple[object, ...]) -> None:
    done = kerfwise(*base, "--time-limit", "0.01")
    assert "\n  tried: all engines within 0.01 s, then for a contradiction among the hard rules" in done.err
    for _ in range(4):
        if (done := kerfwise(*base, *advised(done, LIMIT))).code == 0:
            break
    assert done.code == 0, done.err


@pytest.mark.full
@pytest.mark.slow
def test_all_engines_find_what_one_does_not(base: tuple[object, ...]) -> None:
    done = kerfwise(*base, "--engine", "cp-sat-alone", "--work", "0.001")
    assert "\n  tried: the engine cp-sat-alone for work 0.001" in done.err
    assert advised(done, ENGINE) == ["--engine"]
    assert kerfwise(*base, *advised(done, WORK)).code == 0
