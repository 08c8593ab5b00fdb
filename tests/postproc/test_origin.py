"""Where a sheet lies on its machine: the plan has the drawing's coordinates, the program the machine's; both judged."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest, Sheet
from kerfwise.models.plan.read_plan import read_plan
from kerfwise.postproc.clock import job_of_plan, job_of_program, read_program
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan, check_program
from kerfwise.rules.case import part, rect
from kerfwise.rules.profile.plant_sections import Machine
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.values import placing_notes
from kerfwise.tests.postproc.plans import cut_of, plan_of, profile
from kerfwise.tests.tools import canon

FAR = Nest(Sheet(Curve.of(rect(3000, 20, 100, 90))), (part("A", rect(3020, 40, 60, 50)),))
CORNER = profile(machine=replace(profile().machine, origin="sheet-corner"))


def made(plant: Profile):  # type: ignore[no-untyped-def]
    """The part cut once, by a plan and its program."""
    plan = plan_of(FAR, [cut_of(FAR.contour("A.outer"), 0.1, "cw")], plant)
    plan = replace(plan, origin=plant.machine.origin, zero=plant.frame_on(FAR).corner)
    return plan, write_program(plan, FAR, plant)


@pytest.mark.linuxcnc
def test_the_plan_keeps_the_drawings_coordinates_and_the_program_has_the_machines() -> None:
    plan, text = made(CORNER)
    assert plan.cuts[0].cut.pierce[0] > 3000
    assert "\n(ORIGIN SHEET CORNER, AT X3000 Y20 OF THE DRAWING)\n" in text
    run = canon.run(text)
    (burn,) = run.burns
    x, y = plan.cuts[0].cut.pierce
    assert burn.pierce == pytest.approx((x - 3000, y - 20))
    assert run.position == (0, 0)
    drawn = canon.run(made(profile())[1])
    assert drawn.burns[0].pierce == pytest.approx((x, y))
    assert drawn.idle_mm > 5900 > 200 > run.idle_mm
    assert run.idle_mm == pytest.approx(plan.totals.idle_mm, abs=0.01)


def test_the_check_takes_the_origin_from_plan_and_program() -> None:
    for mine, other in ((CORNER, profile()), (profile(), CORNER)):
        plan, text = made(mine)
        for judge in (mine, other):
            assert check_plan(FAR, plan, judge).broken() == ()
            written = check_program(FAR, text, judge)
            assert written.broken() == ()
            told = [w for w in written.warnings if "origin" in w]
            assert told == (
                []
                if judge is mine
                else [
                    f"the program's origin is {mine.machine.origin}, the profile says {other.machine.origin}: the "
                    "program's counts"
                ]
            )
            assert written.measured.idle_mm == pytest.approx(plan.totals.idle_mm, abs=0.01)


def test_a_program_that_says_nothing_has_the_profiles_origin() -> None:
    text = re.sub(r"\(ORIGIN .*\)\n", "", made(CORNER)[1])
    assert check_program(FAR, text, CORNER).broken() == ()
    assert "every-contour-once" in check_program(FAR, text, profile()).broken()


def test_a_header_that_lies_is_found() -> None:
    text = made(CORNER)[1].replace("AT X3000 Y20", "AT X3000 Y21")
    result = check_program(FAR, text, CORNER)
    assert not result.ok
    (violation,) = result.rule("program-state").violations
    assert violation.text == (
        "it says that its zero is at (3000, 21) of the drawing, by its origin it is at (3000, 20)"
    )


def test_the_plan_says_its_origin_where_it_is_not_the_drawings(tmp_path: Path) -> None:
    plan, _ = made(CORNER)
    (tmp_path / "plan.json").write_text(plan.to_json())
    again = read_plan(tmp_path / "plan.json")
    assert (again.origin, again.zero) == ("sheet-corner", (3000, 20))
    plain = made(profile())[0].to_json()
    assert '"origin"' not in plain
    assert '"zero"' not in plain


def test_the_clock_reads_both_alike() -> None:
    plan, text = made(CORNER)
    planned, written = job_of_plan(plan, FAR, profile()), job_of_program(read_program(text, FAR, profile()), FAR)
    assert planned.idle_mm == pytest.approx(written.idle_mm, abs=0.01)
    assert planned.nc_blocks == written.nc_blocks


def test_a_far_home_is_told() -> None:
    (text,) = placing_notes(FAR, Profile("shop"))
    assert text == (
        "the sheet is 3000 mm from the machine's home, further than it is long (100 mm): the torch travels there and "
        "back; machine.origin: sheet-corner (or --origin sheet-corner) puts its corner at the machine's zero"
    )
    assert list(placing_notes(FAR, CORNER)) == []
    assert list(placing_notes(FAR, Profile("shop", machine=Machine(home=(2901, 20))))) == []


@pytest.mark.parametrize(
    ("attributes", "told"),
    [
        ({"thickness": 10}, "A should be of 10 mm (thickness in the nest), the profile cuts S235 of 6 mm"),
        ({"material": "1.4301"}, "A should be of 1.4301 (material in the nest), the profile cuts S235 of 6 mm"),
        ({"thickness": 6.0, "material": "S355J2"}, ""),
        ({"thickness": None, "material": "oak"}, ""),
    ],
)
def test_parts_of_another_metal_than_the_profile_cuts_are_told(attributes: dict[str, object], told: str) -> None:
    plate = replace(FAR.parts[0], attributes=attributes)
    texts = list(placing_notes(replace(FAR, parts=(plate,)), replace(Profile("shop"), machine=CORNER.machine)))
    assert [text.startswith(told) for text in texts] == ([True] if told else [])


def test_a_sheet_beyond_the_travel_is_told() -> None:
    short = Machine(home=(2950, 0), travel_x_mm=(0, 3050))
    (text,) = placing_notes(FAR, Profile("shop", machine=short))
    assert text.startswith("the sheet lies from (3000, 20) to (3100, 110) of the machine, beyond its travel")


@pytest.mark.parametrize(
    ("travel", "found"),
    [
        ({}, None),
        ({"travel_x_mm": (0, 81), "travel_y_mm": (0, 71)}, []),
        ({"travel_y_mm": (0, 80)}, []),
        (
            {"travel_x_mm": (0, 80.7)},
            ["the path of A.outer is 0.1 mm out of the machine's travel, at X 80.8"],
        ),
        (
            {"travel_x_mm": (1, 90)},
            ["the machine's home is 1.0 mm out of the machine's travel, at X 0.0"],
        ),
    ],
)
def test_every_point_is_judged_by_the_machines_travel(travel: dict[str, object], found: list[str] | None) -> None:
    plant = replace(CORNER, machine=replace(CORNER.machine, **travel))  # type: ignore[arg-type]
    plan, text = made(plant)
    for result in (check_plan(FAR, plan, plant), check_program(FAR, text, plant)):
        judged = {j.id: j for j in result.rules}
        assert ("within-travel" in judged) == (found is not None)
        if found is not None:
            texts = [v.text.split(": ")[-1] for v in judged["within-travel"].violations]
            told = [re.sub(r"at \((.*), .*\) of the machine", r"at X \1", text) for text in texts]
            assert [t for t in told if not t.startswith("the way")] == found


def test_a_rapid_beyond_the_travel_is_found_with_its_line() -> None:
    plant = replace(CORNER, machine=replace(CORNER.machine, travel_x_mm=(-1, 90)))
    _, text = made(plant)
    text = text.replace("M3 $0 S1", "G0 X95 Y3\nG0 X14 Y14\nM3 $0 S1", 1)
    texts = [v.text for v in check_program(FAR, text, plant).rule("within-travel").violations]
    assert len(texts) == 1
    assert re.fullmatch(
        r"line \d+: the way without torch leads 5.0 mm out of the machine's travel, at \(95.0, 3.0\) of the machine",
        texts[0],
    )
