"""Bounds by walks for every stretch apart, from the last to the first: what is ahead of a stretch is settled before it.

A stretch is a problem of its own, between a home that stands for whatever comes before it and one for whatever comes
after. It ends at what the next stretch still costs at least from there on, so that the bounds of all stretches add up,
and each is found in tables of its own sites and places alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.models.engines import bounds
from kerfwise.models.engines.solution import Progress
from kerfwise.models.problem.problem import Problem

from .alone import FAR, alone, ends_of
from .by_contour import ByContour
from .crossed import HOME
from .local import Local
from .rest_bound import RestBound
from .series import series
from .shelf import Shelf
from .stretches import travel_between

if TYPE_CHECKING:
    from kerfwise.models.engines.bounds import Completion

MOST_NEIGHBOURS, SHARE, BYTES_A_NUMBER = 6, 0.25, 8
"""What a walk remembers at the most, and the share of the bytes given that the tables of all stretches may take."""


@dataclass(frozen=True, eq=False, slots=True)
class Ahead:
    """A stretch and what is ahead in it: `sites` of its contours, those it may begin (`into`) and end with (`out_of`).

    `bound` is what a plan costs from a state on to its end at least; `onward` (len(out_of),) from the end of the
    stretch on.
    """

    group: tuple[int, ...]
    sites: Ints
    into: Ints
    out_of: Ints
    onward: Ints
    bound: Completion

    def rests(self, local: Local, missed: int) -> Callable[[int], RestBound]:
        """The same for the sweep of this stretch; later ones cost `missed` more than their bounds say."""
        near = np.where(self.bound.near < 0, -1, self.bound.near)

        def after(depth: int) -> RestBound:
            return RestBound(np.ascontiguousarray(self.bound.to_go[depth]), near, self.bound.price, float(missed))

        return after


def look_ahead(
    problem: Problem,
    route: Sequence[int],
    work: float,
    progress: Progress | None,
    most_bytes: float,
    most: float = inf,
) -> list[Ahead]:
    """What is ahead in every stretch of a problem, in their order.

    Each has its share of the work. `route` is a lawful one: what it costs is what a bound may rise to.

    Raises
    ------
    TooMuch
        If all stretches take `most` deterministic seconds or more, one round of each being the least.
    """
    groups = series(problem)
    sites = [problem.sites_of(group) for group in groups]
    ends = [ends_of(problem, group) for group in groups]
    weight = np.array([float(len(of)) ** 2 * len(group) for of, group in zip(sites, groups, strict=True)])
    numbers = sum((len(group) + 1) * len(of) for of, group in zip(sites, groups, strict=True))
    remembered = int(np.log2(max(1.0, SHARE * most_bytes / BYTES_A_NUMBER / max(1, numbers))))
    until = np.cumsum([len(group) for group in groups]).tolist()
    found: list[Ahead] = []
    parts, shelf = ByContour(problem), Shelf()
    for k in reversed(range(len(groups))):
        before = ends[k - 1][1] if k else np.array([HOME])
        asked = parts.of(groups[k])
        onward = _onward(asked, ends[k][1], found[-1] if found else None)
        enter = travel_between(asked, before, sites[k]).min(axis=0)
        apart = alone(asked, groups[k], sites[k], enter, ends[k][1], onward)
        own = list(route[until[k] - len(groups[k]) : until[k]])
        known = int(problem.legs(own[:-1], own[1:]).sum() + problem.site_cost[own].sum() + enter[sites[k] == own[0]][0])
        known += int(onward[ends[k][1] == own[-1]][0])
        share = work * float(weight[k] / weight.sum())
        bound = bounds.complete(apart, known, share, progress, min(MOST_NEIGHBOURS, remembered), most_bytes, most)
        most -= bound.work
        kept = replace(bound, to_go=shelf.put(bound.to_go))
        found.append(Ahead(groups[k], sites[k], *ends[k], onward, kept))
    return found[::-1]


def _onward(problem: Problem, leave: Ints, following: Ahead | None) -> Ints:
    """What plans cost from the end of a stretch at least, by the site that they leave it from."""
    if following is None:
        return np.minimum(travel_between(problem, leave, np.array([HOME]))[:, 0], FAR)
    size = np.diff(problem.first)[list(following.group)]
    rest = following.bound.after_first(np.repeat(np.arange(len(size)), size))
    whole = np.floor(np.minimum(rest + problem.site_cost[following.sites], FAR)).astype(np.int64)
    first = np.isin(following.sites, following.into)
    least: Ints = (travel_between(problem, leave, following.into) + whole[first]).min(axis=1)
    return np.minimum(least, FAR)
