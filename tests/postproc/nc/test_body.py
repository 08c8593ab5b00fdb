"""The blocks of a plan's cuts are kept with its nest, and given again for the same cuts only."""

from dataclasses import fields, replace

import pytest

from kerfwise.encoder.cut import Cut, Pierce, Span, Tab
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.clock import with_times
from kerfwise.postproc.nc import program
from kerfwise.postproc.nc.program import write_program
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile

PROFILE = profile()
OTHERS: dict[str, object] = {
    "contour": "B.outer",
    "direction": "ccw",
    "pierce": (1.0, 2.0),
    "lead_in": None,
    "lead_out": None,
    "zone": 9,
    "linked": True,
    "span": Span((0.0, 0.0), (1.0, 1.0)),
    "tabs": (Tab((1.0, 1.0), 0.5),),
    "torch": 2,
    "together": "A.outer",
    "way": "snake1",
}
NOT_IN_BLOCKS = {"start_s": 12.0, "end_s": 13.0, "excused": ("part-rigidity",), "entry": (1.0, 1.0)}


def test_every_field_of_a_cut_is_tried() -> None:
    assert {field.name for field in fields(Cut)} == OTHERS.keys() | NOT_IN_BLOCKS.keys()


@pytest.mark.parametrize("name", [*OTHERS, *NOT_IN_BLOCKS])
def test_what_blocks_hang_on(name: str) -> None:
    cut = next(cut for cut in good_cuts(plate()) if cut.lead_in is not None and cut.lead_out is not None)
    cut = replace(cut, direction="cw")
    other = replace(cut, **{name: {**OTHERS, **NOT_IN_BLOCKS}[name]})  # type: ignore[arg-type]
    assert (program._geometry(cut) == program._geometry(other)) == (name in NOT_IN_BLOCKS)


def made() -> Plan:
    sheet = plate()
    return plan_of(sheet, good_cuts(sheet), PROFILE)


def test_a_program_is_spelt_once_with_its_times(monkeypatch: pytest.MonkeyPatch) -> None:
    sheet, spelt = plate(), []
    plain = program._body
    monkeypatch.setattr(program, "_body", lambda *given: spelt.append(1) or plain(*given))  # type: ignore[func-returns-value]
    plan = with_times(made(), sheet, PROFILE)
    assert write_program(plan, sheet, PROFILE) == write_program(plan, plate(), PROFILE)
    assert len(spelt) == 2


def test_other_plans_profiles_and_dialects_have_blocks_of_their_own() -> None:
    sheet, plan = plate(), made()
    first, *rest = plan.cuts
    faster = replace(PROFILE, machine=replace(PROFILE.machine, cut_feed_mm_s=2 * PROFILE.machine.cut_feed_mm_s))
    essi = replace(PROFILE, machine=replace(PROFILE.machine, dialect="essi"))
    asked = [
        (plan, PROFILE),
        (replace(plan, cuts=(*rest, first)), PROFILE),
        (replace(plan, cuts=(replace(first, dwell_s=3.0), *rest)), PROFILE),
        (replace(plan, pierces=(Pierce(first.cut.contour, first.cut.pierce, 1),)), PROFILE),
        (plan, faster),
        (plan, essi),
    ]
    of_own = [write_program(one, plate(), by) for one, by in asked]
    assert len(set(of_own)) == len(asked)
    assert [write_program(one, sheet, by) for one, by in asked] == of_own
