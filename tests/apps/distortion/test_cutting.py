"""Sheets that are cut: what hangs together when, and what must not matter."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from kerfwise.apps.distortion.cutting import Cutting, cut_sheet
from kerfwise.apps.distortion.elasticity import Elasticity, bodies
from kerfwise.apps.distortion.mesh import make_mesh
from kerfwise.apps.distortion.part_errors import errors_of
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.models.physics.heat import TimedPath, TorchOn
from kerfwise.models.physics.heat.timed_path import in_order
from kerfwise.rules.profile.plant_sections import Heat

from .sheets import HEAT, STEEL, around, part, rectangle, sheet_of

HOW = Cutting(grid_mm=15.0, kerf_mm=2.0, thickness_mm=10.0, yields=False)


def two_parts(dx: float = 0.0, dy: float = 0.0) -> Nest:
    """A strip along the lower edge and a plate with a hole beside it."""

    def moved(ring: list[tuple[float, float]]) -> list[tuple[float, float]]:
        return [(x + dx, y + dy) for x, y in ring]

    return sheet_of(
        moved(rectangle(0, 0, 600, 300)),
        part("strip", moved(rectangle(20, 15, 560, 75))),
        part("plate", moved(rectangle(40, 110, 300, 280)), moved(rectangle(100, 160, 180, 220))),
    )


ORDER = ("strip.outer", "plate.hole1", "plate.outer")


def worst(nest: Nest, path: TimedPath, how: Cutting = HOW) -> dict[str, float]:
    found = errors_of(nest, cut_sheet(nest, path, HEAT, how))
    return {error.part: error.max_mm or 0.0 for error in found}


@cache
def as_drawn(yields: bool = False) -> dict[str, float]:
    """The error of each of the two parts where several tests look from."""
    here = two_parts()
    return worst(here, around(here, *ORDER), replace(HOW, yields=yields))


def test_pieces_have_all_the_metal_but_the_kerf() -> None:
    nest = two_parts()
    path = around(nest, *ORDER)
    mesh = make_mesh(nest, path, 15.0, 2.0)
    kerf = shapely.union_all([shapely.LineString(burn.xy).buffer(1.0) for burn in path.burns])
    metal = nest.sheet.polygon.difference(kerf).area
    assert mesh.moments[:, 0].sum() == pytest.approx(metal, rel=1e-3)
    assert mesh.moments[:, 0] == pytest.approx(shapely.area(mesh.polygon), rel=1e-9)


def test_a_part_hangs_on_until_the_torch_has_come_round() -> None:
    nest = two_parts()
    path = around(nest, *ORDER)
    mesh = make_mesh(nest, path, 15.0, 2.0)

    def count(at_s: float) -> int:
        return len(np.unique(bodies(mesh, mesh.joined(at_s))))

    ends = [float(burn.at_s[-1]) for burn in path.burns]
    assert [count(-1.0), *(count(end) for end in ends)] == [1, 2, 3, 4]
    assert count(ends[0] - 3.0) == 1
    strip = mesh.part == 0
    assert mesh.moments[strip, 0].sum() == pytest.approx(540 * 60, rel=2e-3)


@pytest.mark.parametrize("opened", [0, 7, 20])
def test_ties_hold_as_if_the_metal_were_whole(opened: int) -> None:
    """A factor of the sheet that is cut through, with forces in the ties, against one of the sheet as it hangs."""
    nest = two_parts()
    mesh = make_mesh(nest, around(nest, "strip.outer"), 15.0, 2.0)
    if opened:  # several open at once
        opened = int(np.searchsorted(mesh.opens_s, mesh.opens_s[opened - 1], side="right"))
    made = Elasticity(mesh, STEEL)
    at = mesh.centres()
    forces, rest = made.thermal(np.exp(-(((at - (150, 60)) / 50) ** 2).sum(axis=1)) * 100), np.zeros((mesh.nodes, 2))
    every = np.ones(len(mesh.cell), dtype=np.bool_)
    through = made.state(mesh.joined(np.inf), every)
    factor, widths = through._factor, []
    through._factor = SimpleNamespace(solve=lambda asked: widths.append(asked.shape[1]) or factor.solve(asked))
    (one,) = through.solve([through.load(forces, rest)], mesh.ties, [opened])
    assert max(widths) <= 4, "BLAS begins threads"
    hanging = made.state(mesh.joined(mesh.opens_s[opened - 1] if opened else -1.0), every)
    (other,) = hanging.solve([hanging.load(forces, rest)], mesh.ties[:0], [0])
    a, b = through.spread(one, rest), hanging.spread(other, rest)
    assert np.abs(a - b).max() < 1e-5 * np.abs(b).max()


def test_a_cold_torch_cuts_true() -> None:
    nest = two_parts()
    cold = HEAT.__class__(absorbed_power_w=0.0)
    for yields in (True, False):
        found = errors_of(nest, cut_sheet(nest, around(nest, *ORDER), cold, Cutting(15.0, 2.0, 10.0, yields)))
        assert all(error.max_mm == pytest.approx(0.0, abs=1e-9) for error in found)


def test_twice_the_heat_is_twice_the_error_while_nothing_yields() -> None:
    nest = two_parts()
    once = errors_of(nest, cut_sheet(nest, around(nest, *ORDER), HEAT, HOW))
    twice = HEAT.__class__(absorbed_power_w=2 * HEAT.absorbed_power_w, loss_w_m2k=0.0)
    for one, two in zip(once, errors_of(nest, cut_sheet(nest, around(nest, *ORDER), twice, HOW)), strict=True):
        assert one.max_mm is not None
        assert one.max_mm > 0.01
        assert two.max_mm == pytest.approx(2 * one.max_mm, rel=1e-3)


@pytest.mark.parametrize("yields", [False, True])
def test_it_does_not_matter_where_the_sheet_lies(yields: bool) -> None:
    how = Cutting(15.0, 2.0, 10.0, yields)
    there = two_parts(1234.5, -678.9)
    assert as_drawn(yields) == pytest.approx(worst(there, around(there, *ORDER), how), rel=1e-4)


def mirrored(nest: Nest, path: TimedPath) -> tuple[Nest, TimedPath]:
    """Left for right about x = 300."""
    rings = {c.id: [(600 - x, y) for x, y, _ in c.curve.vertices.tolist()][::-1] for c in nest.contours}
    turned = sheet_of(
        rectangle(0, 0, 600, 300), *(part(p.id, *(rings[c.id] for c in (p.outer, *p.holes))) for p in nest.parts)
    )
    burns = tuple(burn.__class__(burn.contour, burn.xy * (-1, 1) + (600, 0), burn.at_s) for burn in path.burns)
    return turned, TimedPath(burns, path.end_s)


def test_the_mirror_image_is_off_by_as_much() -> None:
    nest = two_parts()
    path = around(nest, *ORDER)
    a, b = as_drawn(), worst(*mirrored(nest, path))
    assert a["strip"] == pytest.approx(b["strip"], rel=0.06)
    assert a["plate"] == pytest.approx(b["plate"], rel=0.06)


def test_a_strip_cut_from_its_free_edge_on_stays_straighter() -> None:
    """The rule of part rigidity: what is cut last ties the strip to the sheet, and should be the sheet's heavy side."""
    nest = two_parts()
    path = around(nest, "strip.outer")
    back = path.burns[0]
    turned = TimedPath(
        (back.__class__(back.contour, back.xy[::-1], back.at_s[-1] + back.at_s[0] - back.at_s[::-1]),), path.end_s
    )
    ends = {name: worst(nest, p)["strip"] for name, p in (("one way", path), ("the other", turned))}
    assert max(ends.values()) > 1.5 * min(ends.values())


def test_wood_has_no_strength_here() -> None:
    nest = two_parts()
    wood = HEAT.__class__(material="plywood")
    with pytest.raises(InputError, match="plywood has no modulus"):
        cut_sheet(nest, around(nest, *ORDER), wood, HOW)


@pytest.mark.full
@pytest.mark.slow
def test_two_torches_at_one_time_are_as_one_of_twice_the_power_that_is_now_here_now_there() -> None:
    """In turns of a second; and quite unlike one torch that cuts one plate and then the other."""
    ring = rectangle(40, 30, 250, 260)
    nest = sheet_of(rectangle(0, 0, 600, 300), part("A", ring), part("B", [(x + 310, y) for x, y in ring]))
    (burn,) = around(nest, "A.outer").burns
    other, end_s = burn.by(2, "B.outer", (310.0, 0.0)), float(burn.at_s[-1])
    together = rms_mm(nest, in_order([burn, other], end_s))
    turns = rms_mm(nest, in_turns(burn, other, 1.0), replace(HEAT, absorbed_power_w=2 * HEAT.absorbed_power_w))
    later = replace(other, at_s=other.at_s + end_s, torch=1)
    one_by_one = rms_mm(nest, in_order([burn, later], 2 * end_s))
    assert together == pytest.approx(turns, rel=0.15)
    assert together["B"] > 1.5 * one_by_one["B"]


def rms_mm(nest: Nest, path: TimedPath, heat: Heat = HEAT) -> dict[str, float]:
    return {error.part: error.rms_mm or 0.0 for error in errors_of(nest, cut_sheet(nest, path, heat, HOW))}


def in_turns(one: TorchOn, other: TorchOn, turn_s: float) -> TimedPath:
    """One torch, twice as fast: what the one burns in so many seconds, then what the other burns in them, and so on."""
    ends_s, burns = np.arange(one.at_s[0], one.at_s[-1], turn_s).tolist(), []
    for low_s, high_s in pairwise([*ends_s, float(one.at_s[-1])]):
        for number, burn in enumerate((one, other)):
            inner = burn.at_s[(burn.at_s > low_s) & (burn.at_s < high_s)]
            at_s = np.concatenate([[low_s], inner, [high_s]])
            xy = np.column_stack([np.interp(at_s, burn.at_s, column) for column in burn.xy.T])
            burns.append(TorchOn(burn.contour, xy, low_s + (number * (high_s - low_s) + at_s - low_s) / 2))
    return in_order(burns, float(one.at_s[-1]))
