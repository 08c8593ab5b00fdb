"""Idle moves over parts that may already be out (rule no-tip-travel), worked out for every move that can occur."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import shapely
from numpy.typing import NDArray

from ..encoder.errors import InputError
from ..rules.statements import Crossing
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
    statements: Sequence[Crossing], lawful: Bools, first: Ints, ends_um: Ints, pierces_um: Ints
) -> Crossings:
    """All crossings between contours that may follow each other.

    `lawful` is the matrix of `successors.lawful_successors` (n + 1, n + 1), `first` the first site of every contour
    and of home; `ends_um`, `pierces_um` (m + 1, 2) include home as their last row.

    Raises
    ------
    TooManyMoves
        If there are more than `MOST_MOVES` moves between sites, as on large nests without zones.
    """
    if not statements:
        return Crossings()
    sites = np.diff(first)
    if (moves := int(sites @ lawful @ sites)) > MOST_MOVES:
        raise TooManyMoves(
            f"idle travel over parts that are out asks about {moves:,} moves, more than the {MOST_MOVES:,} that can be "
            f"looked at: switch {statements[0].about.rule} off or zone-order on in the profile"
        )
    owner = np.repeat(np.arange(len(first) - 1), np.diff(first))
    areas = shapely.STRtree(
        shapely.buffer([shapely.transform(s.area, lambda xy: xy * UM_PER_MM) for s in statements], -GRAZE_UM)
    )
    found: list[tuple[Ints, Ints, Ints]] = []
    for site in range(len(ends_um)):
        ahead = np.flatnonzero(lawful[owner[site]][owner])
        lines = shapely.linestrings(np.stack([np.broadcast_to(ends_um[site], (len(ahead), 2)), pierces_um[ahead]], 1))
        which, met = areas.query(lines, predicate="intersects")
        found.append((np.full(len(which), site), ahead[which], met))
    leave, reach, area = (np.concatenate(column).astype(np.int64) for column in zip(*found, strict=True))
    over = np.array([s.over for s in statements], dtype=np.int64)
    price = [FORBIDDEN if s.weight is None else round(s.weight * UM_PER_MM) for s in statements]
    return Crossings(leave, reach, over[area], np.array(price, dtype=np.int64)[area], area)
