"""Lags, as the search reads them: contours that must keep some cuts, or some seconds, apart."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import Lag

from .compiled import compiled
from .demands import HARD
from .legs import Legs, link_of
from .lists import flatten, ints

STEPS = 8  # a hard lag that is kept for no time at all counts as so many broken statements, besides one for itself


class Lags(NamedTuple):
    """Contour i keeps `cuts` from the contours `other[first[i]:first[i + 1]]`; a cut that is missing costs `cost`.

    `guide_*` are the same with lags in seconds turned into cuts, for choosing a place. Lags in seconds are between
    `a` and `b`; a missing ms costs `per_ms` µm, HARD if it may not be. `cut_ms` is empty where cuts take no time.
    """

    first: Ints
    other: Ints
    cuts: Ints
    cost: Ints
    guide_first: Ints
    guide_other: Ints
    guide_cuts: Ints
    guide_cost: Ints
    a: Ints
    b: Ints
    wait_ms: Ints
    per_ms: Floats
    cut_ms: Ints
    ms_per_um: float


def make_lags(problem: Problem) -> Lags:
    """The lags of a problem."""
    in_cuts = [(lag, lag.cuts, _per_cut(lag, UM_PER_MM)) for lag in problem.lags if lag.cuts > 0]
    waits = [lag for lag in problem.lags if lag.seconds > 0]
    pace = problem.pace
    guide = list(in_cuts)
    if len(pace.cut_ms) and pace.cut_ms.any():
        cut_ms = float(pace.cut_ms.mean())
        guide += [(lag, int(np.ceil(lag.seconds * 1000 / cut_ms)), _per_cut(lag, cut_ms)) for lag in waits]
    return Lags(
        *_both_ways(problem.n, in_cuts),
        *_both_ways(problem.n, guide),
        a=ints([lag.first for lag in waits]),
        b=ints([lag.second for lag in waits]),
        wait_ms=ints([round(lag.seconds * 1000) for lag in waits]),
        per_ms=np.array([HARD if lag.weight is None else lag.weight for lag in waits], dtype=np.float64),
        cut_ms=pace.cut_ms,
        ms_per_um=float(pace.ms_per_um),
    )


def _per_cut(lag: Lag, worth: float) -> int:
    return HARD if lag.weight is None else round(lag.weight * worth)


def _both_ways(n: int, lags: list[tuple[Lag, int, int]]) -> tuple[Ints, Ints, Ints, Ints]:
    rows: list[list[tuple[int, int, int]]] = [[] for _ in range(n)]
    for lag, cuts, cost in lags:
        rows[lag.first].append((lag.second, cuts, cost))
        rows[lag.second].append((lag.first, cuts, cost))
    first, other = flatten([[other for other, _, _ in row] for row in rows])
    return first, other, ints([c for row in rows for _, c, _ in row]), ints([c for row in rows for _, _, c in row])


@compiled
def too_close(lags: Lags, contour: int, position: Ints, at: int) -> tuple[int, int]:
    """Cost, and cuts missing for hard lags, if a contour is put in just before position `at`: a guess for seconds."""
    cost, broken = 0, 0
    for e in range(lags.guide_first[contour], lags.guide_first[contour + 1]):
        where = position[lags.guide_other[e]]
        if where < 0:
            continue
        between = at - where - 1 if where < at else where - at
        missing = lags.guide_cuts[e] - between
        if missing > 0:
            if lags.guide_cost[e] < 0:
                broken += missing
            else:
                cost += missing * lags.guide_cost[e]
    return cost, broken


@compiled
def too_close_within(lags: Lags, contour: int, position: Ints, hi: int) -> tuple[int, int]:
    """Cost, and cuts missing for hard lags, of a contour and those that stand before it or from position `hi` on."""
    cost, broken = 0, 0
    at = position[contour]
    for e in range(lags.first[contour], lags.first[contour + 1]):
        where = position[lags.other[e]]
        if at < where < hi:
            continue
        missing = lags.cuts[e] - (abs(at - where) - 1)
        if missing > 0:
            if lags.cost[e] < 0:
                broken += missing
            else:
                cost += missing * lags.cost[e]
    return cost, broken


@compiled
def too_soon(lags: Lags, legs: Legs, order: Ints, position: Ints, site: Ints, time_ms: Ints) -> tuple[int, int]:
    """Cost, and number of hard ones broken, of the lags in seconds; `time_ms` is room for one number a contour."""
    if len(lags.cut_ms) > 0:
        now, last = 0, legs.m
        for c in order:
            s = site[c]
            link = link_of(legs, last, s)
            if link < 0:
                dx, dy = legs.end[last, 0] - legs.pierce[s, 0], legs.end[last, 1] - legs.pierce[s, 1]
                now += int(np.rint(np.sqrt(dx * dx + dy * dy) * lags.ms_per_um))
            time_ms[c] = now
            now += lags.cut_ms[s]
            if link >= 0:
                now += legs.link_ms[link]
            last = s
    cost, broken = 0, 0
    for k in range(len(lags.a)):
        first, second = lags.a[k], lags.b[k]
        if position[first] > position[second]:
            first, second = second, first
        between = 0
        if len(lags.cut_ms) > 0:
            between = time_ms[second] - time_ms[first] - lags.cut_ms[site[first]]
            if position[first] > 0:
                link = link_of(legs, site[order[position[first] - 1]], site[first])
                if link >= 0:
                    between -= legs.link_ms[link]
        missing = lags.wait_ms[k] - between
        if missing > 0:
            if lags.per_ms[k] < 0:
                broken += 1 + STEPS * missing // lags.wait_ms[k]
            else:
                cost += int(np.rint(lags.per_ms[k] * missing))
    return cost, broken
