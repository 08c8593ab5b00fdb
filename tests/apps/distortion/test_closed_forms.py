"""Sheets whose shape a formula gives."""

from __future__ import annotations

import numpy as np
import pytest

from kerfwise.apps.distortion.elasticity import Elasticity
from kerfwise.apps.distortion.mesh import make_mesh

from .sheets import NO_PATH, STEEL, centroids, curvature, rectangle, shape_under, sheet_of

STRIP = sheet_of(rectangle(0, 0, 1000, 100))
ALPHA = STEEL.expansion_1_k


def test_a_sheet_that_is_warm_all_over_grows_and_keeps_its_shape() -> None:
    nest = sheet_of([(0, 0), (900, 30), (700, 400), (100, 350)])
    mesh, _, u = shape_under(nest, 100.0, 40.0)
    used = np.unique(mesh.node)
    grown = u[used] - ALPHA * 100 * mesh.node_xy()[used]
    assert np.abs(grown - grown.mean(axis=0)).max() < 2e-4  # of 1.1 mm


@pytest.mark.parametrize("h_mm", [25.0, 17.0, 12.5])
def test_a_strip_that_is_warmer_towards_one_edge_bends_as_a_beam(h_mm: float) -> None:
    mesh = make_mesh(STRIP, NO_PATH, h_mm, 2.0)
    per_mm = 2.0  # kelvins a mm
    slope = np.tile([0.0, per_mm * h_mm / 2], (len(mesh.cell), 1))
    mesh, _, u = shape_under(STRIP, per_mm * (centroids(mesh)[:, 1] - 50), h_mm, slope)
    bent = curvature(mesh.node_xy(), u, 50.0, h_mm, (100.0, 900.0))
    assert bent == pytest.approx(ALPHA * per_mm, rel=1.3 * (h_mm / 100) ** 2)


def test_a_strip_heated_along_one_edge_bends_as_beam_theory_says() -> None:
    """The layer above y = 80 is 100 K warmer: the moment of its blocked force over the stiffness, E t cancelled."""
    mesh = make_mesh(STRIP, NO_PATH, 5.0, 2.0)
    middle = centroids(mesh)[:, 1]
    hot = np.clip((middle + 2.5 - 80) / 5, 0, 1) * 100.0
    mesh, _, u = shape_under(STRIP, hot, 5.0)
    layer = float((hot * mesh.moments[:, 0]).sum()) / 1000
    arm = float((hot * mesh.moments[:, 0] * (middle - 50)).sum() / (hot * mesh.moments[:, 0]).sum())
    beam = ALPHA * layer * arm / (100**3 / 12)
    assert curvature(mesh.node_xy(), u, 50.0, 5.0, (200.0, 800.0)) == pytest.approx(beam, rel=0.02)


@pytest.mark.parametrize("lower_mm", [30.0, 50.0, 70.0])
def test_a_bimetal_bends_as_timoshenko_says(lower_mm: float) -> None:
    """Timoshenko 1925, equal moduli: κ = 6 Δα ΔT (1 + m)² / (h (3 (1 + m)² + (1 + m) (m² + 1 / m)))."""
    mesh = make_mesh(STRIP, NO_PATH, 5.0, 2.0)
    upper = np.array([max(0.0, b[3] - max(b[1], lower_mm)) / (b[3] - b[1]) for b in (p.bounds for p in mesh.polygon)])
    mesh, _, u = shape_under(STRIP, 50.0 * upper, 5.0)
    m = lower_mm / (100 - lower_mm)
    bent = 6 * ALPHA * 50 * (1 + m) ** 2 / (100 * (3 * (1 + m) ** 2 + (1 + m) * (m**2 + 1 / m)))
    assert curvature(mesh.node_xy(), u, 50.0, 5.0, (200.0, 800.0)) == pytest.approx(bent, rel=0.02)


def test_a_disc_with_a_hot_middle_grows_as_the_formula_says() -> None:
    """u(b) = 2 α / b ∫ T r dr for a free disc of radius b, and inside u(r) by Timoshenko & Goodier, article 150."""
    b, a, warm = 200.0, 80.0, 100.0
    disc = sheet_of([(b, 0.0, 1.0), (-b, 0.0, 1.0)])
    mesh = make_mesh(disc, NO_PATH, 8.0, 2.0)
    near = centroids(mesh)
    hot = np.where(np.hypot(near[:, 0], near[:, 1]) < a, warm, 0.0)
    mesh, _, u = shape_under(disc, hot, 8.0)
    area = float((hot * mesh.moments[:, 0]).sum()) / warm / np.pi  # a², as the pieces have it
    xy = mesh.node_xy()
    r = np.hypot(xy[:, 0], xy[:, 1])
    outward = (u * xy).sum(axis=1) / np.maximum(r, 1e-9)
    rim = (r > b - 8) & (r < b)
    nu = STEEL.poisson

    def formula(at: np.ndarray) -> np.ndarray:
        return ALPHA * warm * area / 2 * ((1 + nu) / at + (1 - nu) * at / b**2)

    assert (outward[rim] / formula(r[rim])).mean() == pytest.approx(1.0, rel=0.01)
    ring = (r > a + 16) & (r < b - 16)
    assert np.abs(outward[ring] / formula(r[ring]) - 1).max() < 0.03


def test_forces_of_heat_balance_and_their_work_is_the_energy_of_the_strains() -> None:
    nest = sheet_of([(0, 0), (900, 30), (700, 400), (100, 350)])
    mesh = make_mesh(nest, NO_PATH, 30.0, 2.0)
    made = Elasticity(mesh, STEEL)
    hot = 200 * np.exp(-(((centroids(mesh) - (300, 200)) / 120) ** 2).sum(axis=1))
    forces = made.thermal(hot)
    xy = mesh.node_xy()
    size = np.abs(forces).sum()
    assert np.abs(forces.sum(axis=0)).max() < 1e-12 * size
    assert abs((xy[:, 0] * forces[:, 1] - xy[:, 1] * forces[:, 0]).sum()) < 1e-9 * size * 900
    state = made.state(mesh.joined(0.0), np.ones(len(mesh.cell), dtype=np.bool_))
    load = state.load(forces, np.zeros((mesh.nodes, 2)))
    (u,) = state.solve([load], mesh.ties, [0])
    assert load @ u == pytest.approx(u @ (state.matrix @ u), rel=1e-6)


def test_a_comparison_with_a_formula_can_fail() -> None:
    mesh, _, u = shape_under(STRIP, 100.0, 25.0)
    assert curvature(mesh.node_xy(), u, 50.0, 25.0, (100.0, 900.0)) == pytest.approx(0.0, abs=1e-9)
