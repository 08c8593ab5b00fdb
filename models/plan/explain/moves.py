"""What would change if a contour were cut at another place in the order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from kerfwise.rules.statements import About

from .along import Along
from .lawful import quickly_tried


@dataclass(frozen=True, slots=True)
class Relocation:
    """A contour, or the run of contours that it is cut with, moved to another place (from 1).

    `more_um` is what the plan would cost more, entries chosen anew along the order; None where it `breaks` something.
    """

    label: str
    moved: tuple[str, ...]
    place: int
    breaks: tuple[About, ...] = ()
    more_um: int | None = None


def explain_moves(along: Along, contour: int) -> tuple[Relocation, ...]:
    """One place earlier and later, and as early and as late as is lawful; what the contour cannot do is left out."""
    swaps = tuple(_swaps(along, contour))
    told = {(move.moved, move.place) for move in swaps}
    return (*swaps, *(move for move in _farthest(along, contour) if (move.moved, move.place) not in told))


def _swaps(along: Along, contour: int) -> Iterator[Relocation]:
    setting = along.setting
    order = list(setting.order)
    k = order.index(contour)
    for label, other in (("one place earlier", k - 1), ("one place later", k + 1)):
        if 0 <= other < len(order):
            changed = order.copy()
            changed[k], changed[other] = changed[other], changed[k]
            yield _tried(along, label, (contour,), changed, other + 1)


def _farthest(along: Along, contour: int) -> Iterator[Relocation]:
    """The whole run moves, for a contour that is cut with others."""
    setting = along.setting
    problem = setting.problem
    unit = [c for c in setting.order if problem.block[c] == problem.block[contour]]
    rest = [c for c in setting.order if problem.block[c] != problem.block[contour]]
    now = setting.order.index(unit[0])
    place = np.empty(problem.n, dtype=np.int64)
    place[rest] = np.arange(len(rest))
    before = np.flatnonzero(problem.before[:, unit].any(axis=1) & (problem.block != problem.block[contour]))
    after = np.flatnonzero(problem.before[unit].any(axis=0) & (problem.block != problem.block[contour]))
    low = int(place[before].max()) + 1 if len(before) else 0
    high = int(place[after].min()) if len(after) else len(rest)
    for label, slots in (("as early as can be", range(low, now)), ("as late as can be", range(high, now, -1))):
        for slot in slots:
            if 0 < slot < len(rest) and problem.block[rest[slot - 1]] == problem.block[rest[slot]]:
                continue
            changed = [*rest[:slot], *unit, *rest[slot:]]
            move = _tried(along, label, unit, changed, changed.index(contour) + 1)
            if not move.breaks:
                yield move
                break


def _tried(along: Along, label: str, moved: Sequence[int], order: Sequence[int], place: int) -> Relocation:
    setting = along.setting
    tried = quickly_tried(along, order)
    more = None if tried.cost is None else tried.cost - setting.cost
    return Relocation(label, tuple(setting.name(c) for c in moved), place + setting.made, tried.breaks, more)
