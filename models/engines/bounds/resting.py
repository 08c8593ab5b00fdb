"""Sites that a linear program does without: no flow goes by them, and none would soon.

Most sites of a contour are used by no flow, and a program that holds them all takes far longer to solve. A site at rest
has no moves in the program, and a multiplier all the same: one that makes neither coming to it nor leaving it cheap, as
far as that can be. A look at all moves shows whether it is missing after all.
"""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints

AWAKE = 1.25
"""Sites that are left in the program for each that is in use: those next that are nearest to being used."""
NEVER = 1e15
"""Where a site has no way in, or none out, as much as that is said to cost, µm."""


class Resting:
    """Which of so many sites, home last, are at rest, and the moves that were put aside with them.

    Attributes
    ----------
    sites
        (m + 1,)
    leave, reach
        The moves from and to these, (k,) each.
    """

    def __init__(self, sites: int) -> None:
        self.sites: Bools = np.zeros(sites, dtype=np.bool_)
        self.leave, self.reach = np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)

    def lay_down(self, leave: Ints, reach: Ints, reduced: Floats, stays: Bools, bound: Ints) -> tuple[Ints, Bools]:
        """Put sites to rest that are far from being used, and answer which, and which moves (k,) go with them.

        Parameters
        ----------
        leave, reach, reduced
            Moves of the program, (k,) each, and what multipliers leave of the costs of the first ones.
        stays
            Moves whose ends do not rest, (k,).
        bound
            How many moves of the basis go to and from each site (m + 1,), and whether the basis has its row: where that
            comes to one, the site's row alone takes their place.
        """
        busy = np.zeros(len(self.sites), dtype=np.bool_)
        busy[leave[stays]] = busy[reach[stays]] = busy[-1] = True
        ways = np.full((2, len(self.sites)), NEVER)
        for way, ends in zip(ways, (leave, reach), strict=True):
            np.minimum.at(way, ends[: len(reduced)], np.maximum(reduced, 0.0))
        missing = ways.sum(axis=0)
        quiet = np.flatnonzero(~busy & ~self.sites)
        farthest = quiet[np.argsort(missing[quiet], kind="stable")][int((AWAKE - 1) * busy.sum()) :]
        chosen = farthest[(bound[farthest] == 1) & (missing[farthest] > 0)]
        self.sites[chosen] = True
        gone = self.sites[leave] | self.sites[reach]
        self.leave, self.reach = np.append(self.leave, leave[gone]), np.append(self.reach, reach[gone])
        return chosen, gone

    def wake(self, sites: Ints) -> tuple[Ints, Ints]:
        """Let these sites rest no more, and answer which moves come back with them."""
        self.sites[sites] = False
        free = ~self.sites[self.leave] & ~self.sites[self.reach]
        back = self.leave[free], self.reach[free]
        self.leave, self.reach = self.leave[~free], self.reach[~free]
        return back

    def priced(self, price: Floats, come_to: Floats, left: Floats) -> Floats:
        """Multipliers of all sites (m + 1,), given those of the sites that do not rest.

        `come_to` (m + 1,) is what coming to the contour of each site is worth, and `left` (k,) what each move put aside
        costs, less what inequalities pay for it. A site's multiplier lies half way between what would make it cheap to
        leave and what would make it cheap to come to.
        """
        inward = self.sites[self.reach] & ~self.sites[self.leave]
        outward = self.sites[self.leave] & ~self.sites[self.reach]
        most, least = np.full(len(price), np.inf), np.full(len(price), -np.inf)
        np.minimum.at(most, self.reach[inward], (left - come_to[self.reach] + price[self.leave])[inward])
        np.maximum.at(least, self.leave[outward], (come_to[self.reach] + price[self.reach] - left)[outward])
        known = np.isfinite(most).astype(np.int64) + np.isfinite(least)
        sums = np.where(np.isfinite(most), most, 0.0) + np.where(np.isfinite(least), least, 0.0)
        return np.where(self.sites, sums / np.maximum(known, 1), price)
