"""Where a problem falls apart: stretches of the order that must follow each other, such as zones."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from kerfwise.models.problem.problem import Problem


def series(problem: Problem) -> list[tuple[int, ...]]:
    """Contours in as many groups as possible, such that every member of a group precedes all later groups.

    Soft groups are never split, so that what they cost is known within one group.

    Examples
    --------
    Two zones of one contour each come back as `[(0,), (1,)]` when 0 must precede 1.
    """
    order = np.argsort(problem.before.sum(axis=0), kind="stable")
    before = problem.before[np.ix_(order, order)]
    n = problem.n
    # settled[i]: from this place on, every contour is known to follow the i-th
    settled = n - np.argmin(np.column_stack([before[:, ::-1], np.zeros(n, dtype=np.bool_)]), axis=1)
    reach = np.maximum.accumulate(settled) if n else settled
    breaks = {k for k in range(1, n) if reach[k - 1] <= k}
    place = {int(c): k for k, c in enumerate(order)}
    for group in problem.soft_groups:
        places = [place[c] for c in group.contours]
        breaks -= set(range(min(places) + 1, max(places) + 1))
    edges = [0, *sorted(breaks), n]
    return [tuple(sorted(order[a:b].tolist())) for a, b in pairwise(edges) if b > a]
