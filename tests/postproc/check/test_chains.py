"""Burns that cut several contours: the check finds them in order, and what is wrong with links."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest

import kerfwise
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import ReadOptions, read_nest
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.postproc.check import CheckResult, check_program, report
from kerfwise.postproc.check.cuts_from_program import rebuild
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.postproc.nc.program import write_program
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import Cuts, Links
from kerfwise.tests.metal.simulate import by_kind, simulate
from kerfwise.tests.postproc.by_lines import Line, program_of
from kerfwise.tests.postproc.chains import chained, cuts_in_rows
from kerfwise.tests.postproc.plans import KERF_MM, plan_of, profile

NESTS = Path(kerfwise.__file__).parent / "examples" / "nests"


def given(name: str) -> Nest:
    if name.startswith("plate of"):
        return read_json(json.dumps(make_sheet(1, int(name.split()[-1]))).encode(), ReadOptions())
    return read_nest(NESTS / name, ReadOptions())


@pytest.mark.parametrize(("name", "links"), [("plate of 115", 17), ("plate40.json", 1), ("e1x_6.json", 0)])
def test_a_program_with_chains_gives_back_the_order_it_was_planned_in(name: str, links: int) -> None:
    sheet = given(name)
    plan = plan_of(sheet, cuts_in_rows(sheet, KERF_MM), profile())
    program = write_program(plan, sheet, profile())
    for most in (1, 2, 5):
        chains = chained(program, sheet, KERF_MM, most)
        cuts = rebuild(sheet, read_nc(chains.text), KERF_MM, (0, 0)).cuts
        assert [cut.contour for cut in cuts] == [planned.cut.contour for planned in plan.cuts]
        assert [cut.linked for cut in cuts] == [k > 0 for burn in chains.burns for k in range(len(burn))]
        assert [cut.direction for cut in cuts] == [planned.cut.direction for planned in plan.cuts]
        assert all(cut.span is None for cut in cuts)
        for cut, planned in zip(cuts, plan.cuts, strict=True):
            assert cut.entry == pytest.approx(planned.cut.entry, abs=2e-3)
    assert sum(cut.linked for cut in cuts) >= links


def allowed(links_mm: float) -> Profile:
    """Links up to a length, and every rule that does not speak of orders."""
    made = profile()
    off = ("level-ahead", "no-islands", "start-side", "cut-direction", "heat-lag", "no-narrow-strips", "zone-order")
    rules = {name: replace(s, strength="off", weight=None) if name in off else s for name, s in made.rules.items()}
    return replace(made, rules=rules, cuts=Cuts(links=Links(links_mm)))


ROW = nest(340, 120, *(part(name, rect(x, 30, 80, 50)) for name, x in (("A", 20), ("B", 120), ("C", 220))))
HALF = KERF_MM / 2


def corner(x: float, y: float, from_deg: int) -> Line:
    """A quarter round a part's corner, clockwise."""
    turns = (math.radians(from_deg - k * 7.5) for k in range(13))
    return [(x + HALF * math.cos(turn), y + HALF * math.sin(turn)) for turn in turns]


def once_round(x: float, at: float, turn: int = 0) -> Line:
    """Clockwise once round the part that begins at x, from its left side, or its right one, at a height."""
    corners = [corner(x, 80, 180), corner(x + 80, 80, 90), corner(x + 80, 30, 0), corner(x, 30, 270)]
    join = (x + 80 + HALF if turn else x - HALF, at)
    return [join, *(point for row in corners[turn:] + corners[:turn] for point in row), join]


def from_the_right(x: float, at: float) -> Line:
    return once_round(x, at, 2)


CHAIN: Line = [(106, 45), *from_the_right(20, 40), *once_round(120, 40)]
REST: Line = [(212, 52), *once_round(220, 60)]


def judged(burns: list[Line], links_mm: float = 30.0) -> CheckResult:
    return check_program(ROW, program_of(burns, allowed(links_mm)), allowed(links_mm))


def test_a_chain_of_two_parts_passes_where_links_are_allowed() -> None:
    result = judged([CHAIN, REST])
    assert result.ok, report(result)
    assert result.measured.paths == 2
    assert by_kind(simulate(ROW, program_of([CHAIN, REST], allowed(30)), KERF_MM)) == {}


@pytest.mark.parametrize(
    ("longest_mm", "says"),
    [(0.0, "is 18.5 mm long: the profile allows no links"), (15.0, "is 18.5 mm long: the profile allows 15 mm")],
)
def test_links_that_the_profile_does_not_allow(longest_mm: float, says: str) -> None:
    result = judged([CHAIN, REST], longest_mm)
    assert result.broken() == ("links",)
    assert f"line 5: the link from A.outer to B.outer at (100.8, 40.0) {says} (cuts.links.longest)" in report(result)


def test_a_link_moved_over_a_part() -> None:
    over: Line = [(106, 45), *from_the_right(20, 40), (110, 60), (130, 60), (110, 42), *once_round(120, 40)]
    result = judged([over, REST], 100)
    assert "no-gouging" in result.broken()
    assert "a lead of B.outer reaches" in report(result)
    assert "part-eroded" in by_kind(simulate(ROW, program_of([over, REST], allowed(30)), KERF_MM))


def test_a_link_over_an_older_kerf() -> None:
    around: Line = [
        (106, 40),
        *from_the_right(20, 40),
        (110, 40),
        (110, 95),
        (212, 95),
        (212, 60),
        *once_round(220, 60),
    ]
    first: Line = [(112, 100), (112, 90), *once_round(120, 60)]
    result = judged([first, around], 400)
    assert set(result.broken()) == {"links", "pierce"}
    assert "the link from A.outer to C.outer crosses the kerf of B.outer (line 5), at (112" in report(result)
    assert "lead-over-void" in by_kind(simulate(ROW, program_of([first, around], allowed(400)), KERF_MM))


def test_a_pierce_left_out() -> None:
    program = program_of([CHAIN, REST], allowed(30))
    result = check_program(ROW, re.sub(r"M3 \$0 S1\nG4 P0.5\n", "", program, count=1), allowed(30))
    assert "every-contour-once" in result.broken()
    assert all(f"{name}.outer is not cut" in report(result) for name in "AB")
    hasty = check_program(ROW, program.replace("G4 P0.5\n", "", 1), allowed(30))
    assert hasty.broken() == ("pierce-delay",)


def test_a_round_of_a_chain_that_is_not_finished() -> None:
    short: Line = [*CHAIN[:-1], (120 - HALF, 35)]
    result = judged([short, REST])
    assert result.broken() == ("every-contour-once",)
    assert "B.outer is not cut all along: 4.9 mm are left, at (119.2, 37.5); line 5 cut it" in report(result)


def test_a_contour_of_a_chain_cut_again() -> None:
    result = judged([CHAIN, [(112, 52), *once_round(120, 60)], REST])
    assert result.broken() == ("every-contour-once", "burnt-twice")
    assert "B.outer is cut again as cut 3; it was cut as cut 2" in report(result)
    turned = judged([[(112, 52), *once_round(120, 60)], CHAIN, REST])
    assert "burnt-twice" in turned.broken()
    assert "of B.outer are burnt again, at (" in report(turned)


def test_the_second_judge_sees_each_contour_of_a_chain() -> None:
    def kinds(*burns: Line) -> dict[str, int]:
        return by_kind(simulate(ROW, program_of(burns, allowed(30)), KERF_MM))

    assert kinds(CHAIN, REST) == {}
    assert kinds(CHAIN, REST, [(112, 52), *once_round(120, 60)])["cut-twice"] == 1
    assert kinds([*CHAIN[:-1], (120 - HALF, 35)], REST) == {"left-uncut": 1, "part-not-free": 1}


def test_a_chain_whose_first_round_is_on_the_wrong_side() -> None:
    low, high, left, right = 30 + HALF, 80 - HALF, 20 + HALF, 100 - HALF
    inside: Line = [(right, 40), (right, low), (left, low), (left, high), (right, high), (right, 40)]
    result = judged([[(106, 45), *inside, *once_round(120, 40)], REST])
    assert {"every-contour-once", "no-gouging"} <= set(result.broken())
    assert "A.outer is not cut" in report(result)
