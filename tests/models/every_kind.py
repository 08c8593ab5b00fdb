"""One example of each kind of statement, in a row of four parts, with a judge of its own that counts breaches by hand.

The judge tries every order and every entry with plain distances. It reads no statement, no problem and no engine.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise, permutations, product

import shapely

from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.rule_kit import (
    About,
    AtLeast,
    Before,
    Contiguous,
    Crossing,
    Enough,
    Facts,
    Forbid,
    Lag,
    Move,
    NoGood,
    Pick,
    Precede,
    Statement,
    Steps,
)
from kerfwise.rules.registry import RULES
from kerfwise.rules.statements import IdleTravel, Link
from kerfwise.tests.models.plan.conflict.statements import row
from kerfwise.tests.models.solved import plant

PARTS = 4
HOME = (0.0, 0.0)
PROFILE = plant(off=tuple(RULES))
"""No rule is on."""
FEEDS = feeds_of(PROFILE)
TRAVEL = IdleTravel(About("objective", (), "a millimetre of idle travel costs 1"))
ABOUT = About("r", ("P0.outer", "P1.outer", "P2.outer", "P3.outer"), "the example holds")
WEIGHT_MM = 40.0
NEAR_MM = 0.1
"""Engines count whole micrometres and milliseconds."""
TRACK = shapely.box(80, 10, 120, 60)


@dataclass(frozen=True)
class Way:
    """One way to cut the row: contours in order, and the candidate of each in the same order."""

    order: tuple[int, ...]
    candidates: tuple[int, ...]

    @property
    def stops(self) -> list[tuple[tuple[float, float], tuple[float, float]]]:
        """Where the torch arrives and where it leaves again, home at both ends."""
        found = [row(PARTS).candidates[c] for c in self.candidates]
        return [(HOME, HOME), *((c.pierce, c.end) for c in found), (HOME, HOME)]

    @property
    def travel_mm(self) -> float:
        return sum(math.dist(leave, reach) for (_, leave), (reach, _) in pairwise(self.stops))

    def place(self, contour: int) -> int:
        return self.order.index(contour)

    def pause_s(self, i: int, j: int) -> float:
        """Time between the end of one cut and the start of the other, whichever comes first."""
        a, b = sorted((self.place(i), self.place(j)))
        moves = sum(math.dist(self.stops[k][1], self.stops[k + 1][0]) for k in range(a + 1, b + 1)) / FEEDS.travel_mm_s
        cut_mm = [row(PARTS).candidates[c].cut_mm for c in self.candidates[a + 1 : b]]
        return moves + sum(FEEDS.pierce_s + mm / FEEDS.cut_mm_s for mm in cut_mm)

    def follows(self, leave: int, reach: int) -> bool:
        """Whether one candidate comes right after another."""
        return (leave, reach) in pairwise(self.candidates)

    def leg_mm(self, leave: int, reach: int) -> float:
        return math.dist(row(PARTS).candidates[leave].end, row(PARTS).candidates[reach].pierce)

    def crossings(self, over: int, area: shapely.Polygon) -> int:
        """How many moves cross an area once a contour is out."""
        moves = [shapely.LineString((leave, reach)) for (_, leave), (reach, _) in pairwise(self.stops)]
        return sum(area.intersects(move) for move in moves[self.place(over) + 1 :])


@dataclass(frozen=True)
class Example:
    """A hard statement, or a soft one at a weight; `breaches` says how often a way breaks it.

    `given` are orders (before, after) that hold besides.
    """

    name: str
    statement: Statement
    breaches: Callable[[Way], float]
    given: tuple[tuple[int, int], ...] = ()

    def __str__(self) -> str:
        return f"{self.name}, {'hard' if self.hard else 'soft'}"

    @property
    def hard(self) -> bool:
        return self.statement.weight is None

    @property
    def others(self) -> tuple[Statement, ...]:
        """What holds besides."""
        return (TRAVEL, *(Precede(i, j, About("given", (), f"{i} before {j}")) for i, j in self.given))

    @property
    def statements(self) -> tuple[Statement, ...]:
        return (*self.others, self.statement)

    def price_mm(self, way: Way) -> float:
        """What a way costs, infinite where it breaks what is hard."""
        if any(way.place(i) > way.place(j) for i, j in self.given):
            return math.inf
        breaches = self.breaches(way)
        if self.statement.weight is None:
            return math.inf if breaches else way.travel_mm
        return way.travel_mm + self.statement.weight * breaches

    @property
    def best_mm(self) -> float:
        """The least that a plan costs."""
        return min(self.price_mm(way) for way in ways())

    @property
    def without_mm(self) -> float:
        """The same where the statement is ignored."""
        return min(way.travel_mm for way in ways() if all(way.place(i) < way.place(j) for i, j in self.given))


def _hard() -> Iterator[Example]:
    yield Example("order", Precede(3, 0, ABOUT), lambda way: way.place(3) > way.place(0), ((0, 1),))
    yield Example("entry", Forbid(0, ABOUT), lambda way: 0 in way.candidates, ((0, 3), (3, 1)))
    yield Example(
        "sum of orders",
        AtLeast((Before(2, 0), Before(3, 0)), (1, 1), 1, ABOUT),
        lambda way: way.place(2) > way.place(0) and way.place(3) > way.place(0),
        ((0, 1),),
    )
    early, entered = Enough((Before(3, 0), Before(3, 1)), (1, 1), 2), Enough((Before(2, 0), Pick(1)), (1, -1), 1)
    yield Example(
        "sum of sums",
        AtLeast((early, entered), (1, 1), 1, ABOUT),
        lambda way: (
            way.place(3) > min(way.place(0), way.place(1)) and (way.place(2) > way.place(0) or 1 in way.candidates)
        ),
        ((0, 1),),
    )
    yield Example(
        "sum of entries",
        AtLeast((Pick(1), Pick(3), Pick(5), Before(3, 2)), (1, 1, 1, 1), 2, ABOUT),
        lambda way: sum(c in way.candidates for c in (1, 3, 5)) + (way.place(3) < way.place(2)) < 2,
        ((2, 3),),
    )
    yield Example(
        "moves one after the other",
        AtLeast((Steps(1, 2), Steps(2, 3)), (-1, -1), -1, ABOUT),
        lambda way: way.place(1) + 2 == way.place(2) + 1 == way.place(3),
        ((1, 2), (2, 3)),
    )
    yield Example(
        "sum of steps",
        AtLeast((Steps(0, 1, -1, 1), Before(0, 2)), (-1, 1), 0, ABOUT),
        lambda way: abs(way.place(0) - way.place(1)) == 1 and way.place(2) < way.place(0),
        ((0, 1), (2, 0)),
    )
    yield Example("run", Contiguous((0, 3), ABOUT), lambda way: abs(way.place(0) - way.place(3)) - 1 and 1, ((0, 1),))
    yield Example(
        "lag of one cut",
        Lag(2, 3, ABOUT, cuts=1),
        lambda way: abs(way.place(2) - way.place(3)) == 1,
        ((0, 1),),
    )
    yield Example(
        "lag of cuts", Lag(0, 1, ABOUT, cuts=2), lambda way: max(0, 3 - abs(way.place(0) - way.place(1))), ((2, 3),)
    )
    yield Example("lag of seconds", Lag(0, 1, ABOUT, seconds=5.2), lambda way: _missing(5.2 - way.pause_s(0, 1)))
    yield Example(
        "no-good",
        NoGood(frozenset({0, 1}), frozenset({3}), ABOUT),
        lambda way: way.place(3) > max(way.place(0), way.place(1)),
        ((0, 1), (1, 2)),
    )
    yield Example(
        "move",
        Move((0, 1), (1, 2), ABOUT),
        lambda way: sum(way.place(j) == way.place(i) + 1 for i in (0, 1) for j in (1, 2)),
        ((0, 3),),
    )
    yield Example(
        "move of entries",
        Move((1, 2, 3), (0, 1, 2), ABOUT, leaving=frozenset({2, 4}), reaching=frozenset({0, 2})),
        lambda way: sum(way.follows(c, d) for c in (2, 4) for d in (0, 2)),
    )
    yield Example("crossing", Crossing(1, TRACK, ABOUT), lambda way: way.crossings(1, TRACK), ((1, 2), (1, 3), (3, 0)))


def _missing(seconds: float) -> float:
    return max(0.0, seconds)


@cache
def examples() -> tuple[Example, ...]:
    """Each kind hard and soft, and idle travel, which is a price."""
    hard = tuple(_hard())
    soft = tuple(replace(e, statement=replace(e.statement, weight=WEIGHT_MM)) for e in hard)
    dearer = IdleTravel(About("objective", (), "a millimetre of idle travel costs 2 more"), 2.0)
    link = Link((0,), (7,), ((0.0, 0.0), (9.0, 0.0)), ABOUT, -30.0)
    return (
        *hard,
        *soft,
        Example("idle travel", dearer, lambda way: way.travel_mm),
        Example("link", link, lambda way: way.follows(0, 7) * (1 + way.leg_mm(0, 7) / 30.0)),
    )


@cache
def ways() -> tuple[Way, ...]:
    """Every way to cut the row."""
    return tuple(
        Way(order, candidates)
        for order in permutations(range(PARTS))
        for candidates in product(*((2 * k, 2 * k + 1) for k in order))
    )


def way_of(facts: Facts, route: Sequence[int]) -> Way:
    """The way of a route of candidates."""
    return Way(tuple(facts.candidates[c].contour for c in route), tuple(route))
