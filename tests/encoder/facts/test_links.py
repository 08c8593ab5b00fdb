"""Where links may run: between outers that stand side by side, through free waste, and none that meet."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from itertools import combinations
from typing import Literal

import numpy as np
import pytest
import shapely
from shapely.ops import substring

from kerfwise.encoder.candidates import LeadOptions, build_candidates
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.facts import FactOptions, compute_facts, links
from kerfwise.encoder.facts.facts import Facts, LinkPath
from kerfwise.encoder.facts.links import LinkOptions, with_links
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.rules.case import circle, nest, part, rect

KERF_MM = 1.5
A, B = part("A", rect(10, 10, 40, 40)), part("B", rect(62, 10, 40, 40))
PAIR = nest(400, 200, A, B)


def facts(sheet: Nest, longest_mm: float = 30.0, entries: int = 8) -> Facts:
    ways = build_candidates(sheet, LeadOptions(entries=entries, kerf_mm=KERF_MM))
    return with_links(compute_facts(sheet, FactOptions(), ways), LinkOptions(longest_mm, KERF_MM, 0.5))


def pairs(found: Facts) -> set[tuple[str, str]]:
    """The contours of every link."""
    names = [c.id for c in found.nest.contours]
    return {(names[_of(found, link.leave)], names[_of(found, link.reach)]) for link in found.links}


def _of(found: Facts, places: tuple[int, ...]) -> int:
    (contour,) = {found.candidates[c].contour for c in places}
    return contour


def line(link: LinkPath) -> shapely.LineString:
    return shapely.LineString(link.path)


@pytest.mark.parametrize(
    ("gap_mm", "linked"), [(KERF_MM, set()), (KERF_MM + 0.1, set()), (2 * KERF_MM, {"A", "B", "C"})]
)
def test_parts_a_kerf_from_another_have_no_links(gap_mm: float, linked: set[str]) -> None:
    """Not to a third one either: what their neighbour's cut has burnt of their ring would be burnt again."""
    third = part("C", rect(112 + gap_mm, 10, 40, 40))
    found = facts(nest(400, 200, A, part("B", rect(50 + gap_mm, 10, 40, 40)), third))
    assert {name[0] for pair in pairs(found) for name in pair} == linked


@pytest.mark.parametrize("web_mm", [2.0, 5.0, 12.0])
def test_no_link_runs_along_the_part_that_it_leads_to(web_mm: float) -> None:
    """In a row of equal parts, their edges in line: so are the rings that the torch follows."""
    row = nest(400, 200, *(part(f"P{k}", rect(10 + k * (20 + web_mm), 10, 20, 40)) for k in range(4)))
    found = facts(row, longest_mm=60.0, entries=12)
    assert found.links
    for link in found.links:
        target = found.nest.contours[_of(found, link.reach)]
        ring = shapely.buffer(target.polygon, KERF_MM / 2, join_style="mitre").exterior
        assert line(link).intersection(shapely.buffer(ring, 0.05)).length <= 2 * KERF_MM + 0.1


def test_neighbours_are_linked_both_ways_from_end_to_join() -> None:
    found = facts(PAIR)
    assert pairs(found) == {("A.outer", "B.outer"), ("B.outer", "A.outer")}
    for link in found.links:
        assert all(math.dist(found.candidates[c].end, link.path[0]) < 1e-9 for c in link.leave)
        assert all(math.dist(found.candidates[c].join, link.path[-1]) < 1e-9 for c in link.reach)
        assert link.length_mm <= 30


def test_none_is_longer_than_asked_and_none_is_asked_for() -> None:
    assert facts(PAIR, 10.0).links == ()
    assert facts(PAIR, 0.0).links == ()
    shortest = min(link.length_mm for link in facts(PAIR).links)
    assert 12 - KERF_MM < shortest < 12
    assert 0 < len(facts(PAIR, 12.0, 32).links) < len(facts(PAIR, 30.0, 32).links)


def test_every_link_keeps_off_metal_and_off_third_parts() -> None:
    row = nest(400, 200, A, B, part("C", rect(30, 58, 60, 30)), part("D", circle(56, 30, 3)))
    found = facts(row)
    assert found.links
    for link in found.links:
        ends = {_of(found, link.leave), _of(found, link.reach)}
        for k, contour in enumerate(row.contours):
            least = KERF_MM / 2 - 0.03 if k in ends else 1.5 * KERF_MM - 0.02
            assert contour.polygon.distance(line(link)) >= least


def test_a_part_in_between_shuts_the_way() -> None:
    wall = part("W", rect(54, 1, 4, 69))
    assert ("A.outer", "B.outer") not in pairs(facts(nest(400, 200, A, B, wall)))


def test_where_no_straight_link_is_free_one_goes_round_a_corner() -> None:
    """The only entry of each is at its lower right corner: straight on lies the whole of the other part's side."""
    found = facts(nest(400, 200, A, B, part("W", rect(54, 24, 4, 4))), 60.0, entries=1)
    bent = [link for link in found.links if len(link.path) == 3]
    assert ("A.outer", "B.outer") in pairs(replace(found, links=tuple(bent)))
    for link in bent:
        one, corner, other = link.path
        assert min(math.dist(one, corner), math.dist(corner, other)) > KERF_MM
        assert math.dist(one, other) ** 2 >= math.dist(one, corner) ** 2 + math.dist(corner, other) ** 2 - 1e-6
        assert link.length_mm <= 60
        assert all(c.polygon.distance(line(link)) >= KERF_MM / 2 - 0.03 for c in found.nest.contours)
        free = substring(line(link), KERF_MM, link.length_mm - KERF_MM)
        assert all(c.line.distance(free) >= KERF_MM - 0.02 for c in found.nest.contours)


def test_parts_with_a_straight_link_have_none_round_a_corner() -> None:
    assert all(len(link.path) == 2 for link in facts(PAIR).links)


def test_a_corner_takes_no_straight_link_away(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of links that would meet the straight ones stay, however short those round a corner are."""
    sheet = read_json(json.dumps(make_sheet(1, 40)).encode(), ReadOptions())
    both = {link.path for link in facts(sheet, 90.0).links}
    monkeypatch.setattr(links, "round_corners", lambda asked, straight, *_: straight.take(np.zeros(0, dtype=np.int64)))
    straight = {link.path for link in facts(sheet, 90.0).links}
    assert straight == {path for path in both if len(path) == 2}
    assert len(both) > len(straight)


def test_only_outers_in_the_same_metal_are_linked() -> None:
    host = part("H", rect(10, 10, 120, 80), [rect(20, 20, 100, 60)])
    inside = part("G", rect(26, 26, 30, 40)), part("K", rect(66, 26, 30, 40))
    beside = part("S", rect(140, 10, 40, 80))
    found = pairs(facts(nest(400, 200, host, *inside, beside)))
    assert ("G.outer", "K.outer") in found
    assert ("H.outer", "S.outer") in found
    assert not {pair for pair in found if "hole" in "".join(pair)}
    assert not {pair for pair in found if ("H.outer" in pair) and {"G.outer", "K.outer"} & set(pair)}


def test_a_link_leaves_the_kerf_behind_it_at_once() -> None:
    found = facts(PAIR)
    for link in found.links:
        ring = found.nest.contours[_of(found, link.leave)].polygon
        begun = line(link).interpolate(KERF_MM)
        assert ring.distance(begun) >= KERF_MM - 0.02


@pytest.mark.parametrize("lead_in", ["line", "none"])
def test_a_link_keeps_off_the_lead_out_of_what_it_reaches(lead_in: Literal["line", "none"]) -> None:
    ways = build_candidates(PAIR, LeadOptions(entries=8, kerf_mm=KERF_MM, lead=lead_in, lead_out="line"))
    found = with_links(compute_facts(PAIR, FactOptions(), ways), LinkOptions(60.0, KERF_MM))
    reached = [(link, ways[c].lead_out) for link in found.links for c in link.reach if ways[c].leaves]
    assert reached
    for link, lead_out in reached:
        assert lead_out is not None
        before = substring(line(link), 0.0, max(link.length_mm - KERF_MM, 0.0))
        assert before.distance(lead_out.line()) >= KERF_MM / 2 - 1e-6


def test_of_links_that_one_plan_could_use_no_two_meet() -> None:
    grid = nest(400, 300, *(part(f"P{k}", rect(10 + 52 * (k % 3), 10 + 52 * (k // 3), 40, 40)) for k in range(6)))
    found = facts(grid, 40.0)
    assert len(pairs(found)) > 10
    for one, other in combinations(found.links, 2):
        contours = [{_of(found, way.leave), _of(found, way.reach)} for way in (one, other)]
        if not contours[0] & contours[1]:
            assert line(one).distance(line(other)) >= KERF_MM


def test_leads_of_an_earlier_program_are_in_the_way() -> None:
    free = facts(PAIR)
    shortest = min(free.links, key=lambda link: link.length_mm)
    (x, y), _ = shortest.path
    slit = Curve.of([(56.0, y - 20), (56.0, y + 20)], closed=False)
    burnt = Cut("C.outer", (x, y), "cw", (56.0, y - 20), slit)
    left = with_links(compute_facts(PAIR, FactOptions(), free.candidates), LinkOptions(30.0, KERF_MM), [burnt])
    assert shortest.path not in [link.path for link in left.links]


def test_a_sheet_of_nothing_has_no_links() -> None:
    assert facts(nest(100, 100, part("A", rect(10, 10, 40, 40)))).links == ()
    assert with_links(compute_facts(PAIR, FactOptions(), ()), LinkOptions(30.0, KERF_MM)).links == ()
