"""Temperatures of the heat simulation as the pieces of a mesh have them: in the middle of each, and their slope."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from scipy.sparse import coo_matrix, csr_matrix, diags

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.nest import Nest
from kerfwise.models.physics.heat import TimedPath
from kerfwise.models.physics.heat.physical import LONGEST_STEP_S, SheetSimulation
from kerfwise.models.physics.heat.timed_path import NO_PART, Grid, events_of
from kerfwise.rules.profile.plant_sections import Heat

from .mesh import CORNERS, Mesh

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
