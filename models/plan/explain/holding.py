"""What holds a contour in its place: the statements that keep it from coming earlier, and later, nearest first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import assert_never

import numpy as np

from kerfwise.rules.statements import (
    About,
    AtLeast,
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

from .setting import Setting


@dataclass(frozen=True, slots=True)
class Hold:
    """An order that holds: the other contour, its place in the plan (from 1), and the statement."""

    contour: str
    place: int
    about: About


def holds(setting: Setting, contour: int, earlier: bool) -> tuple[Hold, ...]:
    """The orders that keep a contour from coming earlier (else later), the nearest in the plan first."""
    place = {c: k for k, c in enumerate(setting.order, 1)}
    mine, other = (1, 0) if earlier else (0, 1)
    found = []
    for k in np.flatnonzero(setting.pairs[:, mine] == contour).tolist():
        rival = int(setting.pairs[k, other])
        found.append(Hold(setting.name(rival), place[rival] + setting.made, setting.orders[k].about))
    return tuple(sorted(found, key=lambda hold: abs(hold.place - setting.made - place[contour])))


def chain(setting: Setting, contour: int, earlier: bool) -> tuple[Hold, ...]:
    """From the contour to an end of the plan: its nearest hold, the nearest hold of that, and so on."""
    found: list[Hold] = []
    mine, other = (1, 0) if earlier else (0, 1)
    place = np.empty(setting.problem.n, dtype=np.int64)
    place[list(setting.order)] = np.arange(1, setting.problem.n + 1)
    at = contour
    while len(rows := np.flatnonzero(setting.pairs[:, mine] == at)):
        away = place[at] - place[setting.pairs[rows, other]]
        nearest = int(np.abs(away).argmin())
        if (away[nearest] > 0) != earlier:  # the plan does not keep the order, as an old one need not
            break
        at = int(setting.pairs[rows[nearest], other])
        found.append(Hold(setting.name(at), int(place[at]) + setting.made, setting.orders[rows[nearest]].about))
    return tuple(found)


def others(setting: Setting, contour: int, asked: Sequence[Statement] | None = None) -> tuple[About, ...]:
    """What else is asked of a contour's place: hard statements that are not the order of two contours.

    `asked` are those that may be such, if known.
    """
    found = []
    for s in setting.stated.statements if asked is None else asked:
        if s.weight is not None:
            continue
        match s:
            case Contiguous(contours):
                mine = contour in contours
            case NoGood(out, left):
                mine = contour in out or contour in left
            case Lag(i, j):
                mine = contour in (i, j)
            case Precede() | Forbid() | AtLeast() | Crossing() | IdleTravel() | Link():
                mine = False  # orders are `holds`; entries, sums and moves are told elsewhere
            case _:
                assert_never(s)
        if mine:
            found.append(s.about)
    site = setting.route[setting.order.index(contour)]
    found += [c.about for c in setting.conditions.get(contour, ()) if c.cost is None and c.when in (None, site)]
    return tuple(dict.fromkeys(found))
