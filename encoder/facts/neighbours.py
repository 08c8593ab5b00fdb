"""What the boundary of each part and the ends of each path face: a part, an edge or solid metal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints, concat_ranges
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.nest import Sheet

from .facts import SIDES, Facing, FactOptions, Stretch
from .outlines import ROUNDING_MM, Outlines, sum_by_owner, sum_by_pair

# What the boundary of each part faces: another part, the sheet's edge or solid metal (Petunin 2009, section 2.1).
#
# From the middle of every cell of an outer contour the outward normal is followed to whatever it meets first. A part
# within `web_mm` makes the cell face a neighbour, the end of the sheet within `edge_band_mm` an edge; all else is
# solid: wide uncut metal, or another stretch of the same contour across a narrow mouth. For a part inside a host's
# hole the metal around is the host's, so its neighbour is the host's outer contour.
#
# Holes and marks face solid metal only: what is inside a hole stays with the part until the part is cut.


@dataclass(frozen=True, eq=False, slots=True)
class Outlook:
    """What each cell faces: a contour's index, n + its place in SIDES for a sheet's edge, or NOTHING."""

    cells: Cells
    faces: Ints
    n: int


@dataclass(frozen=True, eq=False, slots=True)
class OutlookSums:
    """The sums of an outlook over whole contours; arrays as in `Facts`."""

    neighbours: Facing
    edge_length_mm: Floats
    solid_mm: Floats


def outlook_of(outlines: Outlines, parent: Ints, sheet: Sheet, cells: Cells, options: FactOptions) -> Outlook:
    """Follow the normals of all cells."""
    faces, away_mm = first_hits(
        cells, _obstacles(outlines, parent, sheet), max(options.web_mm, options.edge_band_mm) + ROUNDING_MM
    )
    limit_mm = np.where(faces >= outlines.n, options.edge_band_mm, options.web_mm)
    beyond = (away_mm > limit_mm + ROUNDING_MM) | (faces == cells.contour)
    return Outlook(cells, np.where(beyond, NOTHING, faces), outlines.n)


def surroundings_of(outlines: Outlines, parent: Ints, outlook: Outlook) -> OutlookSums:
    """Sum up what each contour faces."""
    n, cells, faces = outlines.n, outlook.cells, outlook.faces
    at_edge = faces >= n
    edge_length_mm = np.zeros((n, len(SIDES)))
    np.add.at(edge_length_mm, (cells.contour[at_edge], faces[at_edge] - n), cells.length_mm[at_edge])

    at_part = (faces >= 0) & ~at_edge
    row, neighbour, length_mm = sum_by_pair(cells.contour[at_part], faces[at_part], cells.length_mm[at_part], n)
    facing = Facing(row, neighbour, length_mm, _gaps(outlines, parent, row, neighbour))
    solid_mm = outlines.length_mm - edge_length_mm.sum(axis=1) - sum_by_owner(row, length_mm, n)
    return OutlookSums(facing, edge_length_mm, np.maximum(solid_mm, 0.0))


def _gaps(outlines: Outlines, parent: Ints, row: Ints, neighbour: Ints) -> Floats:
    """The smallest distance between the two curves; from a part in a hole to its host, that to the hole."""
    hole = parent[row]
    at_host = (hole >= 0) & (outlines.own_outer[hole] == neighbour)
    gap_mm: Floats = shapely.distance(outlines.line[row], outlines.line[np.where(at_host, hole, neighbour)])
    return gap_mm


def _obstacles(outlines: Outlines, parent: Ints, sheet: Sheet) -> Obstacles:
    """The outer contours, the holes that parts lie in (as their host) and the edges of the sheet."""
    in_the_way = outlines.is_outer.copy()
    holes = parent[outlines.outers]
    in_the_way[holes[holes >= 0]] = True
    kept = in_the_way[outlines.chord_contour]
    edge_start, edge_end, side = _sheet_edges(sheet)
    return Obstacles(
        start=np.concatenate([outlines.chord_start[kept], edge_start]),
        end=np.concatenate([outlines.chord_end[kept], edge_end]),
        owner=np.concatenate([outlines.own_outer[outlines.chord_contour[kept]], outlines.n + side]),
    )


def _sheet_edges(sheet: Sheet) -> tuple[Floats, Floats, Ints]:
    """Straight pieces of the sheet's outline and holes, and the place in SIDES that each one faces most.

    The edge of a hole in a remnant belongs to the side that lies beyond the hole as seen from the metal.
    """
    starts, ends, sides = [], [], []
    for curve, metal_inside in [(sheet.outline, True), *((hole, False) for hole in sheet.holes)]:
        start = curve.flatten()
        end = np.roll(start, -1, axis=0)
        step = (end - start) * (1 if curve.is_ccw == metal_inside else -1)
        out_x, out_y = step[:, 1], -step[:, 0]
        sideways = np.abs(out_x) >= np.abs(out_y)
        starts.append(start)
        ends.append(end)
        sides.append(
            np.where(
                sideways,
                np.where(out_x < 0, SIDES.index("left"), SIDES.index("right")),
                np.where(out_y < 0, SIDES.index("bottom"), SIDES.index("top")),
            )
        )
    return np.concatenate(starts), np.concatenate(ends), np.concatenate(sides)


# The boundaries of all outer contours, divided into short cells of equal length.

SPACING_MM = 2.5
CELLS_MIN, CELLS_MOST = 80, 4000
"""Where what is faced changes, a cell is off by half its length: too little to matter in a quarter of a contour."""


@dataclass(frozen=True, eq=False, slots=True)
class Cells:
    """k cells, contour after contour, each along its contour as drawn.

    `point` (k, 2) is the middle of a cell and `normal` (k, 2) the unit normal there, out of the part. A cell begins
    `from_mm` along its contour and is `length_mm` long: at most SPACING_MM, and no contour has less than CELLS_MIN, nor
    has what is left of it when a way has begun it (up to CELLS_MOST in all).
    """

    contour: Ints
    point: Floats
    normal: Floats
    from_mm: Floats
    length_mm: Floats


def cells_of(outlines: Outlines, rest_mm: Mapping[int, float] | None = None) -> Cells:
    """The cells of every outer contour; `rest_mm` is how much is left of those that a way begins, at the least."""
    held = outlines.is_outer[outlines.chord_contour]
    start, end, of = outlines.chord_start[held], outlines.chord_end[held], outlines.chord_contour[held]
    step = end - start
    chord_mm = np.hypot(step[:, 0], step[:, 1])
    chord_from = np.cumsum(chord_mm) - chord_mm

    outers = outlines.outers
    length_mm = outlines.length_mm[outers]
    count = np.maximum(CELLS_MIN, np.ceil(length_mm / SPACING_MM)).astype(np.int64)
    for k, mm in (rest_mm or {}).items():
        own = np.flatnonzero(outers == k)
        count[own] = np.maximum(count[own], np.minimum(np.ceil(CELLS_MIN * length_mm[own] / mm), CELLS_MOST))
    number = concat_ranges(np.zeros_like(count), count)
    per_contour_mm = sum_by_owner(of, chord_mm, outlines.n)[outers]
    contour_from = np.cumsum(per_contour_mm) - per_contour_mm
    middle = np.repeat(contour_from, count) + (number + 0.5) * np.repeat(per_contour_mm / count, count)

    tangent = step / np.where(chord_mm > 0, chord_mm, 1.0)[:, None]
    outwards = np.where(outlines.is_ccw[of], 1.0, -1.0)[:, None]
    normal = outwards * np.column_stack([tangent[:, 1], -tangent[:, 0]])
    # A middle on a corner looks along the normal of the chord that begins there.
    chord = np.searchsorted(chord_from, middle + ROUNDING_MM, side="right") - 1
    share = (middle - chord_from.take(chord)) / chord_mm.take(chord)
    cell_mm = np.repeat(length_mm / count, count)
    return Cells(
        contour=np.repeat(outers, count),
        point=start.take(chord, axis=0) + step.take(chord, axis=0) * share[:, None],
        normal=normal.take(chord, axis=0),
        from_mm=number * cell_mm,
        length_mm=cell_mm,
    )


CONTACT_MM = 0.05
"""Outlines that overlap by less than this touch; a contour's own curve nearer than this is the cell's own place."""
CELLS_PER_BOX = 8
BOXES_AT_ONCE = 20_000
PAIRS_AT_ONCE = 1 << 18
"""Pairs of a cell and a piece that are intersected in one go, which takes a hundred bytes of memory for each."""
NOTHING = -1


@dataclass(frozen=True, eq=False, slots=True)
class Obstacles:
    """Straight pieces (m, 2) that rays may meet; `owner` (m,) is what a hit is reported as."""

    start: Floats
    end: Floats
    owner: Ints


def first_hits(cells: Cells, obstacles: Obstacles, reach_mm: float) -> tuple[Ints, Floats]:
    """The owner of the first obstacle that each cell's outward normal meets within `reach_mm`, and how far it is.

    NOTHING and inf where there is none. A few cells in a row share one search rectangle in an STRtree of the
    obstacles, and what it finds is intersected with all their rays in one array operation: near-linear.
    """
    k = len(cells.contour)
    owner, distance_mm = np.full(k, NOTHING), np.full(k, np.inf)
    tree = shapely.STRtree(shapely.linestrings(np.stack([obstacles.start, obstacles.end], axis=1)))
    first, count = _boxes_of(cells.contour)
    for chunk in range(0, len(first), BOXES_AT_ONCE):
        begin, cells_in = first[chunk : chunk + BOXES_AT_ONCE], count[chunk : chunk + BOXES_AT_ONCE]
        all_in = slice(begin[0], begin[-1] + cells_in[-1])
        point, normal = cells.point[all_in], cells.normal[all_in]
        ends = np.stack([point - CONTACT_MM * normal, point + reach_mm * normal])
        x0, y0 = np.minimum.reduceat(ends.min(axis=0), begin - begin[0]).T
        x1, y1 = np.maximum.reduceat(ends.max(axis=0), begin - begin[0]).T
        box, piece = tree.query(shapely.box(x0, y0, x1, y1))
        for some in _at_once(box, cells_in):
            cell = concat_ranges(begin[box[some]], cells_in[box[some]])
            pieces = np.repeat(piece[some], cells_in[box[some]])
            met, away_mm = _crossings(cells, obstacles, cell, pieces, reach_mm)
            cell, pieces = cell[met], pieces[met]
            np.minimum.at(distance_mm, cell, away_mm)
            nearest = away_mm == distance_mm[cell]
            np.maximum.at(owner, cell[nearest], obstacles.owner[pieces[nearest]])
    return owner, np.maximum(distance_mm, 0.0)


def _at_once(box: Ints, cells_in: Ints) -> Iterator[slice]:
    """The rows of some whole boxes, ascending, that make no more pairs than PAIRS_AT_ONCE, but for a single box."""
    first = np.flatnonzero(np.diff(box, prepend=-1))
    pairs = np.diff(first, append=len(box)) * cells_in[box[first]]
    begin, so_many = 0, 0
    for row, more in zip(first.tolist(), pairs.tolist(), strict=True):
        if so_many and so_many + more > PAIRS_AT_ONCE:
            yield slice(begin, row)
            begin, so_many = row, 0
        so_many += more
    yield slice(begin, len(box))


def _boxes_of(contour: Ints) -> tuple[Ints, Ints]:
    """First cell and number of cells of each search box: CELLS_PER_BOX in a row, never of two contours."""
    new = np.flatnonzero(np.diff(contour, prepend=-1))
    place = np.arange(len(contour)) - np.repeat(new, np.diff(new, append=len(contour)))
    first = np.flatnonzero(place % CELLS_PER_BOX == 0)
    return first, np.diff(first, append=len(contour))


def _crossings(cells: Cells, obstacles: Obstacles, cell: Ints, piece: Ints, reach_mm: float) -> tuple[Bools, Floats]:
    """Which of the (cell, piece) pairs meet, and the distances along the normal of those that do."""
    normal, start = cells.normal.take(cell, axis=0), obstacles.start.take(piece, axis=0)
    step, offset = obstacles.end.take(piece, axis=0) - start, start - cells.point.take(cell, axis=0)
    turn = normal[:, 0] * step[:, 1] - normal[:, 1] * step[:, 0]
    parallel = np.abs(turn) < 1e-12
    turn = np.where(parallel, 1.0, turn)
    away_mm = (offset[:, 0] * step[:, 1] - offset[:, 1] * step[:, 0]) / turn
    share = (offset[:, 0] * normal[:, 1] - offset[:, 1] * normal[:, 0]) / turn
    nearest_mm = np.where(obstacles.owner.take(piece) == cells.contour.take(cell), CONTACT_MM, -CONTACT_MM)
    met = ~parallel & (share >= -1e-9) & (share <= 1 + 1e-9) & (away_mm >= nearest_mm) & (away_mm <= reach_mm)
    return met, away_mm[met]


# What the first and the last stretch of every candidate's path face (Petunin 2009, section 2.1).
#
# The path runs once round the contour from the entry, or along a stretch of it, so its head and tail are stretches of
# the boundary; leads and overcut are left out.


@dataclass(frozen=True, eq=False, slots=True)
class Runs:
    """Longest stretches of boundary that face one thing, solid ones left out; those of contour i from `first[i]`."""

    from_mm: Floats
    to_mm: Floats
    faces: Ints
    first: Ints


def runs_of(outlook: Outlook) -> Runs:
    """Join the cells that follow each other and face the same."""
    cells, faces = outlook.cells, outlook.faces
    new = (np.diff(cells.contour, prepend=-1) != 0) | (np.diff(faces, prepend=NOTHING - 1) != 0)
    begin = np.flatnonzero(new)
    last = np.append(begin[1:], len(faces)) - 1 if len(faces) else begin
    facing = faces[begin] != NOTHING
    begin, last = begin[facing], last[facing]
    return Runs(
        from_mm=cells.from_mm[begin],
        to_mm=cells.from_mm[last] + cells.length_mm[last],
        faces=faces[begin],
        first=np.searchsorted(cells.contour[begin], np.arange(outlook.n + 1)),
    )


def stretch_of(
    outlines: Outlines, runs: Runs, candidates: Sequence[Candidate], share: float, part: Literal["head", "tail"]
) -> Stretch:
    """What the first or last `share` of each candidate's path faces; everything but edges and neighbours is solid."""
    m, n = len(candidates), outlines.n
    contour = np.fromiter((c.contour for c in candidates), np.int64, m)
    entry_mm = np.fromiter((c.entry_mm for c in candidates), np.float64, m)
    is_ccw = np.fromiter((c.direction == "ccw" for c in candidates), np.bool_, m)
    as_drawn = is_ccw == outlines.is_ccw[contour]
    around_mm = outlines.length_mm[contour]
    way_mm = np.array([np.nan if c.along_mm is None else c.along_mm for c in candidates], dtype=np.float64)
    total_mm = share * np.where(np.isnan(way_mm), around_mm, way_mm)
    after_entry = as_drawn if part == "head" else ~as_drawn
    begin_mm = np.where(after_entry, entry_mm, entry_mm - total_mm)
    if part == "tail":  # once round it ends where it begins
        begin_mm += np.nan_to_num(np.where(as_drawn, way_mm, -way_mm))
    begin_mm %= around_mm

    count = (runs.first[1:] - runs.first[:-1])[contour]
    run = concat_ranges(runs.first[contour], count)
    row = np.repeat(np.arange(m), count)
    low, high = begin_mm[row], (begin_mm + total_mm)[row]
    faced_mm = np.zeros(len(run))
    for lap_mm in (0.0, around_mm[row]):  # a stretch that passes the contour's first point goes on in a second lap
        overlap_mm = np.minimum(high, runs.to_mm[run] + lap_mm) - np.maximum(low, runs.from_mm[run] + lap_mm)
        faced_mm += np.maximum(overlap_mm, 0.0)

    touched = faced_mm > 0
    row, faces, faced_mm = row[touched], runs.faces[run[touched]], faced_mm[touched]
    at_edge = faces >= n
    edge_mm = sum_by_owner(row[at_edge], faced_mm[at_edge], m)
    row, neighbour, length_mm = sum_by_pair(row[~at_edge], faces[~at_edge], faced_mm[~at_edge], n)
    solid_mm = total_mm - edge_mm - sum_by_owner(row, length_mm, m)
    gap_mm = np.full(len(row), np.nan)
    return Stretch(total_mm, edge_mm, np.maximum(solid_mm, 0.0), Facing(row, neighbour, length_mm, gap_mm))
