"""Idle moves over parts that may already be out (rule no-tip-travel), worked out for every move that can occur."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import shapely
from numpy.typing import NDArray

from ..encoder.errors import InputError
from ..rules.statements import Crossing
from .crossed_areas import Moves, crossed_areas
from .successors import Bools

Ints = NDArray[np.int64]
UM_PER_MM = 1000
GRAZE_UM = 100.0
"""A move that touches an area less deeply than this does not cross it."""
FORBIDDEN = -1
MOST_MOVES = 3_000_000
"""Moves that can be looked at one by one in a minute or so."""


def _none() -> Ints:
    return np.zeros(0, dtype=np.int64)


@dataclass(frozen=True, eq=False, slots=True)
class Crossings:
    """Row k: going from site `leave[k]` to site `reach[k]` once contour `over[k]` is cut costs `cost[k]` µm.

    A site number of m, the number of sites, is the machine's home; a cost of `FORBIDDEN` makes the move unlawful.
    `statement[k]` is the place of the statement among those given.
    """

    leave: Ints = field(default_factory=_none)
    reach: Ints = field(default_factory=_none)
    over: Ints = field(default_factory=_none)
    cost: Ints = field(default_factory=_none)
    statement: Ints = field(default_factory=_none)

    def __len__(self) -> int:
        return len(self.leave)


class TooManyMoves(InputError):
    """The moves that can occur cannot all be looked at."""


def find_crossings(
    statements: Sequence[Crossing], before: Bools, lawful: Bools, first: Ints, ends_um: Ints, pierces_um: Ints
) -> Crossings:
    """All crossings between contours that may follow each other, of areas that may be out by then.

    `before` (n, n) is the closed order, `lawful` the matrix of `successors.lawful_successors` (n + 1, n + 1), `first`
    the first site of every contour and of home; `ends_um`, `pierces_um` (m + 1, 2) include home as their last row.

    Raises
    ------
    TooManyMoves
        If there are more than `MOST_MOVES` moves between sites, as on large nests without zones.
    """
    if not statements:
        return Crossings()
    sites = np.diff(first)
    if (
        moves := sum(int(k) * int(sites[follows].sum()) for k, follows in zip(sites, lawful, strict=True))
    ) > MOST_MOVES:
        raise TooManyMoves(
            f"idle travel over parts that are out asks about {moves:,} moves, more than the {MOST_MOVES:,} that can be "
            f"looked at: switch {statements[0].about.rule} off or zone-order on in the profile"
        )
    n = len(before)
    over = np.array([s.over for s in statements], dtype=np.int64)
    late = np.vstack([before[:, over] | (np.arange(n)[:, None] == over), np.zeros(len(over), dtype=np.bool_)])
    owner = np.repeat(np.arange(n + 1), sites)
    ends, pierces = ends_um.astype(np.float64), pierces_um.astype(np.float64)
    ahead = [np.flatnonzero(lawful[c][owner]) for c in range(n)]
    left = [c for c in range(n) if len(ahead[c]) and sites[c]]
    found = crossed_areas(
        [
            Moves(ends[first[c] : first[c + 1]], pierces[ahead[c]], owner[ahead[c]], np.flatnonzero(~before[c, over]))
            for c in left
        ],
        shapely.buffer([shapely.transform(s.area, lambda xy: xy * UM_PER_MM) for s in statements], -GRAZE_UM),
        late,
    )
    rows = [(first[c] + leave, ahead[c][reach], area) for c, (leave, reach, area) in zip(left, found, strict=True)]
    leave, reach, area = (np.concatenate(column) for column in zip((_none(),) * 3, *rows, strict=True))
    price = [FORBIDDEN if s.weight is None else round(s.weight * UM_PER_MM) for s in statements]
    return Crossings(leave, reach, over[area], np.array(price, dtype=np.int64)[area], area)
