"""Plans that bend their parts less: orders, entries and directions priced by what simulations of them show.

As for overheats (`jobs/cooler_orders.py`), with the error of each part in the place of the overheats near each contour:
random lawful orders are simulated, the errors are explained by which neighbours are out when a contour is cut and where
it is entered, the nest is planned with these prices, and what comes of it, with lawful routes near it, is simulated and
the prices are fitted again. The best route of all that were simulated is taken.
"""

from __future__ import annotations

import math

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.facts import Facts
from kerfwise.jobs.cooler_orders import CoolerOrders
from kerfwise.jobs.inputs import Inputs, expect_one_torch
from kerfwise.jobs.plan_nest import OrdersOf
from kerfwise.models.physics.heat import TimedPath
from kerfwise.models.physics.heat.timed_path import RoutePaths
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.problem.compile import make_problem
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.stating.state_rules import Stated

from .cutting import Cutting, cut_sheet
from .part_errors import errors_of
from .tolerances import tolerances_of
from .yielding import metal_of

CELLS = 800
"""Cells of a sheet while plans are looked for: coarse, since a hundred of them are simulated."""
UNIT_MM = 0.01
"""Errors are counted in these."""
ORDERS, NEARBY = 48, 12


class StraighterOrders(CoolerOrders):
    """Routes of a nest whose parts' errors are simulated and remembered.

    Parameters
    ----------
    facts, stated
        Of the nest, and its rules.
    profile
        Machine, material and heat.
    """

    def __init__(self, facts: Facts, profile: Profile, stated: Stated) -> None:
        home, feeds = profile.home_on(facts.nest), feeds_of(profile)
        problem = make_problem(facts, stated.statements, home, feeds)
        paths = RoutePaths(facts, profile.material.kerf_mm, feeds, home)
        super().__init__(facts, problem, profile.heat, profile.material.thickness_mm, paths)
        x0, y0, x1, y1 = facts.nest.sheet.bounds
        grid_mm = math.sqrt((x1 - x0) * (y1 - y0) / CELLS)
        self._how = Cutting(grid_mm, max(profile.material.kerf_mm, 0.1), profile.material.thickness_mm)
        self._outer = {part.id: facts.nest.index[part.outer.id] for part in facts.nest.parts}

    @property
    def effort(self) -> tuple[int, int]:
        """Fewer than for overheats: each simulation takes a second."""
        return ORDERS, NEARBY

    def price_mm(self, profile: Profile) -> float:
        """Of a unit of a part's error."""
        return price_of_unit(profile.objective.distortion, len(self._facts.nest.parts))

    def count(self, path: TimedPath) -> Ints:
        """The worst error of each part, in hundredths of a mm, at its outer contour (n,)."""
        found = np.zeros(len(self._facts.nest.contours), dtype=np.int64)
        for error in errors_of(self._facts.nest, cut_sheet(self._facts.nest, path, self._heat, self._how)):
            found[self._outer[error.part]] = round((error.max_mm or 0.0) / UNIT_MM)
        return found


def price_of_unit(price_mm: float, parts: int) -> float:
    """The price of a unit of a part's error, mm of travel, where a mm of the mean over the parts costs `price_mm`."""
    return price_mm * UNIT_MM / max(parts, 1)


def straighter_for(profile: Profile) -> OrdersOf | None:
    """What finds straighter orders, where the profile has a price on distortion.

    Raises
    ------
    InputError
        If it has one on overheats as well, several torches, or a material of unknown strength.
    """
    if not profile.objective.distortion:
        return None
    if profile.objective.heat:
        raise InputError(
            "objective: plans are chosen by one simulation: give a price for heat or for distortion, not for both"
        )
    expect_one_torch(profile, "the price of distortion")
    metal_of(profile.heat.material)
    return StraighterOrders


def orders_for(inputs: Inputs) -> OrdersOf | None:
    """What finds straighter orders, if there is a price on distortion; for a nest whose parts' errors are asked for.

    Raises
    ------
    InputError
        If they cannot be simulated: of several torches, of an unknown metal, or with a tolerance that is no length.
    """
    tolerances_of(inputs.nest, inputs.profile)
    expect_one_torch(inputs.profile, "the simulation of distortion")
    metal_of(inputs.profile.heat.material)
    return straighter_for(inputs.profile)
