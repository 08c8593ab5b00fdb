"""The sheet as square cells that kerfs cut in pieces, and which pieces still hang together at a time.

Every cell that a kerf or the edge of the sheet crosses becomes as many pieces as metal it holds, each with its true
shape and with four corner nodes of its own, some of which lie outside it (phantom nodes: Hansbo & Hansbo 2004, "A
finite element method for the simulation of strong and weak discontinuities in solid mechanics"). Pieces of neighbouring
cells share the nodes of a face that both touch. Pieces on both sides of a kerf are tied until the torch has passed
there. So no metal is lost but the kerf, and it hardly matters how the cells lie to the parts.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components, minimum_spanning_tree

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.nest import Nest
from kerfwise.models.physics.heat import TimedPath

SHIFT_X, SHIFT_Y = 0.1373, 0.2179
"""The cells begin so many widths outside the sheet: straight cuts at round numbers should not run along their faces."""
LEAST_AREA = 0.01
"""Smaller pieces, as a share of a cell, are left out."""
TOUCH = 1e-3
"""Two pieces hang together where they share more than this of a face."""
CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
"""Signs of a cell's corners, counter-clockwise from the lower left."""
_SHARED: dict[tuple[int, int], tuple[list[int], list[int]]] = {
    (0, 0): ([0, 1, 2, 3], [0, 1, 2, 3]),
    (1, 0): ([1, 2], [0, 3]),
    (-1, 0): ([0, 3], [1, 2]),
    (0, 1): ([3, 2], [0, 1]),
    (0, -1): ([0, 1], [3, 2]),
}
"""Where another cell lies from one: which corners of the one are which of the other."""
NO_PART = -1
_NEAR_MM = 0.05


@dataclass(frozen=True, eq=False, slots=True)
class Mesh:
    """Pieces (p), nodes (n) and ties (m) of a sheet with all its kerfs.

    `x0_mm`, `y0_mm` is the lower left corner of cell (0, 0); `shape` counts cells along x and y. Of every piece: `cell`
    (p, 2), its polygon, `moments` (p, 6) of its area A, ∫ξ, ∫η, ∫ξ², ∫ξη, ∫η², mm², in the coordinates of its cell, -1
    to 1; `node` (p, 4) its corners, and `part` (p,), the number of the part it lies in. `first` and `count`, by flat
    number of the cell, say which pieces a cell has. Ties (m, 2) are pairs of nodes that are one until `opens_s` (m,).
    """

    h_mm: float
    x0_mm: float
    y0_mm: float
    shape: tuple[int, int]
    cell: Ints
    polygon: NDArray[np.object_]
    moments: Floats
    node: Ints
    part: Ints
    first: Ints
    count: Ints
    ties: Ints
    opens_s: Floats

    @property
    def nodes(self) -> int:
        """How many nodes there are."""
        return int(self.node.max(initial=-1)) + 1

    def centres(self) -> Floats:
        """The middle of the cell of every piece (p, 2), mm."""
        middles: Floats = (self.cell + 0.5) * self.h_mm + np.array([self.x0_mm, self.y0_mm])
        return middles

    def node_xy(self) -> Floats:
        """Where the nodes are (n, 2), mm."""
        xy = np.zeros((self.nodes, 2))
        xy[self.node] = self.centres()[:, None, :] + CORNERS * (self.h_mm / 2)
        return xy

    def local(self, piece: Ints, xy: Floats) -> Floats:
        """Points (k, 2), mm, in the coordinates of the cells of pieces (k,)."""
        return (xy - self.centres()[piece]) / (self.h_mm / 2)

    def cell_at(self, xy: Floats) -> Ints:
        """The cells (k, 2) in which points lie, the nearest for those outside."""
        at = np.floor((xy - (self.x0_mm, self.y0_mm)) / self.h_mm).astype(np.int64)
        return np.clip(at, 0, np.array(self.shape) - 1)

    def joined(self, after_s: float) -> Ints:
        """The numbers of nodes (n,) with those that are one after a time given one number."""
        tied = self.ties[self.opens_s > after_s]
        return components(self.nodes, tied)

    def find(self, xy: Floats, part: Ints | None = None) -> Ints:
        """The piece nearest to each point (k, 2), of the part named by number if one is given; -1 where none is near.

        Looked for in the point's cell, and if that has none, in the eight around it.
        """
        found = np.full(len(xy), -1, dtype=np.int64)
        cells = self.cell_at(xy)
        rings = ([(0, 0)], [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j])
        for offsets in rings:
            left = np.flatnonzero(found < 0)
            if not len(left):
                break
            row, piece = self._around(left, cells, offsets)
            if part is not None:
                own = self.part[piece] == part[row]
                row, piece = row[own], piece[own]
            far = shapely.distance(self.polygon[piece], shapely.points(xy[row]))
            for k in np.lexsort((piece, far, row))[::-1]:
                found[row[k]] = piece[k]
        return found

    def _around(self, rows: Ints, cells: Ints, offsets: Sequence[tuple[int, int]]) -> tuple[Ints, Ints]:
        """Pairs of a row and a piece of the cells at these offsets from the row's."""
        at_rows, at_pieces = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
        for i, j in offsets:
            x, y = cells[rows, 0] + i, cells[rows, 1] + j
            inside = (x >= 0) & (x < self.shape[0]) & (y >= 0) & (y < self.shape[1])
            flat = x[inside] * self.shape[1] + y[inside]
            count = self.count[flat]
            at_rows.append(np.repeat(rows[inside], count))
            steps = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
            at_pieces.append(np.repeat(self.first[flat], count) + steps)
        return np.concatenate(at_rows), np.concatenate(at_pieces)


def components(nodes: int, pairs: Ints) -> Ints:
    """A number for each of `nodes` things, the same for all that pairs (k, 2) join."""
    links = coo_matrix((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=(nodes, nodes))
    numbers: Ints = connected_components(links, directed=False)[1].astype(np.int64)
    return numbers


@dataclass(frozen=True, eq=False, slots=True)
class Samples:
    """Points along the torch's path, in order of time: xy (k, 2), direction of travel (k, 2), seconds, burn, mm along.

    `length_mm` (k,) is how much of the path each stands for.
    """

    xy: Floats
    ahead: Floats
    at_s: Floats
    burn: Ints
    along_mm: Floats
    length_mm: Floats

    def at(self, which: Ints | Bools) -> Samples:
        """Some of them."""
        return Samples(
            self.xy[which], self.ahead[which], self.at_s[which], self.burn[which], self.along_mm[which],
            self.length_mm[which],
        )  # fmt: skip


def sample_path(path: TimedPath, step_mm: float) -> Samples:
    """Points at the middle of equal steps of every burn, no longer than `step_mm`; burns that only stand have none."""
    rows: list[Floats] = []
    for number, burn in enumerate(path.burns):
        moves = np.concatenate([[True], np.hypot(*np.diff(burn.xy, axis=0).T) > 1e-9])
        xy, at_s = burn.xy[moves], burn.at_s.copy()
        stays = np.flatnonzero(~moves)
        at_s = np.delete(at_s, stays)
        for k in stays:  # a torch that stands leaves when it has stood
            at_s[np.searchsorted(np.flatnonzero(moves), k) - 1] = burn.at_s[k]
        along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(xy, axis=0).T))]) if len(xy) > 1 else np.zeros(1)
        if along[-1] <= 0:
            continue
        count = max(1, math.ceil(along[-1] / step_mm))
        d_mm = along[-1] / count
        middle = (np.arange(count) + 0.5) * d_mm
        before, after = (
            np.column_stack([np.interp(middle + s * d_mm / 4, along, xy[:, c]) for c in (0, 1)]) for s in (-1, 1)
        )
        ahead = after - before
        ahead /= np.maximum(np.hypot(*ahead.T), 1e-12)[:, None]
        at = np.column_stack([np.interp(middle, along, column) for column in (xy[:, 0], xy[:, 1], at_s)])
        same = np.ones((count, 1))
        rows.append(np.hstack([at[:, :2], ahead, at[:, 2:], same * number, middle[:, None], same * d_mm]))
    table = np.vstack(rows) if rows else np.zeros((0, 8))
    table = table[np.argsort(table[:, 4], kind="stable")]  # several torches burn at one time
    return Samples(
        table[:, :2], table[:, 2:4], table[:, 4], table[:, 5].astype(np.int64), table[:, 6], table[:, 7]
    )  # fmt: skip


def make_mesh(nest: Nest, path: TimedPath, h_mm: float, kerf_mm: float) -> Mesh:
    """Cut cells of `h_mm` by the sheet's edge and the kerf of a whole program, and tie what is cut later."""
    x0, y0, x1, y1 = nest.sheet.bounds
    x0, y0 = x0 - SHIFT_X * h_mm, y0 - SHIFT_Y * h_mm
    nx, ny = math.ceil((x1 - x0) / h_mm + 1e-9), math.ceil((y1 - y0) / h_mm + 1e-9)
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(nx), np.arange(ny), indexing="ij"))
    boxes = shapely.box(x0 + i * h_mm, y0 + j * h_mm, x0 + (i + 1) * h_mm, y0 + (j + 1) * h_mm)
    sheet = nest.sheet.polygon
    shapely.prepare(sheet)
    metal = boxes.copy()
    edge = ~shapely.contains(sheet, boxes)
    metal[edge] = shapely.intersection(boxes[edge], sheet)
    cells, cut = _kerfs(path, boxes, kerf_mm)
    metal[cells] = shapely.difference(metal[cells], cut)
    polygon, flat = shapely.get_parts(metal, return_index=True)
    large = (shapely.get_dimensions(polygon) == 2) & (shapely.area(polygon) > LEAST_AREA * h_mm**2)
    polygon, flat = polygon[large], flat[large]
    cell = np.column_stack([i[flat], j[flat]])
    count = np.bincount(flat, minlength=nx * ny)
    first = np.cumsum(count) - count
    simple = ~edge
    simple[cells] = False
    node = _nodes(polygon, flat, simple, first, count, (nx, ny), (x0, y0), h_mm)
    ties, opens_s = _ties(polygon, cell, node, path, h_mm, kerf_mm)
    middles = (cell + 0.5) * h_mm + (x0, y0)
    return Mesh(
        h_mm, x0, y0, (nx, ny), cell, polygon, _moments(polygon, middles, h_mm), node,
        _parts(nest, polygon), first, count, ties, opens_s,
    )  # fmt: skip


def _kerfs(path: TimedPath, boxes: NDArray[np.object_], kerf_mm: float) -> tuple[Ints, NDArray[np.object_]]:
    """The cells that any kerf touches, flat, and the kerf in each."""
    pieces = []
    for burn in path.burns:
        line = shapely.simplify(shapely.LineString(burn.xy), kerf_mm / 20) if len(burn.xy) > 1 else None
        if line is not None and line.length > 0:
            points = shapely.get_coordinates(line)
            pieces.append(np.stack([points[:-1], points[1:]], axis=1))
    if not pieces:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=object)
    segments = shapely.linestrings(np.concatenate(pieces))
    number, cell = shapely.STRtree(boxes).query(segments, predicate="dwithin", distance=kerf_mm / 2)
    order = np.lexsort((number, cell))
    cells, group = np.unique(cell[order], return_inverse=True)
    lines = shapely.multilinestrings(segments[number[order]], indices=group)
    x0, y0, x1, y1 = shapely.bounds(boxes[cells]).T
    near = shapely.box(x0 - kerf_mm, y0 - kerf_mm, x1 + kerf_mm, y1 + kerf_mm)
    return cells, shapely.buffer(shapely.intersection(lines, near), kerf_mm / 2, quad_segs=4)


def _moments(polygon: NDArray[np.object_], middles: Floats, h_mm: float) -> Floats:
    """Area and its first and second moments of every polygon (p, 6) about a middle, lengths in half cells, areas mm².

    Ring by ring as sums over the edges (Green's theorem).
    """
    rings, of = shapely.get_rings(polygon, return_index=True)
    clockwise = ~shapely.is_ccw(rings)
    xy, ring = shapely.get_coordinates(rings, return_index=True)
    at = (xy - middles[of[ring]]) / (h_mm / 2)
    last = np.concatenate([ring[1:] != ring[:-1], [True]])[:-1]
    a, b, at_ring = at[:-1][~last], at[1:][~last], ring[:-1][~last]
    cross = a[:, 0] * b[:, 1] - b[:, 0] * a[:, 1]
    x, y, u, v = a[:, 0], a[:, 1], b[:, 0], b[:, 1]
    terms = np.column_stack([
        cross / 2, cross * (x + u) / 6, cross * (y + v) / 6, cross * (x * x + x * u + u * u) / 12,
        cross * (2 * x * y + x * v + u * y + 2 * u * v) / 24, cross * (y * y + y * v + v * v) / 12,
    ])  # fmt: skip
    inner = np.concatenate([[False], of[1:] == of[:-1]]) if len(of) else np.zeros(0, dtype=np.bool_)
    sign = np.where(clockwise, -1.0, 1.0) * np.where(inner, -1.0, 1.0)
    terms *= sign[at_ring, None]
    found: Floats = np.column_stack([np.bincount(of[at_ring], column, len(polygon)) for column in terms.T])
    found *= (h_mm / 2) ** 2
    return found


def _nodes(
    polygon: NDArray[np.object_], flat: Ints, simple: Bools, first: Ints, count: Ints, shape: tuple[int, int],
    origin: tuple[float, float], h_mm: float,
) -> Ints:  # fmt: skip
    """The node of every corner of every piece (p, 4): corners are one where their pieces share a face."""
    nx, ny = shape
    cells = np.arange(nx * ny).reshape(nx, ny)
    pairs = [np.zeros((0, 2), dtype=np.int64)]
    for axis, (mine, others) in ((0, _SHARED[1, 0]), (1, _SHARED[0, 1])):
        one = (cells[:-1] if axis == 0 else cells[:, :-1]).ravel()
        other = (cells[1:] if axis == 0 else cells[:, 1:]).ravel()
        both = simple[one] & simple[other]
        a, b = first[one[both]], first[other[both]]
        one, other = one[~both], other[~both]
        # every pair of pieces of two neighbours
        many = count[one] * count[other]
        row = np.repeat(np.arange(len(one)), many)
        k = np.arange(len(row)) - np.repeat(np.cumsum(many) - many, many)
        p = first[one[row]] + k // np.maximum(count[other[row]], 1)
        q = first[other[row]] + k % np.maximum(count[other[row]], 1)
        fx, fy = origin[0] + (other[row] // ny) * h_mm, origin[1] + (other[row] % ny) * h_mm
        dx, dy = (0.0, h_mm) if axis == 0 else (h_mm, 0.0)
        faces = shapely.linestrings(np.stack([np.column_stack([fx, fy]), np.column_stack([fx + dx, fy + dy])], axis=1))
        shared = shapely.intersection(shapely.intersection(polygon[p], faces), shapely.intersection(polygon[q], faces))
        touch = shapely.length(shared) > TOUCH * h_mm
        a, b = np.concatenate([a, p[touch]]), np.concatenate([b, q[touch]])
        pairs += [np.column_stack([4 * a + m, 4 * b + o]) for m, o in zip(mine, others, strict=True)]
    return components(4 * len(polygon), np.concatenate(pairs)).reshape(-1, 4)


def _ties(
    polygon: NDArray[np.object_], cell: Ints, node: Ints, path: TimedPath, h_mm: float, kerf_mm: float
) -> tuple[Ints, Floats]:
    """Pairs of nodes of pieces on both sides of a kerf, and when the torch is through between them.

    The pieces are of one cell, or of two neighbours where the kerf runs along their face, or so near to it that what is
    left of one cell beyond the kerf is no piece. Of all ties only a spanning forest is kept, of those that open last:
    its ties hold together at any time what all of them do.
    """
    samples = sample_path(path, min(h_mm / 6, max(kerf_mm, h_mm / 12)))
    within_mm = kerf_mm / 2 + _NEAR_MM + LEAST_AREA * h_mm
    row, piece = shapely.STRtree(polygon).query(shapely.points(samples.xy), predicate="dwithin", distance=within_mm)
    order = np.lexsort((piece, row))
    row, piece = row[order], piece[order]
    beside: dict[tuple[int, int], list[int]] = {}
    starts = np.flatnonzero(np.concatenate([[True], row[1:] != row[:-1]])) if len(row) else np.zeros(0, dtype=np.int64)
    at, pieces = cell.tolist(), piece.tolist()
    for begin, end in pairwise([*starts.tolist(), len(pieces)]):
        for k in range(begin, end):
            for other in pieces[k + 1 : end]:
                one = pieces[k]
                if abs(at[one][0] - at[other][0]) + abs(at[one][1] - at[other][1]) <= 1:
                    beside.setdefault((one, other), []).append(int(row[begin]))
    pairs, opens = [], []
    burn, along_mm, at_s = samples.burn.tolist(), samples.along_mm.tolist(), samples.at_s.tolist()
    for (one, other), rows in beside.items():
        last = rows[-1]
        run = [r for r in rows if burn[r] == burn[last] and along_mm[r] > along_mm[last] - 1.5 * h_mm]
        mine, its = _SHARED[at[other][0] - at[one][0], at[other][1] - at[one][1]]
        pairs.append(np.column_stack([node[one][mine], node[other][its]]))
        opens += [(at_s[run[(len(run) - 1) // 2]] + at_s[run[len(run) // 2]]) / 2] * len(mine)  # in order of time
    if not pairs:
        return np.zeros((0, 2), dtype=np.int64), np.zeros(0)
    return _forest(np.sort(np.concatenate(pairs), axis=1), np.array(opens), int(node.max()) + 1)


def _forest(tied: Ints, opens_s: Floats, nodes: int) -> tuple[Ints, Floats]:
    keep = tied[:, 0] != tied[:, 1]
    tied, opens_s = tied[keep], opens_s[keep]
    order = np.lexsort((-opens_s, tied[:, 1], tied[:, 0]))
    tied, opens_s = tied[order], opens_s[order]
    first = np.concatenate([[True], (np.diff(tied, axis=0) != 0).any(axis=1)]) if len(tied) else np.zeros(0, np.bool_)
    tied, opens_s = tied[first], opens_s[first]
    if not len(tied):
        return tied, opens_s
    weight = opens_s.max() + 1.0 - opens_s
    tree = minimum_spanning_tree(csr_matrix((weight, (tied[:, 0], tied[:, 1])), shape=(nodes, nodes))).tocoo()
    opens = opens_s.max() + 1.0 - tree.data
    order = np.lexsort((tree.col, tree.row, opens))
    return np.column_stack([tree.row, tree.col])[order].astype(np.int64), opens[order]


def _parts(nest: Nest, polygon: NDArray[np.object_]) -> Ints:
    """The number of the part in which each piece lies, `NO_PART` for the skeleton and what falls out of holes."""
    points = shapely.point_on_surface(polygon)
    found = np.full(len(polygon), NO_PART, dtype=np.int64)
    if nest.parts:
        point, part = shapely.STRtree(points).query([p.polygon for p in nest.parts], predicate="intersects")[::-1]
        found[point] = part
    return found
