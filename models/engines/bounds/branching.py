"""Branching on what a flow leaves open: which contour directly follows which, and by which site a contour is cut.

Each case is the same linear program with fewer moves, solved on from the last basis; the cuts found in one hold in all.
Bounds are worked out from multipliers as everywhere, so a case is done with once its bound reaches the known plan.
"""

from __future__ import annotations

import heapq
from typing import TYPE_CHECKING

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints

if TYPE_CHECKING:
    from .flow import CutLoop

ROUNDS, GAIN = 3, 3e-4
"""A case is split again once so many rounds of cuts have gained less than this share."""
MOST_BRANCHED, MOST_CASES = 1200, 1000
"""Sites from which on cases take too long; and cases that are kept at the most."""
WHOLE = 1e-3
"""What is no further from a whole number is one."""


def branch(loop: CutLoop) -> float:
    """What every plan costs at least by all cases together; the case with the lowest bound is split first."""
    flow = loop.flow
    goal, known = float(flow.plan_um - 1), float(flow.plan_um)
    cases: list[tuple[float, int, Bools]] = []
    number, reached, done = 0, loop.best, known
    while True:
        parts = split(flow.allowed, flow.contours_used(), flow.sites_used(), flow.owner) if reached <= goal else []
        if reached <= goal and not parts:
            done = min(done, reached)
        for part in parts:
            number += 1
            heapq.heappush(cases, (reached, number, part))
        if not cases:
            return done
        if cases[0][0] > goal or len(cases) > MOST_CASES or not loop.go():
            return min(done, cases[0][0])
        bound, _, allowed = heapq.heappop(cases)
        flow.restrict(allowed)
        reached = max(bound, loop.run(ROUNDS, GAIN))
        if not loop.stalled and reached <= goal:  # not looked at to its end
            return min(done, reached, *(case[0] for case in cases))


def split(allowed: Bools, used: Floats, sites_used: Floats, owner: Ints) -> list[Bools]:
    """Two cases that have every plan of the moves `allowed` (m + 1, m + 1) between them; none where all is whole.

    `used` (n + 1, n + 1) goes from contour to contour, `sites_used` (m + 1,) to sites; `owner` is the contour of each.
    """
    open_ = np.minimum(used, 1.0 - used)
    i, j = np.unravel_index(int(np.argmax(open_)), open_.shape)
    without, only = allowed.copy(), allowed.copy()
    if open_[i, j] > WHOLE:
        leaves, reaches = owner == i, owner == j
        without[np.ix_(leaves, reaches)] = False
        only[np.ix_(leaves, ~reaches)] = False
        only[np.ix_(~leaves, reaches)] = False
        return [without, only]
    open_sites = np.minimum(sites_used, 1.0 - sites_used)
    site = int(np.argmax(open_sites))
    if open_sites[site] <= WHOLE:
        return []
    without[site] = without[:, site] = False
    others = (owner == owner[site]) & (np.arange(len(owner)) != site)
    only[others] = only[:, others] = False
    return [without, only]
