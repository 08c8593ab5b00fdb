"""What the pages about cuts have in common: a nest is planned, and its program has to pass the check."""

from __future__ import annotations

from kerfwise.encoder.nest import Nest
from kerfwise.jobs.ask import ask, facts_of
from kerfwise.jobs.produce import Produced, produce
from kerfwise.jobs.solve_options import options_for
from kerfwise.rules.profile.profile import Profile


def checked_plan(name: str, nest: Nest, profile: Profile, work: float, and_zones: bool = False) -> Produced:
    """Plan a nest with so much work, and judge the plan and its program.

    Raises
    ------
    SystemExit
        If the program does not pass the check; `name` is what the message begins with.
    """
    asked = ask(facts_of(nest, profile), profile)
    made = produce(asked, profile, options_for(nest, profile, work=work), and_zones=and_zones)
    if not made.verdict.ok:
        raise SystemExit(f"{name}: the program fails the check: {', '.join(made.verdict.broken())}")
    return made
