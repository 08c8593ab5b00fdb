from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given

from kerfwise.arrays import Bools, Floats
from kerfwise.encoder.facts import FactOptions, compute_facts, neighbours
from kerfwise.encoder.facts.facts import SIDES, Facts
from kerfwise.encoder.facts.neighbours import CELLS_MIN, NOTHING, SPACING_MM, cells_of, outlook_of
from kerfwise.encoder.facts.outlines import outlines_of
from kerfwise.encoder.facts.relations import parents_of
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest, Sheet
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.tests.encoder.facts.random_nests import nests
from kerfwise.tests.tools.amount import examples


def facts_of(given_nest: Nest, **options: float) -> Facts:
    return compute_facts(given_nest, FactOptions(**options))  # type: ignore[arg-type]


def facing(facts: Facts) -> dict[tuple[str, str], tuple[float, float]]:
    """(part, neighbour) → rounded length and gap."""
    parts, near = [c.part for c in facts.nest.contours], facts.neighbours
    rows = zip(near.row, near.neighbour, near.length_mm, near.gap_mm, strict=True)
    return {(parts[i], parts[j]): (round(float(s), 2), round(float(g), 2)) for i, j, s, g in rows}


def edges(facts: Facts, contour_id: str) -> dict[str, float]:
    row = facts.edge_length_mm[facts.nest.index[contour_id]]
    return {side: round(float(v), 2) for side, v in zip(SIDES, row, strict=True) if v > 0}


def test_two_plates_face_each_other_the_edge_and_solid_metal() -> None:
    two = nest(400, 400, part("A", rect(10, 10, 80, 80)), part("B", rect(100, 10, 80, 60)))
    facts = facts_of(two)
    assert facing(facts) == {("A", "B"): (60, 10), ("B", "A"): (60, 10)}
    assert edges(facts, "A.outer") == {"left": 80, "bottom": 80}
    assert edges(facts, "B.outer") == {"bottom": 80}
    assert facts.solid_mm.tolist() == pytest.approx([80 + 20, 80 + 60])


@pytest.mark.parametrize(("gap", "near"), [(24.5, True), (25, True), (25.5, False)])
def test_how_far_a_neighbour_and_an_edge_may_be(gap: float, near: bool) -> None:
    # A 100 × 50 plate has 60 cells of 5 mm, so every side is a whole number of cells.
    parts = part("A", rect(gap, 100, 100, 50)), part("B", rect(2 * gap + 100, 100, 100, 50))
    facts = facts_of(nest(600, 300, *parts))
    assert facing(facts) == ({("A", "B"): (50, gap), ("B", "A"): (50, gap)} if near else {})
    assert edges(facts, "A.outer") == ({"left": 50} if near else {})
    facts = facts_of(nest(600, 300, *parts), web_mm=30, edge_band_mm=10)
    assert len(facing(facts)) == 2
    assert edges(facts, "A.outer") == {}


def test_what_stands_between_hides_what_is_behind() -> None:
    parts = part("A", rect(100, 100, 50, 50)), part("C", rect(165, 100, 50, 50))
    thin = part("B", rect(155, 100, 5, 25))
    found = facing(facts_of(nest(400, 400, *parts, thin)))
    assert found["A", "B"] == (25, 5)
    assert found["A", "C"] == (25, 15)


def test_touching_parts_are_neighbours_at_no_distance() -> None:
    found = facing(facts_of(nest(400, 400, part("A", rect(100, 100, 50, 50)), part("B", rect(150, 100, 50, 50)))))
    assert found == {("A", "B"): (50, 0), ("B", "A"): (50, 0)}


def test_a_part_in_a_hole_has_its_host_for_a_neighbour() -> None:
    host = part("H", rect(100, 100, 200, 200), [rect(120, 120, 160, 160)])
    facts = facts_of(nest(400, 400, host, part("G", rect(130, 130, 60, 60))))
    assert facing(facts) == {("G", "H"): (120, 10)}  # its left and lower side; the others are 90 mm away
    assert facts.solid_mm[facts.nest.index["G.outer"]] == pytest.approx(120)


def test_holes_and_marks_face_solid_metal() -> None:
    facts = facts_of(nest(400, 400, part("A", rect(10, 10, 80, 80), [rect(20, 20, 60, 60)], [[(12, 12), (15, 12)]])))
    assert facts.solid_mm.tolist() == pytest.approx([3, 240, 160])
    assert facts.edge_length_mm[:2].sum() == 0


def test_the_arms_of_one_part_do_not_make_it_its_own_neighbour() -> None:
    channel = [(100, 100), (200, 100), (200, 120), (120, 120), (120, 140), (200, 140), (200, 160), (100, 160)]
    facts = facts_of(nest(400, 400, part("A", channel)))
    assert facing(facts) == {}
    assert facts.solid_mm[0] == pytest.approx(facts.nest.contours[0].curve.length_mm)


def test_the_edge_of_a_hole_in_a_remnant_is_an_edge() -> None:
    sheet = Sheet(Curve.of(rect(0, 0, 400, 400)), (Curve.of(rect(100, 100, 100, 100)),))
    facts = facts_of(Nest(sheet, (part("A", rect(210, 100, 50, 50)), part("B", rect(300, 300, 50, 50)))))
    assert edges(facts, "A.outer") == {"left": 50}
    assert edges(facts, "B.outer") == {}
    turned = Sheet(sheet.outline.reversed(), (sheet.holes[0].reversed(),))
    assert edges(facts_of(Nest(turned, facts.nest.parts)), "A.outer") == {"left": 50}


def test_the_direction_a_contour_is_drawn_in_does_not_matter() -> None:
    a, b = rect(10, 10, 80, 80), rect(100, 10, 80, 60)
    forth = facts_of(nest(400, 400, part("A", a), part("B", b)))
    back = facts_of(nest(400, 400, part("A", a[::-1]), part("B", b[::-1])))
    assert facing(forth) == facing(back)
    assert np.allclose(forth.edge_length_mm, back.edge_length_mm)


def test_cells_cover_every_outer_contour_once() -> None:
    outlines = outlines_of(
        nest(900, 900, part("A", rect(0, 0, 700, 500), [circle(50, 50, 10)]), part("B", circle(800, 800, 9)))
    )
    cells = cells_of(outlines)
    total = np.bincount(cells.contour, weights=cells.length_mm, minlength=3)
    assert total.tolist() == pytest.approx([0, 2400, 56.549], abs=0.001)
    assert np.bincount(cells.contour).tolist() == [0, 2400 / SPACING_MM, CELLS_MIN]
    assert np.allclose(np.hypot(*cells.normal.T), 1)
    disc = cells.contour == 2
    assert np.allclose(cells.point[disc] - (800, 800), 9 * cells.normal[disc], atol=0.4)


@given(nests())
@examples(30)
def test_agrees_with_rays_cast_one_by_one(given_nest: Nest) -> None:
    """Each cell's normal is followed with shapely past every curve, and the nearest crossing must be what is faced."""
    outlines = outlines_of(given_nest)
    options = FactOptions()
    cells = cells_of(outlines)
    outlook = outlook_of(outlines, parents_of(outlines), given_nest.sheet, cells, options)
    curves = [(c.part, c.kind == "outer", c.line) for c in given_nest.contours if c.kind != "mark"]
    parts = [c.part for c in given_nest.contours]
    for k in range(0, len(cells.contour), 7):
        part_id, normal, start = parts[cells.contour[k]], cells.normal[k], cells.point[k]
        ray = shapely.LineString([start + 0.06 * normal, start + options.web_mm * normal])
        origin = shapely.Point(start)
        crossed = [
            (origin.distance(shapely.intersection(ray, line)), name)
            for name, is_outer, line in curves
            if ray.intersects(line) and (is_outer or name != part_id)
        ]
        if ray.intersects(given_nest.sheet.polygon.exterior):
            crossed.append((origin.distance(shapely.intersection(ray, given_nest.sheet.polygon.exterior)), "edge"))
        expected = min(crossed)[1] if crossed else "solid"
        faced = outlook.faces[k]
        got = "solid" if faced == NOTHING else "edge" if faced >= outlines.n else parts[faced]
        assert got == ("solid" if expected == part_id else expected)


def test_rays_are_intersected_a_few_boxes_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """A star of 2000 vertices has pairs of a ray and a piece for 2 GB of memory."""
    plate = nest(400, 400, *(part(f"P{k}", rect(10 + 60 * k, 10, 50, 300)) for k in range(5)))
    outlines = outlines_of(plate)
    asked = (outlines, parents_of(outlines), plate.sheet, cells_of(outlines), FactOptions())
    whole = outlook_of(*asked)
    pairs: list[int] = []
    plain = neighbours._crossings

    def counted(*given: object) -> tuple[Bools, Floats]:
        pairs.append(len(given[2]))  # type: ignore[arg-type]
        return plain(*given)  # type: ignore[arg-type]

    monkeypatch.setattr(neighbours, "_crossings", counted)
    monkeypatch.setattr(neighbours, "PAIRS_AT_ONCE", 200)
    assert outlook_of(*asked).faces.tolist() == whole.faces.tolist()
    assert len(pairs) > 10
    assert max(pairs) <= 200
