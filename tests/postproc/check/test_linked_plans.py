"""Plans with linked cuts and spans: judged as cuts, as the programs are that they were read from, and kept in files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from kerfwise.encoder.cut import Cut, CutSequence, Span
from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import read_plan
from kerfwise.postproc.check import CheckResult, check_cuts, check_program, report
from kerfwise.postproc.check.cuts_from_program import rebuild
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.postproc.by_lines import Line, program_of
from kerfwise.tests.postproc.check.test_chains import CHAIN, HALF, REST, ROW, allowed, corner
from kerfwise.tests.postproc.plans import KERF_MM, plan_of

PROFILE = allowed(30)
TWO = nest(240, 120, part("A", rect(20, 30, 80, 50)), part("B", rect(100 + KERF_MM, 30, 80, 50)))
EDGE = 100 + HALF
"""The line that A and B share."""


def of_each() -> tuple[Line, Line]:
    """A all round from the top of its right side on, and from there round what is left of B."""
    a = [(EDGE, 80), *corner(100, 30, 0), *corner(20, 30, 270), *corner(20, 80, 180), *corner(100, 80, 90)]
    x = 100 + KERF_MM
    b = [*corner(x, 80, 180), *corner(x + 80, 80, 90), *corner(x + 80, 30, 0), *corner(x, 30, 270)]
    return [(EDGE, 90), *a], b


def common() -> list[Line]:
    """Both, with the torch on all the time."""
    a, b = of_each()
    return [[*a, *b]]


def without_pierces(profile: Profile) -> Profile:
    off = replace(profile.rules["pierce"], strength="off", weight=None)
    return replace(profile, rules={**profile.rules, "pierce": off})


def cuts_of(sheet: Nest, burns: list[Line]) -> CutSequence:
    return rebuild(sheet, read_nc(program_of(burns, PROFILE)), KERF_MM, (0, 0)).cuts


def judged(sheet: Nest, cuts: CutSequence) -> CheckResult:
    return check_cuts(sheet, cuts, without_pierces(PROFILE))


def changed(cuts: CutSequence, k: int, **fields: object) -> CutSequence:
    return replace(cuts, cuts=tuple(replace(c, **fields) if n == k else c for n, c in enumerate(cuts)))  # type: ignore[arg-type]


def test_a_part_that_only_a_later_cut_of_its_neighbour_frees_is_not_out() -> None:
    """B's three sides, then A all round, the edge between them with it: A and B come out in that order."""
    a, b = of_each()
    burns = [a, [a[-1], *b]]
    cuts = cuts_of(TWO, burns)
    assert [cut.contour for cut in cuts] == ["A.outer", "B.outer"]
    assert "every-contour-once" not in judged(TWO, cuts).broken(), report(judged(TWO, cuts))
    swapped = replace(cuts, cuts=tuple(reversed(cuts.cuts)))
    result = judged(TWO, swapped)
    assert "every-contour-once" in result.broken()
    assert "B.outer is not out with its own cut 1: cut 2 of A.outer finishes it" in report(result)
    assert "every-contour-once" not in check_program(TWO, program_of(burns[::-1], PROFILE), PROFILE).broken()


@pytest.mark.parametrize(("sheet", "burns"), [(ROW, [CHAIN, REST]), (TWO, common())], ids=["chain", "common"])
def test_what_is_read_from_a_program_passes_as_a_plan(sheet: Nest, burns: list[Line]) -> None:
    program = check_program(sheet, program_of(burns, PROFILE), without_pierces(PROFILE))
    assert program.ok, report(program)
    plan = judged(sheet, cuts_of(sheet, burns))
    assert plan.ok, report(plan)
    assert plan.measured.paths == program.measured.paths == len(burns)
    assert plan.measured.on_mm == pytest.approx(program.measured.on_mm, abs=0.2)


def test_a_common_edge_is_cut_once_and_the_second_part_follows_what_is_left() -> None:
    cuts = cuts_of(TWO, common())
    assert [(c.contour, c.linked, c.span is not None) for c in cuts] == [
        ("A.outer", False, False),
        ("B.outer", True, True),
    ]
    span = cuts[1].span
    assert span is not None
    assert span.begin == pytest.approx((EDGE, 80), abs=0.3)
    assert span.end == pytest.approx((EDGE, 30), abs=0.3)


def test_a_span_too_short_and_a_link_from_nowhere() -> None:
    cuts = cuts_of(TWO, common())
    short = changed(cuts, 1, span=Span(_rounded(cuts[1]).begin, (150.0, 30.0 - HALF)))
    assert "every-contour-once" in judged(TWO, short).broken()
    assert "B.outer is not cut all along: 4" in report(judged(TWO, short))
    chain = cuts_of(ROW, [CHAIN, REST])
    moved = judged(ROW, changed(chain, 1, pierce=(105.0, 40.0)))
    assert "B.outer: the link begins 4.250 mm from where A.outer ends" in report(moved)
    first = judged(ROW, changed(chain, 0, linked=True))
    assert "A.outer: there is no cut before, to be linked with" in report(first)


def test_a_plan_file_keeps_links_and_spans(tmp_path: Path) -> None:
    plan = _plan(TWO, cuts_of(TWO, common()))
    file = tmp_path / "plan.json"
    file.write_text(plan.to_json(), encoding="utf-8")
    cut = read_plan(file).cuts[1].cut
    assert (cut.linked, cut.span) == (True, _rounded(plan.cuts[1].cut))


def _plan(sheet: Nest, cuts: CutSequence) -> Plan:
    return plan_of(sheet, list(cuts), PROFILE)


def _rounded(cut: Cut) -> Span:
    assert cut.span is not None
    begin, end = (tuple(round(v, 6) for v in at) for at in (cut.span.begin, cut.span.end))
    return Span((begin[0], begin[1]), (end[0], end[1]))
