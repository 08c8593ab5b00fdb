"""Why the contours of a plan are cut where they are: what the rules state is worked out once, and asked many times."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property

import numpy as np

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.plan.conflict import state_relaxed
from kerfwise.models.plan.explain import (
    Along,
    Explanation,
    Setting,
    expect_planned,
    explained,
    make_setting,
)
from kerfwise.models.plan.made_from import made_with_another
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.stating.state_rules import state_rules

from .ask import facts_of
from .given import Given
from .one_torch import expect_of_first, of_first_torch
from .priced_heat import with_heat_prices
from .stopped import again_first


class Explainer:
    """Explains the contours of one plan.

    Parameters
    ----------
    given
        The nest, and the profile that the plan is explained by.
    plan
        What was planned.
    facts
        Of what the plan cuts, where they are known.

    Raises
    ------
    InputError
        If a lock of the profile names what the nest does not have, or a contour cannot be cut; if the plan was made
        with another profile and this one's rules cannot all hold.
    """

    def __init__(self, given: Given, plan: Plan, facts: Facts | None = None) -> None:
        profile = again_first(given.profile.at_origin(plan.origin), plan.already)
        state = state_relaxed if any(dropped.relaxed for dropped in plan.dropped) else state_rules
        with _by_its_profile(plan, given):
            facts = facts or _by_its_zones(facts_of(given.nest, profile, plan.already), plan)
            stated = state(facts, profile)
        if profile.objective.heat:
            stated = with_heat_prices(facts, profile, stated)
        self.facts, self.profile, self.stated, self.plan = facts, profile, stated, of_first_torch(plan)
        self.whole_plan = plan

    @cached_property
    def setting(self) -> Setting:
        """The plan as the engines would see it.

        Raises
        ------
        InputError
            If the plan is not one of this nest.
        """
        return make_setting(self.facts, self.profile, self.stated, self.plan)

    @cached_property
    def _along(self) -> Along:
        return Along(self.setting)

    def explain(self, contour: str) -> Explanation:
        """What holds the contour in its place, why it is entered so, and what moving it would cost.

        Raises
        ------
        InputError
            If the plan does not cut such a contour; the nearest id is named.
        """
        expect_of_first(self.whole_plan, contour)
        expect_planned(self.facts, self.plan, contour)
        return explained(self.setting, self.plan, contour, self._along)


@contextmanager
def _by_its_profile(plan: Plan, given: Given) -> Iterator[None]:
    """What a profile has against the nest is told with the profile of the plan, where that is another one."""
    try:
        yield
    except (InputError, RulesConflict) as error:
        if not (told := made_with_another(plan, given.profile)):
            raise
        details = error.details if isinstance(error, InputError) else error.reasons
        raise InputError(f"{told}; by this one it cannot be explained: {error.message}", details=details) from error


def _by_its_zones(facts: Facts, plan: Plan) -> Facts:
    """The facts with the zones of the plan, which need not be those that geometry alone has made."""
    zones = {planned.cut.contour: planned.cut.zone for planned in plan.cuts if planned.cut.zone}
    found = [zones.get(contour.id, int(zone)) for contour, zone in zip(facts.nest.contours, facts.zone, strict=True)]
    return replace(facts, zone=np.array(found, dtype=np.int64))
