"""A plan made by hand passes the check, as a plan and as a program; and the check hears what it is told."""

import dataclasses

import pytest

from kerfwise.encoder.cut import CutSequence
from kerfwise.postproc.check import CheckResult, RelaxedStatement, check_cuts, report
from kerfwise.postproc.check.cuts_from_program import rebuild
from kerfwise.postproc.check.reader.controls import Setup
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan, check_program, judge, report_of
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.tests.postproc.plans import KERF_MM, cut_of, good_cuts, plan_of, plate, profile

PLATE, PROFILE = plate(), profile()
PLAN = plan_of(PLATE, good_cuts(PLATE), PROFILE)
PROGRAM = write_program(PLAN, PLATE, PROFILE)


@pytest.mark.parametrize(
    "result",
    [check_plan(PLATE, PLAN, PROFILE), check_program(PLATE, PROGRAM, PROFILE), judge(PLATE, PLAN, PROGRAM, PROFILE)],
    ids=["plan", "program", "both"],
)
def test_a_good_plan_passes(result: CheckResult) -> None:
    assert result.ok
    assert {j.id: j.verdict for j in result.rules if j.verdict not in ("holds", "off")} == {}
    assert result.warnings == ()


def test_every_rule_of_the_profile_is_judged() -> None:
    judged = {j.id for j in check_program(PLATE, PROGRAM, PROFILE).rules}
    assert set(PROFILE.settings()) <= judged
    assert {
        "every-contour-once",
        "contour-geometry",
        "kerf-side",
        "on-sheet",
        "no-gouging",
        "torch-off-travel",
    } <= judged


def test_a_program_is_rebuilt_into_the_cuts_it_was_written_from() -> None:
    built = rebuild(PLATE, read_nc(PROGRAM, Setup(PROFILE.machine.travel_mm_s)), KERF_MM, (0, 0))
    assert built.cuts.start_side == "left"
    for cut, planned in zip(built.cuts, PLAN.cuts, strict=True):
        want = planned.cut
        assert (cut.contour, cut.direction, cut.zone) == (want.contour, want.direction, want.zone)
        assert cut.entry == pytest.approx(want.entry, abs=2e-3)
        assert cut.pierce == pytest.approx(want.pierce, abs=1e-4)
        assert cut.end == pytest.approx(want.end, abs=1e-4)
        assert (cut.start_s, cut.end_s) == pytest.approx((want.start_s, want.end_s), abs=0.02)


def test_a_program_without_comments_is_known_by_its_geometry() -> None:
    bare = "".join(line + "\n" for line in PROGRAM.splitlines() if not line.startswith("("))
    built = rebuild(PLATE, read_nc(bare), KERF_MM, (0, 0))
    assert [c.contour for c in built.cuts] == [p.cut.contour for p in PLAN.cuts]
    result = check_program(PLATE, bare, PROFILE)
    assert result.ok
    assert {j.id for j in result.rules if j.verdict == "not judged"} == {"level-ahead", "start-side", "zone-order"}


def test_the_report_lists_every_rule_and_ends_with_the_verdict() -> None:
    text = report(check_plan(PLATE, PLAN, PROFILE))
    assert all(name in text for name in PROFILE.settings())
    idle_mm = PLAN.totals.idle_mm
    assert text.endswith(
        f"9 paths, {PLAN.totals.cut_mm:.1f} mm torch on, {idle_mm:.1f} mm idle\nok: every hard rule holds"
    )
    assert f"mm torch on, {idle_mm:.1f} mm idle" in report(check_program(PLATE, PROGRAM, PROFILE))


def test_verdicts_go_back_to_the_plan_and_are_then_held_against_it() -> None:
    verdicts = report_of(check_plan(PLATE, PLAN, PROFILE), PROFILE)
    assert {v.id for v in verdicts} == set(PROFILE.settings())
    assert check_plan(PLATE, dataclasses.replace(PLAN, rules=verdicts), PROFILE).ok
    lie = tuple(dataclasses.replace(v, holds=v.id != "pierce") for v in verdicts if v.id != "zone-order")
    result = check_plan(PLATE, dataclasses.replace(PLAN, rules=lie), PROFILE)
    assert result.broken() == ("claims",)
    assert [v.text for v in result.rule("claims").violations] == [
        "rule pierce holds, the plan says that it is broken",
        "rule zone-order holds, the plan says nothing of it",
    ]


def test_a_plan_made_with_another_profile_need_not_know_all_rules_of_this_one() -> None:
    verdicts = tuple(v for v in report_of(check_plan(PLATE, PLAN, PROFILE), PROFILE) if v.id != "zone-order")
    other = {"name": "other", "sha256": "0" * 64}
    assert check_plan(PLATE, dataclasses.replace(PLAN, rules=verdicts, profile=other), PROFILE).ok
    false = tuple(dataclasses.replace(v, holds=v.id != "pierce") for v in verdicts)
    assert not check_plan(PLATE, dataclasses.replace(PLAN, rules=false, profile=other), PROFILE).ok


def test_soft_rules_never_fail_the_check() -> None:
    rules = dict(PROFILE.rules)
    rules["zone-order"] = dataclasses.replace(rules["zone-order"], strength="soft", weight=1.0)
    plant = profile(rules=rules)
    cuts = CutSequence(tuple(dataclasses.replace(c, zone=3 - c.zone) for c in good_cuts(PLATE)), "left")
    result = check_cuts(PLATE, cuts, plant)
    assert result.rule("zone-order").verdict == "broken"
    assert result.ok
    rules["zone-order"] = dataclasses.replace(rules["zone-order"], strength="off", weight=None)
    result = check_cuts(PLATE, cuts, profile(rules=rules))
    assert result.rule("zone-order").verdict == "off"
    assert "off        off  zone-order" in report(result)
    assert "zone-order" not in {verdict.id for verdict in report_of(result, plant)}


def test_parts_closer_than_the_kerf_are_refused_unless_contours_may_touch() -> None:
    tight = nest(300, 120, part("A", rect(20, 20, 60, 60)), part("B", rect(81, 20, 60, 60)))
    cuts = [cut_of(tight.contour("A.outer"), 0.1, "cw"), cut_of(tight.contour("B.outer"), 0.1, "cw")]
    rules = dict(PROFILE.rules)
    rules["shared-metal"] = dataclasses.replace(rules["shared-metal"], strength="off")
    wood = dataclasses.replace(PROFILE, rules=rules)
    plan = plan_of(tight, cuts, PROFILE)
    program = write_program(plan, tight, PROFILE)
    for result in (check_plan(tight, plan, PROFILE), check_program(tight, program, PROFILE)):
        assert result.broken() == ("no-gouging", "shared-metal")
    for result in (check_plan(tight, plan, wood), check_program(tight, program, wood)):
        assert result.ok, report(result)
        assert result.warnings == (
            "A and B are less than the kerf of 1.5 mm apart: each cut takes metal of both, up to 0.500 mm",
        )
    let = RelaxedStatement("shared-metal", ("A.outer", "B.outer"))
    told = program.replace("(CUT 1", "(RELAXED 1 shared-metal A.outer B.outer)\n(CUT 1")
    for result in (check_cuts(tight, plan.sequence(), PROFILE, None, (let,)), check_program(tight, told, PROFILE)):
        assert result.ok, report(result)
        assert result.rule("shared-metal").verdict == "excused"
        assert result.warnings == ("relaxed: shared-metal about A.outer, B.outer",)


def test_an_empty_nest_and_no_cuts() -> None:
    empty = nest(100, 100)
    assert check_cuts(empty, CutSequence((), "left"), PROFILE).ok
    assert check_program(empty, "G21\nM2\n", PROFILE).ok


def test_two_contours_whose_kerfs_share_one_path_are_told_apart_by_the_comment() -> None:
    # a disc in a hole exactly one kerf wider: the torch runs the same circle for both
    both = nest(200, 200, part("H", rect(20, 20, 160, 160), [circle(100, 100, 51.5)]), part("D", circle(100, 100, 50)))
    program = "G21\nG0 X100 Y100\n{}M3 $0 S1\nG1 X150.75 Y100 F600\nG3 I-50.75\nG1 X150 Y100\nM5 $0\nM2\n"
    for name in ("D.outer", "H.hole1"):
        built = rebuild(both, read_nc(program.format(f"(CUT 1 {name} ZONE 1 CCW)\n")), KERF_MM, (0, 0))
        assert [c.contour for c in built.cuts] == [name]
