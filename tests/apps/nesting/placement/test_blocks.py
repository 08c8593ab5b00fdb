"""Blocks with common edges: a kerf apart along straight edges, cut once by what solve makes of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely

from kerfwise.apps.nesting.find_nests import spacing_of, with_held
from kerfwise.apps.nesting.nests import nests_from
from kerfwise.apps.nesting.placement.blocks import places_beside, turns_to_try
from kerfwise.apps.nesting.placement.demand import Common, Demand, PartType, Spacing, Stock
from kerfwise.apps.nesting.placement.fill import Room, Taste, fill
from kerfwise.apps.nesting.placement.layout import Layout, Sheetful
from kerfwise.apps.nesting.placement.rounds import Effort, Patterns, best_layout
from kerfwise.apps.nesting.placement.shapes import Shapes
from kerfwise.apps.nesting.programs import planned
from kerfwise.benchmarks.nesting_lists import usable_area_mm2
from kerfwise.jobs.progress import Listener
from kerfwise.rule_kit import Part, Sheet, circle, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.sections import Common as CommonCuts
from kerfwise.rules.profile.sections import Cuts
from kerfwise.tests.apps.nesting.placement.random_lists import random_order
from kerfwise.tests.postproc.plans import with_tabs

PLATE = part("plate", rect(0, 0, 60, 30))
HALF = part("half", [(0, 0), (120, 0), (0, 90)], [circle(30, 30, 5)])
ROUND = part("round", circle(0, 0, 30))
COMMON = Common(0.2, 20.0)


def sizes(shape: Part, quantity: int) -> list[int]:
    """How many copies each block of a part has, the part itself last."""
    shapes = Shapes((PartType(shape.id, shape, quantity),), 2.2, COMMON)
    return [size for _, size in shapes.ways(0, blocks=True)]


def test_blocks_are_doubled_as_long_as_there_are_parts_for_them() -> None:
    assert sizes(PLATE, 14) == [8, 4, 2, 1]
    assert sizes(PLATE, 3) == [2, 1]
    assert sizes(ROUND, 8) == [1]


@pytest.mark.parametrize(("pitch_mm", "most"), [(60.0, 1), (10.0, 4)])
def test_parts_that_tabs_of_the_profile_hold_form_no_blocks(pitch_mm: float, most: int) -> None:
    """A plate of 60 × 30 mm tips over slats 60 mm apart, and lies safely on slats 10 mm apart."""
    profile = with_tabs("laser-st10kp-2mm", slat_pitch_mm=pitch_mm)
    kinds = with_held(Demand((PartType("plate", PLATE, 4),)), profile).types
    assert next(size for _, size in Shapes(kinds, 2.2, COMMON).ways(0, blocks=True)) == most


@pytest.mark.slow
def test_all_copies_of_a_block_hang_together() -> None:
    """Two pairs that meet at their tips alone are no block of four: nothing there is cut once."""
    asked, spacing = random_order(10)
    nested = nests_from(best_layout(asked, spacing, Effort(1, seed=10, method="pavlov")))
    assert spacing.common is not None
    assert nested.faults == ()


def test_two_triangles_are_a_kerf_apart_along_their_longest_side() -> None:
    shapes = Shapes((PartType("half", HALF, 2),), 2.2, COMMON)
    [number, *_] = [number for number, size in shapes.ways(0, blocks=True) if size == 2]
    one, other = (lying.area(HALF.outer.polygon) for lying in shapes.members((number, shapes.poses(number)[0]), 0, 0))
    assert shapely.distance(one, other) == pytest.approx(0.2, abs=2e-3)
    along = shapely.intersection(one.boundary, other.buffer(0.21)).length
    assert along == pytest.approx(150.0, abs=1.0)


def test_plates_a_kerf_apart_pass_the_check_and_take_few_pierces() -> None:
    plant = replace(load_profile("laser-st10kp-2mm"), cuts=Cuts(common=CommonCuts(shortest_mm=20.0)))
    wanted = Demand((PartType("plate", PLATE, 6),), (Stock("sheet", Sheet.rectangle(400, 200)),))
    nested = nests_from(best_layout(wanted, spacing_of(plant), Effort(1)))
    assert nested.faults == ()
    _, done, moved = planned(nested, 0, plant, 0.5, lambda name: Listener())
    assert moved == ""
    assert done.made.verdict.ok
    assert done.made.plan.totals.pierces == 2
    assert done.made.plan.totals.cut_mm < 6 * 180


def test_without_common_edges_the_check_refuses_parts_that_are_so_near() -> None:
    wanted = Demand((PartType("plate", PLATE, 4),), (Stock("sheet", Sheet.rectangle(300, 200)),))
    layout = best_layout(wanted, Spacing(2.2, 10.0, COMMON), Effort(1))
    assert nests_from(layout).faults == ()
    said = nests_from(replace(layout, spacing=Spacing(2.2, 10.0))).faults
    assert any("0.200 mm apart, and 2.2 mm were asked for" in fault for fault in said)
    longer = replace(layout, spacing=Spacing(2.2, 10.0, Common(0.2, 80.0)))
    assert nests_from(longer).faults


def test_what_is_left_of_a_block_is_laid_anew_where_a_copy_too_many_is_taken_off() -> None:
    """Three of these four hang together no more: two of them meet at a tip alone."""
    wanted = Demand((PartType("half", HALF, 7),), (Stock("sheet", Sheet.rectangle(145, 205)),))
    spacing = Spacing(2.2, 10.0, COMMON)
    shapes = Shapes(wanted.types, spacing.gap_mm, COMMON)
    patterns, stock = Patterns(wanted, shapes, spacing), wanted.stocks[0]
    placed = fill(Room(shapes, stock.sheet, spacing), [0], {0: 4}, Taste(blocks=True))
    patterns.add(Sheetful(stock, 0, tuple(placed)))
    assert nests_from(Layout(wanted, spacing, (Sheetful(stock, 0, tuple(placed[:3])),))).faults
    layout = patterns.cover(Layout(wanted, spacing, ()), 1)
    assert layout.missing == (0,)
    assert nests_from(layout).faults == ()


def test_blocks_lie_apart_from_each_other() -> None:
    wanted = Demand((PartType("plate", PLATE, 6),), (Stock("sheet", Sheet.rectangle(300, 200)),))
    layout = best_layout(wanted, Spacing(2.2, 10.0, COMMON), Effort(1))
    areas = np.array(layout.metal_of(layout.sheets[0]), dtype=object)
    apart = [float(areas[i].distance(areas[j])) for i in range(6) for j in range(i)]
    assert {mm < 0.3 for mm in apart} == {True, False}
    assert all(mm < 0.3 or mm > 2.19 for mm in apart)


TRIANGLE = shapely.Polygon([(0, 0), (40, 0), (0, 30)])
ELL = shapely.Polygon([(0, 0), (30, 0), (30, 10), (10, 10), (10, 30), (0, 30)])
SLAB = shapely.Polygon([(0, 0), (40, 0), (52, 20), (12, 20)])


def test_the_usable_area_is_that_of_the_paper() -> None:
    assert usable_area_mm2(100.0, 50.0, (10.0, 5.0), 0.5) == (100 - 20 + 0.5) * (50 - 10 + 0.5)


@pytest.mark.parametrize(
    ("one", "other", "area"),
    [
        (TRIANGLE, TRIANGLE, 1200.0),  # two triangles with a right angle make a rectangle
        (shapely.box(0, 0, 40, 20), shapely.box(0, 0, 20, 10), 1000.0),  # 50 × 20
        (shapely.box(0, 0, 40, 20), shapely.box(0, 0, 20, 40), 1600.0),  # turned, long side to long side
        (ELL, shapely.box(0, 0, 20, 20), 900.0),  # a square in the corner of an angle
        (SLAB, SLAB, 1840.0),  # slanted side to slanted side: 92 × 20
    ],
)
def test_the_least_rectangle_around_a_pair_is_exact(one: shapely.Polygon, other: shapely.Polygon, area: float) -> None:
    found = places_beside(one, other)[0]
    assert found.area_mm2 == pytest.approx(area, abs=1e-6)


def test_there_are_finitely_many_turns_and_none_twice() -> None:
    turns = turns_to_try(TRIANGLE, TRIANGLE)
    assert len(turns) == len(set(turns)) <= 3 * 3 + 4 * 3
    assert 180.0 in turns


@pytest.mark.parametrize("one", [TRIANGLE, ELL, SLAB])
@pytest.mark.parametrize("other", [TRIANGLE, ELL, SLAB])
def test_no_turn_in_between_gives_a_smaller_rectangle(one: shapely.Polygon, other: shapely.Polygon) -> None:
    best = places_beside(one, other)[0].area_mm2
    others = np.random.default_rng(5).uniform(0, 360, 40).tolist()
    assert places_beside(one, other, others)[0].area_mm2 >= best - 1e-6


def test_the_pair_touches_and_does_not_overlap() -> None:
    found = places_beside(ELL, SLAB)[0]
    c, s = np.cos(np.radians(found.turn_deg)), np.sin(np.radians(found.turn_deg))
    laid = shapely.transform(SLAB, lambda points: points @ np.array([[c, s], [-s, c]]) + found.shift)
    assert shapely.distance(ELL, laid) < 1e-6
    assert ELL.intersection(laid).area < 1e-3
    x0, y0, x1, y1 = shapely.union(ELL, laid).bounds
    assert (x1 - x0, y1 - y0) == pytest.approx((found.width_mm, found.height_mm), abs=1e-6)
