"""Moves between sites: looked up where a matrix fits, else computed, links aside."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.models.problem.problem import Problem

from .compiled import compiled
from .crossed import always_crossed

MATRIX_SITES = 3000  # a travel matrix is kept up to this many sites
NO_LINK = 1 << 58  # more than any move costs, µm


class Legs(NamedTuple):
    """n contours, m sites; home is site m.

    Sites of contour i are `first[i]` … `first[i + 1] - 1`; `contour` of home is n. `travel` (m + 1, m + 1) includes
    what moves cross in any order; it is (0, 0) when legs are computed from `pierce`, `end` and `weight`. `leave[a, c]`
    is the least travel from site a to contour c, `enter[b, c]` that from contour c to site b; where there is no matrix
    the circles round a contour's points bound them.

    Links from site a are the rows `link_from[a]` … `link_from[a + 1] - 1`, sorted by the site `link_to` that they lead
    to; each costs `link_cost`, and the cut there takes `link_ms` more. `link_into[c]` is what the cheapest link to a
    site of contour c costs, `link_at[b]` the cheapest to site b, `NO_LINK` where there is none.
    """

    n: int
    m: int
    first: Ints
    contour: Ints
    site_cost: Ints
    travel: Ints
    leave: Ints
    enter: Ints
    pierce: Floats
    end: Floats
    weight: float
    pierce_circle: Floats
    end_circle: Floats
    link_from: Ints
    link_to: Ints
    link_cost: Ints
    link_ms: Ints
    link_into: Ints
    link_at: Ints


def make_legs(problem: Problem) -> Legs:
    """The legs of a problem."""
    n, m = problem.n, problem.m
    if problem.matrix is None and m > MATRIX_SITES:
        travel = leave = enter = np.zeros((0, 0), dtype=np.int64)
    else:
        travel = problem.travel(np.arange(m + 1), np.arange(m + 1))
        from_site, to_site, cost = always_crossed(problem)
        np.add.at(travel, (from_site, to_site), cost)
        leave = _least(travel[:, :m], problem.first)
        enter = _least(travel[:m].T, problem.first)
    return Legs(
        n=n,
        m=m,
        first=problem.first,
        contour=np.append(problem.site_contour, n),
        site_cost=problem.site_cost,
        travel=travel,
        leave=leave,
        enter=enter,
        pierce=problem.pierces().astype(np.float64),
        end=problem.ends().astype(np.float64),
        weight=float(problem.travel_weight),
        pierce_circle=_circles(problem.pierce_um, problem.first),
        end_circle=_circles(problem.end_um, problem.first),
        link_from=np.searchsorted(problem.links.leave, np.arange(m + 2)).astype(np.int64),
        link_to=problem.links.reach,
        link_cost=problem.links.cost,
        link_ms=problem.links.ms,
        link_into=_cheapest(problem, np.append(problem.site_contour, n)[problem.links.reach], n),
        link_at=_cheapest(problem, problem.links.reach, m),
    )


def _cheapest(problem: Problem, to: Ints, home: int) -> Ints:
    """What the cheapest link to each of several places costs, home the last."""
    least = np.full(home + 1, NO_LINK, dtype=np.int64)
    np.minimum.at(least, to, problem.links.cost)
    return least


def _least(travel: Ints, first: Ints) -> Ints:
    """Least of each contour's columns."""
    if len(first) == 1:
        return np.zeros((len(travel), 0), dtype=np.int64)
    return np.ascontiguousarray(np.minimum.reduceat(travel, first[:-1], axis=1), dtype=np.int64)


def _circles(points: Ints, first: Ints) -> Floats:
    """Centre and radius of a circle round each contour's points, (n, 3)."""
    if len(first) == 1:
        return np.zeros((0, 3))
    starts = first[:-1]
    centre = (np.minimum.reduceat(points, starts) + np.maximum.reduceat(points, starts)) / 2
    away = np.hypot(*(points - np.repeat(centre, np.diff(first), axis=0)).T)
    return np.column_stack([centre, np.maximum.reduceat(away, starts)])


@compiled
def leg(legs: Legs, a: int, b: int) -> int:
    """The move from the end of site a to the pierce of site b, whole µm."""
    if legs.travel.shape[0] > 0:
        return int(legs.travel[a, b])
    link = link_of(legs, a, b)
    if link >= 0:
        return int(legs.link_cost[link])
    dx = legs.end[a, 0] - legs.pierce[b, 0]
    dy = legs.end[a, 1] - legs.pierce[b, 1]
    return int(np.rint(legs.weight * np.sqrt(dx * dx + dy * dy)))


@compiled
def link_of(legs: Legs, a: int, b: int) -> int:
    """The link from site a to site b, -1 if there is none."""
    low, high = legs.link_from[a], legs.link_from[a + 1]
    stop = high
    while low < high:
        middle = (low + high) >> 1
        if legs.link_to[middle] < b:
            low = middle + 1
        else:
            high = middle
    return int(low) if low < stop and legs.link_to[low] == b else -1


@compiled
def least_leave(legs: Legs, a: int, c: int) -> int:
    """At most the travel from site a to any site of contour c."""
    if legs.travel.shape[0] > 0:
        return int(legs.leave[a, c])
    dx = legs.end[a, 0] - legs.pierce_circle[c, 0]
    dy = legs.end[a, 1] - legs.pierce_circle[c, 1]
    idle = int(legs.weight * max(0.0, np.sqrt(dx * dx + dy * dy) - legs.pierce_circle[c, 2])) - 1
    return idle if legs.link_from[a] == legs.link_from[a + 1] else min(idle, int(legs.link_into[c]))


@compiled
def least_enter(legs: Legs, c: int, b: int) -> int:
    """At most the travel from any site of contour c to site b."""
    if legs.travel.shape[0] > 0:
        return int(legs.enter[b, c])
    dx = legs.end_circle[c, 0] - legs.pierce[b, 0]
    dy = legs.end_circle[c, 1] - legs.pierce[b, 1]
    idle = int(legs.weight * max(0.0, np.sqrt(dx * dx + dy * dy) - legs.end_circle[c, 2])) - 1
    return min(idle, int(legs.link_at[b]))
