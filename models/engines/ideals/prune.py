"""What plans still cost after a state, as the sweep of a stretch needs it to drop what is too dear."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from kerfwise.models.problem.followers import Followers
from kerfwise.models.problem.problem import Problem

from .local import Local
from .rest_bound import RestBound

if TYPE_CHECKING:
    from kerfwise.models.engines.bounds import Completion

NOWHERE = 1e12
"""Travel to a contour that nothing may come right before: more than any plan costs, but finite."""


def least_rest(local: Local, earlier: frozenset[int], least: LeastIn) -> Callable[[int], RestBound]:
    """Every contour that is left must be travelled to, which costs `least`, whatever is cut last."""
    n = len(least)
    inside = set(local.contours)
    rest = RestBound(
        np.zeros((1, len(local.sites))),
        np.zeros((len(local.contours), 0), dtype=np.int64),
        np.array([least[c] for c in local.contours]),
        float(sum(least[c] for c in range(n) if c not in earlier and c not in inside)),
    )
    return lambda _: rest


def walked_rest(local: Local, earlier: frozenset[int], bound: Completion) -> Callable[[int], RestBound]:
    """The bound by walks."""
    number = np.full(len(bound.price) + 1, -2, dtype=np.int64)
    number[[*earlier, -1]] = -1
    number[list(local.contours)] = np.arange(len(local.contours))
    chosen = list(local.contours)
    near, price = number[bound.near[chosen]], bound.price[chosen]
    later = float(bound.price[number[:-1] == -2].sum())

    def after(depth: int) -> RestBound:
        return RestBound(np.ascontiguousarray(bound.to_go[len(earlier) + depth][:, local.sites]), near, price, later)

    return after


class LeastIn:
    """For every contour a lower bound on the travel that leads to it from what may come right before.

    Each is worked out when it is first asked for: it takes a look at all sites, and a window asks for few.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._sites = np.append(np.diff(problem.first), 1)
        self._known: dict[int, float] = {}

    def __len__(self) -> int:
        return self._problem.n

    def __getitem__(self, contour: int) -> float:
        if contour not in self._known:
            self._known[contour] = self._least(contour)
        return self._known[contour]

    @cached_property
    def _followers(self) -> Followers:
        return self._problem.followers()

    def _least(self, contour: int) -> float:
        problem = self._problem
        before = np.flatnonzero(np.repeat(self._followers.ahead_of(contour), self._sites))
        ways = problem.travel(before, np.array(problem.sites(contour)))
        if len(problem.links):  # which save a pierce that the site is paid for with
            ways += problem.site_cost[problem.first[contour] : problem.first[contour + 1]]
        return float(ways.min(initial=NOWHERE))
