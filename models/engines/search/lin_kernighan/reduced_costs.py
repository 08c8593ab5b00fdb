"""What arcs cost beyond the cheapest assignment of a successor to everyone.

A tour is an assignment, too. So every tour costs the assignment's cost and, above that, the reduced costs of its arcs:
none of them is below zero, and most arcs of a good tour are at zero where costs differ much both ways.
"""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Bools, Ints


def reduced_costs(cost: Ints, lawful: Bools) -> Ints:
    """Reduced costs (k, k) of arcs that cost `cost` (k, k), whole numbers at least 0 wherever the arc is lawful.

    What an unlawful arc has in its place means nothing. Some lawful arcs must make an assignment.

    Examples
    --------
    >>> lawful = ~np.eye(3, dtype=bool)
    >>> reduced_costs(np.array([[0, 2, 5], [4, 0, 3], [1, 6, 0]]), lawful).tolist()[0]
    [-2, 0, 3]
    """
    from scipy.optimize import linear_sum_assignment  # it takes longer to load than a small nest to plan

    size = len(cost)
    far = (int(cost[lawful].max(initial=0)) + 1) * (size + 1)
    dear = np.where(lawful, cost, far).astype(np.int64)
    assigned = linear_sum_assignment(dear)[1]
    taken = dear[np.arange(size), assigned]
    more = dear - taken[:, None]  # than what the assignment takes: no circle of such changes is below zero
    into = np.zeros(size, dtype=np.int64)
    while True:
        least = np.minimum(into, (more + into[assigned][:, None]).min(axis=0))
        if (least == into).all():
            break
        into = least
    out_of = taken - into[assigned]
    return np.asarray(cost - out_of[:, None] - into[None, :], dtype=np.int64)
