"""Why a contour is cut where it is, then, and so: everything that can be said of one contour of a finished plan."""

from __future__ import annotations

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.slits import narrow_because
from kerfwise.encoder.small_holes import not_cut_because
from kerfwise.models.plan.common import common_because
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.tabs import tabs_because
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.stating.state_rules import Stated

from .along import Along
from .entry import explain_entry
from .heat_prices import heat_prices
from .holding import chain, holds, others
from .moves import explain_moves
from .setting import Setting, make_setting
from .words import Explanation


def explain(facts: Facts, profile: Profile, stated: Stated, plan: Plan, contour: str) -> Explanation:
    """Explain one contour of a plan under the facts and statements as they are now.

    Raises
    ------
    InputError
        If the nest has no such contour (the nearest names are given), or the plan is not one of this nest.
    """
    expect_planned(facts, plan, contour)
    return explained(make_setting(facts, profile, stated, plan), plan, contour)


def expect_planned(facts: Facts, plan: Plan, contour: str) -> None:
    """Make sure that the plan cuts such a contour; InputError with the nearest id, or why it does not."""
    index = facts.nest.index
    left = next((left for left in plan.left_out if left.contour == contour), None)
    if contour not in index and left is not None:
        raise InputError(f"{contour} is not in the plan: {left.why}")
    if contour in (made := [cut.contour for cut in facts.already_cut]):
        raise InputError(
            f"{contour} was cut before the stop, as cut {made.index(contour) + 1}: the old plan explains it"
        )
    if contour not in index:
        raise InputError(unknown("contour", contour, index))


def explained(setting: Setting, plan: Plan, contour: str, along: Along | None = None) -> Explanation:
    """One contour of a plan whose setting is made already, and perhaps what is known `along` its order."""
    along = along or Along(setting)
    facts, profile = setting.facts, setting.profile
    number = facts.nest.index[contour]
    order, budget_kj = setting.order, facts.options.zone_heat_kj
    k = order.index(number)
    return Explanation(
        contour,
        k + 1 + setting.made,
        len(order) + setting.made,
        int(facts.zone[number]),
        setting.name(order[k - 1]) if k else "",
        setting.name(order[k + 1]) if k + 1 < len(order) else "",
        holds(setting, number, earlier=True),
        holds(setting, number, earlier=False),
        chain(setting, number, earlier=True),
        chain(setting, number, earlier=False),
        others(setting, number, along.asked),
        explain_entry(along, number),
        explain_moves(along, number),
        setting.notes,
        heat_prices(setting, number),
        plan.cuts[k].dwell_s,
        plan.cuts[k].waits_because,
        None if budget_kj is None else float(facts.zone_heat_kj[facts.zone[number] - 1]),
        budget_kj,
        not_cut_because(facts.whole_nest, profile.hole_limits()).get(contour, ""),
        narrow_because(facts.whole_nest, profile.material.kerf_mm).get(contour, ""),
        plan.cuts[k].linked_because,
        tabs_because(facts, profile).get(contour, ""),
        plan.cuts[k].pierced_because,
        "".join(common_because(facts.candidates[setting.candidates[k]], contour)),
    )
