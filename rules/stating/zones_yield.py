"""Zones that yield to hard sums of orders, as they do to hard orders: parts whose sum cannot hold change zones."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.rules.statements import AtLeast, Before, Statement, by_kind

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts

MOST_ROUNDS = 20
"""How often zones are looked at again, as one change may ask for another."""


def zones_that_yield(facts: Facts, statements: Sequence[Statement], zoning: frozenset[str]) -> Ints | None:
    """Zones (n,) in which no hard sum is impossible for the zones alone; None where they need not, or cannot, yield.

    `zoning` are the rules whose orders may come from zones: they do where all lead from one zone to a later one. A part
    changes zone as a whole, with all that lies in it or around it; what must be cut before it comes along. It goes to
    the nearest zone that leaves room for all parts of which the same rule asks the same.
    """
    kinds = by_kind(statements)
    zone, first = facts.zone.copy(), facts.zone
    sums = [(pivot, s) for s in kinds.at_least if s.weight is None and (pivot := _pivot(s)) is not None]
    hard = [s for s in kinds.precede if s.weight is None]
    zoning &= {s.about.rule for s in hard} - {s.about.rule for s in hard if first[s.before] >= first[s.after]}
    if not sums or not zoning:
        return None
    unit = _units(facts)
    orders = [(s.before, s.after) for s in hard if s.about.rule not in zoning]
    for _ in range(MOST_ROUNDS):
        stuck = [(pivot, s) for pivot, s in sums if not _possible(s, zone, frozenset())]
        if not stuck:
            return None if (zone == first).all() else zone
        of_rule: dict[str, set[int]] = defaultdict(set)
        for pivot, s in stuck:
            of_rule[s.about.rule].add(pivot)
        for pivot, s in stuck:
            if _possible(s, zone, frozenset()):
                continue
            zone = _moved(pivot, s, zone, frozenset(of_rule[s.about.rule]), unit, orders)
    return None


def _pivot(s: AtLeast) -> int | None:
    """The contour that all orders of a sum are about; None where there is none, or fewer than three orders."""
    if s.when is not None or len(s.literals) < 3:
        return None
    pairs = [{x.i, x.j} for x in s.literals if isinstance(x, Before)]
    common = set.intersection(*pairs) if len(pairs) == len(s.literals) else set()
    return common.pop() if len(common) == 1 else None


def _possible(s: AtLeast, zone: Ints, together: frozenset[int]) -> bool:
    """Whether the sum can hold by the zones alone; contours `together` in the pivot's zone take the worst place."""
    most = 0
    for literal, weight in zip(s.literals, s.weights, strict=True):
        assert isinstance(literal, Before)
        before, after = int(zone[literal.i]), int(zone[literal.j])
        if before == after and {literal.i, literal.j} <= together:
            most += min(weight, 0)
        elif before == after:
            most += max(weight, 0)
        elif before < after:
            most += weight
    return most >= s.bound


def _units(facts: Facts) -> Ints:
    """Contours that share a zone have one number: those of a part, and of parts that lie in each other."""
    number = np.arange(facts.n)
    parts = {contour.part: k for k, contour in enumerate(facts.nest.contours)}
    for k, contour in enumerate(facts.nest.contours):
        number[k] = parts[contour.part]
    for outer, inner in facts.contains.tolist():
        number[number == number[inner]] = number[outer]
    return number


def _moved(
    pivot: int, s: AtLeast, zone: Ints, group: frozenset[int], unit: Ints, orders: Sequence[tuple[int, int]]
) -> Ints:
    """The zones with a pivot and its group in the nearest one in which its sum can hold, whatever their order."""
    now, changed = int(zone[pivot]), zone
    for away in sorted(range(int(zone.min()), int(zone.max()) + 1), key=lambda z: (abs(z - now), z)):
        earlier, changed = away < now, zone.copy()
        waiting, done = [pivot, *group], set[int]()
        while waiting:
            contour = waiting.pop()
            for k in np.flatnonzero(unit == unit[contour]).tolist():
                if k in done or (changed[k] <= away if earlier else changed[k] >= away):
                    continue
                done.add(k)
                changed[k] = away
                waiting += [a for a, b in orders if b == k] if earlier else [b for a, b in orders if a == k]
        if _possible(s, changed, group | {pivot}):
            break
    return changed
