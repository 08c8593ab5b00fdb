"""Zones: groups of parts cut one group after the other, so that what is left keeps its stiffness."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Floats, Ints, unique, unique_pairs
from kerfwise.encoder.cut import Side
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.graphs import strong_components, weak_components
from kerfwise.encoder.nest import Nest

from .facts import FactOptions, OrderFact
from .outlines import Outlines, outlines_of
from .zone_strips import Blocks, blocks_of, divide_zone, locked_pairs, strips_of

# Petunin 2009, fig. 4: what remains uncut after each zone should come as close to a square as the sheet allows.
# Strips of about `zone_contours` contours are taken off the bounding rectangle of the parts that remain: off the
# start side at first and while the rectangle's sides differ by more than `square_ratio`, then off whichever
# admissible side leaves it most square. Then zones are raised until no respected order points backwards. Where a
# budget of heat is given, strips end before they pass it, and what raising makes too hot is divided again. Where no
# number is given, strips are wide and cut piece by piece, and zones are as large as a proof bears: pieces that follow
# each other are joined as long as a zone has few sets of contours that may be out.

SIZE = 12
"""Contours in a zone, about, where locks put parts in zones and a profile says no number."""
PIECE = 8
"""Contours in a piece of a strip, about, before pieces are joined."""
MOST_SETS, MOST_OF_ONE, USUAL = 1_500_000, 1_000_000, 30
"""Sets of contours that may be out, of all zones together if each has `USUAL` contours, and of one at the most: a proof
takes under 1 GB, and some seconds."""


def set_limit(contours: int) -> float:
    """The most sets that a zone of a nest with so many contours has where no number is given."""
    return min(MOST_OF_ONE, MOST_SETS * USUAL / max(1, contours))


def respected_orders(contains: Ints, level_ahead: Ints, in_hull: Ints, options: FactOptions) -> Ints:
    """The pairs of contours (before, after) that no zone may contradict, (k, 2), of these facts."""
    pairs: dict[OrderFact, Ints] = {"contains": contains[:, ::-1], "level_ahead": level_ahead, "in_hull": in_hull}
    chosen = (of for name, of in pairs.items() if name in options.zone_respects)
    return np.concatenate([np.empty((0, 2), dtype=np.int64), *chosen])


def zones_of(
    nest: Nest,
    outlines: Outlines,
    parent: Ints,
    start_side: Side,
    respected: Ints,
    options: FactOptions,
    heat_kj: Floats,
) -> Ints:
    """Array (n,): the zone of each contour, 1…m without holes; the lines that cut up the skeleton are the last.

    `respected` (k, 2) are pairs of contours (before, after). `heat_kj` (n,) is what cutting each contour leaves in the
    sheet; nan counts as nothing. A part in `options.zone_fixed` stays where it is put, whatever heat that brings
    together; what must go before it is brought forward with it, and closing up empty zones may lower its number. Where
    two fixed parts contradict a pair, the fixed zones stand. Raises InputError if `zone_pairs` or `zone_fixed` name an
    unknown contour or part, a zone below 1, or two zones for one part.
    """
    if not outlines.n:
        return np.empty(0, dtype=np.int64)
    if nest.scrap:
        bare, lines = nest.without_scrap, {line.id for line in nest.scrap}
        n, locked = len(bare.contours), (pair for pair in options.zone_pairs if not lines.intersection(pair))
        options = replace(options, zone_pairs=tuple(locked))
        of_parts = zones_of(bare, outlines_of(bare), parent[:n], start_side, respected, options, heat_kj[:n])
        return np.append(of_parts, np.full(len(nest.scrap), int(of_parts.max(initial=0)) + 1))
    blocks = blocks_of(nest, outlines, parent, respected, options, heat_kj)
    if options.zone_contours is None and not options.zone_fixed:
        orders = np.concatenate([respected, locked_pairs(nest, options)])
        units = units_of(outlines.own_outer, outlines.is_mark, orders, options.parts_in_one_go)
        zone, pairs = _divided_within_set_limit(blocks, units, start_side, options)
    else:
        zone, pairs = _divided(blocks, start_side, options, options.zone_contours or SIZE)
    placed = _placed(nest, blocks.of, options)
    first, last = ([block for block, position in placed.items() if position == end] for end in (1, outlines.n))
    pairs = pairs[~np.isin(pairs[:, 1], first) & ~np.isin(pairs[:, 0], last)]  # nothing goes before the first of all
    cut_by = np.cumsum(np.bincount(zone[blocks.of]))  # how many contours there are up to every zone, from zone 0 on
    reached = {block: int(np.searchsorted(cut_by, position)) for block, position in placed.items()}
    return _closed_up(_with_fixed(zone, pairs, reached | _fixed(nest, blocks.of, options)))[blocks.of]


def _divided_within_set_limit(
    blocks: Blocks, units: Units, start_side: Side, options: FactOptions
) -> tuple[Ints, Ints]:
    """As `_divided`, of pieces joined as long as a zone has few sets."""
    zone, pairs = _divided(blocks, start_side, options, PIECE, in_pieces=True)
    heat_kj = np.bincount(zone - 1, blocks.heat_kj).astype(np.float64)
    zone[blocks.of] = merge_zones(zone[blocks.of], units, set_limit(len(blocks.of)), heat_kj, options.zone_heat_kj)
    return zone, pairs


def _divided(
    blocks: Blocks, start_side: Side, options: FactOptions, size: int, in_pieces: bool = False
) -> tuple[Ints, Ints]:
    """The zone of every block, of about so many contours each, and the pairs that zones respect."""
    strips, pairs = strips_of(blocks, start_side, options, size, in_pieces), blocks.pairs
    zone, rank = np.empty((2, len(blocks.contours)), dtype=np.int64)
    in_turn = np.concatenate(strips)
    zone[in_turn] = np.repeat(np.arange(len(strips)), [len(strip) for strip in strips])
    rank[in_turn] = np.arange(len(in_turn))
    zone = _closed_up(raise_zones(zone, pairs))
    if options.zone_heat_kj is not None:
        zone = _closed_up(divide_zone(zone, rank, blocks, options.zone_heat_kj))
        pairs = pairs[zone[pairs[:, 0]] <= zone[pairs[:, 1]]]  # without circles that were too hot for one zone
    return zone, pairs


def _fixed(nest: Nest, block_of: Ints, options: FactOptions) -> dict[int, int]:
    """Block → the zone it is fixed in."""
    fixed: dict[int, int] = {}
    for part_id, zone in options.zone_fixed:
        if part_id not in nest.part_of:
            raise InputError(f"zone_fixed names part {part_id!r}, which the nest does not have")
        if zone < 1:
            raise InputError(f"zone_fixed puts part {part_id!r} in zone {zone}; zones count from 1")
        block = int(block_of[nest.index[nest.part_of[part_id].outer.id]])
        if fixed.setdefault(block, zone) != zone:
            raise InputError(
                f"zone_fixed puts part {part_id!r} in zone {zone} and itself, or a part that shares its zone as its "
                f"host or guest, in zone {fixed[block]}; give them one zone"
            )
    return fixed


def _placed(nest: Nest, block_of: Ints, options: FactOptions) -> dict[int, int]:
    """Block → the position where a contour of it must be cut; the first that is named, of several."""
    found: dict[int, int] = {}
    for part_id, position in options.zone_places:
        found.setdefault(int(block_of[nest.index[nest.part_of[part_id].outer.id]]), position)
    return found


def raise_zones(zone: Ints, pairs: Ints, kept: Ints | None = None) -> Ints:
    """Raise the zones of blocks until no pair points backwards; blocks in `kept` stay where they are."""
    while True:
        higher = zone.copy()
        np.maximum.at(higher, pairs[:, 1], zone[pairs[:, 0]])
        if kept is not None:
            higher[kept] = zone[kept]
        if np.array_equal(higher, zone):
            return zone
        zone = higher


def _with_fixed(zone: Ints, pairs: Ints, fixed: Mapping[int, int]) -> Ints:
    """Put the fixed blocks in their zones, bring forward what must go before them, raise what must go after."""
    if not fixed:
        return zone
    kept = np.array(list(fixed), dtype=np.int64)
    zone = zone.copy()
    zone[kept] = list(fixed.values())
    # Seen from the end, lowering a zone is raising its negative along the pairs turned round.
    latest = np.full(len(zone), np.iinfo(np.int64).max)
    latest[kept] = zone[kept]
    latest = -raise_zones(-latest, pairs[:, ::-1])
    movable = np.setdiff1d(np.arange(len(zone)), kept)
    zone[movable] = np.minimum(zone, latest)[movable]
    return raise_zones(zone, pairs, kept)


def _closed_up(zone: Ints) -> Ints:
    """The same order of zones numbered 1…m without holes."""
    numbers: Ints = np.unique(zone, return_inverse=True)[1] + 1
    return numbers


# How many sets of contours can be out while a zone is cut: what a proof of its best order has to go through.
#
# The sets that orders allow are the ideals of a partial order, those of several unrelated parts of it a product. A
# state's further burden, its last site, is left out: it is about the same for every zone.

KEPT = 1 << 12
"""Answers about orders that are kept."""
MOST_UNITS = 63
"""Units in a zone that a machine word holds one bit each."""
Masks = NDArray[np.uint64]


@dataclass(frozen=True, eq=False, slots=True)
class Units:
    """What is cut without another between: a part with its holes, or a contour where parts are not cut in one go.

    `of` (n,) is the unit of each contour, -1 for marks; `inner` (units,) how many contours go before its last in any
    order; `pairs` (k, 2) say which unit is cut before which.
    """

    of: Ints
    inner: Ints
    pairs: Ints


def units_of(part: Ints, is_mark: Bools, pairs: Ints, in_one_go: bool) -> Units:
    """The units of contours of parts (n,), with `pairs` (k, 2) of contours (before, after)."""
    of = np.full(len(part), -1, dtype=np.int64)
    cut = ~is_mark
    of[cut] = np.unique(part[cut], return_inverse=True)[1] if in_one_go else np.arange(int(cut.sum()))
    ordered = of[pairs]
    ordered = unique_pairs(ordered[(ordered >= 0).all(axis=1)])
    circle = strong_components(int(of.max(initial=-1)) + 1, ordered)  # orders that go round in one are no orders
    inner = np.bincount(of[cut]) - 1
    return Units(of, inner, ordered[circle[ordered[:, 0]] != circle[ordered[:, 1]]])


def sets_within(members: Ints, units: Units, most: float) -> float:
    """The sets that can be out while these units are cut, infinite if there are more than `most`.

    Examples
    --------
    Of two parts without an order each may be out alone; a hole more makes one set more before and after the other.

    >>> two = units_of(np.array([0, 1]), np.array([False, False]), np.empty((0, 2), dtype=np.int64), True)
    >>> sets_within(np.array([0, 1]), two, 100.0)
    4.0
    >>> holed = units_of(np.array([0, 0, 1]), np.zeros(3, dtype=bool), np.empty((0, 2), dtype=np.int64), True)
    >>> sets_within(np.array([0, 1]), holed, 100.0)
    6.0
    """
    number = np.full(len(units.inner), -1, dtype=np.int64)
    number[members] = np.arange(len(members))
    pairs = number[units.pairs]
    pairs = pairs[(pairs >= 0).all(axis=1)]
    part = weak_components(len(members), pairs)
    whole, begun = 1.0, 0.0  # sets of whole units, and those in which one more is begun
    with np.errstate(over="ignore"):
        half_done: Floats = np.exp2(units.inner[members].astype(np.float64)) - 1
    for k in range(int(part.max(initial=-1)) + 1):
        own = np.flatnonzero(part == k)
        place = np.full(len(members), -1, dtype=np.int64)
        place[own] = np.arange(len(own))
        if len(own) > MOST_UNITS:
            return float("inf")
        within = place[pairs[part[pairs[:, 0]] == k]]
        ideals, started = _ideals(len(own), within.tobytes(), half_done[own].tobytes(), most)
        if ideals + started > most:
            return float("inf")
        whole, begun = whole * ideals, whole * started + begun * ideals
        if whole + begun > most:
            return float("inf")
    return whole + begun


@lru_cache(maxsize=KEPT)
def _ideals(size: int, within: bytes, begun: bytes, most: float) -> tuple[float, float]:
    """Sets that have with every unit all that comes before it, and such with one more unit begun; both may end early,
    over `most`.

    Given are the bytes of the pairs (k, 2) of units and of what a unit adds that is begun, (size,). Zones grow piece
    by piece, so that the same is asked again and again.
    """
    pairs, half_done = np.frombuffer(within, dtype=np.int64).reshape(-1, 2), np.frombuffer(begun)
    bit = np.uint64(1) << np.arange(size, dtype=np.uint64)
    needs = np.zeros(size, dtype=np.uint64)
    np.bitwise_or.at(needs, pairs[:, 1], bit[pairs[:, 0]])
    layer: Masks = np.zeros(1, dtype=np.uint64)
    ideals, started = 0.0, 0.0
    while len(layer) and ideals + started <= most:
        ideals += len(layer)
        grown, counts = [], np.zeros(size, dtype=np.int64)
        for first in range(0, len(layer), _SETS_AT_ONCE):
            sets = layer[first : first + _SETS_AT_ONCE, None]
            ready = ((sets & needs) == needs) & ((sets & bit) == 0)
            counts += ready.sum(axis=0)
            grown.append((sets | bit)[ready])
        started += sum(count * adds for count, adds in zip(counts.tolist(), half_done.tolist(), strict=True))
        layer = unique(np.concatenate(grown))
    return ideals, started


_SETS_AT_ONCE = 2000


def merge_zones(zone: Ints, units: Units, most_sets: float, heat_kj: Floats, budget_kj: float | None = None) -> Ints:
    """The zones 1…m of contours (n,) after as many of those that follow each other are made one as have so few sets.

    No more than a budget of heat, or of whatever else adds up, is joined; `heat_kj` (m,) is that of every zone. Zones
    that have too much of either stay as they are.

    Examples
    --------
    Two parts in one go, each a zone of its own, are one zone of four sets.

    >>> two = Units(np.array([0, 1]), np.array([0, 0]), np.empty((0, 2), dtype=np.int64))
    >>> merge_zones(np.array([1, 2]), two, 4.0, np.zeros(2)), merge_zones(np.array([1, 2]), two, 3.0, np.zeros(2))
    (array([1, 1]), array([1, 2]))
    """
    return merge_zones_while(Bearing(zone, units, most_sets, heat_kj, budget_kj), zone, len(heat_kj))


def merge_zones_while(bears: Bears, zone: Ints, count: int) -> Ints:
    """The zones 1…count of contours (n,) after those that follow each other are made one while the answer is yes."""
    number = np.ones(count + 1, dtype=np.int64)
    begin = 0
    for end in range(2, count + 1):
        if not bears(begin, end):
            begin = end - 1
        number[end] = number[end - 1] + (begin == end - 1)
    return number[zone]


class Bearing:
    """Whether zones that follow each other may be one, as `merge_zones` makes them."""

    def __init__(
        self, zone: Ints, units: Units, most_sets: float, heat_kj: Floats, budget_kj: float | None = None
    ) -> None:
        cut = units.of >= 0
        of_unit = np.zeros(len(units.inner), dtype=np.int64)
        of_unit[units.of[cut]] = zone[cut]
        self._by_zone = np.argsort(of_unit, kind="stable")
        ends = np.arange(1, len(heat_kj) + 2)
        self._first = np.searchsorted(of_unit[self._by_zone], ends)
        self._pairs = units.pairs[np.argsort(of_unit[units.pairs[:, 0]], kind="stable")]
        self._pairs_from = np.searchsorted(of_unit[self._pairs[:, 0]], ends)
        self._units, self._most_sets = units, most_sets
        self._heat_kj, self._most_kj = heat_kj, np.inf if budget_kj is None else budget_kj

    def __call__(self, begin: int, end: int) -> bool:
        """Whether the zones begin + 1 … end may be one."""
        if float(self._heat_kj[begin:end].sum()) > self._most_kj:
            return False
        within = replace(self._units, pairs=self._pairs[self._pairs_from[begin] : self._pairs_from[end]])
        members = self._by_zone[self._first[begin] : self._first[end]]
        return sets_within(members, within, self._most_sets) <= self._most_sets


# Where an order is divided into zones, for every number of zones that there may be.

Bears = Callable[[int, int], bool]
"""Whether the pieces begin + 1 … end of an order may be one zone. What may not be is no part of any that may."""
Price = Callable[[Ints, int], Floats]
"""What zones of the pieces begin + 1 … end cost, for several begins (k,), and one end."""


def divisions(count: int, price: Price, bears: Bears, most: int) -> Iterator[Ints]:
    """Ways to make zones of so many pieces that follow each other: the zone, from 1, of every piece (count,).

    The fewest zones come first, then one more each time, up to `most` (the fewest come anyway). Of all zones that are
    so many, they have the least price together (a shortest way over the places between pieces, as in Bellman 1957). A
    piece alone is always borne.

    Examples
    --------
    Four pieces, no more than three may be one zone; zones cost the square of what they are too long by, over two.

    >>> def price(begins, end):
    ...     return (end - begins - 2.0) ** 2
    >>> [zone.tolist() for zone in divisions(4, price, lambda begin, end: end - begin <= 3, 0)]
    [[1, 1, 2, 2]]
    """
    first = _largest_zone_starts(count, bears)
    fewest = [0]
    for end in range(1, count + 1):
        fewest.append(fewest[first[end]] + 1)
    most_zones = min(count, max(most, fewest[count]))
    least = np.full((most_zones + 1, count + 1), np.inf)
    came = np.zeros((most_zones + 1, count + 1), dtype=np.int64)
    least[0, 0] = 0.0
    for end in range(1, count + 1):
        begins = np.arange(first[end], end)
        whole = least[:-1, begins] + price(begins, end)
        came[1:, end] = begins[whole.argmin(axis=1)]
        least[1:, end] = whole.min(axis=1)
    for zones in np.flatnonzero(np.isfinite(least[:, count])).tolist():
        zone, end = np.empty(count, dtype=np.int64), count
        for number in range(zones, 0, -1):
            begin = int(came[number, end])
            zone[begin:end] = number
            end = begin
        yield zone


def _largest_zone_starts(count: int, bears: Bears) -> list[int]:
    """For the end of every piece, where the largest zone begins that ends with it."""
    first, begin = [0], 0
    for end in range(1, count + 1):
        while begin < end - 1 and not bears(begin, end):
            begin += 1
        first.append(begin)
    return first
