"""Nests without room for a pierce are moved apart where the sheet has room, and left where it has none."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kerfwise.apps.nesting import programs
from kerfwise.apps.nesting.find_nests import weigh
from kerfwise.apps.nesting.nests import Nested, nests_from
from kerfwise.apps.nesting.placement.demand import Demand, PartType, Spacing, Stock
from kerfwise.apps.nesting.placement.layout import Layout
from kerfwise.apps.nesting.placement.rounds import Effort, best_layout
from kerfwise.apps.nesting.programs import planned
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.nest import Sheet
from kerfwise.jobs.progress import Listener
from kerfwise.rules.case import part, rect
from kerfwise.rules.profile.load import load_profile

PLANT = load_profile("plasma-carbon-steel")


def nine_plates(width_mm: float, height_mm: float) -> Nested:
    """Plates 0.2 mm apart, less than a kerf."""
    wanted = Demand(
        (PartType("plate", part("plate", rect(0, 0, 60, 30)), 9, turns_deg=(0.0,)),),
        (Stock("sheet", Sheet.rectangle(width_mm, height_mm), 1),),
    )
    return nests_from(best_layout(wanted, Spacing(0.2, 5.0), Effort(1)))


def test_parts_are_moved_apart_where_the_sheet_has_room() -> None:
    before = nine_plates(400, 300)
    made, done, moved = planned(before, 0, PLANT, 0.5, lambda name: Listener())
    assert moved.startswith("sheet1 repaired: ")
    assert moved.endswith("mm more around all parts")
    assert done.made.verdict.ok
    assert made.faults == ()
    assert made.texts != before.texts
    assert made.layout.missing == (0,)


def test_where_the_check_refuses_one_way_to_move_parts_the_next_is_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    before, moved = nine_plates(400, 300), list[Nested]()

    def first_is_refused(layout: Layout) -> Nested:
        nested = nests_from(layout)
        moved.append(nested if moved else replace(nested, faults=("plate-1 lies too near",)))
        return moved[-1]

    monkeypatch.setattr(programs, "nests_from", first_is_refused)
    made, done, _ = planned(before, 0, PLANT, 0.5, lambda name: Listener())
    assert made is not moved[0]
    assert made.faults == ()
    assert done.made.verdict.ok


def test_a_sheet_without_room_is_left_and_its_refusal_is_told() -> None:
    full = nine_plates(190.8, 100.8)
    assert full.layout.missing == (0,)
    with pytest.raises((InputError, RulesConflict)):
        planned(full, 0, PLANT, 0.5, lambda name: Listener())
    weighed = weigh(full, PLANT, 0.5, lambda name: Listener())
    assert weighed.price is None
    assert weighed.why.startswith("sheet1: ")


def test_what_was_moved_stands_in_what_was_weighed() -> None:
    weighed = weigh(nine_plates(400, 300), PLANT, 0.5, lambda name: Listener())
    assert weighed.price is not None
    assert [text.split(":")[0] for text in weighed.moved] == ["sheet1 repaired"]
