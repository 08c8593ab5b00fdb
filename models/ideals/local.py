"""One stretch of the order, translated to bit masks: what the sweep over its ideals works on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..problem import Problem

Masks = NDArray[np.uint64]
Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
MOST_CONTOURS = 63


@dataclass(frozen=True, eq=False, slots=True)
class Local:
    """A group of k contours with local numbers; masks have bit i set for local contour i.

    `needs[i]` must be cut before i; `mates[i]` is i's contiguous block (0 for none). Sites of contour i are the
    columns `first[i]` … `first[i+1] - 1`. Condition q of contour i (`cond_of[i]` ≤ q < `cond_of[i+1]`) concerns site
    column `cond_site[q]` (-1: all) and asks `cond_weight` over `cond_member` to reach `cond_bound`; `cond_cost` is
    infinite for a hard one. `soft_mask`, `soft_cost` are groups that cost when they are left before they are whole.
    """

    contours: tuple[int, ...]
    sites: Ints
    first: Ints
    needs: Masks
    mates: Masks
    cond_of: Ints
    cond_site: Ints
    cond_from: Ints
    cond_member: Ints
    cond_weight: Ints
    cond_bound: Ints
    cond_cost: Floats
    soft_mask: Masks
    soft_cost: Floats
    site_cost: Floats

    @property
    def full(self) -> int:
        """The mask of all contours."""
        return (1 << len(self.contours)) - 1


def localise(problem: Problem, contours: tuple[int, ...], earlier: frozenset[int]) -> Local:
    """Translate the group `contours`, of which all of `earlier` are cut before and all others after."""
    number = {c: k for k, c in enumerate(contours)}
    sites = np.array([s for c in contours for s in problem.sites(c)], dtype=np.int64)
    column = {int(s): k for k, s in enumerate(sites)}
    first = np.cumsum([0, *(len(problem.sites(c)) for c in contours)]).astype(np.int64)

    def mask(members: list[int]) -> int:
        return sum(1 << number[c] for c in members if c in number)

    blocks = {int(b): np.flatnonzero(problem.block == b).tolist() for b in np.unique(problem.block[list(contours)])}
    rows = []
    for condition in problem.conditions:
        if condition.contour not in number:
            continue
        pairs = list(zip(condition.members, condition.weights, strict=True))
        rows.append(
            (
                number[condition.contour],
                -1 if condition.when is None else column[condition.when],
                [(number[c], w) for c, w in pairs if c in number],
                condition.bound - sum(w for c, w in pairs if c in earlier),
                np.inf if condition.cost is None else float(condition.cost),
            )
        )
    rows.sort(key=lambda row: row[0])
    groups = [g for g in problem.soft_groups if g.contours[0] in number]
    return Local(
        contours=contours,
        sites=sites,
        first=first,
        needs=np.array([mask(np.flatnonzero(problem.before[:, c]).tolist()) for c in contours], dtype=np.uint64),
        mates=np.array([_mate_mask(mask(blocks[int(problem.block[c])])) for c in contours], dtype=np.uint64),
        cond_of=np.searchsorted([r[0] for r in rows], np.arange(len(contours) + 1)).astype(np.int64),
        cond_site=np.array([r[1] for r in rows], dtype=np.int64),
        cond_from=np.cumsum([0, *(len(r[2]) for r in rows)]).astype(np.int64),
        cond_member=np.array([m for r in rows for m, _ in r[2]], dtype=np.int64),
        cond_weight=np.array([w for r in rows for _, w in r[2]], dtype=np.int64),
        cond_bound=np.array([r[3] for r in rows], dtype=np.int64),
        cond_cost=np.array([r[4] for r in rows], dtype=np.float64),
        soft_mask=np.array([mask(list(g.contours)) for g in groups], dtype=np.uint64),
        soft_cost=np.array([g.cost for g in groups], dtype=np.float64),
        site_cost=problem.site_cost[sites].astype(np.float64),
    )


def _mate_mask(mask: int) -> int:
    return mask if mask & (mask - 1) else 0
