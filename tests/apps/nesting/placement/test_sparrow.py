"""Strips packed by sparrow, in a process of its own: what it gives passes the check, or it is told to have failed."""

from __future__ import annotations

import json

import pytest

from kerfwise.apps.nesting.nests import nests_from
from kerfwise.apps.nesting.placement import sparrow
from kerfwise.apps.nesting.placement.demand import Demand, PartType, Spacing, Stock
from kerfwise.apps.nesting.placement.rounds import Effort, best_layout
from kerfwise.apps.nesting.placement.shapes import Shapes
from kerfwise.apps.nesting.placement.sparrow import compact_layout
from kerfwise.encoder.nest import Sheet
from kerfwise.rules.case import circle, part, rect

ELL = part("L", [(0, 0), (60, 0), (60, 15), (15, 15), (15, 60), (0, 60)])
RING = part("R", circle(0, 0, 50), [circle(0, 0, 38)])
BAR = part("B", rect(0, 0, 30, 12))
TYPES = (PartType("L", ELL, 6), PartType("R", RING, 2), PartType("B", BAR, 6))
WANTED = Demand(TYPES, (Stock("s", Sheet.rectangle(300, 200)),))
SPACING = Spacing(4.0, 5.0)


@pytest.mark.slow
def test_what_sparrow_packs_passes_the_check_and_is_never_worse() -> None:
    first = best_layout(WANTED, SPACING, Effort(1))
    told: list[str] = []
    made = compact_layout(first, Shapes(WANTED.types, SPACING.gap_mm), 2.5, 1, told.append)
    assert told == []
    assert made.score <= first.score
    assert nests_from(made).faults == ()


def test_a_shape_that_ends_its_process_is_told_and_the_layout_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    real = sparrow._asked

    def crossed(task: str, *rest: object) -> object:
        given = json.loads(task)
        given["items"][0]["points"] = [[0, 0], [10, 10], [10, 0], [0, 10]]
        return real(json.dumps(given), *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(sparrow, "_asked", crossed)
    first = best_layout(WANTED, SPACING, Effort(1))
    told: list[str] = []
    assert compact_layout(first, Shapes(WANTED.types, SPACING.gap_mm), 2.5, 1, told.append) is first
    assert len(told) == 1
    assert told[0].startswith("sparrow: its process ended with")


def test_it_stops_when_told_to() -> None:
    shapes = Shapes(WANTED.types, SPACING.gap_mm)
    with pytest.raises(sparrow.SparrowFailed, match="it was stopped"):
        sparrow.packed(shapes, {0: 6, 2: 6}, 190.0, 30.0, 1, lambda: False)
