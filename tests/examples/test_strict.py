"""The strict example profile: no island, no narrow strip, and every part held at the end of its cut, by geometry."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.encoder.readers import read_nest
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.pipeline import solve_and_verify
from kerfwise.rules.catalogue.part_rigidity import ALLOWANCE, PartRigidityOptions
from kerfwise.rules.judging.facing import rigid_at_the_end
from kerfwise.rules.profile.load import load_profile

EXAMPLES = Path(__file__).parents[2] / "examples"
STIFF = ("no-islands", "no-narrow-strips", "part-rigidity")


@pytest.mark.slow
def test_a_plate_without_an_exception() -> None:
    profile = load_profile(EXAMPLES / "profiles" / "strict.yaml")
    sheet = read_nest(EXAMPLES / "nests" / "plate40.json", profile.read_options())
    limits = options_for(sheet, profile, work=10)
    made = solve_and_verify(make_request(facts_of(sheet, profile), profile), profile, limits)
    settings, book = profile.settings(), profile.rulebook()
    cuts = made.plan.sequence(profile.machine.home)
    for rule in STIFF:
        assert settings[rule].strength == "hard"
        assert book[rule].violations(sheet, cuts, settings[rule].options) == []
        assert made.verdict.rule(rule).verdict == "holds"
    asked = settings["part-rigidity"].options
    assert isinstance(asked, PartRigidityOptions)
    shares = [share for _, share in rigid_at_the_end(sheet, cuts, asked.tail_share, asked.web_mm, asked.edge_band_mm)]
    assert len(shares) == len(sheet.parts)
    assert min(shares) >= asked.rigid_min - ALLOWANCE
