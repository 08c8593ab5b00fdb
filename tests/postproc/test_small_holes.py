"""Small holes from profile to program: marked, left out, cut more slowly; and what the check makes of programs that
do something else."""

from __future__ import annotations

import dataclasses
import json
import re
from functools import cache

import pytest

import kerfwise
from kerfwise import InputError, Nest, Profile, Result, load_profile
from kerfwise.rule_kit import circle, nest, part, rect
from kerfwise.tests.checked import checked

PLATE = nest(
    500,
    300,
    part("A", rect(50, 50, 120, 120), [circle(80, 80, 2), circle(130, 130, 9), rect(70, 120, 25, 4)]),
    part("B", rect(200, 50, 100, 100), [circle(250, 100, 20)]),
)
"""A has a hole of 4 mm, one of 18 mm and a slot of 4 mm; B one of 40 mm."""


def plant(under: str = "spot", least_mm: float = 6.0, **changes: object) -> Profile:
    """The shipped plasma profile, for plate of 6 mm, with another section of small holes."""
    shipped = load_profile("plasma-carbon-steel")
    holes = dataclasses.replace(shipped.small_holes, under=under, min_hole=least_mm)
    return dataclasses.replace(shipped, small_holes=holes, **changes)


@cache
def made(under: str = "spot", least_mm: float = 6.0) -> Result:
    """The plate planned and written."""
    profile = plant(under, least_mm)
    return kerfwise.solve(PLATE, profile, work=2)


def broken(program: str, profile: Profile, plate: Nest = PLATE) -> dict[str, list[str]]:
    """The sentences on every hard rule that a program breaks."""
    return {
        j.id: [v.text for v in j.violations]
        for j in checked(plate, program, profile).rules
        if j.strength == "hard" and not j.holds
    }


def test_spots_are_marks_at_the_middle_of_the_holes_and_the_rest_is_cut() -> None:
    done = made("spot")
    kinds = {planned.cut.contour: planned.kind for planned in done.plan.cuts}
    assert kinds == {
        "A.hole1": "mark", "A.hole2": "hole", "A.hole3": "mark", "A.outer": "outer", "B.hole1": "hole",
        "B.outer": "outer",
    }  # fmt: skip
    assert done.verdict.ok
    assert done.plan.totals.pierces == 4
    assert "(SMALL HOLES MARKED AT THEIR MIDDLE 2)" in done.program
    assert re.search(r"\(MARK \d A.hole1 .*\n.*G0 X(79|80|81) Y(79|80|81)\n.*M3 \$1 S1", done.program)
    assert "2 small holes are not cut but marked at the middle (small_holes.under: spot): A.hole1, A.hole3" in (
        done.verdict.warnings
    )
    spot = next(planned for planned in done.plan.cuts if planned.cut.contour == "A.hole1")
    assert spot.because[0].startswith("A.hole1 is 4.00 mm across, less than small_holes.min_hole, 6 mm")


def test_what_is_left_out_is_told_in_plan_program_and_check() -> None:
    done = made("skip")
    assert {planned.cut.contour for planned in done.plan.cuts} == {"A.hole2", "A.outer", "B.hole1", "B.outer"}
    assert [left.contour for left in done.plan.left_out] == ["A.hole1", "A.hole3"]
    assert "(LEFT OUT 1 A.hole1)\n(LEFT OUT 2 A.hole3)" in done.program
    assert done.verdict.ok
    assert "2 small holes are left out (small_holes.under: skip): A.hole1, A.hole3" in done.verdict.warnings
    data = json.loads(done.plan.to_json())
    assert [left["contour"] for left in data["left_out"]] == ["A.hole1", "A.hole3"]


@pytest.mark.parametrize("under", ["spot", "skip"])
def test_the_drawing_is_what_plans_and_programs_are_checked_against(under: str) -> None:
    """The check is given the drawing, not the nest that the planner made of it."""
    done = made(under)
    assert kerfwise.check(PLATE, done.plan, plant(under)).ok
    assert broken(done.program, plant(under)) == {}


def test_the_feed_falls_with_the_diameter_in_program_times_and_plan() -> None:
    done, profile = made("spot"), plant("spot")
    feeds = {m[1]: float(m[2]) for m in re.finditer(r"\(CUT \d (\S+) (?:.*\n){1,6}?.*F([\d.]+)\n", done.program)}
    assert feeds == {"A.hole2": 2000, "A.outer": 2500, "B.hole1": 2500, "B.outer": 2500}
    slow = next(planned for planned in done.plan.cuts if planned.cut.contour == "A.hole2")
    asked_s = profile.machine.pierce_time_s + slow.length_mm / (2000 / 60)
    assert slow.cut.end_s - slow.cut.start_s == pytest.approx(asked_s, abs=1e-6)


@pytest.mark.parametrize("feed", ["F2500", "F1990", "F2010"])
def test_a_small_hole_cut_at_another_feed_is_found(feed: str) -> None:
    program = made("spot").program.replace("F2000\n", f"{feed}\n")
    assert list(broken(program, plant("spot"))) == ["feeds"]
    assert (
        f"it cuts at {feed[1:]} mm/min, the profile says 2000 mm/min in A.hole2" in broken(program, plant())["feeds"][0]
    )


def test_another_contour_cut_as_slowly_is_found() -> None:
    program = made("spot").program.replace("F2500\n", "F2000\n")
    assert list(broken(program, plant("spot"))) == ["feeds"]


def test_holes_that_are_cut_through_although_the_profile_says_otherwise_are_found() -> None:
    through = made("refuse", 3.0).program
    assert broken(through, plant("refuse", 3.0)) == {}
    for under, done in (("spot", "marked at their middle"), ("skip", "left out")):
        found = broken(through, plant(under))
        small = f"A.hole1 is 4.00 mm across, holes under 6 mm are not cut but {done} (small_holes.under: {under})"
        assert small in found["small-holes"][0]
        assert "every-contour-once" in found
    refused = broken(through, plant("refuse"))
    assert refused["small-holes"] == [
        f"{name} is 4.00 mm across, holes under 6 mm are not cut: the profile refuses the nest (small_holes.under)"
        for name in ("A.hole1", "A.hole3")
    ]


def test_a_hole_that_is_cut_through_is_found_too() -> None:
    through = made("refuse", 3.0)
    with pytest.raises(InputError, match=r"A\.hole1 as hole of A, and it is mark of A"):
        kerfwise.check(PLATE, through.plan, plant("spot"))
    judged = [checked(PLATE, through.program, plant(under)) for under in ("spot", "skip")]
    for verdict in (*judged, kerfwise.check(PLATE, through.plan, plant("skip"))):
        found = {j.id: j for j in verdict.rules if j.strength == "hard" and not j.holds}
        assert {v.contours for v in found["small-holes"].violations} == {("A.hole1",), ("A.hole3",)}


def test_a_spot_that_is_missing_or_beside_the_middle_is_found() -> None:
    program = made("spot").program
    block = re.search(r"\(MARK \d A.hole1 .*\n(.*\n)*?.*M5 \$1\n", program)
    assert block is not None
    assert broken(program.replace(block[0], ""), plant("spot")) == {"every-contour-once": ["A.hole1 is not marked"]}
    moved = re.sub(r"X(\d+)", lambda m: f"X{int(m[1]) + 0.3:g}", block[0])
    beside = broken(program.replace(block[0], moved), plant("spot"))
    assert "the torch is up to 0.30 mm off where A.hole1 asks for it" in beside["contour-geometry"][0]


def test_a_spot_where_the_profile_cuts_is_not_enough() -> None:
    found = broken(made("spot").program, plant("refuse", 3.0))
    assert any(text.endswith("A.hole1 is only marked, not cut") for text in found["every-contour-once"])
    assert "A.hole3 is not cut" in found["every-contour-once"]


def test_a_contour_left_out_that_the_profile_does_not_leave_out_is_missed() -> None:
    assert broken(made("skip").program, plant("refuse", 3.0))["every-contour-once"] == [
        "A.hole1 is not cut",
        "A.hole3 is not cut",
    ]
