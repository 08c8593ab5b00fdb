"""What the pages about cuts have in common: a nest is planned, and its program has to pass the check."""

from __future__ import annotations

from kerfwise.encoder.nest import Nest
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.pipeline import VerifiedPlan, solve_and_verify
from kerfwise.rules.profile.profile import Profile


def checked_plan(name: str, nest: Nest, profile: Profile, work: float, and_zones: bool = False) -> VerifiedPlan:
    """Plan a nest with so much work, and judge the plan and its program.

    Raises SystemExit if the program does not pass the check; `name` is what the message begins with.
    """
    asked = make_request(facts_of(nest, profile), profile)
    made = solve_and_verify(asked, profile, options_for(nest, profile, work=work), move_zones=and_zones)
    if not made.verdict.ok:
        raise SystemExit(f"{name}: the program fails the check: {', '.join(made.verdict.broken())}")
    return made
