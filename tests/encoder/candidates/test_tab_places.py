"""Where tabs are put: on straights away from corners, beside metal that stays, far from each other and from entries."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.candidates import LeadOptions, build_candidates
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.cut import CutSequence, Tab
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.torch_path import TabOptions, tips
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.catalogue.hold_small_parts import HoldSmallPartsOptions
from kerfwise.rules.registry import RULES
from kerfwise.tests.tools.amount import examples

ASKED = TabOptions("all", 0.6, 2, 3.0, 60.0, "y", at_end=False)
LEADS = LeadOptions(kerf_mm=0.4, lead_in_mm=4.0, tabs=ASKED)


def ways(drawn: Nest, **more: Any) -> tuple[Candidate, ...]:
    return build_candidates(drawn, replace(LEADS, tabs=replace(ASKED, **more)))


def test_two_tabs_of_a_plate_lie_opposite_each_other() -> None:
    found = ways(nest(200, 200, part("A", rect(50, 50, 60, 40))))
    assert {tuple(tab.at for tab in way.tabs) for way in found} == {((80.0, 50.0), (80.0, 90.0))}
    around_mm = 2 * (60 + 40) + math.tau * 0.2
    leads = [way.lead_in.length_mm for way in found if way.lead_in is not None]
    assert [way.cut_mm for way in found] == pytest.approx([mm + around_mm - 2 * (0.6 + 0.4) for mm in leads], abs=1e-3)


def test_a_part_that_fills_its_sheet_has_no_metal_to_be_held_by() -> None:
    with pytest.raises(InputError, match="no room for a tab"):
        ways(nest(60, 40, part("A", rect(0, 0, 60, 40))))


def test_tabs_of_a_disc_lie_opposite_each_other() -> None:
    (first, second) = ways(nest(200, 200, part("A", circle(100, 100, 30))))[0].tabs
    assert math.dist(first.at, second.at) > 55


def test_entries_keep_off_tabs() -> None:
    for way in ways(nest(200, 200, part("A", rect(50, 50, 60, 40)))):
        assert all(math.dist(way.entry, tab.at) >= 2.5 - 1e-9 for tab in way.tabs)


def test_no_tab_where_a_neighbour_leaves_no_metal() -> None:
    drawn = nest(300, 200, part("A", rect(50, 50, 60, 40)), part("B", rect(50, 91.5, 60, 40)))
    tabs = {tab.at for way in ways(drawn) for tab in way.tabs}
    assert all(not 89 < y < 92.5 for _, y in tabs)


@pytest.mark.parametrize("direction", ["cw", "ccw"])
def test_at_the_end_the_torch_stops_before_its_tab(direction: str) -> None:
    found = [w for w in ways(nest(200, 200, part("A", rect(50, 50, 60, 40))), at_end=True) if w.direction == direction]
    assert found
    for way in found:
        (tab,) = way.tabs
        assert way.lead_in is not None
        join = way.lead_in.end
        assert math.dist(way.end, join) == pytest.approx(1.0, abs=1e-6)
        assert math.dist(way.entry, tab.at) == pytest.approx(0.5, abs=1e-6)
        assert not way.leaves
        assert min(abs(tab.at[0] - x) + abs(tab.at[1] - y) for x in (50, 110) for y in (50, 90)) > 3


def test_a_locked_entry_keeps_its_place_and_the_tabs_give_way() -> None:
    drawn = nest(200, 200, part("A", rect(50, 50, 60, 40)))
    found = build_candidates(drawn, replace(LEADS, entry_points={"A.outer": (80.0, 50.0)}))
    assert any(way.entry == pytest.approx((80.0, 50.0)) for way in found)
    assert all(math.dist(tab.at, (80, 50)) > 2 for way in found for tab in way.tabs)


def test_every_part_without_room_is_named() -> None:
    tiny = nest(200, 200, *(part(name, rect(x, 20, 5, 5)) for name, x in (("A", 20), ("B", 60))))
    with pytest.raises(InputError) as error:
        ways(tiny)
    assert error.value.message == "2 parts have no room for tabs (rules.hold-small-parts)"
    assert [line.partition(":")[0] for line in error.value.details] == ["A.outer", "B.outer"]


def test_drawn_tabs_come_first() -> None:
    drawn = nest(200, 200, replace(part("A", rect(50, 50, 60, 40)), tabs=(Tab((70, 50.2), 0.9),)))
    assert {way.tabs for way in ways(drawn)} == {(Tab((70.0, 50.0), 0.9),)}


def test_who_may_tip() -> None:
    leaning = part("A", [(0, 0), (200, 0), (200, 10), (50, 10), (50, 200), (0, 200)])
    assert tips(leaning.polygon, 60, "y") is not None
    assert tips(part("A", rect(0, 0, 200, 20)).polygon, 60, "y") is None
    assert tips(part("A", rect(0, 0, 200, 20)).polygon, 60, "x") is not None


def _offered(drawn: Nest, leads: LeadOptions) -> tuple[Candidate, ...]:
    """The ways to cut a nest, none where it has no room for them."""
    try:
        return build_candidates(drawn, leads)
    except InputError:
        return ()


@examples(30)
@given(
    st.lists(st.tuples(st.integers(12, 90), st.integers(12, 90)), min_size=1, max_size=5),
    st.booleans(),
    st.sampled_from(["tipping", "all"]),
    st.sampled_from([0.4, 1.0, 3.0]),
    st.sampled_from([0.5, 3.0]),
)
def test_what_is_offered_the_rule_has_nothing_against(
    sizes: list[tuple[int, int]], at_end: bool, choose: str, width: float, corner: float
) -> None:
    parts = [part(f"P{k}", rect(20 + 110 * k, 20, w, h)) for k, (w, h) in enumerate(sizes)]
    drawn = nest(40 + 110 * len(sizes), 150, *parts)
    rule = RULES["hold-small-parts"]
    options = HoldSmallPartsOptions(
        tabs=choose,
        width_mm=width,
        corner_mm=corner,
        kerf_mm=0.4,
        process="plasma" if at_end else "laser",  # type: ignore[arg-type]
    )
    leads = rule.lead_options(replace(LEADS, tabs=None), options, "hard")
    for way in _offered(drawn, leads):
        cuts = CutSequence((way.as_cut(drawn.contours[way.contour].id),))
        assert rule.violations(drawn, cuts, options) == []


def test_a_part_without_any_place_for_a_tab_at_the_end_is_refused() -> None:
    """All round there is less metal than tabs want, so that no place is left to ask about."""
    close = [part(name, rect(50 + 40.5 * k, 50, 40, 40)) for k, name in enumerate("ABC")]
    rows = [part(f"{k}{j}", rect(9.5 + 40.5 * j, 50 + 40.5 * k, 40, 40)) for k in (-1, 1) for j in range(5)]
    drawn = nest(300, 200, *close, *rows)
    with pytest.raises(InputError, match="room"):
        ways(drawn, at_end=True)


@pytest.mark.slow
@pytest.mark.parametrize("lead", ["line", "arc"])
def test_no_lead_in_leans_over_a_tab_at_the_end(lead: str) -> None:
    """Streets of 5 mm, in which a straight lead-in has no room everywhere."""
    grid = [part(f"{i}{j}", rect(20 + 45 * i, 20 + 45 * j, 40, 40)) for i in range(3) for j in range(3)]
    options = replace(LEADS, kerf_mm=1.5, lead=lead, tabs=replace(ASKED, width_mm=1.0, at_end=True), entries=6)
    found = build_candidates(nest(300, 300, *grid), options)
    for way in found:
        assert way.lead_in is not None
        gap_mm = shapely.distance(shapely.Point(way.end), way.lead_in.line()) - 1.5
        assert gap_mm >= 1.0 - 0.05


def test_no_tab_where_a_scrap_line_ends() -> None:
    """Lines that end at each side of a square, at its middle, where its tabs would be."""
    square = part("A", rect(50, 50, 60, 60))
    lines = [[(80, 0), (80, 49)], [(80, 111), (80, 200)], [(0, 80), (49, 80)], [(111, 80), (200, 80)]]
    for way in ways(nest(200, 200, square, scrap=lines)):
        assert all(min(math.dist(tab.at, line[k]) for line in lines for k in (0, 1)) > 1.5 for tab in way.tabs)


def test_no_tab_hangs_on_the_waste_of_a_notch_that_a_neighbour_closes() -> None:
    """A slot of 3 mm into A, whose mouth lies in the kerf of B: the strip in it falls out."""
    slotted = [(10, 10), (90, 10), (90, 28.5), (70, 28.5), (70, 31.5), (90, 31.5), (90, 70), (10, 70)]
    drawn = nest(181.5, 80, part("A", slotted), part("B", rect(91.5, 10, 80, 60)))
    options = replace(
        LEADS, kerf_mm=1.0, lead_in_min_mm=1.0, tabs=replace(ASKED, corner_mm=1.0, at_end=True), entries=24
    )
    tabs = [tab.at for way in build_candidates(drawn, options) if way.contour == 0 for tab in way.tabs]
    assert tabs
    assert not [at for at in tabs if 70 < at[0] < 90 and 28 < at[1] < 32]
