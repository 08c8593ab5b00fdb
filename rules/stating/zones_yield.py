"""Zones that yield to hard sums of orders, as they do to hard orders: parts whose sum cannot hold change zones."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import TYPE_CHECKING, assert_never

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.rules.registry import RULES
from kerfwise.rules.statements import AtLeast, Before, Enough, Literal, Pick, Precede, Statement, Steps, by_kind, plain

from .feasible_sums import shown_impossible, sums_of_orders
from .reduced_statements import by_orders

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts

MOST_ROUNDS = 20
"""How often zones are looked at again, as one change may ask for another."""


def zones_that_yield(facts: Facts, statements: Sequence[Statement], zoning: frozenset[str]) -> Ints | None:
    """Zones (n,) in which no hard sum is impossible for the zones alone; None where they need not, or cannot, yield.

    `zoning` are the rules whose orders may come from zones: they do where all lead from one zone to a later one. A part
    changes zone as a whole, with all that lies in it or around it; what must be cut before it comes along. Where all
    orders of a sum are about one contour, that goes to the nearest zone that leaves room for all parts of which the
    same rule asks the same. Else the orders that fail by the fewest zones are mended first, until enough of them can
    hold. Where sums that can hold one by one cannot hold together, whatever else gives way, the sheet is one zone.
    """
    kinds, first = by_kind(statements), facts.zone
    hard = [s for s in kinds.precede if s.weight is None]
    zoning &= {s.about.rule for s in hard} - {s.about.rule for s in hard if first[s.before] >= first[s.after]}
    if not zoning:
        return None
    changed = _one_by_one(facts, kinds.at_least, hard, zoning)
    zone = first if changed is None else changed
    sums, runs = sums_of_orders(statements), [s.contours for s in kinds.contiguous if s.weight is None]
    if not sums:
        return changed
    yielding = zoning | {name for name, rule in RULES.items() if rule.gives_way}
    links = list(dict.fromkeys((s.before, s.after) for s in hard if s.about.rule not in yielding))
    zoned = sorted({k for s in hard if s.about.rule in zoning for k in (s.before, s.after)})
    members = [[k for k in zoned if zone[k] == level] for level in sorted(set(zone[zoned].tolist()))]
    by_zone = [link for one, then in pairwise(members) for link in product(one, then)]
    if not shown_impossible(facts.n, [*links, *by_zone], runs, sums) or shown_impossible(facts.n, links, runs, sums):
        return changed
    whole = zone.copy()
    whole[zoned] = zone[zoned].min()
    return whole


def _one_by_one(
    facts: Facts, at_least: Sequence[AtLeast], hard: Sequence[Precede], zoning: frozenset[str]
) -> Ints | None:
    """Zones in which every sum can hold by itself; None where they need not, or cannot, be others."""
    zone, first = facts.zone.copy(), facts.zone
    sums = [(_pivot(s), s) for s in at_least if s.weight is None and s.when is None and s.literals]
    if not sums:
        return None
    moves = _Moves(_units(facts), [(s.before, s.after) for s in hard if s.about.rule not in zoning])
    for _ in range(MOST_ROUNDS):
        stuck = [(pivot, s) for pivot, s in sums if not _possible(s, zone)]
        if not stuck:
            return None if (zone == first).all() else zone
        of_rule: dict[str, set[int]] = defaultdict(set)
        for pivot, s in stuck:
            if pivot is not None:
                of_rule[s.about.rule].add(pivot)
        for pivot, s in stuck:
            if _possible(s, zone):
                continue
            if pivot is None:
                zone = _mended(s, zone, moves)
            else:
                zone = _moved(pivot, s, zone, frozenset(of_rule[s.about.rule]), moves)
    return None


def _pivot(s: AtLeast) -> int | None:
    """The contour that all orders of a sum are about; None where there is none, or fewer than three orders."""
    if len(s.literals) < 3:
        return None
    pairs = [{x.i, x.j} for x in s.literals if isinstance(x, Before)]
    common = set.intersection(*pairs) if len(pairs) == len(s.literals) else set()
    return common.pop() if len(common) == 1 else None


def _possible(s: AtLeast | Enough, zone: Ints, together: frozenset[int] = frozenset()) -> bool:
    """Whether the sum can hold by the zones alone; contours `together` in one zone take the worst place."""
    return sum(_most(x, weight, zone, together) for x, weight in zip(s.literals, s.weights, strict=True)) >= s.bound


def _most(literal: Literal, weight: int, zone: Ints, together: frozenset[int]) -> int:
    """What a literal adds at the most: an order between zones is decided, an entry is not."""
    match literal:
        case Pick():
            return max(weight, 0)
        case Enough():
            return max(weight, 0) if weight < 0 or _possible(literal, zone, together) else 0
        case Before(i, j):
            if zone[i] == zone[j]:
                return min(weight, 0) if {i, j} <= together else max(weight, 0)
            return weight if zone[i] < zone[j] else 0
        case Steps():
            if weight > 0:
                return weight if _possible(by_orders(literal, len(zone)), zone, together) else 0
            move = literal.least == literal.most  # seldom the only way
            return 0 if move or _possible(by_orders(literal, len(zone), holds=False), zone, together) else weight
        case _:
            assert_never(literal)


def _units(facts: Facts) -> Ints:
    """Contours that share a zone have one number: those of a part, and of parts that lie in each other."""
    number = np.arange(facts.n)
    parts = {contour.part: k for k, contour in enumerate(facts.nest.contours)}
    for k, contour in enumerate(facts.nest.contours):
        number[k] = parts[contour.part]
    for outer, inner in facts.contains.tolist():
        number[number == number[inner]] = number[outer]
    return number


@dataclass(frozen=True, eq=False, slots=True)
class _Moves:
    """Changes of zone: units (n,) of contours that share one, and the hard orders that zones do not give."""

    unit: Ints
    orders: Sequence[tuple[int, int]]

    def to(self, zone: Ints, contours: Iterable[int], away: int, *, earlier: bool) -> Ints:
        """The zones with contours in zone `away`, or an earlier (later) one, and what must come before (after) them."""
        changed = zone.copy()
        waiting, done = [*contours], set[int]()
        while waiting:
            contour = waiting.pop()
            for k in np.flatnonzero(self.unit == self.unit[contour]).tolist():
                if k in done or (changed[k] <= away if earlier else changed[k] >= away):
                    continue
                done.add(k)
                changed[k] = away
                waiting += [a for a, b in self.orders if b == k] if earlier else [b for a, b in self.orders if a == k]
        return changed


def _moved(pivot: int, s: AtLeast, zone: Ints, group: frozenset[int], moves: _Moves) -> Ints:
    """The zones with a pivot and its group in the nearest one in which its sum can hold, whatever their order."""
    now, changed = int(zone[pivot]), zone
    for away in sorted(range(int(zone.min()), int(zone.max()) + 1), key=lambda z: (abs(z - now), z)):
        changed = moves.to(zone, (pivot, *group), away, earlier=away < now)
        if _possible(s, changed, group | {pivot}):
            break
    return changed


def _mended(s: AtLeast, zone: Ints, moves: _Moves) -> Ints:
    """The zones in which so many orders of a sum can hold that it can: each order by the smaller of its two moves."""
    for _ in range(len(tuple(plain(s.literals)))):
        if _possible(s, zone):
            break
        wrong = [(first, last) for first, last in _wanted(s, zone) if zone[first] > zone[last]]
        if not wrong:
            break
        first, last = min(wrong, key=lambda pair: (zone[pair[0]] - zone[pair[1]], pair))
        ways = (
            moves.to(zone, (first,), int(zone[last]), earlier=True),
            moves.to(zone, (last,), int(zone[first]), earlier=False),
        )
        zone = min(ways, key=lambda way: np.count_nonzero(way != zone))
    return zone


def _wanted(s: AtLeast | Enough, zone: Ints) -> Iterator[tuple[int, int]]:
    """The orders that would help a sum, of each the contour that should come first."""
    for literal, weight in zip(s.literals, s.weights, strict=True):
        match literal:
            case Pick():
                pass
            case Enough():
                if weight > 0 and not _possible(literal, zone):
                    yield from _wanted(literal, zone)
            case Before(i, j):
                yield (i, j) if weight > 0 else (j, i)
            case Steps():
                yield from _wanted(by_orders(literal, len(zone), holds=weight > 0), zone)
            case _:
                assert_never(literal)
