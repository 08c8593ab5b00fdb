"""What pieces of a mesh learn of the heat in the sheet."""

from __future__ import annotations

import numpy as np
import pytest

from kerfwise.apps.distortion.cutting import Warmth
from kerfwise.apps.distortion.elasticity import yielded
from kerfwise.apps.distortion.mesh import make_mesh
from kerfwise.models.physics.heat.timed_path import in_order, torch_on
from kerfwise.rules.profile.plant_sections import MATERIALS

from .sheets import HEAT, centroids, rectangle, sheet_of


@pytest.mark.parametrize("h_mm", [12.0, 15.0, 20.0, 24.0, 28.0])
def test_a_web_between_two_cuts_keeps_the_heat_that_both_put_in(h_mm: float) -> None:
    """27 mm wide, however many points of the heat simulation that is: half of each cut's energy, and all of both."""
    nest = sheet_of(rectangle(0, 0, 600, 300))
    ways = [(np.array([[0.0, y], [600.0, y]]), float(k)) for k, y in enumerate((101.0, 130.0))]
    path = in_order([torch_on("", way, begin_s, begin_s + 1) for way, begin_s in ways], 2.0)
    mesh = make_mesh(nest, path, h_mm, 2.0)
    excess, _ = Warmth(nest, path, HEAT, 10.0, mesh).at(10.0)
    joules = excess * mesh.moments[:, 0] * MATERIALS[HEAT.material].capacity_j_mm3 * 10.0
    y = centroids(mesh)[:, 1]
    web = (y > 102) & (y < 129)
    assert mesh.moments[web, 0].sum() == pytest.approx(27 * 600)
    one = HEAT.absorbed_power_w * 1.0
    assert joules[web].sum() == pytest.approx(one, rel=0.06)
    assert joules.sum() == pytest.approx(2 * one, rel=0.06)


def test_a_band_never_pulls_with_more_than_the_metal_bears() -> None:
    """The metal is at its yield stress to half the width at most, and less beyond: Okerblom's triangle and more."""
    for material, thickness_mm, watts, feed in (
        ("carbon-steel", 20.0, 3300.0, 355 / 60),
        ("stainless-steel", 6.0, 1300.0, 30.0),
        ("aluminium-amg3m", 1.0, 300.0, 100.0),
    ):
        band = yielded(material, thickness_mm, watts, feed)
        most = {"carbon-steel": 235, "stainless-steel": 210, "aluminium-amg3m": 80}[material]
        assert 0.3 < -band.at_last_n / (most * thickness_mm * band.width_mm) < 1.0
        assert band.pull_n.max() <= 0.0
        assert 0 < band.depth_mm < band.width_mm


def test_twice_the_heat_makes_the_band_twice_as_wide() -> None:
    one, two = (yielded("carbon-steel", 10.0, watts, 10.0) for watts in (1000.0, 2000.0))
    assert two.width_mm == pytest.approx(2 * one.width_mm, rel=1e-6)
    assert two.at_last_n == pytest.approx(2 * one.at_last_n, rel=1e-6)
