"""Torch paths as DXF: GDAL, which nobody here has written, reads them as the plan has them."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pyogrio.raw
import pytest
import shapely

from kerfwise import Nest, Plan, Profile
from kerfwise.postproc.nc.ordered_drawings import LAYERS, write_dxf
from kerfwise.postproc.nc.toolpaths import toolpaths
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.postproc.dialects.reading import apart_mm
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile


def read(file: Path) -> tuple[list[str], list[shapely.LineString]]:
    """Layers and lines of a drawing, as GDAL reads it; it makes chords of arcs."""
    _, _, shapes, columns = pyogrio.raw.read(file, columns=["Layer"])
    return list(columns[0]), list(shapely.from_wkb(shapes))


def drawn(plan: Plan, nest: Nest, plant: Profile, folder: Path) -> tuple[list[str], list[shapely.LineString]]:
    (folder / "out.dxf").write_bytes(write_dxf(plan, nest, plant).encode())
    return read(folder / "out.dxf")


@pytest.mark.parametrize("origin", ["drawing", "sheet-corner"])
def test_gdal_reads_the_plans_paths_in_order(origin: str, tmp_path: Path) -> None:
    nest = plate()
    plant = profile(machine=dataclasses.replace(profile().machine, origin=origin))
    plan = dataclasses.replace(plan_of(nest, good_cuts(nest), plant), origin=origin)
    layers, lines = drawn(plan, nest, plant, tmp_path)
    assert layers == [LAYERS[nest.contour(planned.cut.contour).kind] for planned in plan.cuts]
    x, y = plant.frame_on(nest).corner
    for made, line in zip(toolpaths(plan, nest, plant), lines, strict=True):
        points = shapely.get_coordinates(line)
        path = made.path.moved(-x, -y)
        assert np.allclose(points[0], path.point_at(0.0), atol=1e-5)  # its direction is the cut's
        assert apart_mm(path, points.tolist()) < 0.05  # GDAL's chords of 4 degrees
        assert line.length == pytest.approx(path.length_mm, rel=1e-3)


def test_the_same_plan_gives_the_same_bytes() -> None:
    nest, plant = plate(), profile()
    plan = plan_of(nest, good_cuts(nest), plant)
    assert write_dxf(plan, nest, plant) == write_dxf(plan, nest, plant)


def test_a_damaged_drawing_is_told_apart(tmp_path: Path) -> None:
    nest, plant = plate(), profile()
    plan = plan_of(nest, good_cuts(nest), plant)
    turned = dataclasses.replace(plan, cuts=plan.cuts[::-1])
    assert drawn(turned, nest, plant, tmp_path)[0] != drawn(plan, nest, plant, tmp_path)[0]


def test_solve_writes_it_beside_the_others_and_protects_what_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.json").write_text(
        '{"format": "kerfwise-nest/1", "sheet": {"width": 200, "height": 120}, '
        '"parts": [{"id": "A", "outer": [[20, 30], [80, 30], [80, 90]]}]}'
    )
    done = kerfwise("solve", "a.json", "--work", 1, "--dxf", "a.dxf", "--plan", "a.plan.json")
    assert done.code == 0, done.err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.dxf", "a.json", "a.plan.json"]
    assert read(Path("a.dxf"))[0] == ["CUT_OUTER"]
    assert kerfwise("solve", "a.dxf", "--sheet", "200x120", "--dxf", "a.dxf").code == 2
    refused = kerfwise("solve", "a.json", "--dxf", "a.svg")
    assert (refused.code, "give a name ending in .dxf" in refused.err) == (2, True)
