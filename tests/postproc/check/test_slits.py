"""The check of passes along slots narrower than the kerf, on plans and programs made by hand."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check import CheckResult, check_cuts
from kerfwise.postproc.check.check import check_program
from kerfwise.rules.case import nest, part
from kerfwise.rules.profile.sections import Cuts
from kerfwise.tests.postproc.plans import cut_of, profile

PLANT = profile(cuts=Cuts("slit"))
START, END = (60.0, 120.559), (60.0, 60.75)


def sheet(width_mm: float = 1.0) -> Nest:
    """A plate of 80 x 100 mm with a slot 60 mm deep in the middle of its upper side."""
    left, right = 60 - width_mm / 2, 60 + width_mm / 2
    rows = [(20, 20), (100, 20), (100, 120), (right, 120), (right, 60), (left, 60), (left, 120), (20, 120)]
    return nest(120, 150, part("P", rows))


def a_pass(
    start: tuple[float, float] = START, end: tuple[float, float] = END, pierce: tuple[float, float] = (60.0, 126.0)
) -> Cut:
    lead = Curve.of([pierce, start], closed=False)
    return Cut("P.slit1", start, "ccw", pierce, lead, Curve.of([end], closed=False), 1)


def judged(*cuts: Cut, width_mm: float = 1.0, refuse: bool = False) -> CheckResult:
    drawn = sheet(width_mm)
    ring = cut_of(drawn.contour("P.outer"), 0.05, "cw")
    in_order = [ring if cut.contour == "P.outer" else cut for cut in cuts] if len(cuts) > 1 else [*cuts, ring]
    return check_cuts(drawn, CutSequence(tuple(in_order), "bottom"), profile() if refuse else PLANT)


def told(result: CheckResult, rule: str) -> str:
    return " ".join(violation.text for violation in result.rule(rule).violations)


def test_a_pass_along_the_middle_holds_and_what_it_costs_is_told() -> None:
    result = judged(a_pass())
    assert result.broken() == ()
    (warning,) = (text for text in result.warnings if "slit" in text)
    assert warning == (
        "P.slit1 opens a slot of P.outer at (60.0, 119.8), 1.00 mm wide and 59.8 mm deep, by one pass: it becomes 1.5 "
        "mm wide, the part loses 0.25 mm at each side (cuts.narrow: slit)"
    )


def test_without_it_the_slot_is_lost() -> None:
    assert judged().broken() == ("features-kept",)


def test_a_profile_that_refuses_takes_it_for_a_stranger() -> None:
    result = judged(a_pass(), refuse=True)
    assert "every-contour-once" in result.broken()
    assert "cut 1 is of P.slit1, which the nest does not have" in told(result, "every-contour-once")


def test_beside_the_middle_it_burns_more_than_it_may() -> None:
    result = judged(a_pass((60.2, 120.559), (60.2, 60.75), (60.2, 126.0)))
    assert {"features-kept", "no-gouging"} <= set(result.broken())
    assert "runs up to 0.20 mm beside the middle of the slot" in told(result, "features-kept")


def test_within_the_tolerance_it_holds() -> None:
    assert judged(a_pass((60.04, 120.559), (60.04, 60.75), (60.04, 126.0))).broken() == ()


def test_slanting_it_leaves_the_middle() -> None:
    result = judged(a_pass(end=(60.15, 60.75)))
    assert "beside the middle of the slot" in told(result, "features-kept")


def test_it_may_not_burn_beyond_the_end() -> None:
    result = judged(a_pass(end=(60.0, 60.3)))
    assert "P.slit1) at (60.0, 119.8) burns 0.45 mm beyond the end of the slot" in told(result, "features-kept")


def test_nor_stop_short_of_it() -> None:
    result = judged(a_pass(end=(60.0, 62.0)))
    assert result.broken() == ("features-kept",)
    assert "of P.outer are left uncut" in told(result, "features-kept")


def test_in_a_slot_as_wide_as_two_kerfs_it_has_no_business() -> None:
    result = judged(a_pass(), width_mm=3.0)
    assert "runs along no slot narrower than the kerf" in told(result, "features-kept")


def test_it_comes_before_its_contour() -> None:
    result = judged(cut_of(sheet().contour("P.outer"), 0.05, "cw"), a_pass())
    assert "inner-before-outer" in result.broken()
    assert "P.slit1 (cut 2) must be cut before P.outer (cut 1): it opens a slot beside metal that cutting P.outer" in (
        told(result, "inner-before-outer")
    )


def test_it_is_pierced_in_the_waste_and_not_in_its_slot() -> None:
    inside_out = Cut("P.slit1", END, "ccw", END, None, Curve.of([START], closed=False), 1)
    assert "pierce" in judged(inside_out).broken()
    on_part = judged(a_pass(pierce=(50.0, 110.0)))
    assert "is not pierced in the waste of P.outer" in told(on_part, "pierce")


def test_its_lead_burns_nothing() -> None:
    result = judged(a_pass(pierce=(66.0, 120.8)))
    assert "a lead of P.slit1 reaches" in told(result, "no-gouging")


def test_a_contour_is_not_pierced_in_the_kerf_of_its_slit() -> None:
    drawn = sheet()
    ring = replace(cut_of(drawn.contour("P.outer"), 0.05, "cw"))
    lead = Curve.of([(60.0, 126.0), (61.0, 120.75)], closed=False)
    at_mouth = Cut("P.outer", (61.0, 120.0), "cw", (60.0, 126.0), lead, None, 1)
    result = check_cuts(drawn, CutSequence((a_pass(), at_mouth), "bottom"), PLANT)
    assert "pierce" in result.broken()
    assert "P.outer (cut 2) is pierced in the kerf of the lead-in of P.slit1 (cut 1)" in told(result, "pierce")
    assert check_cuts(drawn, CutSequence((a_pass(), ring), "bottom"), PLANT).broken() == ()


def test_the_same_slot_is_cut_once() -> None:
    result = judged(a_pass(), a_pass(), cut_of(sheet().contour("P.outer"), 0.05, "cw"))
    assert "P.slit1 is cut again as cut 2" in told(result, "every-contour-once")


@pytest.mark.parametrize("width_mm", [0.5, 1.0, 1.4, 1.5])
def test_every_width_up_to_the_kerf_has_its_loss(width_mm: float) -> None:
    result = judged(a_pass(), width_mm=width_mm)
    assert result.broken() == ()
    assert any(f"loses {(1.5 - width_mm) / 2:.2f} mm at each side" in text for text in result.warnings)


def test_what_is_left_of_a_hole_s_cut_is_a_pass_in_no_slot() -> None:
    hole = [(40, 40), (80, 40), (80, 80), (40, 80)]
    drawn = nest(150, 150, part("P", [(20, 20), (100, 20), (100, 120), (20, 120)], [hole]))
    moves = "G1 X60 Y40.75 F2000\nG1 X75 Y40.75\nG1 X75 Y60\n"  # along some of the hole, and away from it
    result = check_program(drawn, f"G21 G90\nG0 X60 Y60\nM3 $0 S1\n{moves}M5 $0\nM2\n", PLANT)
    assert {"every-contour-once", "features-kept"} <= set(result.broken())
    assert "P.hole1 is not cut" in told(result, "every-contour-once")
    assert "P.slit1) at (75.0, 40.8) runs along no slot narrower than the kerf" in told(result, "features-kept")
