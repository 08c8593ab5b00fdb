"""Lawful routes that are not far from a given one: some contours elsewhere in the order, some entered elsewhere."""

from __future__ import annotations

import random
from collections.abc import Sequence

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.models.engines.baselines.walk import Walk
from kerfwise.models.problem.evaluate import broken
from kerfwise.models.problem.problem import Problem

from .prices import HeatPrices

ATTEMPTS = 20
MOST_MOVES = 3
MOST_PULLED = 4
"""Contours that are entered at random, at the most."""


def nearby(
    problem: Problem, route: Sequence[int], prices: HeatPrices, price_mm: float, chance: random.Random
) -> tuple[int, ...] | None:
    """A lawful route (sites) near to a route, its entries the cheapest for its order but for a few drawn at random.

    None if no attempt led to the end.
    """
    for _ in range(ATTEMPTS):
        found = _walk(problem, _moved(problem, route, prices, chance), prices, price_mm, chance)
        if found is not None and not broken(problem, found):
            return found
    return None


def _moved(problem: Problem, route: Sequence[int], prices: HeatPrices, chance: random.Random) -> Floats:
    """Where each contour would like to be, (n,): a near pair the other way round, or a stretch backwards."""
    order = [int(problem.site_contour[s]) for s in route]
    pairs = prices.terms.pairs.tolist()
    for _ in range(chance.randint(0, MOST_MOVES)):
        if pairs and chance.random() < 0.5:
            i, j = sorted(chance.choice(pairs), key=order.index)
            block = [c for c in order if problem.block[c] == problem.block[j]]
            rest = [c for c in order if c not in block or c == i]
            at = rest.index(i)
            order = [*rest[:at], *(c for c in block if c != i), *rest[at:]]
        else:
            a, b = sorted((chance.randrange(len(order)), chance.randrange(len(order))))
            order[a : b + 1] = order[a : b + 1][::-1]
    place = np.empty(problem.n)
    place[order] = np.arange(problem.n)
    return place


def _walk(
    problem: Problem, place: Floats, prices: HeatPrices, price_mm: float, chance: random.Random
) -> tuple[int, ...] | None:
    """The lawful order that follows these places as well as it can, with its cheapest entries."""
    walk, out = Walk(problem), np.zeros(problem.n, dtype=np.bool_)
    layers: list[list[int]] = []
    cost = problem.site_cost.astype(np.float64)
    sites, more = prices.of_entries()
    while not walk.finished:
        options = walk.options()
        if not options:
            return None
        contour = min((int(problem.site_contour[s]) for s in options), key=lambda c: (place[c], c))
        layers.append([s for s in options if problem.site_contour[s] == contour])
        cost[layers[-1]] += price_mm * UM_PER_MM * (sites[layers[-1]] + more[layers[-1]] @ out)
        walk.take(layers[-1][0])
        out[contour] = True
    for k in chance.sample(range(len(layers)), min(len(layers), chance.randint(0, MOST_PULLED))):
        layers[k] = [chance.choice(layers[k])]
    return _cheapest(problem, layers, cost)


def _cheapest(problem: Problem, layers: Sequence[list[int]], cost: Floats) -> tuple[int, ...]:
    """One site of each layer, so that travel and sites cost least: a shortest path."""
    total, ways = np.zeros(1), []
    leave = [problem.m]
    for layer in layers:
        through = total[:, None] + problem.travel(leave, layer)
        ways.append(through.argmin(axis=0))
        total, leave = through.min(axis=0) + cost[layer], layer
    at = int((total + problem.travel(leave, [problem.m])[:, 0]).argmin()) if layers else 0
    route = []
    for layer, way in zip(reversed(layers), reversed(ways), strict=True):
        route.append(layer[at])
        at = int(way[at])
    return tuple(reversed(route))
