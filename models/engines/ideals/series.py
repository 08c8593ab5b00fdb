"""Where a problem falls apart: stretches of the order that must follow each other, such as zones."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from kerfwise.models.problem.bits import ROWS_AT_ONCE
from kerfwise.models.problem.last import LastOf, digest
from kerfwise.models.problem.problem import Problem

_last = LastOf[list[tuple[int, ...]]]()


def series(problem: Problem) -> list[tuple[int, ...]]:
    """Contours in as many groups as possible, such that every member of a group precedes all later groups.

    Soft groups are never split, so that what they cost is known within one group. The last answer is kept: a proof
    asks for it a few times.

    Examples
    --------
    Two zones of one contour each come back as `[(0,), (1,)]` when 0 must precede 1.
    """
    asked = digest(*(np.array(group.contours, dtype=np.int64) for group in problem.soft_groups))
    found = _last.known(problem.before, asked)
    if found is None:
        found = _apart(problem)
        _last.keep(problem.before, asked, found)
    return list(found)


def _apart(problem: Problem) -> list[tuple[int, ...]]:
    order = np.argsort(problem.before.sum(axis=0), kind="stable")
    n = problem.n
    settled = np.empty(n, dtype=np.int64)  # from this place on, every contour is known to follow the i-th
    for k in range(0, n, ROWS_AT_ONCE):
        some = slice(k, k + ROWS_AT_ONCE)
        follows = problem.before[order[some]].take(order[::-1], axis=1)
        settled[some] = n - np.argmin(follows, axis=1)  # behind the last that does not follow, perhaps itself
    reach = np.maximum.accumulate(settled) if n else settled
    breaks = {k for k in range(1, n) if reach[k - 1] <= k}
    place = {int(c): k for k, c in enumerate(order)}
    for group in problem.soft_groups:
        places = [place[c] for c in group.contours]
        breaks -= set(range(min(places) + 1, max(places) + 1))
    edges = [0, *sorted(breaks), n]
    return [tuple(sorted(order[a:b].tolist())) for a, b in pairwise(edges) if b > a]
