"""The Python side of `no_tip_travel.mzn`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import GRAZE_UM, UM_PER_MM, points_um
from kerfwise.encoder.minizinc_data import Fields, flags, numbers
from kerfwise.rules.minizinc.twin import Twin, TwinCase
from kerfwise.rules.options.option import NoOptions


class NoTipTravelTwin(Twin[NoOptions]):
    """Moves over parts."""

    def data(self, case: TwinCase, options: NoOptions) -> Fields:
        over = tip_moves(case.facts, case.home_mm, case.linked)
        last = len(case.facts.candidates)
        moves = flags(leads for _, table in over for leads in table.ravel().tolist())
        return [
            ("n_tip_parts", str(len(over))),
            ("tip_outer", numbers(0 if outer is None else outer + 1 for outer, _ in over)),
            ("tip_over", f"array3d(1..{len(over)}, 0..{last}, 0..{last}, {moves})"),
        ]


def tip_moves(facts: Facts, home_mm: Point, linked: Sequence[tuple[int, int]] = ()) -> list[tuple[int | None, Bools]]:
    """Outer contours, and which moves lead over the part of each: from each stop (row) to each, home being number 0.

    Parts that no move leads over are left out. A contour of None is out from the start; no other is when the torch
    leaves home. A move that is linked is no idle travel.
    """
    left = facts.nest.index
    held, parts = facts.held_by_tabs, facts.whole_nest.parts
    over = [(left.get(part.outer.id), part.outer.polygon) for part in parts if part.outer.id not in held]
    gone = np.array([outer is None for outer, _ in over], dtype=np.bool_)
    areas = shapely.STRtree(shapely.buffer([area for _, area in over], -GRAZE_UM / UM_PER_MM))
    pierces = rounded_mm([home_mm, *(c.pierce for c in facts.candidates)], home_mm)
    leads = np.zeros((len(over), len(pierces), len(pierces)), dtype=np.bool_)
    for stop, end in enumerate(rounded_mm([home_mm, *(c.end for c in facts.candidates)], home_mm)):
        moves = shapely.linestrings(np.stack([np.broadcast_to(end, pierces.shape), pierces], axis=1))
        reached, part = areas.query(moves, "intersects")
        leads[part, stop, reached] = True
    leads[~gone, 0] = False
    leads[:, 0, 0] = False
    for move in linked:
        leads[:, move[0], move[1]] = False
    return [(outer, leads[k]) for k, (outer, _) in enumerate(over) if leads[k].any()]


def rounded_mm(points_mm: list[Point], home_mm: Point) -> Floats:
    """Points at whole µm, as every engine sees them."""
    return points_um(points_mm, home_mm) / UM_PER_MM
