"""The shortest way through points, each visited once, from one place to another: a plain problem without orders."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kerfwise.encoder.geometry.segment import Point
from kerfwise.models.engines.solution import SolveOptions

from .instance import Instance
from .solve import solve_instance

MOST_AT_ONCE = 400
"""Points of one problem: where there are more they are taken in strips, from left to right."""
_UM = 1000


def way_through(points: Sequence[Point], start: Point, end: Point, options: SolveOptions) -> list[int]:
    """The numbers of the points in the order of a short way from `start` through all of them to `end`.

    Examples
    --------
    >>> way_through([(30, 0), (10, 0), (20, 0)], (0, 0), (40, 0), SolveOptions(work=0.1))
    [1, 2, 0]
    """
    by_x = sorted(range(len(points)), key=lambda k: (points[k], k))
    strips = [by_x[k : k + MOST_AT_ONCE] for k in range(0, len(by_x), MOST_AT_ONCE)]
    if len(strips) > 1 and math.dist(start, points[by_x[-1]]) < math.dist(start, points[by_x[0]]):
        strips.reverse()
    way: list[int] = []
    at = start
    for number, strip in enumerate(strips, 1):
        goal = end if number == len(strips) else _middle([points[k] for k in strips[number]])
        way += [strip[k] for k in _solved([points[k] for k in strip], at, goal, options)]
        at = points[way[-1]]
    return way


def _solved(points: Sequence[Point], start: Point, end: Point, options: SolveOptions) -> list[int]:
    if len(points) < 2:
        return list(range(len(points)))
    places = np.array([start, *points])
    cost = np.rint(np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1)) * _UM).astype(np.int64)
    cost[:, 0] = np.rint(np.hypot(*(places - np.array(end)).T) * _UM).astype(np.int64)
    cost[0, 0] = 0
    clusters = tuple((k,) for k in range(len(places)))
    orders = np.empty((0, 2), dtype=np.int64)
    answer = solve_instance(Instance("way", cost, clusters, orders, 0, closed=True), options)
    return [vertex - 2 for vertex in answer.tour[1:]] or list(range(len(points)))


def _middle(points: Sequence[Point]) -> Point:
    x, y = np.mean(points, axis=0).tolist()
    return x, y
