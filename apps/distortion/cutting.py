"""A sheet that is cut: how far the metal under the torch has moved from where it lies when cold, all along a program.

Step by step the heat of the torch warms the pieces of the mesh, the kerf opens behind it, and the sheet takes the
shape in which all forces balance; inertia has no say. A batch is a stretch of the program, mostly a contour or two:
its sheet is factorised once, as it hangs together at the batch's end, and every state in the batch is found from that
factor with the ties that still hold then. What is cut free is not followed any further.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import shapely
from scipy.sparse import coo_matrix, csc_matrix, csr_matrix, diags

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.nest import Nest
from kerfwise.models.physics.heat import TimedPath
from kerfwise.models.physics.heat.physical import LONGEST_STEP_S, SheetSimulation
from kerfwise.models.physics.heat.timed_path import NO_PART, Grid, events_of
from kerfwise.rules.profile.plant_sections import Heat, Material

from .elasticity import Band, Elasticity, bodies, metal_of, shape_weights, yielded
from .mesh import CORNERS, Mesh, Samples, make_mesh, sample_path

MOST_TIES = 60
"""A batch is divided where more ties open in it: each takes two right-hand sides, a factor as much as some fifty."""
FEW_TIES = 30
"""A batch goes on with the next burn until so many have opened."""
SPACING_MM = 80.0
"""Between points of a contour where it is asked how far the metal has moved, unless the contour is short."""
LEAST_POINTS = 10


@dataclass(frozen=True, slots=True)
class Cutting:
    """How a sheet is simulated: width of a cell, mm, width of the kerf, mm, thickness, mm; whether metal yields.

    Errors are asked for at so many times as many points as usual.
    """

    grid_mm: float
    kerf_mm: float
    thickness_mm: float
    yields: bool = True
    points: int = 1


def cutting_of(material: Material, grid_mm: float, yields: bool = True) -> Cutting:
    """How a sheet of a profile's material is simulated on cells so wide."""
    return Cutting(grid_mm, max(material.kerf_mm, 0.1), material.thickness_mm, yields)


def cell_mm(nest: Nest, cells: int) -> float:
    """How wide cells are of which so many make a nest's sheet, mm."""
    x0, y0, x1, y1 = nest.sheet.bounds
    return float(np.sqrt((x1 - x0) * (y1 - y0) / cells))


@dataclass(frozen=True, eq=False, slots=True)
class Moved:
    """Points of contours and how far each is off, cut as the metal lay then: (k, …), in order of time.

    `contour` is the number of the contour, `xy` the point of it, mm, `off` (k, 2) where that edge of the cold part lies
    less where the drawing has it, mm, before any fit; `at_s` when it was cut, `length_mm` the length it stands for.
    `cold` (k, 2) is how the yielded bands bend the part for ever, mm: no order of the cuts changes it.
    """

    contour: Ints
    xy: Floats
    off: Floats
    at_s: Floats
    length_mm: Floats
    cold: Floats


@dataclass(frozen=True, eq=False, slots=True)
class Followed:
    """Points (k, 2), mm, followed at times (f,), s, in order: `moved` (f, k, 2) is how far they have moved, mm.

    `part` (k,) is the number of the part that each belongs to, -1 for the sheet. What is cut free stays where it was.
    """

    xy: Floats
    part: Ints
    at_s: Floats
    moved: Floats


def cut_sheet(nest: Nest, path: TimedPath, heat: Heat, how: Cutting, follow: Followed | None = None) -> Moved:
    """Simulate a whole program.

    Where points are to be followed, `follow.moved` is filled in. Raises InputError if nothing is known of the metal's
    strength.
    """
    metal = metal_of(heat.material)
    mesh = make_mesh(nest, path, how.grid_mm, how.kerf_mm)
    elastic = Elasticity(mesh, metal.elastic(how.thickness_mm))
    asked = _asked(nest, path, how)
    contour, at_xy = asked[:, 0].astype(np.int64), asked[:, 1:3]
    piece = mesh.find(at_xy, np.array(nest.owners, dtype=np.int64)[contour])  # of the contour's own part
    there = piece >= 0
    contour, at_xy, at_s, length_mm, piece = (
        contour[there],
        at_xy[there],
        asked[there, 3],
        asked[there, 4],
        piece[there],
    )
    weights = shape_weights(mesh.local(piece, at_xy))
    bands = _Bands(mesh, elastic, path, heat, how)
    warmth = Warmth(nest, path, heat, how.thickness_mm, mesh)
    times = at_s if follow is None else np.concatenate([at_s, follow.at_s])
    order = np.argsort(times, kind="stable")
    hot = np.zeros((len(piece), 2))
    spots = None if follow is None else _Spots(mesh, follow)
    for number, moved in zip(order.tolist(), _states(elastic, path, bands, warmth, times[order]), strict=True):
        if number < len(piece):
            one = slice(number, number + 1)
            hot[one] = at_points(moved, mesh.node[piece[one]], weights[one])
        elif spots is not None:
            spots.take(number - len(piece), moved)
    cold = _cold(mesh, elastic, bands, piece, weights) if how.yields else np.zeros_like(hot)
    return Moved(contour, at_xy, cold - hot, at_s, length_mm, cold)


def _states(elastic: Elasticity, path: TimedPath, bands: _Bands, warmth: Warmth, at_s: Floats) -> Iterator[Floats]:
    """Displacements (n, 2) of all nodes, mm, at each of these times (k,), which never fall."""
    mesh = elastic.mesh
    lies, done = np.zeros((mesh.nodes, 2)), 0
    for batch in _batches(mesh, path):
        last = int(np.searchsorted(at_s, batch.end_s, side="right"))
        asked, done = at_s[done:last].tolist(), last
        keep = _still_cut(mesh, batch.begin_s)
        if not keep.any():
            yield from (lies for _ in asked)
            continue
        state = elastic.state(mesh.joined(batch.end_s), keep)
        ties = mesh.ties[batch.first : batch.last]
        times = [*asked, batch.end_s]
        loads, open_ = [], []
        for when_s, pulls in zip(times, bands.forces(np.array(times)), strict=True):
            excess, slope = warmth.at(when_s)
            loads.append(state.load(elastic.thermal(excess, slope) + pulls, lies))
            open_.append(_opened(mesh.opens_s[batch.first : batch.last], when_s))
        open_[-1] = len(ties)
        *found, at_end = state.solve(loads, ties, open_)
        yield from (state.spread(one, lies) for one in found)
        lies = state.spread(at_end, lies)
    yield from (lies for _ in at_s[done:])


class _Spots:
    """Points of the mesh that are followed."""

    def __init__(self, mesh: Mesh, follow: Followed) -> None:
        piece = mesh.find(follow.xy, follow.part)
        lost = piece < 0
        piece[lost] = mesh.find(follow.xy[lost])
        self._known = piece >= 0
        self._node = mesh.node[piece[self._known]]
        self._weights = shape_weights(mesh.local(piece, follow.xy)[self._known])
        self._moved = follow.moved

    def take(self, frame: int, moved: Floats) -> None:
        """Where they are when all nodes have moved so (n, 2)."""
        self._moved[frame, self._known] = at_points(moved, self._node, self._weights)


# Where it is asked how far the metal has moved: along the contours, as the torch passes.


def _asked(nest: Nest, path: TimedPath, how: Cutting) -> Floats:
    """Points of contours at the time the torch first passes them, evenly along each.

    Rows (k, 5) in order of time: number of the contour, x and y, when, and the length that the point stands for.
    """
    shaping = [k for k, contour in enumerate(nest.contours) if contour.shapes_part]
    lines = [nest.contours[k].line for k in shaping]
    fine = sample_path(path, 2.0)
    sample, line = points_of(lines, fine.xy, 0.75 * how.kerf_mm + 0.1)
    along = shapely.line_locate_point(np.array(lines, dtype=object)[line], shapely.points(fine.xy[sample]))
    rows: list[tuple[int, float, float, float]] = []
    for number in range(len(lines)):
        mine = np.flatnonzero(line == number)
        mine = mine[np.argsort(fine.at_s[sample[mine]], kind="stable")]
        run = np.cumsum(fine.length_mm[sample[mine]])
        for k, length_mm in _evenly(run, lines[number], how.points):
            rows.append((number, float(along[mine[k]]), float(fine.at_s[sample[mine[k]]]), length_mm))
    found = np.array(sorted(rows, key=lambda row: row[2])).reshape(-1, 4)
    numbers = found[:, 0].astype(np.int64)
    at = shapely.line_interpolate_point(np.array(lines, dtype=object)[numbers], found[:, 1])
    xy = shapely.get_coordinates(at).reshape(-1, 2)
    return np.column_stack([np.array(shaping, dtype=np.int64)[numbers], xy, found[:, 2:]])


def _evenly(run_mm: Floats, line: shapely.LineString, times: int) -> Iterator[tuple[int, float]]:
    """The samples (k,) in the middle of equal stretches of the way along a contour, and how long the stretches are.

    `run_mm` is the way at each. From where the torch came on: how far it is from coming round decides how the metal
    moves. Where it overruns its start nothing is cut any more.
    """
    length_mm = line.length
    usual = length_mm / SPACING_MM
    count = times * (max(LEAST_POINTS, int(np.ceil(usual))) if line.is_closed else max(2, int(usual)))
    middles = (np.arange(count) + 0.5) * length_mm / count
    at = np.searchsorted(run_mm, middles)
    for k in np.unique(at[at < len(run_mm)]):
        yield int(k), length_mm / count


# The program in batches, and what of the sheet each has to do with.


@dataclass(frozen=True, slots=True)
class _Batch:
    """A stretch of time, and which ties open in it, by number."""

    begin_s: float
    end_s: float
    first: int
    last: int


def _batches(mesh: Mesh, path: TimedPath) -> Iterator[_Batch]:
    begin_s, first = -1.0, 0
    ends = [float(burn.at_s[-1]) for burn in path.burns]
    for k, end_s in enumerate(ends):
        last = int(np.searchsorted(mesh.opens_s, end_s, side="right"))
        if last - first < FEW_TIES and k < len(ends) - 1:
            continue
        parts = max(1, -(-(last - first) // MOST_TIES))
        for part in range(1, parts):
            middle = first + (last - first) // (parts - part + 1)
            at_s = float(mesh.opens_s[middle - 1])
            middle = int(np.searchsorted(mesh.opens_s, at_s, side="right"))
            yield _Batch(begin_s, at_s, first, middle)
            begin_s, first = at_s, middle
        yield _Batch(begin_s, end_s, first, last)
        begin_s, first = end_s, last


def _still_cut(mesh: Mesh, after_s: float) -> Bools:
    """The pieces of bodies that are cut after a time."""
    joined = mesh.joined(after_s)
    body = bodies(mesh, joined)
    of_node = np.empty(mesh.nodes, dtype=np.int64)
    of_node[mesh.node] = body[:, None]
    later = mesh.ties[mesh.opens_s > after_s]
    return np.isin(body, of_node[later.ravel()])


def _opened(opens_s: Floats, when_s: float) -> float:
    """How many ties are open at a time: each opens bit by bit, half before its own time and half after it."""
    middles = (opens_s[1:] + opens_s[:-1]) / 2
    k = int(np.searchsorted(middles, when_s, side="right"))
    if not len(opens_s):
        return 0.0
    begin_s = middles[k - 1] if k else opens_s[0]
    end_s = middles[k] if k < len(middles) else opens_s[-1]
    share = (when_s - begin_s) / (end_s - begin_s) if end_s > begin_s else float(when_s >= end_s)
    return k + min(max(share, 0.0), 1.0)


# The bands beside the cut, which yield.


class _Bands:
    """What the metal beside the cut pulls with, on both sides, from the passing of the torch on."""

    def __init__(self, mesh: Mesh, elastic: Elasticity, path: TimedPath, heat: Heat, how: Cutting) -> None:
        self._nodes = mesh.nodes
        self._rows: list[tuple[Band, Floats, Floats, csc_matrix]] = []
        if not how.yields or heat.absorbed_power_w <= 0:
            return
        fine = sample_path(path, how.grid_mm / 3)
        feeds = np.array([_feed(burn.xy, burn.at_s) for burn in path.burns])
        rounded = np.round(feeds, 1)
        for feed in np.unique(rounded[fine.burn]):
            band = yielded(heat.material, how.thickness_mm, heat.absorbed_power_w, float(max(feed, 0.1)))
            some = fine.at(rounded[fine.burn] == feed)
            for side in (1.0, -1.0):
                self._add(mesh, elastic, band, some, side * (how.kerf_mm / 2 + max(band.depth_mm, 0.1)))

    def _add(self, mesh: Mesh, elastic: Elasticity, band: Band, some: Samples, aside_mm: float) -> None:
        beside = some.xy + aside_mm * np.column_stack([-some.ahead[:, 1], some.ahead[:, 0]])
        piece = mesh.find(beside)
        found = piece >= 0
        found[found] = shapely.distance(mesh.polygon[piece[found]], shapely.points(beside[found])) < abs(aside_mm) / 2
        some, piece, beside = some.at(found), piece[found], beside[found]
        self._rows.append((band, some.at_s, some.length_mm, elastic.line_loads(piece, beside, some.ahead)))

    def forces(self, when_s: Floats) -> Floats:
        """Nodal forces (t, n, 2), N, at times (t,); `inf` for the cold sheet."""
        total = np.zeros((len(when_s), 2 * self._nodes))
        for band, at_s, length_mm, loads in self._rows:
            since_s = when_s - at_s[:, None]
            total += (loads @ (band.pull(since_s) * length_mm[:, None])).T
        return total.reshape(len(when_s), -1, 2)


def _feed(xy: Floats, at_s: Floats) -> float:
    """How fast a burn moves, mm/s; where it stands does not count."""
    steps, took = np.hypot(*np.diff(xy, axis=0).T), np.diff(at_s)
    moves = steps > 1e-9
    return float(steps[moves].sum() / max(took[moves].sum(), 1e-9)) if moves.any() else 0.0


def _cold(mesh: Mesh, elastic: Elasticity, bands: _Bands, piece: Ints, weights: Floats) -> Floats:
    """How the bands have bent the parts when all is cold and cut: displacements (k, 2) of points of pieces, mm."""
    joined = mesh.joined(np.inf)
    body = bodies(mesh, joined)
    state = elastic.state(joined, np.isin(body, body[piece]))
    rest = np.zeros((mesh.nodes, 2))
    found = state.solve([state.load(bands.forces(np.array([np.inf]))[0], rest)], mesh.ties[:0], [0])[0]
    every = state.spread(found, rest)
    return at_points(every, mesh.node[piece], weights)


def at_points(every: Floats, node: Ints, weights: Floats) -> Floats:
    """Displacements (k, 2) of points, of those of all nodes (n, 2), the corners (k, 4) and their weights (k, 4)."""
    found: Floats = np.einsum("kc,kcx->kx", weights, every[node])
    return found


POINTS = 3
"""Points of the heat simulation along a side of a cell."""
REACH = 3
"""Pieces away, through faces that they share, where a piece without points finds a temperature, and heat is kept."""


class Warmth:
    """The heat of a program as it goes on, read off piece by piece.

    Parameters
    ----------
    nest, path, heat, thickness_mm
        As for `kerfwise.models.physics.heat.simulate`; the grid is that of the mesh, three points to a cell.
    mesh
        Pieces, with all kerfs of the path.
    """

    def __init__(self, nest: Nest, path: TimedPath, heat: Heat, thickness_mm: float, mesh: Mesh) -> None:
        step_mm = mesh.h_mm / POINTS
        shape = (mesh.shape[0] * POINTS, mesh.shape[1] * POINTS)
        grid = Grid(
            mesh.x0_mm + step_mm / 2, mesh.y0_mm + step_mm / 2, step_mm, np.zeros(shape, dtype=np.bool_),
            np.full(shape, NO_PART, dtype=np.int32),
        )  # fmt: skip
        grid._mark(grid.metal, nest.sheet.polygon, True)
        self._metal = grid.metal
        self._at, self._slope = _readers(mesh, grid)
        moves = [np.hypot(*np.diff(burn.xy, axis=0).T).sum() / burn.seconds for burn in path.burns if burn.seconds > 0]
        longest_s = min(LONGEST_STEP_S, mesh.h_mm / 2 / max([1e-9, *moves]))
        self._sheet = SheetSimulation(grid, replace(heat, grid_mm=step_mm), thickness_mm, longest_s)
        self._events, self._ambient_c = events_of(path, grid), heat.ambient_c

    def at(self, when_s: float) -> tuple[Floats, Floats]:
        """Excess over the air (p,) in the middle of pieces, K, and its slope (p, 2), K over half a cell; never back."""
        self._sheet.run(self._events, when_s)
        excess = np.where(self._metal, self._sheet.temperature_c() - self._ambient_c, 0.0).ravel().astype(np.float64)
        return self._at @ excess, (self._slope @ excess).reshape(-1, 2)


def _readers(mesh: Mesh, grid: Grid) -> tuple[csr_matrix, csr_matrix]:
    """What makes of the points of a grid the temperature in the middle of every piece (p, ·) and its slopes (2p, ·).

    A straight fit through the points of a piece. A piece without points is as warm as those it hangs together with.
    The heat simulation counts metal in whole points: a web of 28 mm is two or three points of 12 mm wide to it, and so
    too warm or too cold, though the heat in it is right. So temperatures are scaled to keep the heat: by the metal that
    points stand for over that of the pieces, both summed over the `REACH` nearest pieces on the same side of kerfs.
    """
    point, piece = _owned(mesh, grid)
    i, j = np.divmod(point, grid.shape[1])
    xy = np.column_stack([grid.x0_mm + i * grid.step_mm, grid.y0_mm + j * grid.step_mm])
    at = mesh.local(piece, xy)
    n, size = len(mesh.cell), grid.shape[0] * grid.shape[1]
    own = csr_matrix((np.ones(len(piece)), (piece, np.arange(len(piece)))), shape=(n, len(piece)))
    count = np.bincount(piece, minlength=n)
    some = np.maximum(count, 1)
    middle = own @ at / some[:, None]
    off = at - middle[piece]
    spread = (own @ (off[:, :, None] * off[:, None, :]).reshape(-1, 4)).reshape(n, 2, 2)
    inverse = np.linalg.pinv(spread, rcond=0.02, hermitian=True)
    slopes = np.einsum("kab,kb->ka", inverse[piece], off)
    centre = mesh.moments[:, 1:3] / mesh.moments[:, :1] - middle
    value = 1.0 / some[piece] + (centre[piece] * slopes).sum(axis=1)
    read = csr_matrix((value, (piece, point)), shape=(n, size))
    rows = np.concatenate([2 * piece, 2 * piece + 1])
    slope = csr_matrix((slopes.T.ravel(), (rows, np.concatenate([point, point]))), shape=(2 * n, size))
    beside = _beside(mesh)
    for _ in range(REACH):
        known = np.diff(read.indptr) > 0
        links = beside @ diags(known.astype(float))
        total = np.maximum(np.asarray(links.sum(axis=1)).ravel(), 1.0)
        read = (read + diags(~known / total) @ links @ read).tocsr()
    held, metal = count * grid.step_mm**2, mesh.moments[:, 0]
    for _ in range(REACH):
        held, metal = beside @ held, beside @ metal
    share = held / metal
    return (diags(share) @ read).tocsr(), (diags(np.repeat(share, 2)) @ slope).tocsr()


def _owned(mesh: Mesh, grid: Grid) -> tuple[Ints, Ints]:
    """Pairs of a point of metal, flat, and the piece it lies in or, within a kerf, beside."""
    metal = np.flatnonzero(grid.metal.ravel())
    i, j = np.divmod(metal, grid.shape[1])
    flat = (i // POINTS) * mesh.shape[1] + j // POINTS
    only = mesh.count[flat] == 1
    piece = np.where(only, mesh.first[flat], -1)
    shared = mesh.count[flat] > 1
    xy = np.column_stack([grid.x0_mm + i[shared] * grid.step_mm, grid.y0_mm + j[shared] * grid.step_mm])
    piece[shared] = mesh.find(xy)
    return metal[piece >= 0], piece[piece >= 0]


def _beside(mesh: Mesh) -> csr_matrix:
    """1 where two pieces are one or share a face (p, p)."""
    n = len(mesh.cell)
    of = coo_matrix((np.ones(4 * n), (np.repeat(np.arange(n), 4), mesh.node.ravel())), shape=(n, mesh.nodes)).tocsr()
    return ((of @ of.T) >= len(CORNERS) / 2).astype(np.float64)


def points_of(lines: list[shapely.LineString], xy: Floats, within_mm: float) -> tuple[Ints, Ints]:
    """Pairs of a point (k, 2) and a line that it is near to."""
    if not lines or not len(xy):
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    point, line = shapely.STRtree(lines).query(shapely.points(xy), predicate="dwithin", distance=within_mm)
    return point.astype(np.int64), line.astype(np.int64)
