"""Contours that several burns cut: grids of which every edge is cut once, and what can be wrong with them."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check import CheckResult, check_program, report
from kerfwise.postproc.check.cuts_from_program import rebuild
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.metal.simulate import by_kind, simulate
from kerfwise.tests.postproc.by_lines import AT, H, Line, W, across, grid, program_of, upright
from kerfwise.tests.postproc.plans import KERF_MM, profile

COLUMNS, ROWS = 4, 3
GRID = grid(COLUMNS, ROWS)
INNER = [across(COLUMNS, 1), across(COLUMNS, 2), *(upright(ROWS, k) for k in (1, 2, 3))]
FRAME = [across(COLUMNS, 0), upright(ROWS, 0), across(COLUMNS, ROWS), upright(ROWS, COLUMNS)]


def bare() -> Profile:
    """The profile without the rules that speak of pierces and of orders: what burns do to the metal is left."""
    given = profile()
    kept = ("inner-before-outer", "shared-metal")
    rules = {name: s if name in kept else replace(s, strength="off", weight=None) for name, s in given.rules.items()}
    return replace(given, rules=rules)


PROFILE = bare()


def judged(burns: list[Line], sheet: Nest = GRID) -> CheckResult:
    return check_program(sheet, program_of(burns, PROFILE), PROFILE)


def test_a_grid_of_which_every_edge_is_cut_once() -> None:
    result = judged([*INNER, *FRAME])
    assert result.ok, report(result)
    lines_mm = 4 * (COLUMNS * (W + KERF_MM)) + 5 * (ROWS * (H + KERF_MM))
    assert result.measured.on_mm == pytest.approx(lines_mm, abs=0.01)
    assert result.measured.paths == 9


def test_a_grid_comes_out_in_the_order_in_which_its_edges_close() -> None:
    program = read_nc(program_of([*INNER, *FRAME], PROFILE))
    cuts = rebuild(GRID, program, KERF_MM, (0, 0)).cuts
    names = [cut.contour for cut in cuts]
    assert names == [f"P{k}.outer" for k in (5, 8, 4, 7, 1, 2, 3, 6, 9, 10, 11, 12)]
    assert [cut.linked for cut in cuts] == [k in (3, 5, 7, 8, 10, 11) for k in range(12)]
    assert all(cut.span is not None for cut in cuts)


def test_an_edge_left_out() -> None:
    result = judged([*INNER[:-1], *FRAME])
    assert result.broken() == ("every-contour-once",)
    assert len(result.rule("every-contour-once").violations) == 6
    assert "P7.outer is not cut all along: 40.0 mm are left, at (213.8, 50.0); line 25 cut it" in report(result)


def test_an_edge_cut_twice() -> None:
    result = judged([*INNER, INNER[-1], *FRAME])
    assert result.broken() == ("burnt-twice",)
    assert "mm of P7.outer are burnt again, at (" in report(result)


def test_a_block_cut_off_before_it_is_divided() -> None:
    result = judged([*FRAME, *INNER])
    assert result.broken() == ("loose-metal",)
    named = {violation.contours[0] for violation in result.rule("loose-metal").violations}
    assert len(named) == len(GRID.contours) - 1  # the last stretch of one is burnt in the name of its neighbour
    assert "line 35: P1.outer is cut in metal that is loose since line 20: the piece at" in report(result)


def test_a_part_cut_loose_before_its_hole() -> None:
    two = replace(GRID, parts=(replace(part("P1", rect(AT, AT, W, H), [circle(AT + 30, AT + 20, 8)])), *GRID.parts[1:]))
    hole = [(AT + 30, AT + 20), (AT + 30 + 7.25, AT + 20)]
    ring = [*hole, *_round(AT + 30, AT + 20, 7.25)]
    assert judged([ring, *INNER, *FRAME], two).ok
    late = judged([*INNER, *FRAME, ring], two)
    assert set(late.broken()) == {"loose-metal", "inner-before-outer"}


def _round(x: float, y: float, r: float) -> Line:
    import math

    return [(x + r * math.cos(math.tau * k / 180), y + r * math.sin(math.tau * k / 180)) for k in range(1, 181)]


ONE = nest(200, 200, part("A", rect(40, 40, 100, 60)))
LOW, HIGH = 40 - KERF_MM / 2, (140 + KERF_MM / 2, 100 + KERF_MM / 2)
HALVES: list[Line] = [
    [(90, LOW), (HIGH[0], LOW), HIGH, (90, HIGH[1])],
    [(90, HIGH[1]), (LOW, HIGH[1]), (LOW, LOW), (90, LOW)],
]


def test_a_pierce_that_finishes_no_contour_is_judged_too() -> None:
    given = replace(PROFILE, rules={**PROFILE.rules, "pierce": profile().rules["pierce"]})
    out: list[Line] = [[(x, y), *burn] for (x, y), burn in zip([(95, LOW - 5), (84, HIGH[1] + 5)], HALVES, strict=True)]
    assert check_program(ONE, program_of(out, given), given).ok
    on_part: list[Line] = [[(95, LOW + 5), *HALVES[0]], out[1]]
    result = check_program(ONE, program_of(on_part, given), given)
    assert {"pierce", "no-gouging"} == set(result.broken())
    assert "A.outer (cut 1) is pierced inside itself, at (95.00, 44.25)" in report(result)


@pytest.mark.parametrize(
    ("burns", "kinds"),
    [
        ([*INNER, *FRAME], set()),
        ([*INNER[:-1], *FRAME], {"left-uncut"}),
        ([*FRAME, *INNER], {"loose-part-burnt"}),
    ],
)
def test_the_second_judge_agrees(burns: list[Line], kinds: set[str]) -> None:
    found = simulate(GRID, program_of(burns, PROFILE), KERF_MM, touching=True)
    ignored = {"pierce-over-void", "lead-over-void", "cut-twice"}
    assert set(by_kind(found)) - ignored == kinds
