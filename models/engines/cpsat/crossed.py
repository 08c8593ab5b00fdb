"""Crossings that the hard orders leave open, gathered: of the moves that leave one contour only one is made."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass

import numpy as np

from kerfwise.models.problem.problem import Problem

from .arcs import ArcLiterals
from .moves import Out, arc_of_move, out_by_then


@dataclass(frozen=True, slots=True)
class OpenCrossing:
    """Leaving contour `leave` by one of `arcs` costs `cost` µm (or is `FORBIDDEN`) if contour `over` is out."""

    leave: int
    over: int
    cost: int
    arcs: tuple[int, ...]


def open_crossings(problem: Problem, arcs: ArcLiterals) -> tuple[OpenCrossing, ...]:
    """All of them; an arc that crosses several areas of the same contour is in as many."""
    rows = problem.crossings
    arc = arc_of_move(problem.m, arcs.tail, arcs.head, rows.leave, rows.reach)
    left = np.flatnonzero((out_by_then(problem) == Out.OPEN) & (arc >= 0) & (rows.cost != 0))
    leave = problem.site_contour[rows.leave[left]]
    columns = (arc[left].tolist(), leave.tolist(), rows.over[left].tolist(), rows.cost[left].tolist())
    times: Counter[tuple[int, int, int]] = Counter()
    gathered: dict[tuple[int, int, int, int], list[int]] = defaultdict(list)
    for a, i, over, cost in zip(*columns, strict=True):
        gathered[i, over, cost, times[a, over, cost]].append(a)
        times[a, over, cost] += 1
    return tuple(OpenCrossing(i, over, cost, tuple(found)) for (i, over, cost, _), found in gathered.items())
