"""With a pierce pass, MiniZinc keeps leads off the holes of other contours as all other engines do."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.facts import compute_facts
from kerfwise.jobs.request import options_for
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.catalogue.pierce import meeting_holes
from kerfwise.rules.catalogue.pierce.model_data import met_holes
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.sections import Cuts
from kerfwise.rules.stating.state_rules import state_rules
from kerfwise.tests.models.engines.agree import disagreements
from kerfwise.tests.models.engines.cases import Case

STREETS_MM = (4.1, 5.0, 12.0)
"""Between two parts, and from these to a third: the wider, the fewer leads come near holes."""
MEET_UP_TO_MM = 5.0


def passed_case(street_mm: float) -> Case:
    """Three parts beside each other, with all holes of the sheet pierced before its cuts, wherever these lie."""
    above = part("C", rect(30, 80 + street_mm, 90, 30))
    drawn = nest(170, 130, part("A", rect(20, 20, 50, 60)), part("B", rect(70 + street_mm, 20, 50, 60)), above)
    profile = load_profile()
    profile = replace(profile, cuts=Cuts(pierce_pass="sheet"), leads=replace(profile.leads, entries=4))
    candidates = build_candidates(drawn, replace(profile.lead_options(drawn), splash_mm=None))
    facts = compute_facts(drawn, profile.fact_options(drawn), candidates)
    return Case(facts, profile, options_for(drawn, profile, work=5))


@pytest.mark.parametrize("street_mm", STREETS_MM)
def test_the_same_ways_meet_holes(street_mm: float) -> None:
    case = passed_case(street_mm)
    options = case.profile.settings()["pierce"].options
    stated, met = (
        {(min(pair), max(pair)) for pair in of(case.facts, options.kerf_mm, options.splash_mm)}
        for of in (meeting_holes, met_holes)
    )
    assert stated == met
    assert bool(met) == (street_mm <= MEET_UP_TO_MM)


@pytest.mark.minizinc
@pytest.mark.parametrize("street_mm", STREETS_MM)
def test_the_proofs_and_minizinc_agree(street_mm: float) -> None:
    case = passed_case(street_mm)
    stated = state_rules(case.facts, case.profile)
    asked = [s for s in stated.statements if "pierced before for" in s.about.sentence]
    assert bool(asked) == (street_mm <= MEET_UP_TO_MM)
    assert disagreements(case) == ("solved", [])
