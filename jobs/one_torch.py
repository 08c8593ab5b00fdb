"""What knows one torch only, and says so where a profile or a plan has several."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.profile.profile import Profile


def expect_torches(profile: Profile, nest: Nest, resumes: bool) -> None:
    """Refuse what does not go together with several torches; `resumes` says that some of the nest is cut already.

    Raises
    ------
    InputError
        With what to change.
    """
    if profile.machine.torches.several and (why := next(_why_not(profile, nest, resumes), None)):
        raise InputError(
            f"machine.torches: {why}, or say machine: {{torches: {{count: 1}}}}", file=profile.file or None
        )


def _why_not(profile: Profile, nest: Nest, resumes: bool) -> Iterator[str]:
    cuts, limit = profile.cuts, profile.temperature_limit()
    if resumes:
        yield "a program that goes on after a stop is planned for one torch: cut the rest with one"
    if profile.link_options() is not None:
        yield "links are not planned together with several torches: say cuts.links.longest: 0 mm"
    if profile.common_options() is not None:
        yield "common cuts are not planned together with several torches: say cuts.common.shortest: off"
    if cuts.pierce_pass is not None:
        yield "a pierce pass is not planned together with several torches: say cuts.pierce_pass: off"
    if limit is not None:
        yield f"{limit.rule} simulates the heat of one torch: turn it off"
    if profile.objective.heat and profile.heat.absorbed_power_w:
        yield "the price of heat is simulated for one torch: say objective: {heat: 0}"
    if any(getattr(setting.options, "zone_heat_kj", None) is not None for setting in profile.settings().values()):
        yield "the heat of zones is counted for one torch: say zone_heat: unlimited"


def expect_one_torch(profile: Profile, what: str, plan: Plan | None = None) -> None:
    """Refuse what knows one torch only, where the profile has several, or a plan uses them.

    Raises
    ------
    InputError
        That says so.
    """
    if profile.machine.torches.several or (plan is not None and any(c.cut.torch > 1 for c in plan.cuts)):
        whose = "the profile has" if profile.machine.torches.several else "the plan uses"
        raise InputError(f"{what} knows one torch, and {whose} several (machine.torches)", file=profile.file or None)


def of_first_torch(plan: Plan) -> Plan:
    """The plan with the cuts of the first torch alone."""
    first = tuple(planned for planned in plan.cuts if planned.cut.torch == 1)
    return plan if len(first) == len(plan.cuts) else replace(plan, cuts=first)


def expect_of_first(plan: Plan, contour: str) -> None:
    """Refuse what only the cuts of the first torch can be asked.

    Raises
    ------
    InputError
        If the contour is one that another torch cuts: what it is cut with is named.
    """
    for planned in plan.cuts:
        if planned.cut.contour == contour and planned.cut.torch > 1:
            first = planned.cut.together
            raise InputError(
                f"{contour} is cut by torch {planned.cut.torch} at the time of {first}, by the same motion: ask about "
                f"{first}"
            )
