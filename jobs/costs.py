"""What a sheet of a nest costs by the prices of the profile: plans, batches, work sheets and comparisons ask here."""

from __future__ import annotations

from kerfwise.encoder.nest import Nest
from kerfwise.encoder.scrap import remnant_of
from kerfwise.models.physics.timing.cost import Cost, Spent, cost_of
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.profile.materials import MATERIALS
from kerfwise.rules.profile.profile import Profile

_M3_PER_MM3 = 1e-9


def cost_of_plan(plan: Plan, nest: Nest, profile: Profile) -> Cost | None:
    """What one sheet of a plan costs: machine, gas, power, consumables, the sheet less its remnant, and the total.

    Where a plan goes on after a stop, that is what the rest costs: the sheet was paid before.

    Parameters
    ----------
    plan
        With its times; none is worked out again.
    nest
        As the profile has it cut.
    profile
        Whose `prices` count.

    Returns
    -------
    Cost or None
        Of one sheet, in `Cost.currency`; `Cost.total`, `Cost.parts`, `str(cost)`. None where the profile has no prices,
        or the plan says nothing of its times.

    Examples
    --------
    >>> import kerfwise
    >>> from dataclasses import replace
    >>> from kerfwise.rules.profile.prices_section import Prices
    >>> nest = kerfwise.read_nest("examples/nests/e1x_6.json")
    >>> plan = kerfwise.solve(nest, work=2).plan
    >>> plant = replace(kerfwise.load_profile(), prices=Prices(machine_hour=80, sheet_kg=1.2))
    >>> cost = cost_of_plan(plan, nest, plant)
    >>> [name for name, amount in cost.parts]
    ['machine', 'sheet']
    """
    stock = None if plan.already_cut else nest
    return None if plan.time is None else cost_of_sheet(plan.time, plan.totals.pierces, stock, profile)


def cost_of_sheet(spent: Spent, pierces: int, nest: Nest | None, profile: Profile) -> Cost | None:
    """What one sheet costs that takes so long and so many pierces; without its nest the sheet itself is left out."""
    prices, flow = profile.prices, profile.material.gas_flow_m3_h or 0.0
    sheet, remnant = (0.0, 0.0) if nest is None else _sheet(nest, profile)
    return cost_of(spent, prices, pierces, flow, sheet, remnant)


def _sheet(nest: Nest, profile: Profile) -> tuple[float, float]:
    """What the sheet costs, and what the remnant that the profile saves is still worth."""
    prices, area_mm2 = profile.prices, nest.sheet.polygon.area
    if not (prices.sheet_kg or prices.sheet_each) or not area_mm2:
        return 0.0, 0.0
    if nest.reading is not None and nest.reading.assumed:  # nobody has stated a sheet: it has no price
        return 0.0, 0.0
    kg_per_mm2 = MATERIALS[profile.heat.material].density * profile.material.thickness_mm * _M3_PER_MM3
    whole = prices.sheet_each or area_mm2 * kg_per_mm2 * prices.sheet_kg
    side = profile.cuts.scrap.remnant
    if side is None or not prices.remnant_share:
        return whole, 0.0
    width_mm, height_mm = remnant_of(nest, profile.material.kerf_mm, side).size_mm
    return whole, whole * prices.remnant_share * width_mm * height_mm / area_mm2
