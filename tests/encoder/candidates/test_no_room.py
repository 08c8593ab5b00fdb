"""Contours without a lawful pierce are named, and what is said to free them does."""

from __future__ import annotations

import dataclasses
import re

import pytest

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.candidates import LeadOptions, build_candidates, lead_errors
from kerfwise.encoder.candidates.entries import IN_PROFILE
from kerfwise.encoder.candidates.lead_search import LeadAttempt
from kerfwise.encoder.candidates.obstacles import Surroundings
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import circle, nest, part, rect


def told(plate: Nest, options: LeadOptions) -> str:
    with pytest.raises(InputError) as caught:
        build_candidates(plate, options)
    return str(caught.value)


@pytest.mark.slow
def test_a_contour_without_room_is_named_with_its_place_and_what_would_free_it() -> None:
    drawn = nest(400, 300, part("A", rect(100, 100, 80, 80), [circle(140, 140, 20), circle(115, 115, 1.9)]))
    assert told(drawn, LeadOptions(pierce_clearance_mm=2.0)) == (
        "a contour of the nest cannot be cut as the options ask\n"
        "  - A.hole2 at (113.1, 115.0): the best spot for a pierce near it is 1.9 mm from A.hole2, "
        "rules.pierce.clearance asks for 2 mm; `rules.pierce.clearance: 1.9 mm` frees it"
    )


def framed(gap_mm: float) -> Nest:
    """A part in a hole of another, so far from it on all sides."""
    inner = rect(110 + gap_mm, 110 + gap_mm, 80 - 2 * gap_mm, 80 - 2 * gap_mm)
    return nest(400, 300, part("H", rect(100, 100, 100, 100), [rect(110, 110, 80, 80)]), part("G", inner))


@pytest.mark.slow
def test_a_gap_is_told_once_for_both_of_its_sides() -> None:
    assert told(framed(2.1), LeadOptions()) == (
        "2 contours of the nest cannot be cut as the options ask; "
        "`rules.pierce.clearance: 0.92 mm`, or `leads.lead_in_min: 0.5 mm` frees all of them\n"
        "  - 2 contours (H.hole1, G.outer): "
        "`rules.pierce.clearance: 0.92 mm`, or `leads.lead_in_min: 0.5 mm` frees them; such as "
        "H.hole1 at (110.0, 110.0): the best spot for a pierce near it is 0.92 mm from G.outer, "
        "rules.pierce.clearance asks for 1 mm"
    )


@pytest.mark.slow
@pytest.mark.parametrize(("clearance_mm", "key"), [(1.0, "pierce_clearance_mm"), (1.0, "lead_in_min_mm")])
def test_what_is_said_to_free_it_does(clearance_mm: float, key: str) -> None:
    options = LeadOptions(pierce_clearance_mm=clearance_mm)
    said = told(framed(2.1), options)
    value = float(re.search(rf"`{re.escape(IN_PROFILE[key])}: ([\d.]+) mm`", said)[1])  # type: ignore[index]
    assert build_candidates(framed(2.1), dataclasses.replace(options, **{key: value}))


@pytest.mark.slow
def test_a_hole_too_small_for_the_kerf_is_named() -> None:
    drawn = nest(400, 300, part("A", rect(100, 100, 80, 80), [circle(140, 140, 0.7)]))
    assert "A.hole1 at (139.3, 140.0) cannot be cut with a kerf of 1.5 mm" in told(drawn, LeadOptions())


@pytest.mark.slow
def test_a_contour_that_others_enclose_needs_room() -> None:
    host = part("H", rect(100, 100, 100, 100), [rect(110, 110, 80, 80)])
    drawn = nest(400, 300, host, part("G", rect(110, 110, 80, 80)))
    text = told(drawn, LeadOptions())
    assert "H.hole1 at (110.0, 110.0): no lead from leads.lead_in_min, 1 mm, to leads.lead_in, 6 mm, keeps" in text
    assert "2 contours (H.hole1, G.outer): they need more room in the nest" in text


def test_a_locked_entry_without_room_is_told() -> None:
    drawn = nest(400, 300, part("A", rect(100, 100, 80, 80)), part("B", rect(181, 100, 80, 80)))
    text = told(drawn, LeadOptions(entry_points={"A.outer": (180, 140)}))
    assert "A.outer at the entry asked for, (180.0, 140.0): no lead" in text


def test_without_a_lead_the_path_itself_needs_the_room() -> None:
    host = part("H", rect(100, 100, 100, 100), [rect(110, 110, 80, 80)])
    drawn = nest(400, 300, host, part("G", rect(112, 112, 76, 76)))
    text = told(drawn, LeadOptions(lead="none", pierce_clearance_mm=2.0))
    assert "H.hole1 at (110.0, 110.0): without a lead the pierce lies on the torch's path" in text
    assert "`rules.pierce.clearance: 1 mm` frees all of them" in text
    assert build_candidates(drawn, LeadOptions(lead="none", pierce_clearance_mm=1.0))


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (LeadOptions(lead_in_mm=2.0, pierce_clearance_mm=5.0), "leads.lead_in, 2 mm, .* at least 4.25 mm"),
        (LeadOptions(lead_in_mm=2.0, lead_in_min_mm=3.0), "leads.lead_in_min, 3 mm, is more than leads.lead_in, 2 mm"),
        (LeadOptions(lead_in_min_mm=0.0), "leads.lead_in_min must be more than 0 mm"),
        (LeadOptions(directions={"outer": (), "hole": ("cw",), "mark": ("cw",)}), "no direction is given .*: outer"),
        (LeadOptions(entries=0), "leads.entries must be at least 1"),
    ],
)
def test_options_that_cannot_go_together_are_told_at_once(options: LeadOptions, text: str) -> None:
    assert re.search(text, told(nest(400, 300, part("A", rect(100, 100, 80, 80))), options))


@pytest.fixture
def pierced(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How many points were asked for at a time whether a pierce has room there."""
    asked: list[int] = []
    plain = Surroundings.clear_pierces

    def counted(self: Surroundings, points: Floats, clearance_mm: float, not_own: Ints | None = None) -> Bools:
        asked.append(len(points))
        return plain(self, points, clearance_mm, not_own)

    monkeypatch.setattr(Surroundings, "clear_pierces", counted)
    return asked


def test_small_holes_are_refused_without_a_look_at_places_that_none_of_them_has(pierced: list[int]) -> None:
    """A plate of 112 took half a minute: every place in each was looked at eight hundred times."""
    holes = [circle(60 + 30 * (k % 4), 60 + 30 * (k // 4), 1.48) for k in range(8)]
    options = LeadOptions(pierce_clearance_mm=1.5, lead_in_min_mm=0.5)
    said = told(nest(300, 200, part("P", rect(20, 20, 200, 120), holes)), options)
    assert "8 holes (P.hole1, P.hole2, P.hole3 and 5 more): `rules.pierce.clearance: 1.48 mm` frees them" in said
    assert sum(pierced) < 8 * 200


def test_a_pierce_without_room_is_looked_at_once_whatever_is_asked_of_its_lead(pierced: list[int]) -> None:
    told(framed(2.1), LeadOptions())
    assert sum(pierced) < 80_000


def test_no_lead_and_no_kerf_is_tried_where_the_kerf_alone_is_at_fault(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Each look at a contour of 20,000 vertices takes seconds."""
    tried: list[tuple[list[int], LeadOptions]] = []
    plain = lead_errors.try_leads

    def noted(plate: Nest, contours: list[int], around: Surroundings, options: LeadOptions) -> LeadAttempt:
        tried.append((contours, options))
        return plain(plate, contours, around, options)

    monkeypatch.setattr(lead_errors, "try_leads", noted)
    slots = [point for x in (140, 110, 80) for point in ((x, 120), (x, 60), (x - 1, 60), (x - 1, 120))]
    plate = nest(300, 200, part("A", [(20, 20), (200, 20), (200, 120), *slots, (20, 120)]))
    options = LeadOptions(lead_in_min_mm=0.5, narrow="refuse")
    said = told(plate, options)
    assert "material.kerf" not in said
    assert "`cuts.narrow: leave` (the torch cuts straight across) frees it" in said
    assert all(contours == [] or given.narrow == "leave" for contours, given in tried)
    assert all(given.kerf_mm == options.kerf_mm for _, given in tried)
