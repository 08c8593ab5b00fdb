"""The inner loops of the bound by walks, compiled by numba."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.models.kernels import kept


@kept(nogil=True)
def look_ahead(  # pragma: no cover - compiled
    arc_from: Ints,
    arc_to: Ints,
    arc_cost: Floats,
    owner: Ints,
    price: Floats,
    earliest: Ints,
    latest: Ints,
    least: Floats,
    contour: Ints,
    step: Ints,
    second: Floats,
    second_step: Ints,
) -> None:
    """Fill `least[d, s]` (n + 1, m + 1): the least rest of a walk that stands at site s after d steps; row n is given.

    `contour[d, s]`, `step[d, s]` are where it goes next; `second`, `second_step` the same for the least walk that goes
    to another contour next, which is taken where the first would lead straight back to where it came from.
    """
    n, m = len(earliest), len(owner) - 1
    for d in range(n - 1, -1, -1):
        for s in range(m + 1):
            here = owner[s]
            best = other = np.inf
            to = to_other = to_contour = -1
            if s == m if d == 0 else (s < m and earliest[here] < d <= latest[here] + 1):
                for e in range(arc_from[s], arc_from[s + 1]):
                    t = arc_to[e]
                    c = owner[t]
                    if d < earliest[c] or d > latest[c]:
                        continue
                    rest = second[d + 1, t] if contour[d + 1, t] == here else least[d + 1, t]
                    total = arc_cost[e] - price[c] + rest
                    if total < best:
                        if c != to_contour:
                            other, to_other = best, to
                        best, to, to_contour = total, t, c
                    elif total < other and c != to_contour:
                        other, to_other = total, t
            least[d, s], step[d, s], contour[d, s] = best, to, to_contour
            second[d, s], second_step[d, s] = other, to_other


@kept(nogil=True)
def count_visits(  # pragma: no cover - compiled
    owner: Ints, contour: Ints, step: Ints, second_step: Ints, visits: Ints
) -> None:
    """How often the least walk from home visits every contour (n,)."""
    s, before = len(owner) - 1, -1
    visits[:] = 0
    for d in range(len(visits)):
        to = second_step[d, s] if contour[d, s] == before else step[d, s]
        before, s = owner[s], to
        visits[owner[s]] += 1
