"""Conditions of a problem as conditions of a region."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.models.engines.search.demands import Demands
from kerfwise.models.problem.conditions import Condition
from kerfwise.rules.statements import About

from .pieces import Pieces

ABOUT = About("region", (), "what the whole problem asks")


class AskedOf:
    """The conditions of one problem."""

    def __init__(self, demands: Demands) -> None:
        self._demands = demands
        self._row = np.repeat(np.arange(len(demands.contour)), np.diff(demands.member_first))

    def of(self, pieces: Pieces, before: Bools, site_cost: Ints) -> list[Condition]:
        """What they ask of pieces; what they cost by a site in any order is added to `site_cost`.

        What the order within a piece settles, or orders between pieces (`before`), is left out.
        """
        demands, row = self._demands, self._row
        contour, site = demands.contour, demands.site
        piece = pieces.of_contour[contour]
        alone = pieces.alone[piece]
        taken = (site < 0) | alone | (site == pieces.on_route[contour])
        member, weight = demands.member, demands.weight
        other, here = pieces.of_contour[member], piece[row]
        same = other == here
        sooner = np.where(same, pieces.place[member] < pieces.place[contour[row]], before[other, here])
        open_ = ~same & ~sooner & ~before[here, other]
        count = len(contour)
        bound = demands.bound - _summed(row, np.where(sooner, weight, 0), count)
        low = _summed(row, np.where(open_, np.minimum(weight, 0), 0), count)
        high = _summed(row, np.where(open_, np.maximum(weight, 0), 0), count)
        unsure = taken & (low < bound) & (bound <= high)
        never = taken & (high < bound) & alone & (site >= 0)
        priced = never & (demands.cost >= 0)
        np.add.at(site_cost, pieces.new_site[site[priced]], demands.cost[priced])
        found = []
        for k in np.flatnonzero(unsure | (never & (demands.cost < 0))).tolist():
            weights: dict[int, int] = {}
            for e in range(demands.member_first[k], demands.member_first[k + 1]):
                if open_[e]:
                    weights[int(other[e])] = weights.get(int(other[e]), 0) + int(weight[e])
            at = int(pieces.new_site[site[k]]) if alone[k] and site[k] >= 0 else None
            cost = None if demands.cost[k] < 0 else int(demands.cost[k])
            asked = tuple(weights), tuple(weights.values()), int(bound[k])
            found.append(Condition(int(piece[k]), *asked, ABOUT, at, cost))
        return found


def _summed(row: Ints, values: Ints, count: int) -> Ints:
    """Sums by row, exact."""
    total = np.zeros(count, dtype=np.int64)
    np.add.at(total, row, values)
    return total
