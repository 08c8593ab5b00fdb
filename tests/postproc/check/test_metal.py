"""Gouges and paths off the sheet."""

import re
from dataclasses import replace

import numpy as np
import pytest
import shapely

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.facts import FactOptions, compute_facts
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check import CheckResult, check_cuts, gouging
from kerfwise.postproc.check.torch_run import TorchRun, rings_of
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.catalogue.shared_metal import SharedMetalOptions
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.profile.sections import RuleSetting, default_settings
from kerfwise.rules.registry import RULES
from kerfwise.tests.postproc.plans import cut_of, profile

REACHING = replace(profile().machine, travel_x_mm=(-20.0, 3000.0), travel_y_mm=(-20.0, 1500.0))


def one(sheet: Nest, name: str, pierce: tuple[float, float], **changes: object) -> CheckResult:
    """The check of the first part of a nest, joined at a tenth of its outline from this pierce."""
    cut: Cut = cut_of(sheet.contour(name), 0.1, "cw")
    assert cut.lead_in is not None
    lead_in = Curve.of([pierce, cut.lead_in.end], closed=False)
    return check_cuts(sheet, CutSequence((replace(cut, pierce=pierce, lead_in=lead_in),), "left"), profile(**changes))


def test_a_lead_along_a_neighbour_takes_metal_of_it() -> None:
    sheet = nest(200, 200, part("A", rect(20, 20, 60, 60)), part("B", rect(30, 5, 100, 10)))
    assert one(sheet, "A.outer", (44, 16.5)).rule("no-gouging").holds
    result = one(sheet, "A.outer", (44, 15.5))
    (violation,) = result.rule("no-gouging").violations
    assert violation.contours == ("A.outer", "B.outer")
    assert violation.text == (
        "cut 1: a lead of A.outer reaches 0.250 mm into the metal of B at (44.0, 15.0) and burns 0.2 mm² of it"
    )


def from_above(sheet: Nest, **changes: object) -> CheckResult:
    """The check of A, 60 mm square, joined in the middle of its upper side."""
    return check_cuts(sheet, CutSequence((cut_of(sheet.contour("A.outer"), 0.625, "cw"),), "left"), profile(**changes))


CLOSE = nest(200, 200, part("A", rect(20, 20, 60, 60)), part("B", rect(30, 5, 100, 14.2)))


def test_beside_a_part_closer_than_the_kerf_the_round_takes_metal_of_it() -> None:
    result = from_above(CLOSE)
    (gouge,) = result.rule("no-gouging").violations
    assert gouge.contours == ("A.outer", "B.outer")
    assert gouge.text == (
        "cut 1: the kerf of A.outer reaches 0.700 mm into the metal of B at (80.0, 19.2) and burns 35.6 mm² of it"
    )
    (shared,) = result.rule("shared-metal").violations
    assert shared.contours == ("A.outer", "B.outer")


def test_where_contours_may_touch_the_round_is_warned_of_and_a_lead_is_not_let() -> None:
    rules = default_settings()
    rules["shared-metal"] = RuleSetting("off", None, rules["shared-metal"].options)
    result = from_above(CLOSE, rules=rules)
    assert result.rule("no-gouging").holds
    assert result.warnings[0] == (
        "A and B are less than the kerf of 1.5 mm apart: each cut takes metal of both, up to 0.700 mm"
    )
    gouge, *_ = one(CLOSE, "A.outer", (44, 12), rules=rules).rule("no-gouging").violations
    assert "a lead of A.outer reaches 7.250 mm into the metal of B" in gouge.text


@pytest.mark.parametrize("gap_mm", [0.0, 0.01, 0.4, 0.75, 1.0, 1.39, 1.42, 1.44, 1.46, 1.49, 1.5, 1.51, 2.0])
def test_one_line_for_all_gaps(gap_mm: float) -> None:
    """What the planner refuses, the rule's own geometry and the burns of a program refuse alike."""
    sheet = nest(300, 200, part("A", rect(20, 20, 60, 60)), part("B", rect(80 + gap_mm, 20, 60, 60)))
    result = from_above(sheet)
    told = list(RULES["shared-metal"].statements(compute_facts(sheet, FactOptions(), ()), SharedMetalOptions()))
    holds = gap_mm > 1.45
    assert result.rule("no-gouging").holds is holds
    assert result.rule("shared-metal").holds is holds
    assert (told == []) is holds
    if not holds:
        assert f"reaches {1.5 - gap_mm:.3f} mm into" in result.rule("no-gouging").violations[0].text
        assert f"reaches {1.5 - gap_mm:.3f} mm into" in told[0].about.sentence
        area = float(re.search(r"burns (\S+) mm²", result.rule("no-gouging").violations[0].text)[1])  # type: ignore[index]
        assert area == pytest.approx(60 * (1.5 - gap_mm), rel=0.02, abs=0.1)


def test_a_part_that_was_cut_out_before_still_counts() -> None:
    sheet = nest(300, 200, part("A", rect(20, 20, 60, 60)), part("B", circle(200, 100, 40), [circle(200, 100, 20)]))
    cuts = [cut_of(sheet.contour(n), 0.1, w) for n, w in (("A.outer", "cw"), ("B.hole1", "ccw"), ("B.outer", "cw"))]
    assert check_cuts(sheet, CutSequence(tuple(cuts), "left"), profile()).rule("no-gouging").holds
    lead = Curve.of([(50, 50), *cuts[1].lead_in.vertices[-1:, :2].tolist()], closed=False)  # type: ignore[union-attr]
    astray = replace(cuts[1], pierce=(50, 50), lead_in=lead)
    broken = check_cuts(sheet, CutSequence((cuts[0], astray, cuts[2]), "left"), profile()).rule("no-gouging")
    assert {v.contours for v in broken.violations} == {("B.hole1", "A.outer"), ("B.hole1", "B.outer")}


@pytest.mark.parametrize(("x", "edge_start", "holds"), [(-5.0, True, True), (-9.0, True, False), (-5.0, False, False)])
def test_only_an_edge_start_leaves_the_sheet(x: float, edge_start: bool, holds: bool) -> None:
    sheet = nest(200, 200, part("A", rect(3, 20, 60, 60)))
    leads = replace(profile().leads, edge_start=edge_start)
    found = one(sheet, "A.outer", (x, 15), leads=leads, machine=REACHING)
    assert found.rule("on-sheet").holds is holds
    assert found.rule("edge-start").holds is edge_start


def test_an_edge_start_needs_an_edge_and_a_machine_that_gets_there() -> None:
    sheet = nest(200, 200, part("A", rect(3, 20, 60, 60)))
    leads = replace(profile().leads, edge_start=True)
    assert one(sheet, "A.outer", (-1.5, 15), leads=leads, machine=REACHING).rule("edge-start").holds
    assumed = replace(sheet, sheet=replace(sheet.sheet, stated=False))
    for where, machine, why in (
        (assumed, REACHING, "nobody has stated where the sheet's edge is"),
        (
            sheet,
            profile().machine,
            "the profile does not say how far the torch can go (machine.travel_x, machine.travel_y)",
        ),
    ):
        (violation,) = one(where, "A.outer", (-1.5, 15), leads=leads, machine=machine).rule("edge-start").violations
        assert violation.text == f"cut 1: A.outer begins 1.5 mm off the sheet, at (-1.50, 15.00): {why}"
    assert one(assumed, "A.outer", (1.5, 15), leads=leads).rule("edge-start").holds


def test_no_kerf_no_gouge() -> None:
    sheet = nest(200, 200, part("A", rect(20, 20, 60, 60)), part("B", rect(80, 20, 60, 60)))
    thin = replace(profile().material, kerf_mm=0.0)
    cuts = tuple(cut_of(sheet.contour(f"{n}.outer"), 0.1, "cw", kerf_mm=0.0) for n in "AB")
    result = check_cuts(sheet, CutSequence(cuts, "left"), profile(material=thin))
    assert result.rule("no-gouging").holds
    assert result.warnings == ()


def gouges_near(offs_mm: list[tuple[float, float, float]]) -> tuple[list[int], list[tuple[Violation, ...]]]:
    """How many rounds are held against metal, with rings that are clear and without; and what comes of both.

    Each round is the torch ring of a part, shifted, with one place of it drawn somewhere else.
    """
    sheet = nest(700, 200, *(part(f"P{k}", rect(20 + 65 * k, 20, 50, 50)) for k in range(len(offs_mm))))
    runs = []
    for contour, ring, (dx, dy, spike_mm) in zip(sheet.contours, rings_of(sheet, 1.5), offs_mm, strict=True):
        assert ring is not None
        points = shapely.get_coordinates(shapely.segmentize(ring, 10.0)) + np.array([dx, dy])
        points[5] += spike_mm * (np.array([contour.polygon.centroid.x, contour.polygon.centroid.y]) - points[5])
        runs.append(TorchRun(len(runs) + 1, "a line", contour, None, shapely.LineString(points), None))
    asked, found = [], []
    for clear in (gouging._clear_rings, lambda nest, kerf_mm: {}):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(gouging, "_clear_rings", clear)
            burns = [gouging._Burn(run, run.loop, False) for run in runs]
            asked.append(len(gouging._not_clear(sheet, burns, 1.5)))
            found.append(gouging.gouges(sheet, runs, 1.5).violations)
    return asked, found


def test_rounds_beside_clear_rings_gouge_nothing() -> None:
    asked, (told, plainly) = gouges_near([(0, 0, 0), (0.03, 0.03, 0), (0.045, 0, 0), (0, 0, 0.001)])
    assert asked == [0, 4]
    assert told == plainly == ()


def test_rounds_known_to_follow_their_clear_ring_are_not_held_against_it_again(monkeypatch: pytest.MonkeyPatch) -> None:
    sheet = nest(150, 90, part("A", rect(20, 20, 50, 50)), part("B", rect(85, 20, 50, 50)))
    rings = rings_of(sheet, 1.5)
    loops = [shapely.LineString(shapely.segmentize(ring, 10.0).coords) for ring in rings]
    monkeypatch.setattr(gouging, "surely_beside", lambda lines, *_: np.zeros(len(lines), dtype=bool))
    for follows, left in ((rings, []), (rings[::-1], ["A", "B"]), ((None, rings[1]), ["A"])):
        rows = zip(sheet.contours, loops, follows, strict=True)
        runs = [TorchRun(1, "a line", contour, None, loop, None, follows=ring) for contour, loop, ring in rows]
        burns = gouging._not_clear(sheet, [gouging._Burn(run, run.loop, False) for run in runs], 1.5)
        assert [f"{name}.outer" for name in left] == [burn.run.name for burn in burns]


def test_rounds_that_leave_a_clear_ring_are_held_against_metal() -> None:
    offs_mm = [(0, 0.055, 0), (0.07, 0, 0), (0.2, 0.2, 0), (0, 0, 0.01), (0, 0, 0.5), (60.0, 0, 0), (0.01, 0, 0)]
    asked, (told, plainly) = gouges_near(offs_mm)
    assert asked == [6, 7]
    assert told == plainly
    assert {name for violation in told for name in violation.contours} >= {"P1.outer", "P2.outer", "P4.outer"}


def test_a_path_that_touches_metal_to_within_rounding_takes_half_a_kerf_of_it() -> None:
    """It is no way off, and has nothing in common."""
    line = shapely.LineString([(150, 30 - 4e-15), (149.8439277423871, 30.015371775677412)])
    metal = shapely.Polygon([(150, 30), (230, 30), (230, 60), (190, 60), (190, 110), (150, 110)])
    assert shapely.distance(line, metal) == 0
    assert gouging._deepest(line, metal, 0.8)[0] == pytest.approx(0.8)
