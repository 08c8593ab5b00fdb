"""Problems made directly, without a nest: by hand, at random for hypothesis, and larger ones for measuring."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from hypothesis import strategies as st

from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.crossings import FORBIDDEN, Crossings
from kerfwise.models.problem.moves import MovePrices, without_near_lags
from kerfwise.models.problem.precedence import close
from kerfwise.models.problem.problem import Durations, Links, Problem, SoftGroup
from kerfwise.rule_kit import About, AtLeast, Before, Lag, Move, Pick
from kerfwise.rules.statements import Literal

ABOUT = About("test", (), "a statement made for a test")
Points = Sequence[tuple[float, float]]


def problem(
    pierces_mm: Sequence[Points],
    *,
    ends_mm: Sequence[Points] | None = None,
    home_mm: tuple[float, float] = (0.0, 0.0),
    pairs: Sequence[tuple[int, int]] = (),
    blocks: Sequence[Sequence[int]] = (),
    conditions: Sequence[Condition] = (),
    soft_groups: Sequence[SoftGroup] = (),
    lags: Sequence[Lag] = (),
    general: Sequence[AtLeast] = (),
    site_cost: Sequence[int] | None = None,
    travel_weight: float = 1.0,
    crossings: Crossings | None = None,
    pace: Durations | None = None,
    links: Sequence[tuple[int, int, int, int]] = (),
    moves: Sequence[Move] = (),
) -> Problem:
    """A problem with the pierce points of every contour's sites (where the cuts end too, unless `ends_mm` is given).

    Every site is a candidate of the same number. `links` are rows (leave, reach, cost, ms) of
    sites. `pairs` (before, after) and `blocks` may not contradict each other.
    """
    n = len(pierces_mm)
    block = np.arange(n, dtype=np.int64)
    for members in blocks:
        block[list(members)] = members[0]
    before = close(n, list(pairs), block)
    assert not before.diagonal().any(), "the orders contradict each other"
    counts = [len(points) for points in pierces_mm]
    m = sum(counts)
    contours = np.repeat(np.arange(n, dtype=np.int64), counts)
    far, near = without_near_lags(lags)
    return Problem(
        n=n,
        first=np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        site_contour=contours,
        site_candidate=np.arange(m, dtype=np.int64),
        candidate_site=np.arange(m, dtype=np.int64),
        pierce_um=_um(pierces_mm),
        end_um=_um(ends_mm or pierces_mm),
        site_cost=np.array(site_cost or [0] * m, dtype=np.int64),
        home_um=_um([[home_mm]])[0],
        travel_weight=travel_weight,
        before=before,
        block=block,
        conditions=tuple(conditions),
        soft_groups=tuple(soft_groups),
        lags=far,
        moves=MovePrices.of([*near, *moves], contours, np.arange(m), n),
        general=tuple(general),
        ids=tuple(f"C{i}" for i in range(n)),
        crossings=crossings or Crossings(),
        pace=pace or Durations(),
        links=linked(m, links),
    )


def linked(sites: int, rows: Sequence[tuple[int, int, int, int]]) -> Links:
    """Links (leave, reach, cost, ms) between so many sites; of several between the same two the last."""
    once = sorted({(leave, reach): (leave, reach, cost, ms) for leave, reach, cost, ms in rows}.values())
    leave, reach, cost, ms = np.array(once, dtype=np.int64).reshape(-1, 4).T.copy()
    return Links(leave, reach, cost, ms, np.arange(len(once)), sites)


def with_lags(drawn: Problem, lags: Sequence[Lag]) -> Problem:
    """A problem with lags, and no other statements about moves."""
    far, near = without_near_lags(lags)
    return replace(drawn, lags=far, moves=MovePrices.of(near, drawn.site_contour, drawn.candidate_site, drawn.n))


def scattered(seed: int, contours: int, sites: int, pairs: int = 0, blocks: Sequence[Sequence[int]] = ()) -> Problem:
    """Contours strewn over 1000 × 1000 mm, sites on a circle round each, random orders from left to right.

    `blocks` are slices of the contours in the order of their numbers, which is from left to right.
    """
    rng = np.random.default_rng(seed)
    centres = rng.uniform(0, 1000, (contours, 2))
    centres = centres[np.argsort(centres[:, 0])]
    angles = rng.uniform(0, 2 * np.pi, (contours, sites))
    radius = rng.uniform(10, 80, (contours, 1))
    pierces = centres[:, None, :] + radius[..., None] * np.stack([np.cos(angles), np.sin(angles)], axis=2)
    ends = centres[:, None, :] + (radius[..., None] - 5) * np.stack([np.cos(angles), np.sin(angles)], axis=2)
    drawn = [sorted(rng.choice(contours, 2, replace=False).tolist()) for _ in range(pairs)]
    return problem(
        [[(x, y) for x, y in row] for row in pierces.tolist()],
        ends_mm=[[(x, y) for x, y in row] for row in ends.tolist()],
        pairs=[(i, j) for i, j in drawn],
        blocks=blocks,
    )


@st.composite
def problems(draw: st.DrawFn, contours: int = 5, sites: int = 3, choices: int = 12) -> Problem:
    """Tiny problems with everything a problem can hold; some have no lawful route.

    At most `contours` contours with at most `sites` sites each, and at most `choices` ways to pick sites (which keeps
    the routes few enough to try them all).
    """
    n = draw(st.integers(1, contours))
    counts: list[int] = []
    for _ in range(n):
        room = choices // int(np.prod(counts)) if counts else choices
        counts.append(draw(st.integers(1, max(1, min(sites, room)))))
    m = sum(counts)
    points = draw(st.lists(_POINTS, min_size=2 * m, max_size=2 * m))
    starts = np.cumsum([0, *counts]).tolist()
    order = draw(st.permutations(range(n)))
    ranks = st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)).filter(lambda p: p[0] < p[1])
    pairs = draw(st.lists(ranks, max_size=n)) if n > 1 else []
    one_site = st.integers(0, m - 1)
    drawn = problem(
        [points[a:b] for a, b in pairwise(starts)],
        ends_mm=[points[m + a : m + b] for a, b in pairwise(starts)],
        home_mm=draw(_POINTS),
        pairs=[(order[a], order[b]) for a, b in pairs],
        blocks=_slices(order, draw(st.sets(st.integers(1, n), max_size=n)), draw(st.booleans())),
        conditions=draw(st.lists(_conditions(n, starts), max_size=4)),
        soft_groups=draw(st.lists(_soft_groups(n), max_size=2)),
        lags=draw(st.lists(_lags(n), max_size=2)) if n > 1 else (),
        moves=draw(st.lists(_moves(n, m), max_size=2)),
        general=draw(st.lists(_general(n, one_site), max_size=2)),
        site_cost=draw(st.lists(st.integers(0, 20_000), min_size=m, max_size=m)),
        travel_weight=draw(st.sampled_from([1.0, 0.5])),
        crossings=draw(_crossings(n, m)),
        pace=Durations(np.array(draw(st.lists(st.integers(0, 3000), min_size=m, max_size=m)), dtype=np.int64), 0.02),
    )
    return replace(drawn, links=draw(_links(drawn)))


@st.composite
def _links(draw: st.DrawFn, drawn: Problem) -> Links:
    """A few moves with the torch on, cheaper than idle travel, and with their sites not less than nothing."""
    sites = st.integers(0, drawn.m - 1)
    moves = draw(st.sets(st.tuples(sites, sites), max_size=6))
    rows = []
    for leave, reach in sorted(moves):
        if drawn.site_contour[leave] == drawn.site_contour[reach]:
            continue
        least, idle = -int(drawn.site_cost[reach]), int(drawn.legs([leave], [reach])[0])
        least_ms = -int(drawn.pace.cut_ms[reach])
        rows.append((leave, reach, draw(st.integers(least, idle)), draw(st.integers(least_ms, 1000))))
    return linked(drawn.m, rows)


@st.composite
def _crossings(draw: st.DrawFn, n: int, m: int) -> Crossings:
    """A few moves over contours that may be out, all at one price (as one rule states them)."""
    site = st.integers(0, m)
    rows = draw(st.sets(st.tuples(site, site, st.integers(0, n - 1)), max_size=6))
    if not rows:
        return Crossings()
    leave, reach, over = np.array(sorted(rows), dtype=np.int64).T
    cost = draw(st.one_of(st.just(FORBIDDEN), st.integers(1, 60_000)))
    return Crossings(leave, reach, over, np.full(len(rows), cost), np.zeros(len(rows), dtype=np.int64))


_POINTS = st.tuples(st.integers(0, 50).map(float), st.integers(0, 50).map(float))
_COST = st.one_of(st.none(), st.integers(0, 60_000))
_WEIGHT = st.one_of(st.none(), st.integers(0, 60).map(float))
_SMALL = st.integers(-2, 2)


def _um(points_mm: Sequence[Points]) -> np.ndarray:
    flat = [point for points in points_mm for point in points]
    return np.asarray(np.rint(np.array(flat, dtype=np.float64).reshape(-1, 2) * UM_PER_MM), dtype=np.int64)


def _slices(order: Sequence[int], cuts: set[int], blocked: bool) -> list[Sequence[int]]:
    """Blocks that no order along `order` contradicts; none unless `blocked`."""
    bounds = [0, *sorted(cuts - {len(order)}), len(order)]
    return [order[a:b] for a, b in pairwise(bounds)] if blocked and len(bounds) > 2 else []


@st.composite
def _conditions(draw: st.DrawFn, n: int, starts: list[int]) -> Condition:
    contour = draw(st.integers(0, n - 1))
    members = tuple(sorted(draw(st.sets(st.integers(0, n - 1), max_size=3))))
    weights = tuple(draw(_SMALL) for _ in members)
    when = draw(st.one_of(st.none(), st.integers(starts[contour], starts[contour + 1] - 1)))
    return Condition(contour, members, weights, draw(st.integers(-2, 1)), ABOUT, when, draw(_COST))


@st.composite
def _soft_groups(draw: st.DrawFn, n: int) -> SoftGroup:
    members = draw(st.sets(st.integers(0, n - 1), min_size=1))
    return SoftGroup(tuple(sorted(members)), draw(st.integers(0, 60_000)), ABOUT)


@st.composite
def _lags(draw: st.DrawFn, n: int) -> Lag:
    first, second = draw(st.permutations(range(n)))[:2]
    seconds = draw(st.sampled_from([0.0, 0.0, 0.0, 1.5, 4.0]))
    return Lag(first, second, ABOUT, cuts=draw(st.integers(0, 3)), seconds=seconds, weight=draw(_WEIGHT))


@st.composite
def _moves(draw: st.DrawFn, n: int, m: int) -> Move:
    contours = st.sets(st.integers(0, n - 1), min_size=1, max_size=3).map(lambda some: tuple(sorted(some)))
    by = st.one_of(st.none(), st.none(), st.frozensets(st.integers(0, m - 1), max_size=m))
    return Move(draw(contours), draw(contours), ABOUT, draw(_WEIGHT), draw(by), draw(by))


@st.composite
def _general(draw: st.DrawFn, n: int, one_site: st.SearchStrategy[int]) -> AtLeast:
    contour = st.integers(0, n - 1)
    literal: st.SearchStrategy[Literal] = st.one_of(st.builds(Before, contour, contour), st.builds(Pick, one_site))
    literals = tuple(draw(st.lists(literal, max_size=4)))
    weights = tuple(draw(_SMALL) for _ in literals)
    when = draw(st.one_of(st.none(), one_site))
    return AtLeast(literals, weights, draw(st.integers(-2, 2)), ABOUT, when, draw(_WEIGHT))
