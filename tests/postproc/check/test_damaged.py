"""A good plan damaged on purpose fails, and the rule that is broken is named."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.postproc.check import check_cuts, report
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan, check_program
from kerfwise.tests.postproc.plans import cut_of, good_cuts, plan_of, plate, profile

PLATE, PROFILE = plate(), profile()
Cuts = list[Cut]
NAMES = [cut.contour for cut in good_cuts(PLATE)]


def swapped(a: str, b: str) -> Callable[[Cuts], Cuts]:
    def damage(cuts: Cuts) -> Cuts:
        i, j = NAMES.index(a), NAMES.index(b)
        cuts[i], cuts[j] = cuts[j], cuts[i]
        return cuts

    return damage


def changed(name: str, change: Callable[[Cut], Cut]) -> Callable[[Cuts], Cuts]:
    return lambda cuts: [change(cut) if cut.contour == name else cut for cut in cuts]


def pierced_at(x: float, y: float) -> Callable[[Cut], Cut]:
    def change(cut: Cut) -> Cut:
        assert cut.lead_in is not None
        join = cut.lead_in.end
        return replace(cut, pierce=(x, y), lead_in=Curve.of([(x, y), join], closed=False))

    return change


def wrong_side(cut: Cut) -> Cut:
    contour = PLATE.contour(cut.contour)
    along = contour.curve.project(cut.entry)[0] / contour.curve.length_mm
    other = replace(contour, kind="hole" if contour.kind == "outer" else "outer")
    return cut_of(other, along, cut.direction, cut.zone)


DAMAGE: dict[str, tuple[Callable[[Cuts], Cuts], set[str]]] = {
    "hole after its outer": (swapped("A.hole1", "A.outer"), {"inner-before-outer", "part-contiguous", "loose-metal"}),
    "two parts swapped": (
        swapped("D.outer", "A.outer"),
        {"level-ahead", "part-contiguous", "zone-order"},
    ),
    "host's hole before its guest": (
        swapped("C.outer", "B.hole1"),
        {"nested-before-host-holes", "inner-before-outer", "part-contiguous", "pierce", "loose-metal"},
    ),
    "mark last": (lambda cuts: [*cuts[1:], cuts[0]], {"marks-first", "inner-before-outer"}),
    "pierce in a part": (changed("D.outer", pierced_at(370, 100)), {"pierce", "no-gouging"}),
    "pierce in a neighbour": (changed("D.outer", pierced_at(462, 130)), {"pierce", "no-gouging"}),
    "lead across another contour": (changed("A.outer", pierced_at(70, 90)), {"pierce", "no-gouging", "loose-metal"}),
    "contour dropped": (lambda cuts: [c for c in cuts if c.contour != "E.outer"], {"every-contour-once"}),
    "contour cut twice": (lambda cuts: [*cuts, cuts[-1]], {"every-contour-once"}),
    "direction flipped": (changed("A.outer", lambda cut: replace(cut, direction="ccw")), {"cut-direction"}),
    "zone order broken": (changed("A.outer", lambda cut: replace(cut, zone=2)), {"zone-order"}),
}
LONG_LEADS = {"pierce in a part", "pierce in a neighbour", "lead across another contour"}
"""A plan says itself how long its leads are; of a program the profile does."""


@pytest.mark.parametrize("name", DAMAGE)
def test_damaged_plan(name: str) -> None:
    damage, rules = DAMAGE[name]
    result = check_plan(PLATE, plan_of(PLATE, damage(good_cuts(PLATE)), PROFILE), PROFILE)
    assert set(result.broken()) == rules
    assert "FAILED" in report(result)


@pytest.mark.parametrize("name", DAMAGE)
def test_damaged_plan_written_as_a_program(name: str) -> None:
    damage, rules = DAMAGE[name]
    program = write_program(plan_of(PLATE, damage(good_cuts(PLATE)), PROFILE), PLATE, PROFILE)
    rules = rules | {"links"} if name in LONG_LEADS else rules
    assert set(check_program(PLATE, program, PROFILE).broken()) == rules


def moved_by(dx: float, what: str) -> Callable[[Cut], Cut]:
    def change(cut: Cut) -> Cut:
        value = getattr(cut, what)
        new = value.moved(dx, 0) if isinstance(value, Curve) else (value[0] + dx, value[1])
        return replace(cut, **{what: new})

    return change


@pytest.mark.parametrize(
    ("name", "change", "rule", "text"),
    [
        (
            "E.outer",
            moved_by(0.1, "entry"),
            "contour-geometry",
            "cut 9: E.outer: the entry is 0.100 mm off the contour",
        ),
        (
            "E.outer",
            moved_by(0.1, "pierce"),
            "contour-geometry",
            "cut 9: E.outer: the lead-in does not start at the pierce",
        ),
        ("E.outer", moved_by(0.1, "lead_out"), "contour-geometry", "the lead-out does not start where the round ends"),
        (
            "E.outer",
            lambda cut: moved_by(0.1, "lead_in")(moved_by(0.1, "pierce")(cut)),
            "contour-geometry",
            "cut 9: E.outer: the torch joins 0.100 mm off where the kerf asks for it",
        ),
        (
            "E.outer",
            lambda cut: replace(cut, entry=(480, 90)),
            "contour-geometry",
            "the torch joins 14.020 mm from the entry",
        ),
        ("C.hole1", wrong_side, "kerf-side", "the torch joins C.hole1 outside, so that the kerf is on the part's side"),
        (
            "A.mark1",
            lambda cut: replace(cut, pierce=(40, 40)),
            "contour-geometry",
            "marking does not start where the line",
        ),
        ("A.outer", pierced_at(64, -30), "on-sheet", "cut 3: 30.0 mm of the path of A.outer lie off the sheet"),
    ],
)
def test_damaged_geometry_in_a_plan(name: str, change: Callable[[Cut], Cut], rule: str, text: str) -> None:
    plan = plan_of(PLATE, changed(name, change)(good_cuts(PLATE)), PROFILE)
    assert any(text in v.text for v in check_plan(PLATE, plan, PROFILE).rule(rule).violations)


@pytest.mark.parametrize(
    ("totals", "text"),
    [
        ({"idle_mm": 0.2}, "the idle travel is"),
        ({"cut_mm": 20.0}, "the torch is on for"),
        ({"pierces": 1}, "there are 8 pierces, the plan says 9"),
        ({"time_s": -30.0}, "the last cut ends at"),
    ],
)
def test_false_totals(totals: dict[str, float], text: str) -> None:
    plan = plan_of(PLATE, good_cuts(PLATE), PROFILE)
    wrong = {key: getattr(plan.totals, key) + value for key, value in totals.items()}
    result = check_plan(PLATE, replace(plan, totals=replace(plan.totals, **wrong)), PROFILE)
    assert result.broken() == ("totals",)
    assert text in result.rule("totals").violations[0].text


def test_false_lengths_and_times() -> None:
    plan = plan_of(PLATE, good_cuts(PLATE), PROFILE)
    first, *rest = plan.cuts
    for wrong in (replace(first, length_mm=first.length_mm + 1), replace(first, cut=replace(first.cut, end_s=9.0))):
        result = check_plan(PLATE, replace(plan, cuts=(wrong, *rest)), PROFILE)
        assert result.broken() == ("totals",)


def test_a_contour_that_the_nest_does_not_have() -> None:
    cuts = [*good_cuts(PLATE), replace(good_cuts(PLATE)[-1], contour="Z.outer")]
    result = check_cuts(PLATE, CutSequence(tuple(cuts), "left"), PROFILE)
    assert result.broken() == ("every-contour-once",)
    assert "cut 10 is of Z.outer, which the nest does not have" in report(result)
