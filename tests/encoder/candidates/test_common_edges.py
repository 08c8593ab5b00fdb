"""Which straight edges two parts have in common, and the ways along what neighbours leave of a contour."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely

from kerfwise.encoder.candidates import LeadOptions, build_candidates
from kerfwise.encoder.candidates.candidate import Candidate, CommonOptions
from kerfwise.encoder.candidates.common_edges import CommonEdges, common_edges
from kerfwise.encoder.candidates.common_paths import _in_mouths
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.outlines import outlines_of
from kerfwise.encoder.facts.relations import hull_pairs, parents_of
from kerfwise.encoder.geometry.tolerances import tolerance_mm
from kerfwise.encoder.nest import Nest, Part
from kerfwise.encoder.torch_path import compensated
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.tests.metal.common_nests import grid

KERF_MM = 1.5
ASKED = CommonOptions(20.0, 0.05)
OPTIONS = LeadOptions(kerf_mm=KERF_MM, entries=2, common=ASKED)


def edges(sheet: Nest, asked: CommonOptions = ASKED) -> CommonEdges:
    return common_edges(sheet, range(len(sheet.contours)), KERF_MM, asked)


def shared(sheet: Nest, asked: CommonOptions = ASKED) -> dict[tuple[str, str], list[float]]:
    """Names of neighbours → how long their common edges are."""
    names = [c.part for c in sheet.contours]
    return {
        (names[one], names[other]): [round(mm, 3) for _, mm in rows]
        for one, beside in edges(sheet, asked).of.items()
        for other, rows in beside.items()
        if one < other
    }


def two(gap_mm: float, turned: float = 0.0, up_mm: float = 0.0, high_mm: float = 60.0) -> Nest:
    """A, and B to its right, turned about its lower left corner by so many degrees."""
    c, s = math.cos(math.radians(turned)), math.sin(math.radians(turned))
    rows = [
        (100 + gap_mm + x * c - y * s, 30 + up_mm + x * s + y * c)
        for x, y in [(0, 0), (80, 0), (80, high_mm), (0, high_mm)]
    ]
    return nest(300, 200, part("A", rect(20, 30, 80, 60)), part("B", rows))


@pytest.mark.parametrize(
    ("sheet", "found"),
    [
        (two(1.5), [60.0]),
        (two(1.54), [60.0]),
        (two(1.46), [60.0]),
        (two(1.6), None),
        (two(1.4), None),
        (two(0.0), None),
        (two(1.5, up_mm=25), [35.0]),
        (two(1.5, up_mm=45), None),
        (two(1.5, high_mm=19), None),
        (two(1.5, turned=0.03), [60.0]),
        (two(1.5, turned=0.3), None),
    ],
)
def test_two_edges_are_common_where_they_are_a_kerf_apart(sheet: Nest, found: list[float] | None) -> None:
    assert shared(sheet) == ({} if found is None else {("A", "B"): found})


def test_a_part_in_a_hole_and_its_host_have_no_common_edges() -> None:
    host = part("H", rect(20, 20, 160, 160), [rect(40, 40, 120, 120)])
    guests = [part("A", rect(41.5, 60, 50, 80)), part("B", rect(93, 60, 50, 80))]
    assert shared(nest(200, 200, host, *guests)) == {("A", "B"): [80.0]}


def test_round_edges_are_none() -> None:
    assert shared(nest(300, 200, part("A", circle(60, 60, 40)), part("B", circle(141.5, 60, 40)))) == {}


def test_one_long_edge_makes_short_ones_count_that_hang_together_with_it() -> None:
    """Else a short edge would be cut twice, by two ways along stretches."""
    three = nest(300, 300, *two(1.5).parts, part("C", rect(90, 91.5, 80, 60)))
    assert shared(three) == {("A", "B"): [60.0], ("A", "C"): [10.0], ("B", "C"): [68.5]}
    assert shared(three, CommonOptions(70.0, 0.05)) == {}


def test_a_round_edge_a_kerf_away_keeps_a_group_from_common_cuts() -> None:
    """Its neighbour, cut along a stretch, would burn there twice."""
    assert shared(nest(400, 300, *two(1.5).parts, part("C", circle(60, 131.5, 40)))) == {}
    assert shared(nest(400, 300, *two(1.5).parts, part("C", circle(60, 133, 40)))) == {("A", "B"): [60.0]}


def filleted(name: str, x: float, radius: float) -> Part:
    """A rectangle of 80 × 160 whose left corners are round."""
    b, r = -math.tan(math.pi / 8), radius
    rows = [(x + r, 30, b), (x, 30 + r), (x, 190 - r, b), (x + r, 190), (x + 80, 190), (x + 80, 30)]
    return part(name, rows)


def test_beside_a_large_fillet_a_way_begins_where_the_two_kerfs_part() -> None:
    """Up to there one burn covers both rings, though the drawn edge is no longer straight."""
    sheet = nest(300, 230, part("A", rect(20, 30, 80, 160)), filleted("B", 101.5, 60))
    (way,) = [c for c in ways(sheet, "B") if c.out and c.direction == "cw"]
    assert way.span is not None
    (x, y) = way.span.begin
    assert 0.03 < x - 100.75 <= 0.045
    assert 132 < y < 133


def beside_an_inner_corner(turn: float, kerf_mm: float) -> Nest:
    """A, and L, which bends round it by so many degrees, a kerf away on both sides."""
    bend = math.radians(180 - turn)
    along, up = np.array([1.0, 0.0]), np.array([math.cos(bend), math.sin(bend)])
    below, left = np.array([0.0, -1.0]), np.array([-up[1], up[0]])
    outwards = (below + left) / (1 + below @ left)
    corner = np.array([150.0, 60.0])
    inner, outer = corner + kerf_mm * outwards, corner + (kerf_mm + 25) * outwards
    bent = [inner, inner + 60 * up, inner + 60 * up + 25 * left, outer, inner + 60 * along + 25 * below]
    a = [corner, corner + 60 * along, corner + 60 * (along + up), corner + 60 * up]
    rows = [[(float(x), float(y)) for x, y in each] for each in (a, [*bent, inner + 60 * along])]
    return nest(300, 200, part("A", rows[0]), part("L", rows[1]))


@pytest.mark.parametrize(("turn", "kerf_mm"), [(90, 1.5), (90, 0.3), (45, 1.5), (30, 3.0), (100, 0.2)])
def test_ways_part_at_an_inner_corner(turn: float, kerf_mm: float) -> None:
    """The cut round the outer corner does not reach into it, though both ways are one again right behind it."""
    sheet = beside_an_inner_corner(turn, kerf_mm)
    found = common_edges(sheet, [0, 1], kerf_mm, ASKED)
    cut = [compensated(contour, kerf_mm) for contour in sheet.contours]
    for one, other in ((0, 1), (1, 0)):
        line = cut[other].line(0.001)
        for begin_mm, mm in found.of[one][other]:
            beside = cut[one].between(begin_mm, mm).line(0.001)
            far_mm = shapely.distance(line, shapely.points(shapely.get_coordinates(shapely.segmentize(beside, 0.01))))
            assert far_mm.max() <= tolerance_mm(kerf_mm)


@pytest.mark.parametrize("depth_mm", [0.01, 0.04, 0.06, 2.0])
def test_what_common_cuts_take_for_a_mouth_the_fact_does(depth_mm: float) -> None:
    """A shallow notch in a large plate, and a strip half a kerf from its floor."""
    notch = [(400, 500), (400, 500 - depth_mm), (600, 500 - depth_mm), (600, 500)]
    plate = part("P", [(0, 0), (1000, 0), (1000, 500), *reversed(notch), (0, 500)])
    sheet = nest(1100, 700, plate, part("S", [(450, 500 - depth_mm / 2), (550, 500 - depth_mm / 2), (500, 500)]))
    outlines = outlines_of(sheet)
    pairs = hull_pairs(outlines, parents_of(outlines)).tolist()
    assert pairs == ([[1, 0]] if depth_mm > 0.05 else [])
    assert [[j, i] for i, before in _in_mouths(sheet, [0, 1]).items() for j in before] == pairs


def ways(sheet: Nest, name: str, options: LeadOptions = OPTIONS) -> list[Candidate]:
    number = sheet.index[f"{name}.outer"]
    return [c for c in build_candidates(sheet, options) if c.contour == number]


def test_a_rectangle_among_four_has_twelve_states_with_a_way_each_direction() -> None:
    """Thirteen with all neighbours in, in which nothing leads to it; not with two opposite, and not with all out."""
    found = ways(grid(3, 3, KERF_MM), "P5")
    assert len(found) == 24
    assert len({c.out for c in found}) == 12
    assert {c.direction for c in found} == {"cw", "ccw"}
    assert all(set(c.out) | set(c.still_in) == {f"P{k}.outer" for k in (2, 4, 6, 8)} for c in found)
    assert sorted(len(c.out) for c in found) == [1] * 8 + [2] * 8 + [3] * 8


def test_a_way_runs_from_one_old_kerf_to_the_other() -> None:
    (found,) = [c for c in ways(two(1.5), "B") if c.out and c.direction == "cw"]
    assert found.span is not None
    assert found.span.begin == pytest.approx((100.75, 90))
    assert found.span.end == found.end == pytest.approx((100.75, 30))
    assert found.lead_in is None
    assert found.cut_mm == pytest.approx(80 + 60 + 80 + math.pi * KERF_MM)
    assert found.along_mm == pytest.approx(220)
    assert found.unpierced
    assert (found.out, found.still_in) == (("A.outer",), ())


def test_all_round_only_while_all_neighbours_are_in() -> None:
    assert {c.still_in for c in ways(two(1.5), "B") if c.span is None} == {("A.outer",)}


def test_where_three_parts_meet_the_second_goes_straight_on_into_the_kerf_of_the_first() -> None:
    """A has B and C beside it, which are a kerf apart: what lies between them on A's ring is cut with one of them."""
    tee = nest(300, 300, part("B", rect(20, 30, 80, 60)), part("C", rect(20, 91.5, 80, 60)),
               part("A", rect(101.5, 30, 80, 121.5)))  # fmt: skip
    (way,) = [
        c for c in ways(tee, "C") if c.out == ("B.outer",) and c.still_in == ("A.outer",) and c.direction == "ccw"
    ]
    assert way.lead_in is not None
    assert way.lead_in.vertices[:, :2].tolist() == [pytest.approx([100.75, 90]), pytest.approx([100.75, 91.5])]
    assert way.pierce == pytest.approx((100.75, 90))
    (last,) = [c for c in ways(tee, "A") if c.out == ("B.outer", "C.outer") and c.direction == "cw"]
    assert last.span is not None
    assert (last.span.begin, last.span.end) == (pytest.approx((100.75, 151.5)), pytest.approx((100.75, 30)))


def test_ways_do_not_depend_on_how_a_part_is_drawn() -> None:
    drawn = two(1.5)
    turned = [replace(p, outer=replace(p.outer, curve=p.outer.curve.reversed())) for p in drawn.parts]
    one, other = (
        sorted(
            (c.direction, np.round(c.pierce, 6).tolist(), np.round(c.end, 6).tolist())
            for c in ways(sheet, "B")
            if c.out
        )
        for sheet in (drawn, replace(drawn, parts=tuple(turned)))
    )
    assert one == other


def test_without_room_for_one_lead_there_is_no_plan() -> None:
    """All four parts are walled in by others, a kerf and a bit away, that no edge is common with."""
    inner = [part(f"P{k}", rect(60 + 51.5 * (k % 2), 60 + 51.5 * (k // 2), 50, 50)) for k in range(4)]
    sides = [rect(30, 30, 28, 133.5), rect(60, 30, 133.5, 28), rect(163.5, 60, 30, 133.5), rect(30, 163.5, 131.5, 28)]
    walls = [part(f"W{k}", side) for k, side in enumerate(sides)]
    with pytest.raises(InputError) as error:
        build_candidates(nest(300, 300, *inner, *walls), replace(OPTIONS, pierce_clearance_mm=1.5))
    assert error.value.message == "of parts that are cut with common edges none can be pierced"
    assert error.value.details[0].startswith(
        "P0.outer and those that it has edges in common with: no lead to any of them"
    )
