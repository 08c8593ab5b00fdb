"""What the boundary of each part faces: another part, the sheet's edge or solid metal (Petunin 2009, section 2.1).

From the middle of every cell of an outer contour the outward normal is followed to whatever it meets first. A part
within `web_mm` makes the cell face a neighbour, the end of the sheet within `edge_band_mm` an edge; all else is
solid: wide uncut metal, or another stretch of the same contour across a narrow mouth. For a part inside a host's
hole the metal around is the host's, so its neighbour is the host's outer contour.

Holes and marks face solid metal only: what is inside a hole stays with the part until the part is cut.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.nest import Sheet

from .cells import Cells
from .facts import SIDES, Facing, FactOptions
from .outlines import ROUNDING_MM, Outlines
from .rays import NOTHING, Obstacles, first_hits
from .sums import summed_by, summed_by_pair


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
    row, neighbour, length_mm = summed_by_pair(cells.contour[at_part], faces[at_part], cells.length_mm[at_part], n)
    facing = Facing(row, neighbour, length_mm, _gaps(outlines, parent, row, neighbour))
    solid_mm = outlines.length_mm - edge_length_mm.sum(axis=1) - summed_by(row, length_mm, n)
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
