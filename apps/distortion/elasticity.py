"""Plane-stress thermo-elasticity of the pieces of a mesh: stiffness, loads, and displacements while ties open.

Four-node squares. Normal strains are integrated exactly over the metal of a piece (they are linear, so that its area
moments to the second order say all); the shear strain is that of the cell's middle, which keeps narrow strips from
being too stiff (selective reduced integration, Hughes 1980). The slats hold by friction, which at 20 mm of steel is a
thousand times weaker than what heat does: it only settles where the sheet as a whole lies. It resists each movement a
little and forgets it: a weak ground spring (`GROUND`) whose rest is where the metal lay before.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources

import numpy as np
import yaml
from scipy.linalg import cho_solve, cholesky
from scipy.sparse import coo_matrix, csc_matrix
from scipy.sparse.linalg import splu

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.errors import InputError
from kerfwise.rules.profile.plant_sections import MATERIALS

from .mesh import CORNERS, Mesh, components

AT_ONCE = 4
"""Right-hand sides that are solved at a time: with more of them BLAS begins threads, which on a busy machine wait for
each other three times as long as they work."""
GROUND = 1e-10
"""Stiffness of the ground under a whole cell, as a share of Young's modulus times the thickness."""


@dataclass(frozen=True, slots=True)
class Elastic:
    """Young's modulus, N/mm²; Poisson's ratio; expansion, 1/K; thickness, mm."""

    modulus_n_mm2: float
    poisson: float
    expansion_1_k: float
    thickness_mm: float

    @property
    def membrane_n_mm(self) -> float:
        """Modulus times thickness, N/mm."""
        return self.modulus_n_mm2 * self.thickness_mm


class Elasticity:
    """Stiffness and loads of a mesh.

    Parameters
    ----------
    mesh
        Pieces, nodes and ties.
    law
        Of the metal.
    """

    def __init__(self, mesh: Mesh, law: Elastic) -> None:
        self.mesh, self.law = mesh, law
        self._stiffness = _stiffness(mesh, law)

    def thermal(self, excess_k: Floats, slope_k: Floats | None = None) -> Floats:
        """Nodal forces (n, 2), N, of pieces that are so many kelvins warmer in their middle (p,) than when cold.

        `slope_k` (p, 2) is how many kelvins warmer they get over half a cell along x and along y.
        """
        mesh, law = self.mesh, self.law
        m, (sx, sy) = mesh.moments, CORNERS.T
        area, x, y = m[:, 0], m[:, 1], m[:, 2]
        all_, over_x, over_y = area * excess_k, x * excess_k, y * excess_k
        if slope_k is not None:
            xx, xy, yy = m[:, 3] - x * x / area, m[:, 4] - x * y / area, m[:, 5] - y * y / area
            over_x = over_x + slope_k[:, 0] * xx + slope_k[:, 1] * xy
            over_y = over_y + slope_k[:, 0] * xy + slope_k[:, 1] * yy
        along_x = sx * (all_[:, None] + sy * over_y[:, None])
        along_y = sy * (all_[:, None] + sx * over_x[:, None])
        side = law.membrane_n_mm * law.expansion_1_k / (1 - law.poisson) / (2 * mesh.h_mm)
        return self._gather(side * np.stack([along_x, along_y], axis=2))

    def line_loads(self, piece: Ints, xy: Floats, along: Floats) -> csc_matrix:
        """Matrix (2n, k) of the nodal forces of a unit of pull, N·mm, along a direction at points (k, 2) of pieces.

        A pull of 1 N over a length of 1 mm: what a fibre that wants to be longer does to the metal that holds it.
        """
        mesh = self.mesh
        at = mesh.local(piece, xy)
        sx, sy = CORNERS.T
        bx = sx * (1 + sy * at[:, 1:]) / (2 * mesh.h_mm)
        by = sy * (1 + sx * at[:, :1]) / (2 * mesh.h_mm)
        shear_x, shear_y = sx / (2 * mesh.h_mm), sy / (2 * mesh.h_mm)
        tx, ty = along[:, :1], along[:, 1:]
        fx, fy = tx * tx * bx + tx * ty * shear_y, ty * ty * by + tx * ty * shear_x
        rows = (2 * mesh.node[piece][:, :, None] + np.arange(2)).reshape(-1)
        columns = np.repeat(np.arange(len(piece)), 8)
        values = np.stack([fx, fy], axis=2).reshape(-1)
        return coo_matrix((values, (rows, columns)), shape=(2 * mesh.nodes, len(piece))).tocsc()

    def _gather(self, forces: Floats) -> Floats:
        node, n = self.mesh.node.ravel(), self.mesh.nodes
        return np.column_stack([np.bincount(node, forces[:, :, c].ravel(), n) for c in (0, 1)])

    def state(self, joined: Ints, keep: Bools) -> State:
        """The sheet with nodes (n,) that are joined as numbered, and of it only the pieces that `keep` (p,) names."""
        return State(self, joined, keep)


class State:
    """The stiffness of a sheet as it hangs together at a time, factorised.

    `number` (n,) is the place of every node among the unknowns, -1 for those of pieces that are left out.
    """

    def __init__(self, elastic: Elasticity, joined: Ints, keep: Bools) -> None:
        mesh = elastic.mesh
        node = joined[mesh.node[keep]]
        used, dense = np.unique(node, return_inverse=True)
        dense = dense.reshape(node.shape)
        place = np.full(int(joined.max(initial=0)) + 1, -1, dtype=np.int64)
        xy = np.zeros((len(used), 2))
        xy[dense] = mesh.node_xy()[mesh.node[keep]]
        order = dissected(xy)
        rank = np.empty(len(order), dtype=np.int64)
        rank[order] = np.arange(len(order))
        place[used] = rank
        self.number = place[joined]
        dof = (2 * rank[dense][:, :, None] + np.arange(2)).reshape(-1, 8)
        size = 2 * len(used)
        values = elastic._stiffness[keep].ravel()
        rows, columns = np.repeat(dof, 8, axis=1).ravel(), np.tile(dof, (1, 8)).ravel()
        share = np.repeat(mesh.moments[keep, 0] / 4 / mesh.h_mm**2, 4)
        under = np.bincount(rank[dense].ravel(), share, len(used)) * (GROUND * elastic.law.membrane_n_mm)
        self.ground: Floats = np.repeat(under, 2)
        diagonal = np.arange(size)
        rows, columns = np.concatenate([rows, diagonal]), np.concatenate([columns, diagonal])
        values = np.concatenate([values, self.ground])
        self.matrix = coo_matrix((values, (rows, columns)), shape=(size, size)).tocsc()
        self._factor = splu(
            self.matrix, permc_spec="NATURAL", diag_pivot_thresh=0, options={"SymmetricMode": True}
        )  # fmt: skip
        self.size = size

    def load(self, forces: Floats, rest: Floats) -> Floats:
        """The right-hand side (2u,) of nodal forces (n, 2) on a sheet that lies at rest at displacements (n, 2)."""
        known = self.number >= 0
        at = self.number[known]
        total = np.zeros(self.size)
        for c in (0, 1):
            total[c::2] = np.bincount(at, forces[known, c], self.size // 2)
        lies = np.zeros(self.size)
        for c in (0, 1):
            lies[2 * at + c] = rest[known, c]
        total += self.ground * lies
        return total

    def solve(self, loads: Sequence[Floats], ties: Ints, open_: Sequence[float]) -> list[Floats]:
        """Displacements (2u,), mm, under each load, while the first so many of ties are open and the others hold.

        Where a tie is half open, the displacements are those half way between it open and not.

        Ties (m, 2) are pairs of nodes, in the order in which they open, and a forest: they are held by forces between
        their nodes, found from what a unit of each force does (a factor is used for as many states as there are ties).
        """
        one, other = self.number[ties[:, 0]], self.number[ties[:, 1]]
        m = len(ties)
        pulls = np.zeros((self.size, 2 * m))
        for c in (0, 1):
            pulls[2 * one + c, 2 * np.arange(m) + c] = 1.0
            pulls[2 * other + c, 2 * np.arange(m) + c] = -1.0
        asked = np.column_stack([pulls, *loads])
        free = np.hstack([self._factor.solve(asked[:, k : k + AT_ONCE]) for k in range(0, asked.shape[1], AT_ONCE)])
        gives, free = free[:, : 2 * m], free[:, 2 * m :]
        if not m:
            return list(free.T)
        gap = np.empty((2 * m, gives.shape[1]))
        off = np.empty((2 * m, free.shape[1]))
        for c in (0, 1):
            gap[c::2] = gives[2 * one + c] - gives[2 * other + c]
            off[c::2] = free[2 * one + c] - free[2 * other + c]
        # Last to open first: whatever still holds is then a leading block of one Cholesky factor.
        last = np.arange(2 * m).reshape(m, 2)[::-1].ravel()
        lower = cholesky((gap + gap.T)[np.ix_(last, last)] / 2, lower=True)

        def holding(k: int, opened: int) -> Floats:
            held = 2 * (m - opened)
            block, rows = lower[:held, :held], last[:held]
            force = np.zeros(2 * m)
            force[rows] = cho_solve((block, True), off[rows, k])
            return force

        forces = np.zeros_like(off)
        for k, opened in enumerate(open_):
            whole = int(opened)
            forces[:, k] = at = holding(k, whole)
            if opened != whole:
                forces[:, k] += (opened - whole) * (holding(k, whole + 1) - at)
        return list((free - gives @ forces).T)

    def spread(self, found: Floats, before: Floats) -> Floats:
        """Displacements (n, 2) of all nodes: those found (2u,), and those before of nodes that are left out."""
        known = self.number >= 0
        every: Floats = before.copy()
        every[known] = found.reshape(-1, 2)[self.number[known]]
        return every


def bodies(mesh: Mesh, joined: Ints) -> Ints:
    """The number of the body that each piece (p,) belongs to while nodes are joined so."""
    node = joined[mesh.node]
    pairs = np.concatenate([np.column_stack([node[:, 0], node[:, k]]) for k in (1, 2, 3)])
    body: Ints = components(int(joined.max(initial=0)) + 1, pairs)[node[:, 0]]
    return body


def shape_weights(at: Floats) -> Floats:
    """The shares (k, 4) of a cell's corners in the displacement of points (k, 2) in its coordinates."""
    sx, sy = CORNERS.T
    shares: Floats = (1 + sx * at[:, :1]) * (1 + sy * at[:, 1:]) / 4
    return shares


def dissected(xy: Floats, least: int = 24) -> Ints:
    """The order of points (n, 2) by nested dissection: halves first, what parts them last (George 1973).

    A sheet's factor then has a tenth to a fifth fewer numbers than by minimum degree, and many right-hand sides at
    once take two thirds of the time.
    """
    order = np.empty(len(xy), dtype=np.int64)
    waiting = [(np.arange(len(xy)), 0)]
    while waiting:
        points, low = waiting.pop()
        span = np.ptp(xy[points], axis=0) if len(points) else np.zeros(2)
        if len(points) <= least or not span.any():
            order[low : low + len(points)] = points
            continue
        value = xy[points, int(span[1] > span[0])]
        middle = np.partition(value, len(value) // 2)[len(value) // 2]
        below, above, on = points[value < middle], points[value > middle], points[value == middle]
        order[low + len(below) + len(above) : low + len(points)] = on
        waiting += [(below, low), (above, low + len(below))]
    return order


def _stiffness(mesh: Mesh, law: Elastic) -> Floats:
    """Stiffness (p, 8, 8) of the pieces, N/mm; unknowns are x and y of corner 0, of corner 1, and so on."""
    sx, sy = CORNERS.T
    nu = law.poisson
    one = np.ones(4)
    #        1        ξ           η           of ∂N/∂x and ∂N/∂y, times 2h
    of_x, of_y = (sx, 0 * one, sx * sy), (sy, sx * sy, 0 * one)
    pairs = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
    basis = np.zeros((6, 8, 8))
    for number, (i, j) in enumerate(pairs):
        for a, b in {(i, j), (j, i)}:
            basis[number, 0::2, 0::2] += np.outer(of_x[a], of_x[b])
            basis[number, 1::2, 1::2] += np.outer(of_y[a], of_y[b])
            basis[number, 0::2, 1::2] += nu * np.outer(of_x[a], of_y[b])
            basis[number, 1::2, 0::2] += nu * np.outer(of_y[a], of_x[b])
    basis *= law.membrane_n_mm / (1 - nu**2) / (4 * mesh.h_mm**2)
    shear = np.zeros(8)
    shear[0::2], shear[1::2] = sy, sx
    shear_part = law.membrane_n_mm / (2 * (1 + nu)) * np.outer(shear, shear) / (4 * mesh.h_mm**2)
    moments: Floats = mesh.moments
    found: Floats = np.einsum("pm,mij->pij", moments, basis)
    found += moments[:, 0, None, None] * shear_part
    return found


@dataclass(frozen=True, slots=True)
class Metal:
    """One row of `metals.yaml`: modulus and yield stress, N/mm², expansion, 1/K, what heat leaves of both."""

    modulus: float
    poisson: float
    expansion: float
    yield_: float
    at_c: tuple[float, ...]
    of_modulus: tuple[float, ...]
    of_yield: tuple[float, ...]
    source: str

    def elastic(self, thickness_mm: float) -> Elastic:
        """A sheet of it."""
        return Elastic(self.modulus, self.poisson, self.expansion, thickness_mm)


def _read() -> Mapping[str, Metal]:
    text = (resources.files(__package__) / "metals.yaml").read_text(encoding="utf-8")
    return {
        name: Metal(**{("yield_" if key == "yield" else key): value for key, value in row.items()})
        for name, row in yaml.safe_load(text).items()
    }


METALS: Mapping[str, Metal] = _read()


def metal_of(material: str) -> Metal:
    """The metal of that name. Raises InputError if its strength is not known."""
    if material not in METALS:
        raise InputError(
            f"heat.material: {material} has no modulus, expansion and yield stress here, so that nobody can tell how "
            f"it bends: simulate one of {', '.join(METALS)}"
        )
    return METALS[material]


@dataclass(frozen=True, eq=False, slots=True)
class Band:
    """One side of a cut: what it pulls with, N, in excess of an elastic sheet, `since_s` (k,) after the torch passed.

    Never more than 0: what has yielded wants to be shorter. `depth_mm` is how far from the edge the pull acts at the
    end, `width_mm` how wide the band is that keeps a strain.
    """

    since_s: Floats
    pull_n: Floats
    depth_mm: float
    width_mm: float

    def pull(self, since_s: Floats) -> Floats:
        """What it pulls with, N, so long after the torch passed (any shape): 0 before, what is left at `inf`."""
        found = np.interp(since_s, self.since_s, self.pull_n)
        found[since_s <= 0] = 0.0
        return found

    @property
    def at_last_n(self) -> float:
        """What is left when all is cold, N."""
        return float(self.pull_n[-1])


@lru_cache(maxsize=256)
def yielded(material: str, thickness_mm: float, absorbed_w: float, feed_mm_s: float) -> Band:
    """The band beside a cut at a feed, with so many watts staying in the sheet.

    Examples
    --------
    >>> band = yielded("carbon-steel", 20.0, 3300.0, 355 / 60)
    >>> round(band.at_last_n / 1000), round(band.width_mm)
    (-59, 19)
    """
    metal, data = metal_of(material), MATERIALS[material]
    energy = absorbed_w / feed_mm_s / thickness_mm  # J/mm², half of it on each side
    yields_k = metal.yield_ / metal.modulus / metal.expansion
    reach_mm = max(energy / data.capacity_j_mm3 / math.sqrt(2 * math.pi * math.e) / yields_k, 1e-6)
    edges = np.concatenate([[0.0], np.geomspace(reach_mm / 100, 4 * reach_mm, 160)])
    d_mm, width = (edges[1:] + edges[:-1]) / 2, np.diff(edges)
    spreads = data.diffusivity_mm2_s
    since = np.geomspace((reach_mm / 100) ** 2 / spreads, 4e4 * reach_mm**2 / spreads, 600)
    plastic, pulls = np.zeros(len(d_mm)), [0.0]
    for at_s in since:
        excess = energy / data.capacity_j_mm3 / math.sqrt(4 * math.pi * spreads * at_s)
        warm = np.minimum(excess * np.exp(-(d_mm**2) / (4 * spreads * at_s)), data.melting_c - 20.0)
        modulus = np.maximum(metal.modulus * np.interp(20.0 + warm, metal.at_c, metal.of_modulus), 1e-3 * metal.modulus)
        most = metal.yield_ * np.interp(20.0 + warm, metal.at_c, metal.of_yield)
        stress = -modulus * (metal.expansion * warm + plastic)
        held = np.clip(stress, -most, most)
        plastic += (stress - held) / modulus
        pulls.append(-thickness_mm * float(((held + metal.modulus * metal.expansion * warm) * width).sum()))
    # What is warm still is so all over: only the plastic strain stays for ever.
    pulls[-1] = thickness_mm * metal.modulus * float((plastic * width).sum())
    kept = -plastic * width
    depth = float((kept * d_mm).sum() / kept.sum()) if kept.sum() > 0 else 0.0
    wide = float(edges[1:][plastic < -1e-6].max(initial=0.0))
    return Band(np.concatenate([[0.0], since]), np.minimum(np.array(pulls), 0.0), depth, wide)
