"""Zones: groups of parts cut one group after the other, so that what is left keeps its stiffness.

Petunin 2009, fig. 4: what remains uncut after each zone should come as close to a square as the sheet allows. Strips
of about `zone_contours` contours are taken off the bounding rectangle of the parts that remain: off the start side
at first and while the rectangle's sides differ by more than `square_ratio`, then off whichever admissible side leaves
it most square. Then zones are raised until no respected order points backwards. Where a budget of heat is given, strips
end before they pass it, and what raising makes too hot is divided again. Where no number is given, strips are wide and
cut piece by piece, and zones are as large as a proof bears: pieces that follow each other are joined as long as a zone
has few sets of contours that may be out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.cut import Side
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest

from .facts import FactOptions, OrderFact
from .outlines import Outlines, outlines_of
from .zone_blocks import Blocks, blocks_of, locked_pairs
from .zone_heat import divided
from .zone_joined import joined
from .zone_sets import Units, units_of
from .zone_strips import strips_of

SIZE = 12
"""Contours in a zone, about, where locks put parts in zones and a profile says no number."""
PIECE = 8
"""Contours in a piece of a strip, about, before pieces are joined."""
MOST_SETS, MOST_OF_ONE, USUAL = 1_500_000, 1_000_000, 30
"""Sets of contours that may be out, of all zones together if each has `USUAL` contours, and of one at the most: a proof
takes under 1 GB, and some seconds."""


def most_sets(contours: int) -> float:
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
    two fixed parts contradict a pair, the fixed zones stand.

    Raises
    ------
    InputError
        If `zone_pairs` or `zone_fixed` name an unknown contour or part, a zone below 1, or two zones for one part.
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
        zone, pairs = _as_large_as_a_proof_bears(blocks, units, start_side, options)
    else:
        zone, pairs = _divided(blocks, start_side, options, options.zone_contours or SIZE)
    placed = _placed(nest, blocks.of, options)
    first, last = ([block for block, position in placed.items() if position == end] for end in (1, outlines.n))
    pairs = pairs[~np.isin(pairs[:, 1], first) & ~np.isin(pairs[:, 0], last)]  # nothing goes before the first of all
    cut_by = np.cumsum(np.bincount(zone[blocks.of]))  # how many contours there are up to every zone, from zone 0 on
    reached = {block: int(np.searchsorted(cut_by, position)) for block, position in placed.items()}
    return _closed_up(_with_fixed(zone, pairs, reached | _fixed(nest, blocks.of, options)))[blocks.of]


def _as_large_as_a_proof_bears(
    blocks: Blocks, units: Units, start_side: Side, options: FactOptions
) -> tuple[Ints, Ints]:
    """As `_divided`, of pieces joined as long as a zone has few sets."""
    zone, pairs = _divided(blocks, start_side, options, PIECE, in_pieces=True)
    heat_kj = np.bincount(zone - 1, blocks.heat_kj).astype(np.float64)
    zone[blocks.of] = joined(zone[blocks.of], units, most_sets(len(blocks.of)), heat_kj, options.zone_heat_kj)
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
    zone = _closed_up(raised(zone, pairs))
    if options.zone_heat_kj is not None:
        zone = _closed_up(divided(zone, rank, blocks, options.zone_heat_kj))
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


def raised(zone: Ints, pairs: Ints, kept: Ints | None = None) -> Ints:
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
    latest = -raised(-latest, pairs[:, ::-1])
    movable = np.setdiff1d(np.arange(len(zone)), kept)
    zone[movable] = np.minimum(zone, latest)[movable]
    return raised(zone, pairs, kept)


def _closed_up(zone: Ints) -> Ints:
    """The same order of zones numbered 1…m without holes."""
    numbers: Ints = np.unique(zone, return_inverse=True)[1] + 1
    return numbers
