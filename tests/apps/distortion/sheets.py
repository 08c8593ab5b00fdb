"""Sheets, parts and torch paths for the tests of distortion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kerfwise import Nest
from kerfwise.apps.distortion.elasticity import Elastic, Elasticity
from kerfwise.apps.distortion.mesh import Mesh, make_mesh
from kerfwise.arrays import Floats
from kerfwise.models.physics.heat import TimedPath
from kerfwise.models.physics.heat.timed_path import in_order, torch_on
from kerfwise.rule_kit import Contour, Curve, Part, Sheet
from kerfwise.rules.profile.plant_sections import Heat

STEEL = Elastic(210_000.0, 0.3, 12e-6, 10.0)
HEAT = Heat(absorbed_power_w=2000.0, loss_w_m2k=0.0)
NO_PATH = in_order([], 0.0)
FEED_MM_S = 10.0


def rectangle(x0: float, y0: float, x1: float, y1: float) -> list[tuple[float, float]]:
    """Corners, counter-clockwise from the lower left."""
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def part(name: str, *rings: Sequence[tuple[float, float]]) -> Part:
    """A part of an outer ring and holes."""
    outer, *holes = rings
    return Part(
        name,
        Contour(f"{name}.outer", name, "outer", Curve.of(outer)),
        tuple(Contour(f"{name}.hole{k}", name, "hole", Curve.of(hole)) for k, hole in enumerate(holes, 1)),
    )


def sheet_of(ring: Sequence[tuple[float, ...]], *parts: Part) -> Nest:
    """A nest on a sheet of any outline."""
    return Nest(Sheet(Curve.of(ring)), parts)


def around(nest: Nest, *contours: str, pause_s: float = 5.0, kerf_mm: float = 2.0) -> TimedPath:
    """The torch once round each contour, in this order, from its first vertex on, beside it by half the kerf."""
    now_s, burns = 0.0, []
    for name in contours:
        contour = nest.contour(name)
        out = kerf_mm / 2 if contour.kind == "outer" else -kerf_mm / 2
        ring = contour.polygon.buffer(out, join_style="mitre").exterior
        points = np.asarray(ring.coords)[::-1] if contour.kind == "outer" else np.asarray(ring.coords)
        first = int(np.argmin(np.hypot(*(points[:-1] - contour.curve.vertices[0, :2]).T)))
        points = np.concatenate([points[first:-1], points[: first + 1]])
        length = float(np.hypot(*np.diff(points, axis=0).T).sum())
        now_s += pause_s
        burns.append(torch_on(name, points, now_s, now_s + length / FEED_MM_S))
        now_s += length / FEED_MM_S
    return in_order(burns, now_s)


def shape_under(
    nest: Nest, excess_k: Floats | float, h_mm: float, slope_k: Floats | None = None
) -> tuple[Mesh, Elasticity, Floats]:
    """An uncut sheet warmer by so much, piece by piece: the displacements (n, 2) of its nodes."""
    mesh = make_mesh(nest, NO_PATH, h_mm, 2.0)
    made = Elasticity(mesh, STEEL)
    rest = np.zeros((mesh.nodes, 2))
    forces = made.thermal(np.zeros(len(mesh.cell)) + excess_k, slope_k)
    state = made.state(mesh.joined(0.0), np.ones(len(mesh.cell), dtype=np.bool_))
    (found,) = state.solve([state.load(forces, rest)], mesh.ties, [0])
    return mesh, made, state.spread(found, rest)


def centroids(mesh: Mesh) -> Floats:
    """Of the pieces (p, 2), mm."""
    middles: Floats = mesh.centres() + mesh.moments[:, 1:3] / mesh.moments[:, :1] * mesh.h_mm / 2
    return middles


def curvature(xy: Floats, u: Floats, y_mm: float, within_mm: float, x_mm: tuple[float, float]) -> float:
    """Of the line at a height, by the sideways displacement of the nodes near it, 1/mm; positive where it bulges up."""
    near = (np.abs(xy[:, 1] - y_mm) < within_mm) & (xy[:, 0] > x_mm[0]) & (xy[:, 0] < x_mm[1])
    x = xy[near, 0]
    fit = np.linalg.lstsq(np.column_stack([np.ones(len(x)), x, x**2]), u[near, 1], rcond=None)[0]
    return float(-2 * fit[2])
