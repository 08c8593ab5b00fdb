"""Why no plan keeps a limit of temperature: how cool the coolest order gets, and which waits would do."""

from __future__ import annotations

from collections.abc import Sequence

from kerfwise.encoder.cut import HotSpot
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.listed import listed
from kerfwise.models.physics.heat.pacing import Pacing
from kerfwise.rules.temperature_limit import TemperatureLimit

LISTED = 5
"""Waits that are told one by one."""


def too_hot(unpaced: Sequence[tuple[str, HotSpot]], tried: Sequence[Pacing], limit: TemperatureLimit) -> RulesConflict:
    """The conflict, from the orders that were tried: at least one, and none of them allowed.

    `unpaced` are the contour and the place with which each is hottest without any waits.
    """
    contour, spot = min(unpaced, key=lambda hottest: hottest[1].peak_c)
    orders = f"of {len(tried)} orders tried the coolest" if len(tried) > 1 else "the one order tried"
    without = f"{orders} gets to {spot.peak_c:.1f} °C without waits: {said(contour, spot)}"
    paced = min(tried, key=lambda one: (not one.possible, one.peak_c if not one.possible else one.wait_s))
    with_waits = _waits(paced, limit) if paced.possible else _no_wait(paced)
    message = f"{limit.rule}: no plan was found that keeps the metal at {limit.most_c:g} °C or less"
    return RulesConflict(message, (without, with_waits))


def said(contour: str, spot: HotSpot) -> str:
    """What a burn heats, as a sentence."""
    x, y = spot.at
    where = f"part {spot.part}" if spot.part else "the metal between parts"
    return f"{contour} makes {where} {spot.peak_c:.1f} °C hot at ({x:.0f}, {y:.0f})"


def _waits(paced: Pacing, limit: TemperatureLimit) -> str:
    waits = listed([f"{wait_s:.1f} s before {contour}" for contour, wait_s in paced.waits.items()], LISTED)
    allowed = f"longest_dwell is {limit.longest_dwell_s:g} s" if limit.dwells else "dwells are not allowed"
    longest_s = max(paced.waits.values())
    if longest_s <= limit.allowed_dwell_s:  # enough by the plan's clock
        allowed = f"by the program's own times it takes more than {allowed.replace(' is', ',')}"
        longest_s = 1.5 * limit.longest_dwell_s
    return (
        f"waits of {paced.wait_s:.1f} s in all would keep it ({waits}), but {allowed}: "
        f"give {limit.rule} {{dwells: true, longest_dwell: {longest_s + 1:.0f} s}}"
    )


def _no_wait(paced: Pacing) -> str:
    alone = max((hot for hot in paced.heated if hot.wait_s is None), key=lambda hot: hot.least_c)
    return (
        f"no wait helps: the least temperature that was reached is {paced.peak_c:.1f} °C, with waits however long; "
        f"{alone.contour} heats metal to {alone.least_c:.1f} °C on a cold sheet"
    )
