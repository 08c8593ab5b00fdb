"""What is said aloud about where a sheet lies on its machine, before anything is planned."""

from __future__ import annotations

import math
from collections.abc import Iterator

import shapely

from kerfwise.encoder.nest import Nest

from .profile import Profile

_SLACK_MM = 1e-6


def placing_notes(nest: Nest, profile: Profile) -> Iterator[str]:
    """A sentence for each thing that a planner would want to know: a far home, a sheet that sticks out, no edge starts.

    Examples
    --------
    >>> from kerfwise.encoder.geometry.curve import Curve
    >>> from kerfwise.encoder.nest import Sheet
    >>> far = Nest(Sheet(Curve.of([(3000, 0), (3080, 0), (3080, 80), (3000, 80)])), ())
    >>> [text.split(":")[0] for text in placing_notes(far, Profile("shop"))]
    ["the sheet is 3000 mm from the machine's home, further than it is long (80 mm)"]
    """
    yield from _far_home(nest, profile)
    yield from _sticks_out(nest, profile)
    yield from _no_edge_starts(nest, profile)


def _far_home(nest: Nest, profile: Profile) -> Iterator[str]:
    x0, y0, x1, y1 = nest.sheet.bounds
    longest_mm = max(x1 - x0, y1 - y0)
    away_mm = float(shapely.distance(shapely.box(x0, y0, x1, y1), shapely.Point(profile.home_on(nest))))
    if away_mm > longest_mm:
        way_out = "correct machine.home"
        if profile.machine.origin == "drawing":
            way_out = "machine.origin: sheet-corner (or --origin sheet-corner) puts its corner at the machine's zero"
        yield (
            f"the sheet is {away_mm:.0f} mm from the machine's home, further than it is long ({longest_mm:.0f} mm): "
            f"the torch travels there and back; {way_out}"
        )


def _sticks_out(nest: Nest, profile: Profile) -> Iterator[str]:
    reach = profile.reach_on(nest)
    if reach is None:
        return
    frame, (x0, y0, x1, y1) = profile.frame_on(nest), nest.sheet.bounds
    if x0 < reach[0] - _SLACK_MM or y0 < reach[1] - _SLACK_MM or x1 > reach[2] + _SLACK_MM or y1 > reach[3] + _SLACK_MM:
        (ax, ay), (bx, by) = frame.on_machine((x0, y0)), frame.on_machine((x1, y1))
        yield (
            f"the sheet lies from ({ax:g}, {ay:g}) to ({bx:g}, {by:g}) of the machine, beyond its travel "
            "(machine.travel_x, machine.travel_y): what is cut has to lie within"
        )


def _no_edge_starts(nest: Nest, profile: Profile) -> Iterator[str]:
    if not profile.leads.edge_start:
        return
    reach = profile.reach_on(nest)
    if not nest.sheet.stated:
        stated = "a sheet layer, or --sheet (in Python: sheet_mm=)"
        yield f"no edge starts are offered: nobody has stated where the sheet's edge is: {stated}"
    elif reach is None or not all(map(math.isfinite, reach)):
        yield "no edge starts are offered: give machine.travel_x and machine.travel_y, how far the torch can go"
