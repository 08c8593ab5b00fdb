"""Passes along slots narrower than the kerf, by hand: what the simulation lets them take, and what not."""

from __future__ import annotations

import pytest

from kerfwise import Nest
from kerfwise.rule_kit import nest, part
from kerfwise.tests.metal.findings import Finding
from kerfwise.tests.metal.hand_made import KERF_MM, Blocks, program, straight
from kerfwise.tests.metal.simulate import by_kind, simulate

ROWS = [(20, 20), (70, 20), (70, 70), (45.5, 70), (45.5, 40), (44.5, 40), (44.5, 70), (20, 70)]
"""A plate of 50 x 50 mm with a slot 1 mm wide and 30 mm deep; the kerf is 2 mm."""
ROUND = straight(
    (14, 45), (19, 45), (19, 70.414), (19.586, 71), (44.5, 71), (45, 70.866), (45.5, 71), (70.414, 71), (71, 70.414),
    (71, 19.586), (70.414, 19), (19.586, 19), (19, 19.586), (19, 45),
)  # fmt: skip
"""Corners cut a little short, and down to where the kerf meets both edges of the mouth."""
PASS = straight((45, 78), (45, 70.866), (45, 41))


def sheet() -> Nest:
    return nest(100, 100, part("A", ROWS))


def judged(*cuts: tuple[str, Blocks], slits: bool = True) -> list[Finding]:
    return simulate(sheet(), program(cuts), KERF_MM, slits=slits)


def test_a_pass_along_the_middle_and_then_the_contour_is_no_fault() -> None:
    assert judged(("A.slit1", PASS), ("A.outer", ROUND)) == []


def test_where_no_slits_are_allowed_it_erodes_the_part() -> None:
    found = judged(("A.slit1", PASS), ("A.outer", ROUND), slits=False)
    assert by_kind(found) == {"part-eroded": 1}
    assert found[0].size == pytest.approx(0.5, abs=0.01)


def test_without_it_the_slot_is_lost() -> None:
    assert by_kind(judged(("A.outer", ROUND))) == {"feature-lost": 1}


@pytest.mark.parametrize(("off_mm", "faults"), [(0.05, 0), (0.1, 1)])
def test_beside_the_middle_the_part_loses_more_than_it_may(off_mm: float, faults: int) -> None:
    beside = straight((45 + off_mm, 78), (45 + off_mm, 70.866), (45 + off_mm, 41))
    assert by_kind(judged(("A.slit1", beside), ("A.outer", ROUND))).get("part-eroded", 0) == faults


@pytest.mark.parametrize(("end", "kind"), [(42.5, "feature-lost"), (40.3, "part-eroded")])
def test_it_ends_half_a_kerf_before_the_slots_end(end: float, kind: str) -> None:
    found = judged(("A.slit1", straight((45, 78), (45, 70.866), (45, end))), ("A.outer", ROUND))
    assert kind in by_kind(found)


def test_after_its_contour_it_burns_a_loose_part() -> None:
    assert "loose-part-burnt" in by_kind(judged(("A.outer", ROUND), ("A.slit1", PASS)))


def test_a_pass_somewhere_else_is_still_a_burn_in_a_part() -> None:
    found = judged(("A.slit1", straight((60, 78), (60, 41))), ("A.outer", ROUND))
    assert {"part-eroded", "feature-lost"} <= by_kind(found).keys()


def test_its_lead_is_judged_as_any_other() -> None:
    over = straight((36, 70.3), (45, 70.866), (45, 41))
    assert "part-eroded" in by_kind(judged(("A.slit1", over), ("A.outer", ROUND)))
