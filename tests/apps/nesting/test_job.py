"""Layouts that are weighed for cutting: one that the check refuses is told and not taken; nothing else is lost."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kerfwise.apps.nesting import find_nests
from kerfwise.apps.nesting.find_nests import NestingRequest, NestingResult, Watching, weighed_lines
from kerfwise.apps.nesting.find_nests import find_nests as find_nests_job
from kerfwise.apps.nesting.nests import Nested, nests_from
from kerfwise.apps.nesting.placement.demand import Demand, PartType, Spacing, Stock
from kerfwise.apps.nesting.placement.layout import Layout
from kerfwise.apps.nesting.placement.rounds import Effort
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Sheet
from kerfwise.jobs.progress import Listener
from kerfwise.rules.case import part, rect
from kerfwise.rules.profile.load import load_profile

FAULT = "sheet1: plate-1 lies too near to plate-2"
PLANT = load_profile("laser-st10kp-2mm")


def found_where_refused(monkeypatch: pytest.MonkeyPatch, *refused: int) -> NestingResult:
    """What is found for cutting where the check refuses those of the layouts, from 0 on."""
    seen: list[Layout] = []

    def with_fault(layout: Layout) -> Nested:
        seen.append(layout)
        nested = nests_from(layout)
        return replace(nested, faults=(FAULT,)) if len(seen) - 1 in refused else nested

    monkeypatch.setattr(find_nests, "nests_from", with_fault)
    types = (
        PartType("plate", part("plate", rect(0, 0, 90, 40)), 3),
        PartType("strip", part("strip", rect(0, 0, 150, 20)), 2),
    )
    wanted = Demand(types, (Stock("sheet", Sheet.rectangle(400, 300)),))
    asked = NestingRequest(PLANT, wanted, Spacing(6.0, 10.0), Effort(4), purpose="cutting", most=2, work=0.2)
    return find_nests_job(asked, Watching(), lambda name: Listener(), lambda text: None)


@pytest.mark.parametrize("refused", [0, 1])
def test_a_layout_that_the_check_refuses_is_told_and_another_is_taken(
    monkeypatch: pytest.MonkeyPatch, refused: int
) -> None:
    found = found_where_refused(monkeypatch, refused)
    assert [one.price is None for one in found.weighed] == [number == refused for number in (0, 1)]
    assert found.taken is found.weighed[1 - refused]
    assert found.nested.faults == ()
    lines = list(weighed_lines(found, PLANT))
    assert lines[refused - 2].endswith(f"no plan: the check refuses it: {FAULT}")


def test_where_the_check_refuses_all_layouts_nothing_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match="the check refuses these nests; nothing was written"):
        found_where_refused(monkeypatch, 0, 1)
