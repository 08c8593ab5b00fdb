"""Each fault of a nest is found, and its boundary passes."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest

from kerfwise.apps.nesting.nest_check import (
    CommonEdgeLimits,
    RequestedPart,
    RequestedSheet,
    RequestedSpacing,
    nest_faults,
)
from kerfwise.encoder.cut import Tab
from kerfwise.encoder.nest import Sheet
from kerfwise.rules.case import circle, part, rect

FLAG = part("F", [(0, 0), (40, 0), (40, 10), (12, 10), (12, 30), (0, 30, -0.2)], [circle(6, 20, 3)])
ASKED = RequestedPart("F", FLAG, 2, (0.0, 180.0))
SHEETS = [RequestedSheet("200x100", Sheet.rectangle(200, 100), 1)]


def row(
    name: str, dx: float, dy: float, turn: int = 0, flip: bool = False, of: str = "F", **more: Any
) -> dict[str, Any]:
    def moved(rows: list[list[float]]) -> list[list[float]]:
        found = []
        for x, y, *bulge in rows:
            x = -x if flip else x
            for _ in range(turn // 90):
                x, y = -y, x
            found.append([x + dx, y + dy, *(-b if flip else b for b in bulge)])
        return found

    holes = [moved(hole.curve.as_rows()) for hole in FLAG.holes]
    return {"id": name, "of": of, "outer": moved(FLAG.outer.curve.as_rows()), "holes": holes, **more}


def faults(*rows: dict[str, Any], gap: float = 5.0, edge: float = 5.0, width: float = 200, count: int | None = None,
           sheets: int = 1) -> list[str]:  # fmt: skip
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": width, "height": 100}, "parts": list(rows)}
    written = {f"s{k}": json.dumps(nest).encode() for k in range(sheets)}
    asked = RequestedPart("F", FLAG, 2, (0.0, 180.0), count=count)
    return nest_faults(written, [asked], SHEETS, RequestedSpacing(gap, edge))


def test_a_nest_as_asked_for_passes_at_its_boundary() -> None:
    assert faults(row("F-1", 5 + 3, 5), row("F-2", 8 + 40 + 5 + 40, 60, turn=180), count=2) == []


@pytest.mark.parametrize(
    ("rows", "more", "said"),
    [
        ([row("F-1", 20, 20), row("F-2", 50, 20)], {}, "overlap"),
        ([row("F-1", 20, 20), row("F-2", 64, 20)], {}, "4.000 mm apart, and 5 mm were asked for"),
        ([row("F-1", 20, 4)], {}, "4.000 mm from the edge of the sheet"),
        ([row("F-1", 20, 80)], {}, "off the sheet"),
        ([row("F-1", 60, 20, turn=90)], {}, "F-1 is turned as it may not be"),
        ([row("F-1", 60, 20, flip=True)], {}, "F-1 is mirrored, which is not allowed"),
        ([row("F-1", 20, 20) | {"outer": [[20, 20], [60, 20], [60, 50], [20, 50, -0.2]]}], {}, "F-1 has another shape"),
        ([row("F-1", 20, 20) | {"outer": [[20, 20], [60, 20], [60, 30], [32, 30], [32, 50], [20, 50]]}], {}, "0 arcs"),
        ([row("F-1", 20, 20) | {"holes": []}], {}, "F-1 has 0 holes"),
        ([row("F-1", 20, 20) | {"holes": [[[24, 40, 1], [30, 40, 1]]]}], {}, "F-1 has another shape"),
        ([row("X-1", 20, 20, of="X")], {}, "X-1 is of no part that was asked for"),
        ([row(f"F-{k}", 10 + 50 * k, 20) for k in range(3)], {}, "3 of F were laid, and 2 are wanted"),
        ([row("F-1", 20, 20)], {"count": 2}, "1 of F were laid, and the table says 2"),
        ([row("F-1", 20, 20)], {"width": 201}, "its sheet is none of those that there are"),
        ([row("F-1", 20, 20)], {"sheets": 2}, "2 sheets of 200 × 100 mm are used, and there are 1"),
        ([row("F-1", 20, 20)], {"sheets": 2}, "2 parts are called F-1"),
    ],
)  # fmt: skip
def test_a_fault_is_found_and_said(rows: list[dict[str, Any]], more: dict[str, Any], said: str) -> None:
    found = faults(*rows, **more)
    assert any(said in fault for fault in found), found


@pytest.mark.parametrize(
    ("tabs", "said"),
    [
        ([{"at": [80, 50]}, {"at": [100, 40], "width": 0.8}], None),
        ([{"at": [80, 50]}], "T-1 has other tabs than the drawing"),
        ([{"at": [80, 50]}, {"at": [100, 40], "width": 0.5}], "T-1 has other tabs than the drawing"),
        ([{"at": [80, 50]}, {"at": [100, 38], "width": 0.8}], "T-1 has another shape than the drawing"),
    ],
)
def test_a_part_turned_over_keeps_its_tabs(tabs: list[dict[str, Any]], said: str | None) -> None:
    drawn = replace(part("T", rect(0, 0, 40, 30)), tabs=(Tab((20.0, 0.0), 0.0), Tab((0.0, 10.0), 0.8)))
    row = {"id": "T-1", "of": "T", "outer": [[100, 50], [60, 50], [60, 20], [100, 20]], "tabs": tabs}
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": 200, "height": 100}, "parts": [row]}
    written = {"s": json.dumps(nest).encode()}
    assert nest_faults(written, [RequestedPart("T", drawn, 1, (180.0,))], SHEETS, RequestedSpacing(5, 5)) == (
        [] if said is None else [f"s: {said}"]
    )


@pytest.mark.parametrize(("over_mm", "count"), [(0.0, 0), (0.015, 0), (0.05, 1), (3.0, 1)])
def test_corners_of_long_parts_that_touch_do_not_overlap(over_mm: float, count: int) -> None:
    long = RequestedPart("L", part("L", rect(0, 0, 2000, 500)), 2, (0.0,))
    at = [(0.0, 0.0), (2000 - over_mm, 500 - over_mm)]
    rows = [
        {"id": f"L-{k}", "of": "L", "outer": [[x, y], [x + 2000, y], [x + 2000, y + 500], [x, y + 500]]}
        for k, (x, y) in enumerate(at)
    ]
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": 4000, "height": 1000}, "parts": rows}
    sheets = [RequestedSheet("s", Sheet.rectangle(4000, 1000))]
    assert len(nest_faults({"s": json.dumps(nest).encode()}, [long], sheets, RequestedSpacing(0.0, 0.0))) == count


def test_a_part_in_the_hole_of_another_keeps_the_gap_to_its_rim() -> None:
    ring = RequestedPart("R", part("R", circle(0, 0, 40), [circle(0, 0, 30)]), 1, (0.0,))
    disc = RequestedPart("D", part("D", circle(0, 0, 25)), 1, (0.0,))
    rows = [
        {"id": "R-1", "of": "R", "outer": [[10, 50, 1], [90, 50, 1]], "holes": [[[20, 50, 1], [80, 50, 1]]]},
        {"id": "D-1", "of": "D", "outer": [[25, 50, 1], [75, 50, 1]]},
    ]
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": 100, "height": 100}, "parts": rows}
    sheets = [RequestedSheet("s", Sheet.rectangle(100, 100))]
    for gap, count in ((5.0, 0), (5.1, 1)):
        found = nest_faults({"s": json.dumps(nest).encode()}, [ring, disc], sheets, RequestedSpacing(gap, 5.0))
        assert len(found) == count, found


def box(x0: float, y0: float, x1: float, y1: float) -> list[list[float]]:
    return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]


COMMON = RequestedSpacing(2.2, 1.0, CommonEdgeLimits(0.2, 20.0, 0.05))
PLATE = RequestedPart("P", part("P", rect(0, 0, 40, 30)), 2, (0.0,))
BIG = [RequestedSheet("s", Sheet.rectangle(9000, 5000))]


def near_faults(asked: list[RequestedPart], *rows: dict[str, Any]) -> list[str]:
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": 9000, "height": 5000}, "parts": list(rows)}
    return nest_faults({"s": json.dumps(nest).encode()}, asked, BIG, COMMON)


@pytest.mark.parametrize(
    ("off_mm", "up_mm", "count"), [(0.2, 0, 0), (0.25, 0, 0), (0.12, 0, 1), (0.4, 0, 1), (0.2, 11, 1)]
)
def test_plates_are_a_kerf_apart_along_an_edge_as_long_as_asked(off_mm: float, up_mm: float, count: int) -> None:
    one = {"id": "P-1", "of": "P", "outer": box(100, 100, 140, 130)}
    other = {"id": "P-2", "of": "P", "outer": box(140 + off_mm, 100 + up_mm, 180 + off_mm, 130 + up_mm)}
    assert len(near_faults([PLATE], one, other)) == count


@pytest.mark.parametrize("turned_round", [False, True])
def test_a_part_in_a_hole_keeps_the_whole_gap_where_edges_are_cut_once(turned_round: bool) -> None:
    host = RequestedPart("H", part("H", rect(0, 0, 100, 80), [rect(10, 10, 60, 40)]), 1, (0.0,))
    rows = [
        {"id": "H-1", "of": "H", "outer": box(100, 100, 200, 180), "holes": [box(110, 110, 170, 150)]},
        {"id": "P-1", "of": "P", "outer": box(110.2, 115, 150.2, 145)},
    ]
    [said] = near_faults([host, PLATE], *(rows[::-1] if turned_round else rows))
    assert "0.200 mm apart, and 2.2 mm were asked for" in said


@pytest.mark.parametrize("turned_round", [False, True])
def test_a_round_edge_is_cut_with_no_other(turned_round: bool) -> None:
    disc = RequestedPart("D", part("D", circle(0, 0, 2000)), 1, (0.0,))
    rows = [
        {"id": "D-1", "of": "D", "outer": [[100, 2100, 1], [4100, 2100, 1]]},
        {"id": "P-1", "of": "P", "outer": box(4100.2, 2085, 4140.2, 2115)},
    ]
    [said] = near_faults([disc, PLATE], *(rows[::-1] if turned_round else rows))
    assert "0.200 mm apart, and 2.2 mm were asked for" in said


def test_an_edge_exactly_as_long_as_asked_counts_wherever_it_lies() -> None:
    small = RequestedPart("S", part("S", rect(0, 0, 40, 20)), 2, (0.0,))
    for y in (10.1, 30.3, 1000.7):
        rows = [{"id": f"S-{k}", "of": "S", "outer": box(x, y, x + 40, y + 20)} for k, x in enumerate((100, 140.2))]
        assert near_faults([small], *rows) == []
