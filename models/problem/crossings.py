"""Idle moves over parts that may already be out, worked out for every move that can occur."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import shapely

from kerfwise.arrays import Bools, Int32s, Ints
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.microns import GRAZE_UM, UM_PER_MM
from kerfwise.rules.registry import RULES
from kerfwise.rules.statements import Crossing

from .crossed_areas import Going, IdleMoves, Stopped, crossed_areas
from .followers import Followers

FORBIDDEN = -1
MOST_MOVES = 3_000_000
"""Moves that can be looked at one by one in a minute or so."""


def _none() -> Ints:
    return np.zeros(0, dtype=np.int64)


@dataclass(frozen=True, eq=False, slots=True)
class Crossings:
    """Row k: going from site `leave[k]` to site `reach[k]` once contour `over[k]` is cut costs `cost[k]` µm.

    A site number of m, the number of sites, is the machine's home; a cost of `FORBIDDEN` makes the move unlawful.
    `statement[k]` is the place of the statement among those given. What is out from the start is said of the contour
    that the move leaves, which is cut before the move: `over[k]` is that one. All but the costs are narrow numbers, as
    there are many millions of rows on large nests without zones.
    """

    leave: Ints | Int32s = field(default_factory=_none)
    reach: Ints | Int32s = field(default_factory=_none)
    over: Ints | Int32s = field(default_factory=_none)
    cost: Ints = field(default_factory=_none)
    statement: Ints | Int32s = field(default_factory=_none)

    def __len__(self) -> int:
        return len(self.leave)

    @property
    def nbytes(self) -> int:
        """What the rows take."""
        return sum(column.nbytes for column in (self.leave, self.reach, self.over, self.cost, self.statement))

    def moves(self, m: int) -> Ints:
        """A number for the move of every row between `m` sites and home: leave (m + 1) + reach."""
        numbers = self.leave.astype(np.int64)
        numbers *= m + 1
        numbers += self.reach
        return numbers

    def only(self, kept: Bools | Ints) -> Crossings:
        """Some of the rows: those that are told, or those of these numbers, in their order."""
        return Crossings(self.leave[kept], self.reach[kept], self.over[kept], self.cost[kept], self.statement[kept])

    def renumbered(self, number: Ints) -> Crossings:
        """The rows between sites that are left, and home: `number[s]` (m + 1,) is the new number of site s, or -1."""
        left = self.only((number[self.leave] >= 0) & (number[self.reach] >= 0))
        leave, reach = number[left.leave].astype(np.int32), number[left.reach].astype(np.int32)
        return replace(left, leave=leave, reach=reach)


class TooManyMoves(InputError):
    """The moves that can occur cannot all be looked at."""


def find_crossings(
    statements: Sequence[Crossing],
    before: Bools,
    lawful: Followers,
    first: Ints,
    ends_um: Ints,
    pierces_um: Ints,
    going: Going = lambda share: True,
) -> Crossings:
    """All crossings between contours that may follow each other, of areas that may be out before the move.

    `before` (n, n) is the closed order, `lawful` who may follow whom, `first` the first site of every contour and of
    home; `ends_um`, `pierces_um` (m + 1, 2) include home as their last row.

    `going` is asked now and then, with the share of the moves that has been looked at, whether to go on.

    Raises
    ------
    TooManyMoves
        If there are more than `MOST_MOVES` moves between sites, as on large nests without zones, or `going` says no.
    """
    if not statements:
        return Crossings()
    sites = np.diff(first)
    if (moves := int(sites @ lawful.weighed(sites))) > MOST_MOVES:
        zones = " or ".join(name for name, rule in RULES.items() if rule.makes_zones)
        raise TooManyMoves(
            f"idle travel over parts that are out asks about {moves:,} moves, more than the {MOST_MOVES:,} that can be "
            f"looked at: switch {statements[0].about.rule} off or {zones} on in the profile"
        )
    n = len(before)
    over = np.array([-1 if s.over is None else s.over for s in statements], dtype=np.int64)
    from_start = over < 0
    late = np.vstack([before[:, over] | (np.arange(n)[:, None] == over), np.zeros(len(over), dtype=np.bool_)])
    late[:, from_start] = False
    owner = np.repeat(np.arange(n + 1), sites)
    ends, pierces = ends_um.astype(np.float64), pierces_um.astype(np.float64)
    ahead = [np.flatnonzero(lawful[c][owner]) for c in range(n)]
    left = [c for c in range(n) if len(ahead[c]) and sites[c]]
    asked = [
        IdleMoves(
            ends[first[c] : first[c + 1]],
            pierces[ahead[c]],
            owner[ahead[c]],
            np.flatnonzero(~before[c, over] | from_start),
        )
        for c in left
    ]
    try:
        found = crossed_areas(asked, _areas_um(statements), late, going)
    except Stopped:
        raise TooManyMoves(
            f"idle travel over parts that are out asks about {moves:,} moves, for which the time limit is too short"
        ) from None
    rows = list[list[Int32s]]()
    for c in reversed(left):  # what is found is given back as it is taken over
        leave, reach, area = found.pop()
        rows.append(_narrow([first[c] + leave, ahead[c][reach], area]))
    leave, reach, area = (np.concatenate(column) for column in zip(_narrow([_none()] * 3), *rows[::-1], strict=True))
    price = [FORBIDDEN if s.weight is None else round(s.weight * UM_PER_MM) for s in statements]
    out = np.where(from_start[area], owner[leave], over[area]).astype(np.int32)
    return Crossings(leave, reach, out, np.array(price, dtype=np.int64)[area], area)


def in_order(moves: Ints) -> Ints | None:
    """The order of rows by the numbers of their moves; None where they stand so, as those that were found do."""
    return None if (moves[1:] >= moves[:-1]).all() else np.argsort(moves, kind="stable")


def _narrow(columns: list[Ints]) -> list[Int32s]:
    return [column.astype(np.int32) for column in columns]


def from_home(
    statements: Sequence[Crossing], lawful: Followers, first: Ints, pierces_um: Ints
) -> list[tuple[int, int]]:
    """Site, and number of the statement, of every move from home that leads over what is out from the start.

    The other arguments are those of `find_crossings`.
    """
    asked = [k for k, s in enumerate(statements) if s.over is None]
    if not asked:
        return []
    sites = np.diff(first)
    n = len(sites) - 1
    owner = np.repeat(np.arange(n + 1), sites)
    pierces = pierces_um.astype(np.float64)
    ahead = np.flatnonzero(lawful[n][owner] & (owner < n))
    moves = IdleMoves(pierces[-1:], pierces[ahead], owner[ahead], np.arange(len(asked)))
    never = np.zeros((n + 1, len(asked)), dtype=np.bool_)
    ((_, reach, area),) = crossed_areas([moves], _areas_um([statements[k] for k in asked]), never)
    return sorted((int(ahead[r]), asked[a]) for r, a in zip(reach.tolist(), area.tolist(), strict=True))


def _areas_um(statements: Sequence[Crossing]) -> list[shapely.Geometry]:
    """What must not be crossed, less what a move may graze."""
    return list(shapely.buffer([shapely.transform(s.area, lambda xy: xy * UM_PER_MM) for s in statements], -GRAZE_UM))
