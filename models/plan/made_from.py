"""What a plan was made from, against what it is read with."""

from __future__ import annotations

from collections.abc import Iterator

from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.for_one_nest import changed_since
from kerfwise.rules.profile.profile import Profile

from .plan import Plan

_SHA_DIGITS = 12


def made_from_others(plan: Plan, nest: Nest, profile: Profile) -> Iterator[str]:
    """A sentence for each thing that is not as it was when the plan was made: nest, profile, what is for one nest."""
    if plan.nest.get("sha256") != nest.sha256:
        yield "the nest is not the one the plan was made with (its sha256 differs)"
    if told := made_with_another(plan, profile):
        yield told
    yield from changed_since(plan.made_with, profile.for_one_nest)


def made_with_another(plan: Plan, profile: Profile) -> str:
    """That a plan was made with another profile than this, with which, and what to do; "" where it was not."""
    own, sha256 = plan.profile.get("name", ""), plan.profile.get("sha256", "")
    if sha256 == profile.sha256:
        return ""
    told = f"the profile is not the one the plan was made with (its sha256 differs): this is '{profile.name}', "
    if not own:
        return f"{told}the plan does not say which that was"
    begins = f", whose sha256 begins {sha256[:_SHA_DIGITS]}" if sha256 else ""
    return f"{told}that was '{own}'{begins}: give it with -p (in Python profile=)"
