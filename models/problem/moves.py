"""Prices of moves: what it costs, or that it is unlawful, to go directly from one cut to another."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from kerfwise.arrays import Ints, concat_ranges
from kerfwise.encoder.geometry.tolerances import cost_um
from kerfwise.rules.statements import Lag, Move

UNLAWFUL = 1 << 48
"""µm: what an unlawful move costs, more than any plan; sums of it still fit."""
LAWFUL_MOST = 1 << 47
"""µm: what costs more is no lawful move, and no lawful plan, for such cost less than half of it. A link may cost less
than nothing, so that an unlawful one costs somewhat less than `UNLAWFUL`."""

SPARSE = 8
"""Where fewer than one place in so many of a table has a number, to look for these is quicker than to add them all."""

# A number for each ordered pair of things, most of them 0: things that are alike share a row and a column.


@dataclass(frozen=True, eq=False, slots=True)
class PairTable:
    """From thing x to thing y it has the number of row `row[x]`, column `column[y]`: 0 where nothing is kept.

    There are `width` columns. `key` has row · width + column of what is kept, rising, `value` the numbers.

    Examples
    --------
    >>> table = PairTable.of(4, [(np.array([0, 1]), np.array([2, 3]), 5), (np.array([1]), np.array([3]), 7)])
    >>> table.between(np.arange(4), np.arange(4)).tolist()
    [[0, 0, 5, 5], [0, 0, 5, 12], [0, 0, 0, 0], [0, 0, 0, 0]]
    >>> table.only(np.array([1, 3])).each(np.array([0, 1]), np.array([1, 1])).tolist()
    [12, 0]
    """

    row: Ints
    column: Ints
    width: int
    key: Ints
    value: Ints

    @staticmethod
    def of(size: int, groups: Iterable[tuple[Ints, Ints, int]]) -> PairTable:
        """Of so many things: every group adds its number from each of the first things to each of the second.

        `UNLAWFUL` is added once, however many groups say it.
        """
        known = [group for group in groups if group[2] and len(group[0]) and len(group[1])]
        row, _ = _alike(size, [leave for leave, _, _ in known])
        column, width = _alike(size, [reach for _, reach, _ in known])
        keys, values = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
        rows = {id(leave): np.unique(row[leave])[:, None] * width for leave, _, _ in _once(known, 0)}
        columns = {id(reach): np.unique(column[reach])[None, :] for _, reach, _ in _once(known, 1)}
        for leave, reach, value in known:
            keys.append((rows[id(leave)] + columns[id(reach)]).ravel())
            values.append(np.full(len(keys[-1]), value, dtype=np.int64))
        number = np.concatenate(values)
        key, which = np.unique(np.concatenate(keys), return_inverse=True)
        total, unlawful = np.zeros(len(key), dtype=np.int64), np.zeros(len(key), dtype=np.bool_)
        np.add.at(total, which, np.where(number < UNLAWFUL, number, 0))
        unlawful[which[number >= UNLAWFUL]] = True
        return PairTable(row, column, width, key, total + UNLAWFUL * unlawful)

    def __len__(self) -> int:
        return len(self.key)

    def only(self, things: Ints) -> PairTable:
        """The same of some of the things, in this order."""
        return replace(self, row=self.row[things], column=self.column[things]) if len(self) else self

    def between(self, leave: Ints, reach: Ints) -> Ints:
        """From each of `leave` (k,) to each of `reach` (l,), (k, l)."""
        if not len(self):
            return np.zeros((len(leave), len(reach)), dtype=np.int64)
        rows, of_row = np.unique(self.row[leave], return_inverse=True)
        columns, of_column = np.unique(self.column[reach], return_inverse=True)
        place = np.full(self.width, -1, dtype=np.int64)
        place[columns] = np.arange(len(columns))
        low, high = (np.searchsorted(self.key, (rows + more) * self.width) for more in (0, 1))
        kept = concat_ranges(low, high - low)
        here, there = np.repeat(np.arange(len(rows)), high - low), place[self.key[kept] % self.width]
        small = np.zeros((len(rows), len(columns)), dtype=np.int64)
        small[here[there >= 0], there[there >= 0]] = self.value[kept[there >= 0]]
        return small[of_row.reshape(-1)][:, of_column.reshape(-1)]

    def add_to(self, table: Ints, leave: Ints, reach: Ints) -> None:
        """Add what is `between` them to a table (k, l), place by place where few have a number."""
        reached = np.zeros(self.width, dtype=np.bool_)
        reached[self.column[reach]] = True
        kept = np.flatnonzero(reached[self.key % self.width])  # next to none where few sites are reached
        if not len(kept):
            return
        left, come_to = np.divmod(self.key[kept], self.width)
        rows, row, in_row = _alike_to(self.row[leave], left)
        columns, column, in_column = _alike_to(self.column[reach], come_to)
        places = in_row * in_column
        if places.sum() > table.size // SPARSE:
            table += self.between(leave, reach)
            return
        key = np.repeat(np.arange(len(places)), places)
        down, along = np.divmod(concat_ranges(np.zeros_like(places), places), in_column[key])
        table[rows[row[key] + down], columns[column[key] + along]] += self.value[kept[key]]

    def each(self, leave: Ints, reach: Ints) -> Ints:
        """From `leave[k]` to `reach[k]`, (k,)."""
        if not len(self):
            return np.zeros(len(leave), dtype=np.int64)
        keys = self.row[leave] * self.width + self.column[reach]
        at = np.minimum(np.searchsorted(self.key, keys), len(self.key) - 1)
        return np.where(self.key[at] == keys, self.value[at], 0)


def _alike_to(kinds: Ints, wanted: Ints) -> tuple[Ints, Ints, Ints]:
    """Things in order of their kinds, and of each kind that is wanted the first of them there, and how many are."""
    order = np.argsort(kinds, kind="stable")
    first, after = (np.searchsorted(kinds[order], wanted, side=side) for side in ("left", "right"))
    return order, first, after - first


def _once(groups: Iterable[tuple[Ints, Ints, int]], which: int) -> Iterable[tuple[Ints, Ints, int]]:
    """A group of those that share their first things, or their second: few of many statements name other contours."""
    return {id(group[which]): group for group in groups}.values()


def _alike(size: int, groups: Sequence[Ints]) -> tuple[Ints, int]:
    """A number for each thing, the same for those that are in the same groups; and how many numbers there are."""
    if not groups:
        return np.zeros(size, dtype=np.int64), 1
    noise = np.random.default_rng(0).integers(1, 2**63, len(groups), dtype=np.uint64)
    members = np.concatenate(groups)
    digests = np.zeros(size, dtype=np.uint64)
    np.add.at(digests, members, np.repeat(noise, [len(group) for group in groups]))
    names, number = np.unique(digests, return_inverse=True)
    return number.astype(np.int64).reshape(-1), len(names)


def nothing(size: int = 0) -> PairTable:
    """Nothing kept of any pair."""
    return PairTable.of(size, ())


# What statements make moves cost.


@dataclass(frozen=True, eq=False, slots=True)
class MovePrices:
    """What going directly from a cut to another costs beside travel.

    `price` has it from site to site, home last, µm, and `UNLAWFUL` where it is not lawful. `barred` has it of contours,
    home last: more than 0 where one may not follow the other by whatever sites. `statements` say so.
    """

    statements: tuple[Move, ...] = ()
    price: PairTable = field(default_factory=nothing)
    barred: PairTable = field(default_factory=nothing)

    @staticmethod
    def of(statements: Sequence[Move], site_contour: Ints, candidate_site: Ints, n: int) -> MovePrices:
        """The prices of the moves of n contours; `site_contour` is the contour of each site."""
        if not statements:
            return MovePrices()
        first = np.searchsorted(site_contour, np.arange(n + 1))
        prices: list[tuple[Ints, Ints, int]] = []
        barred: list[tuple[Ints, Ints, int]] = []
        known: dict[tuple[Sequence[int], frozenset[int] | None], Ints] = {}
        for s in statements:
            cost = UNLAWFUL if s.weight is None else cost_um(s.weight)
            for end in ((s.leave, s.leaving), (s.reach, s.reaching)):
                if end not in known:
                    known[end] = _sites(*end, first, candidate_site)
            prices.append((known[s.leave, s.leaving], known[s.reach, s.reaching], cost))
            if s.weight is None and s.leaving is None and s.reaching is None:
                barred.append((np.array(s.leave), np.array(s.reach), 1))
        sites = len(site_contour) + 1
        return MovePrices(tuple(statements), PairTable.of(sites, prices), PairTable.of(n + 1, barred))

    def __bool__(self) -> bool:
        return bool(self.statements)

    def of_sites(self, sites: Ints) -> MovePrices:
        """The same where these sites, home last, are left."""
        return replace(self, price=self.price.only(sites))

    def broken_by(self, contours: Sequence[int], ways: Sequence[int]) -> Iterator[tuple[Move, int]]:
        """The statements that an order breaks, each time with the place of the contour that is left.

        `ways` are the candidates by which the contours are cut.
        """
        by_leave = statements_by_leave(self.statements)
        for k in range(len(contours) - 1):
            for s in by_leave.get(contours[k], ()):
                if s.covers(contours[k], contours[k + 1], ways[k], ways[k + 1]):
                    yield s, k


def statements_by_leave(statements: Iterable[Move]) -> dict[int, list[Move]]:
    """The statements about leaving each contour."""
    found: dict[int, list[Move]] = defaultdict(list)
    for s in statements:
        for contour in dict.fromkeys(s.leave):
            found[contour].append(s)
    return found


def _sites(contours: Sequence[int], by: frozenset[int] | None, first: Ints, candidate_site: Ints) -> Ints:
    """The sites of contours, or those of them that stand for one of the candidates `by`."""
    if by is None and len(contours) == 1:
        return np.arange(first[contours[0]], first[contours[0] + 1])
    some = np.array(contours, dtype=np.int64)
    all_ = concat_ranges(first[some], first[some + 1] - first[some])
    if by is None:
        return np.unique(all_)
    chosen = candidate_site[sorted(by)]
    return np.intersect1d(chosen[chosen >= 0], all_)


def without_near_lags(lags: Iterable[Lag]) -> tuple[tuple[Lag, ...], list[Move]]:
    """Lags without those of one cut, which are prices of moves: neither contour follows the other at once."""
    left: list[Lag] = []
    moves: list[Move] = []
    for lag in lags:
        if lag.cuts != 1:
            left.append(lag)
            continue
        for one, other in ((lag.first, lag.second), (lag.second, lag.first)):
            moves.append(Move((one,), (other,), lag.about, lag.weight))
        if lag.seconds > 0:
            left.append(replace(lag, cuts=0))
    return tuple(left), moves
