"""Candidates of small nests, by hand."""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kerfwise
from kerfwise.encoder.candidates import Candidate, CandidateBuilder, LeadOptions, build_candidates
from kerfwise.encoder.candidates import build as build_module
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Nest, Sheet
from kerfwise.encoder.readers import read_nest
from kerfwise.encoder.torch_path import compensated
from kerfwise.rules.case import circle, nest, part, rect

REACH = (-100.0, -100.0, 3000.0, 1500.0)

ROOT = Path(kerfwise.__file__).parent


def of(found: tuple[Candidate, ...], plate: Nest, name: str) -> list[Candidate]:
    """The candidates of one contour."""
    return [c for c in found if plate.contours[c.contour].id == name]


def plate() -> Nest:
    """A square with a hole and a mark far from the edges of a sheet."""
    return nest(400, 300, part("A", rect(100, 100, 80, 80), [circle(140, 140, 20)], [[(105, 110), (125, 110)]]))


def test_a_square_is_entered_at_its_corners_and_the_middles_of_its_edges() -> None:
    found = of(build_candidates(plate(), LeadOptions()), plate(), "A.outer")
    ends = [100, 140, 180]
    assert {c.entry for c in found} == {(x, y) for x in ends for y in ends} - {(140, 140)}
    assert Counter(c.direction for c in found) == {"cw": 8, "ccw": 8}


def test_at_a_corner_the_torch_joins_on_the_bisector() -> None:
    corner = next(c for c in of(build_candidates(plate(), LeadOptions()), plate(), "A.outer") if c.entry == (180, 180))
    r, far = 0.75 / math.sqrt(2), 6.75 / math.sqrt(2)
    assert corner.pierce == pytest.approx((180 + far, 180 + far))
    assert corner.lead_in is not None
    assert corner.lead_in.as_rows() == [pytest.approx([180 + far, 180 + far]), pytest.approx([180 + r, 180 + r])]


def test_from_an_edge_the_lead_is_straight_off_it() -> None:
    middle = next(c for c in of(build_candidates(plate(), LeadOptions()), plate(), "A.outer") if c.entry == (140, 100))
    assert middle.pierce == pytest.approx((140, 93.25))
    assert middle.lead_in is not None
    assert middle.lead_in.as_rows() == [pytest.approx([140, 93.25]), pytest.approx([140, 99.25])]


def test_fewer_entries_are_the_corners() -> None:
    found = of(build_candidates(plate(), LeadOptions(entries=4)), plate(), "A.outer")
    assert {c.entry for c in found} == {(100, 100), (180, 100), (180, 180), (100, 180)}


def test_a_circle_is_entered_all_around() -> None:
    found = of(build_candidates(plate(), LeadOptions()), plate(), "A.hole1")
    angles = sorted(math.atan2(c.entry[1] - 140, c.entry[0] - 140) for c in found if c.direction == "ccw")
    assert np.diff(angles) == pytest.approx([math.tau / 8] * 7, rel=0.3)


def test_a_hole_is_pierced_inside_and_cut_on_a_little() -> None:
    for c in of(build_candidates(plate(), LeadOptions(hole_overcut_mm=2.0)), plate(), "A.hole1"):
        assert math.dist(c.pierce, (140, 140)) == pytest.approx(20 - 0.75 - 6)
        assert c.lead_out is not None
        assert c.lead_out.length_mm == pytest.approx(2.0)
        assert (c.lead_out.vertices[0, 2] > 0) == (c.direction == "ccw")
        assert math.dist(c.end, (140, 140)) == pytest.approx(19.25)
        assert c.cut_mm == pytest.approx(6 + math.tau * 19.25 + 2)


def test_an_outer_contour_ends_where_it_was_joined() -> None:
    for c in of(build_candidates(plate(), LeadOptions()), plate(), "A.outer"):
        assert c.lead_in is not None
        assert c.lead_out is not None
        assert c.lead_out.as_rows() == [list(c.end)] == [c.lead_in.as_rows()[-1]]


def test_the_lead_into_a_small_hole_goes_to_its_middle() -> None:
    small = nest(400, 300, part("A", rect(100, 100, 80, 80), [circle(140, 140, 4.5)]))
    found = of(build_candidates(small, LeadOptions()), small, "A.hole1")
    assert len(found) == 16
    assert all(c.pierce == pytest.approx((140, 140)) for c in found)


def test_in_a_narrow_gap_the_lead_is_shorter() -> None:
    pair = nest(400, 300, part("A", rect(100, 100, 80, 80)), part("B", rect(183, 100, 80, 80)))
    between = [c for c in of(build_candidates(pair, LeadOptions()), pair, "A.outer") if c.entry == (180, 140)]
    assert len(between) == 2
    for c in between:
        assert c.lead_in is not None
        assert 1.0 <= c.lead_in.length_mm <= 3 - 0.75 - 1


def test_a_lead_is_turned_where_straight_on_is_blocked() -> None:
    post = part("B", rect(139.8, 95, 3, 2.5))
    found = build_candidates(nest(400, 300, part("A", rect(100, 100, 80, 80)), post), LeadOptions(splash_mm=None))
    below = [c for c in found if c.contour == 0 and c.entry == (140, 100)]
    assert below
    assert all(c.pierce[0] < 139 for c in below)


def test_a_lead_does_not_run_through_another_limb_of_its_own_part() -> None:
    fins = [(100, 100), (160, 100), (160, 180), (158, 180), (158, 105), (155.5, 105), (155.5, 180), (100, 180)]
    drawn = nest(400, 300, part("F", fins))
    between = [
        c for c in build_candidates(drawn, LeadOptions(lead_in_mm=7.0, lead_in_min_mm=6.0)) if c.entry[0] == 155.5
    ]
    assert all(c.entry[1] == 180 for c in between)


def test_a_pierce_does_not_land_on_a_part_that_overlaps_a_little() -> None:
    drawn = nest(400, 300, part("A", rect(100, 100, 80, 80)), part("B", rect(179.9, 90, 80, 100)))
    found = of(build_candidates(drawn, LeadOptions()), drawn, "A.outer")
    assert found
    assert all(c.pierce[0] < 179 for c in found)


def test_a_lead_does_not_cross_a_slit_in_the_sheet() -> None:
    slit = Curve.of(rect(50, 95, 200, 1))
    part_a = part("A", rect(100, 100, 80, 80))
    remnant = Nest(Sheet(Curve.of(rect(0, 0, 400, 300)), (slit,)), (part_a,))
    found = build_candidates(remnant, LeadOptions(pierce_clearance_mm=0.8, kerf_mm=1.5))
    below = [c for c in found if c.pierce[1] < 100]
    assert below
    assert all(c.pierce[1] > 96.8 for c in below)


def test_where_the_edge_is_too_thin_to_stand_in_nothing_starts() -> None:
    slit = Curve.of(rect(50, 95, 200, 1))
    remnant = Nest(Sheet(Curve.of(rect(0, 0, 400, 300)), (slit,)), (part("A", rect(100, 100, 80, 80)),))
    assert not any(c.edge_start for c in build_candidates(remnant, LeadOptions(edge_start=True, reach=REACH)))


def test_a_lead_out_stays_on_the_sheet() -> None:
    near = nest(400, 300, part("A", rect(1.6, 100, 80, 80)))
    found = build_candidates(
        near, LeadOptions(lead_out="line", entry_points={"A.outer": (1.6, 140)}, edge_start=True, reach=REACH)
    )
    beside = [c for c in found if c.entry == pytest.approx((1.6, 140))]
    assert beside
    assert all(0 < c.end[0] < 0.8 for c in beside)


def test_an_arc_lead_is_tangent_to_the_cut() -> None:
    for c in of(build_candidates(plate(), LeadOptions(lead="arc")), plate(), "A.outer"):
        if c.entry != (140, 100):
            continue
        assert c.lead_in is not None
        (arc,) = c.lead_in.segments
        assert arc.length_mm == pytest.approx(6)
        assert abs(arc.sweep_rad) == pytest.approx(math.pi / 2)
        assert arc.tangent_at(1.0) == pytest.approx((1 if c.direction == "ccw" else -1, 0), abs=1e-9)
        assert c.pierce[1] < 99.25


def test_without_a_lead_the_torch_pierces_where_it_joins() -> None:
    options = LeadOptions(lead="none", hole_overcut_mm=0.0)
    for c in of(build_candidates(plate(), options), plate(), "A.outer"):
        assert c.lead_in is None
        assert c.pierce == c.end
        assert plate().contour("A.outer").curve.project(c.pierce)[1] == pytest.approx(0.75)


def test_with_neither_lead_nor_kerf_the_torch_pierces_at_the_entry() -> None:
    found = of(build_candidates(plate(), LeadOptions(lead="none", kerf_mm=0.0)), plate(), "A.hole1")
    assert len(found) == 16
    assert all(c.pierce == pytest.approx(c.entry) for c in found)


def test_without_a_kerf_the_torch_runs_on_the_contour() -> None:
    for c in of(build_candidates(plate(), LeadOptions(kerf_mm=0.0)), plate(), "A.outer"):
        assert c.end == pytest.approx(c.entry)
        assert c.cut_mm == pytest.approx(326)


def test_a_lead_out_leaves_forwards_into_the_waste() -> None:
    for c in of(build_candidates(plate(), LeadOptions(lead_out="line")), plate(), "A.outer"):
        if c.entry == (140, 100):
            assert c.lead_out is not None
            ahead = 1 if c.direction == "ccw" else -1
            assert c.end == pytest.approx((140 + ahead * math.sqrt(2), 99.25 - math.sqrt(2)))
            assert c.cut_mm == pytest.approx(6 + 320 + math.tau * 0.75 + 2)


def test_an_arc_lead_out_leaves_tangent_to_the_cut() -> None:
    for c in of(build_candidates(plate(), LeadOptions(lead_out="arc")), plate(), "A.hole1"):
        assert c.lead_out is not None
        overcut, arc = c.lead_out.segments
        assert arc.tangent_at(0.0) == pytest.approx(overcut.tangent_at(1.0), abs=1e-6)
        assert math.dist(c.end, (140, 140)) < 19


def test_open_marks_are_followed_from_either_end() -> None:
    found = of(build_candidates(plate(), LeadOptions()), plate(), "A.mark1")
    assert [(c.entry, c.pierce, c.direction, c.end, c.cut_mm) for c in found] == [
        ((125, 110), (125, 110), "cw", (105, 110), 20),
        ((105, 110), (105, 110), "ccw", (125, 110), 20),
    ]
    assert all(c.lead_in is None for c in found)


def test_only_the_directions_asked_for_are_offered() -> None:
    options = LeadOptions(directions={"outer": ("cw",), "hole": ("ccw",), "mark": ("ccw",)})
    found = build_candidates(plate(), options)
    assert {(plate().contours[c.contour].kind, c.direction) for c in found} == {
        ("outer", "cw"),
        ("hole", "ccw"),
        ("mark", "ccw"),
    }


def test_near_the_edge_of_the_sheet_the_torch_may_come_in_from_it() -> None:
    near = nest(400, 300, part("A", rect(10, 100, 80, 80)))
    found = build_candidates(near, LeadOptions(edge_start=True, reach=REACH))
    edge = [c for c in found if c.edge_start]
    assert {c.entry for c in edge} == {(10, 100), (10, 140), (10, 180)}
    assert {c.entry for c in edge} <= {c.entry for c in found if not c.edge_start}
    middle = next(c for c in edge if c.entry == (10, 140))
    assert middle.pierce == pytest.approx((-1.5, 140))
    assert not any(c.edge_start for c in build_candidates(near, LeadOptions()))


def test_nothing_comes_in_from_an_edge_that_was_only_assumed() -> None:
    near = nest(400, 300, part("A", rect(10, 100, 80, 80)))
    assumed = dataclasses.replace(near, sheet=dataclasses.replace(near.sheet, stated=False))
    assert any(c.edge_start for c in build_candidates(near, LeadOptions(edge_start=True, reach=REACH)))
    assert not any(c.edge_start for c in build_candidates(assumed, LeadOptions(edge_start=True, reach=REACH)))


def test_an_edge_start_does_not_run_along_the_part() -> None:
    options = LeadOptions(entry_points={"A.outer": (8, 100)}, edge_start=True, reach=REACH)
    found = build_candidates(nest(400, 300, part("A", rect(4, 100, 8, 80))), options)
    assert any(c.entry == (8, 100) for c in found)
    assert not any(c.edge_start and c.entry == (8, 100) for c in found)


def test_a_contour_with_room_at_the_edge_only_starts_there() -> None:
    tight = nest(84, 84, part("A", rect(2, 2, 80, 80)))
    found = build_candidates(tight, LeadOptions(edge_start=True, reach=REACH))
    assert found
    assert all(c.edge_start for c in found)


def test_a_locked_entry_is_among_the_candidates() -> None:
    found = build_candidates(plate(), LeadOptions(entry_points={"A.outer": (117, 90), "A.hole1": (140, 150)}))
    assert Counter(c.direction for c in found if c.entry == pytest.approx((117, 100))) == {"cw": 1, "ccw": 1}
    assert Counter(c.direction for c in found if c.entry == pytest.approx((140, 160))) == {"cw": 1, "ccw": 1}


def test_a_locked_entry_may_be_in_a_hollow_corner() -> None:
    ell = nest(400, 300, part("L", [(100, 100), (200, 100), (200, 140), (140, 140), (140, 200), (100, 200)]))
    found = build_candidates(ell, LeadOptions(entry_points={"L.outer": (140, 140)}))
    locked = next(c for c in found if c.entry == pytest.approx((140, 140)))
    assert locked.lead_in is not None
    assert locked.lead_in.as_rows()[-1] == pytest.approx([140.75, 140.75])
    assert locked.pierce[0] > 142
    assert locked.pierce[1] > 142


def test_touching_parts_are_entered_from_the_sides_with_room() -> None:
    touching = nest(
        400,
        300,
        part("A", rect(100, 100, 80, 80)),
        part("B", rect(180, 100, 80, 80)),
        part("C", rect(20, 20, 60, 60), [rect(30, 30, 40, 40)]),
        part("D", rect(30, 30, 20, 20)),
    )
    found = build_candidates(touching, LeadOptions())
    assert {c.contour for c in found} == set(range(5))
    assert all(c.entry[0] < 179 for c in of(found, touching, "A.outer"))
    assert all(c.pierce[0] > 50 or c.pierce[1] > 50 for c in of(found, touching, "D.outer"))


def test_the_same_nest_gives_the_same_candidates() -> None:
    a, b = (build_candidates(plate(), LeadOptions(lead="arc", lead_out="line")) for _ in range(2))
    assert [(c.contour, c.entry, c.direction, c.pierce, c.end, c.cut_mm) for c in a] == [
        (c.contour, c.entry, c.direction, c.pierce, c.end, c.cut_mm) for c in b
    ]
    assert [c.contour for c in a] == sorted(c.contour for c in a)


@pytest.mark.parametrize("name", ["e1x_6.json", "s8877.json"])
def test_real_nests_have_all_entries_for_every_contour(name: str) -> None:
    real = read_nest(ROOT / "examples" / "nests" / name)
    found = build_candidates(real, LeadOptions())
    pierced = Counter(c.contour for c in found if not c.edge_start)
    assert pierced == dict.fromkeys(range(len(real.contours)), 16)


def test_leads_end_on_the_compensated_path() -> None:
    for c in build_candidates(plate(), LeadOptions()):
        if c.lead_in is not None:
            path = compensated(plate_contour := plate().contours[c.contour], 1.5)
            assert path.project(c.lead_in.as_rows()[-1][:2])[1] < 1e-9
            assert plate_contour.curve.project(c.entry)[1] < 1e-9


def test_an_unknown_locked_contour_is_an_error() -> None:
    with pytest.raises(InputError, match=r"not in the nest: Z\.outer"):
        build_candidates(plate(), LeadOptions(entry_points={"Z.outer": (0, 0)}))


def test_an_empty_nest_has_no_candidates() -> None:
    assert build_candidates(nest(400, 300), LeadOptions()) == ()


def test_marks_may_be_closed() -> None:
    drawn = part("A", rect(100, 100, 80, 80))
    ring = Contour("A.mark1", "A", "mark", Curve.of(circle(120, 120, 5)))
    closed = nest(400, 300, dataclasses.replace(drawn, marks=(ring,)))
    found = of(build_candidates(closed, LeadOptions()), closed, "A.mark1")
    assert len({c.entry for c in found}) == 4
    assert all(c.entry == c.pierce == c.end and c.cut_mm == pytest.approx(math.tau * 5) for c in found)


def test_nothing_comes_in_from_an_edge_that_the_machine_is_not_known_to_reach() -> None:
    near = nest(400, 300, part("A", rect(10, 100, 80, 80)))
    for reach in (None, (0.0, 0.0, 400.0, 300.0), (-1.4, 0.0, 400.0, 300.0)):
        found = build_candidates(near, LeadOptions(edge_start=True, reach=reach))
        assert found
        assert not any(c.edge_start for c in found)
    found = build_candidates(near, LeadOptions(edge_start=True, reach=(-1.5, 0.0, 400.0, 300.0)))
    assert any(c.edge_start for c in found)


def test_pierces_and_leads_keep_to_what_the_machine_reaches() -> None:
    near = nest(400, 300, part("A", rect(10, 100, 80, 80)))
    everywhere, reached = (build_candidates(near, LeadOptions(reach=r)) for r in (None, (9.0, 90.0, 400.0, 300.0)))
    assert any(c.pierce[0] < 9 for c in everywhere)
    assert reached
    assert all(c.pierce[0] >= 9 for c in reached)


def test_a_contour_that_the_machine_does_not_reach_is_named() -> None:
    far = nest(
        400, 300, part("A", rect(10, 100, 80, 80)), part("B", rect(200, 100, 80, 80), marks=[[(210, 120), (270, 120)]])
    )
    with pytest.raises(InputError) as caught:
        build_candidates(far, LeadOptions(reach=(0.0, 0.0, 250.0, 300.0)))
    assert caught.value.details == (
        "B.mark1 at (270.0, 120.0) is 20.0 mm out of the machine's travel: move the part, or correct machine.travel_x "
        "and machine.travel_y",
        "B.outer at (280.8, 100.0) is 30.8 mm out of the machine's travel: move the part, or correct machine.travel_x "
        "and machine.travel_y",
    )


def test_a_contour_without_a_lead_within_reach_is_named() -> None:
    tight = nest(400, 300, part("A", rect(10, 100, 80, 80)))
    with pytest.raises(InputError) as caught:
        build_candidates(tight, LeadOptions(reach=(9.0, 99.0, 91.0, 181.0)))
    assert caught.value.details == ("A.outer: no lead to it stays within the machine's travel",)


def test_leads_are_looked_for_once_whichever_contours_are_cut_along_stretches(monkeypatch: pytest.MonkeyPatch) -> None:
    row = nest(400, 120, *(part(f"P{k}", rect(20 + 100 * k, 20, 80, 80)) for k in range(3)))
    asked: list[list[int]] = []
    plain = build_module.try_leads

    def try_leads(nest: Nest, numbers: Sequence[int], *rest: Any) -> Any:
        asked.append(list(numbers))
        return plain(nest, numbers, *rest)

    monkeypatch.setattr(build_module, "try_leads", try_leads)
    builder = CandidateBuilder(row, LeadOptions())
    spared, _ = builder.build({"P0.outer", "P1.outer"}, {"P0.outer"})
    every, _ = builder.build()
    assert asked == [[0, 1, 2]]
    assert {c.contour for c in spared} == {0, 2}
    plainly = [(c.contour, c.entry, c.pierce, c.direction, c.end) for c in build_candidates(row, LeadOptions())]
    assert [(c.contour, c.entry, c.pierce, c.direction, c.end) for c in every] == plainly
    assert [c.entry for c in spared] == [c.entry for c in every if c.contour != 1]
