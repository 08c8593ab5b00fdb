"""Which hard statements a changed order breaks, and what it costs where it breaks none."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from kerfwise.models.problem.evaluate import broken, broken_orders
from kerfwise.rules.statements import (
    About,
    AtLeast,
    Before,
    Contiguous,
    Crossing,
    Forbid,
    IdleTravel,
    Lag,
    Link,
    NoGood,
    Precede,
    Statement,
)
from kerfwise.rules.stating.lazy import afterthoughts, forbids_later

from .along import Along
from .resite import Stuck, resite
from .setting import Setting


@dataclass(frozen=True, slots=True)
class TriedOrder:
    """A changed order: what it breaks or, if nothing, what its best route costs, µm."""

    breaks: tuple[About, ...]
    cost: int | None = None
    route: tuple[int, ...] = ()


def try_order(setting: Setting, order: Sequence[int], look: bool = True) -> TriedOrder:
    """Judge an order by all that is stated, with the best entries along it.

    Without a `look`, what only geometry finds in a whole order is left out: where a rule forbids such, that takes most
    of the time.
    """
    breaks = tuple(dict.fromkeys(_broken(setting, order)))
    if breaks:
        return TriedOrder(breaks)
    found = resite(setting, order)
    if isinstance(found, Stuck):
        return TriedOrder(found.abouts)
    breaks = broken(setting.problem, found.route)
    if look and not breaks and forbids_later(setting.facts, setting.profile):
        thoughts = afterthoughts(setting.facts, setting.profile)(order)
        breaks = tuple(s.about for s in thoughts if s.weight is None)
    return TriedOrder(breaks) if breaks else TriedOrder((), found.cost, found.route)


def quickly_tried(along: Along, order: Sequence[int]) -> TriedOrder:
    """The same without its route, by what is known of the plan's own order, where that tells all."""
    setting = along.setting
    if along.exact and not forbids_later(setting.facts, setting.profile):
        breaks = tuple(dict.fromkeys(_broken(setting, order, along.asked)))
        if breaks:
            return TriedOrder(breaks)
        if not broken_orders(setting.problem, order):
            cost = along.moved(order)
            if cost is not None:
                return TriedOrder((), cost)
    return try_order(setting, order)


def _broken(setting: Setting, order: Sequence[int], asked: Sequence[Statement] | None = None) -> Iterator[About]:
    """The hard statements that the order breaks whatever the entries; `asked` are those that may be, if known."""
    place = np.empty(setting.problem.n, dtype=np.int64)
    place[list(order)] = np.arange(len(order))
    if len(setting.pairs):
        for k in np.flatnonzero(place[setting.pairs[:, 0]] > place[setting.pairs[:, 1]]).tolist():
            yield setting.orders[k].about
    for s in setting.stated.statements if asked is None else asked:
        if s.weight is None and not _holds(s, place):
            yield s.about


def _holds(statement: Statement, place: NDArray[np.int64]) -> bool:
    """Whether an order keeps a statement; one that hangs on entries is taken to hold."""
    match statement:
        case Contiguous(contours):
            at = place[list(contours)]
            return bool(at.max() - at.min() < len(contours))
        case NoGood(out, left):
            return bool(place[sorted(out)].max() > place[sorted(left)].min())
        case Lag(i, j):
            return bool(abs(place[i] - place[j]) > statement.cuts)
        case AtLeast():
            if statement.when is not None:
                return True
            pairs = [lit for lit in statement.literals if isinstance(lit, Before)]
            true = sum(w for lit, w in zip(pairs, statement.weights, strict=False) if place[lit.i] < place[lit.j])
            return len(pairs) < len(statement.literals) or true >= statement.bound
        case Precede() | Forbid() | Crossing() | IdleTravel() | Link():
            return True  # `_broken` looks at orders, `resite` and `broken` at entries and moves
        case _:
            assert_never(statement)
