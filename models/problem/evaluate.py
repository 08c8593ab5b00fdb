"""What a route costs and which hard statements it breaks: the plain reference that every engine is held against."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.geometry.tolerances import cost_um
from kerfwise.rules.statements import About, AtLeast, Before, Crossing, Enough, Lag, Move, Pick, Steps, by_kind

from .bitsets import ROWS_AT_ONCE
from .conditions import Condition
from .crossings import FORBIDDEN, paid_along
from .moves import LAWFUL_MOST, UNLAWFUL
from .precedence import known_immediate_pairs
from .problem import Problem


def route_cost(problem: Problem, route: Sequence[int]) -> int:
    """Cost in whole µm of visiting the sites of `route` in order, from home and back, soft statements included."""
    sites = np.asarray(route, dtype=np.int64)
    legs = problem.legs(np.append(problem.m, sites), np.append(sites, problem.m))
    order = [int(problem.site_contour[s]) for s in route]
    total = int(np.where(legs > LAWFUL_MOST, legs - UNLAWFUL, legs).sum()) + int(problem.site_cost[sites].sum())
    total += sum(cost for cost, _ in broken_conditions(problem, route) if cost is not None)
    total += order_cost(problem, order)
    position = {c: k for k, c in enumerate(order)}
    times = times_ms(problem, route) if any(lag.seconds for lag in problem.lags) else {}
    total += sum(round(lag.weight) * missing_ms(lag, times) for lag in problem.lags if lag.weight is not None)
    total += sum(cost for cost in _crossed(problem, route) if cost != FORBIDDEN)
    picked = set(route)
    total += sum(
        cost_um(s.weight)
        for s in problem.general
        if s.weight is not None and not general_holds(problem, s, position, picked)
    )
    return total


def order_cost(problem: Problem, order: Sequence[int]) -> int:
    """The part of a route's cost that its order alone decides, µm: groups that are taken apart, and cuts between."""
    position = {c: k for k, c in enumerate(order)}
    apart = sum(g.cost * (pieces(order, g.contours) - 1) for g in problem.soft_groups)
    few = (cost_um(lag.weight) * _missing_cuts(lag, position) for lag in problem.lags if lag.weight is not None)
    return apart + sum(few)


def broken(problem: Problem, route: Sequence[int]) -> tuple[About, ...]:
    """The hard statements that a route breaks; empty for a lawful one. Every contour must be there once."""
    order = [int(problem.site_contour[s]) for s in route]
    if sorted(order) != list(range(problem.n)):
        return (About("coverage", (), "every contour is cut exactly once"),)
    position = {c: k for k, c in enumerate(order)}
    found = broken_orders(problem, order)
    found += [about for cost, about in broken_conditions(problem, route) if cost is None]
    times = times_ms(problem, route) if any(lag.seconds for lag in problem.lags) else {}
    for lag in problem.lags:
        if lag.weight is None and (_missing_cuts(lag, position) > 0 or missing_ms(lag, times) > 0):
            found.append(lag.about)
    found += _unlawful_moves(problem, route)
    if FORBIDDEN in _crossed(problem, route):
        found.append(About("crossing", (), "an idle move crosses a part that is already out"))
    picked = set(route)
    found += [s.about for s in problem.general if s.weight is None and not general_holds(problem, s, position, picked)]
    return tuple(found)


def _unlawful_moves(problem: Problem, route: Sequence[int]) -> list[About]:
    """Who says so of the moves that are not lawful by themselves; a table of costs tells no more than that."""
    sites = np.asarray(route, dtype=np.int64)
    if not len(problem.moves.price) and problem.matrix is None:
        return []
    if not (problem.legs(sites[:-1], sites[1:]) > LAWFUL_MOST).any():
        return []
    found = [s.about for s, _ in broken_moves(problem, route) if s.weight is None]
    return found or [About("move", (), "a move that is not lawful is made")]


def broken_moves(problem: Problem, route: Sequence[int]) -> Iterator[tuple[Move, int]]:
    """The statements about moves that a route breaks, each time with the place of the cut that is left."""
    sites = np.asarray(route, dtype=np.int64)
    if problem.moves:
        yield from problem.moves.broken_by(problem.site_contour[sites].tolist(), problem.site_candidate[sites].tolist())


def broken_orders(problem: Problem, order: Sequence[int]) -> list[About]:
    """The hard orders and blocks that an order of all contours breaks."""
    found: list[About] = []
    at = np.empty(problem.n, dtype=np.int64)
    at[list(order)] = np.arange(problem.n)
    for first in () if _orders_hold(problem, at) else range(0, problem.n, ROWS_AT_ONCE):
        some = slice(first, first + ROWS_AT_ONCE)
        rows, columns = np.nonzero(problem.before[some] & (at[some, None] > at))
        for i, j in zip((first + rows).tolist(), columns.tolist(), strict=True):
            names = (problem.ids[i], problem.ids[j])
            found.append(About("order", names, f"{names[0]} must be cut before {names[1]}"))
    along = problem.block[list(order)]
    begun = along[np.flatnonzero(np.diff(along, prepend=-1))]  # the block of every piece of the order
    for block, pieces in zip(*np.unique(begun, return_counts=True), strict=True):
        if pieces > 1:
            together = tuple(problem.ids[k] for k in np.flatnonzero(problem.block == block))
            found.append(About("contiguous", together, f"{', '.join(together)} must follow each other"))
    return found


def _orders_hold(problem: Problem, at: Ints) -> bool:
    """Whether all hard orders hold, as far as that is quick to tell, for contours at these places of an order.

    They do where those do with no third contour between them, which large problems know.
    """
    if problem.n < ROWS_AT_ONCE:
        return False
    sooner, later = known_immediate_pairs(problem.before)
    return bool((at[sooner] < at[later]).all())


def general_holds(problem: Problem, statement: AtLeast, position: dict[int, int], picked: set[int]) -> bool:
    """Whether a statement over any literals holds; `picked` are sites."""
    if statement.when is not None and int(problem.candidate_site[statement.when]) not in picked:
        return True
    return _enough(problem, statement, position, picked)


def _enough(problem: Problem, statement: AtLeast | Enough, position: dict[int, int], picked: set[int]) -> bool:
    """Whether the literals that are true weigh enough."""
    total = 0
    for literal, weight in zip(statement.literals, statement.weights, strict=True):
        match literal:
            case Before(i, j):
                total += weight * (position[i] < position[j])
            case Steps(i, j, least, most):
                total += weight * (least <= position[j] - position[i] <= most)
            case Pick(c):
                total += weight * (int(problem.candidate_site[c]) in picked)
            case Enough():
                total += weight * _enough(problem, literal, position, picked)
    return total >= statement.bound


def _missing_cuts(lag: Lag, position: dict[int, int]) -> int:
    return max(0, lag.cuts - (abs(position[lag.first] - position[lag.second]) - 1))


def times_ms(problem: Problem, route: Sequence[int]) -> dict[int, tuple[int, int]]:
    """Contour → when its cut begins and ends, ms from the program's start."""
    if not len(problem.pace.cut_ms):
        return {int(problem.site_contour[s]): (0, 0) for s in route}
    now, at = 0, problem.home_um
    times = {}
    ways = np.array([problem.m, *route], dtype=np.int64)
    for site, row in zip(route, problem.links.rows_of(ways[:-1], ways[1:]).tolist(), strict=True):
        linked = row >= 0
        begin = now if linked else now + int(problem.pace.move_ms(at, problem.pierce_um[site]))
        now = begin + int(problem.pace.cut_ms[site]) + (int(problem.links.ms[row]) if linked else 0)
        at = problem.end_um[site]
        times[int(problem.site_contour[site])] = (begin, now)
    return times


def missing_ms(lag: Lag, times: dict[int, tuple[int, int]]) -> int:
    if not lag.seconds:
        return 0
    (_, end), (begin, _) = sorted((times[lag.first], times[lag.second]))
    return max(0, round(lag.seconds * 1000) - (begin - end))


def _crossed(problem: Problem, route: Sequence[int]) -> list[int]:
    """What the moves of the route cost for the parts they cross, in the order of the rows of `Crossings`."""
    rows, m = problem.crossings, problem.m
    if not len(rows):
        return []
    stops = np.array([m, *route, m])
    step, onward = np.full(m + 1, -1), np.full(m + 1, -1)
    step[stops[:-1]], onward[stops[:-1]] = np.arange(len(stops) - 1), stops[1:]
    place = np.zeros(problem.n, dtype=np.int64)
    place[problem.site_contour[list(route)]] = np.arange(len(route))
    taken = np.flatnonzero(onward[rows.leave] == rows.reach)
    taken = taken[place[rows.over[taken]] < step[rows.leave[taken]]]
    return [int(cost) for cost in rows.cost[taken]]


def unpriced_crossings(problem: Problem, statements: Sequence[Crossing], route: Sequence[int]) -> int:
    """What a route costs besides `route_cost`, µm, where the problem says nothing of what single moves cross.

    That is where it was not asked, or where there were too many moves to look at. `statements` are all on crossings.
    """
    stops = np.array([problem.m, *route, problem.m])
    free = problem.links.rows_of(stops[:-1], stops[1:]) >= 0
    free[0] |= bool(by_kind(problem.told.statements).crossing)  # what the first move crosses is a condition then
    place = np.zeros(problem.n, dtype=np.int64)
    place[problem.site_contour[list(route)]] = np.arange(len(route))
    return paid_along(statements, problem.ends()[stops[:-1]], problem.pierces()[stops[1:]], place, free)


def pieces(order: Sequence[int], members: tuple[int, ...]) -> int:
    """In how many pieces an order has some contours."""
    wanted = set(members)
    inside = [c in wanted for c in order]
    return sum(now and not was for was, now in zip([False, *inside], inside, strict=False))


def broken_conditions(problem: Problem, route: Sequence[int]) -> Iterator[tuple[int | None, About]]:
    """The conditions that a route does not meet, with their prices; None where hard."""
    already: set[int] = set()
    used, of_contour = {None, *route}, dict[int, list[Condition]]()
    for condition in problem.conditions:
        if condition.when in used:
            of_contour.setdefault(condition.contour, []).append(condition)
    for site in route:
        contour = int(problem.site_contour[site])
        for condition in of_contour.get(contour, ()):
            if condition.when in (None, site) and not condition.met(already):
                yield condition.cost, condition.about
        already.add(contour)
