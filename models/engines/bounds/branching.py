"""Branching on what a flow leaves open: which contour directly follows which, and by which site a contour is cut.

Each case is the same linear program with fewer moves, solved on from the last basis; the cuts found in one hold in all.
Bounds are worked out from multipliers as everywhere, so a case is done with once its bound reaches the known plan.
"""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints

WHOLE = 1e-3
"""What is no further from a whole number is one."""


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
