"""Cases are read as they are written, in a file of a rule and in comments of a model file; mistakes have a place."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from kerfwise import InputError
from kerfwise.rule_kit import Case
from kerfwise.rules.case_file import model_cases, read_cases
from kerfwise.rules.flat.model_rule import read_model_rule
from kerfwise.rules.registry import RULES
from kerfwise.rules.run_cases import run_cases
from kerfwise.tests.rules.outside.written import NEST

FILE = """\
nests:
  row:
    sheet: {size: 300 x 100, scrap: ["200 0, 200 100"], common: [A.outer B.outer]}
    A: {outer: rect 10 10 60 60, holes: [circle 40 40 10], tabs: [40 10 0.5]}
    B: rect 90 10 60 60
cuts:
  from-below: A.outer entry 40 10 lead-in 40 4, 40 9 lead-out 40 9, 30 4
cases:
- boundary: all that can be said
  nest: row
  cuts: A.hole1 cw overcut 5, from-below ccw tab tab 50 10 2, B.outer linked at 90 20 span 90 20, 150 20, scrap1
  options: {limit: 100 °C, heat_limit_c: 90}
  start_side: top
  zones: {A: 1, B: 2}
  home: 75 0
  times: 0 10, 11 12, 13 14, 20 21
  hot_spots: [131.2 °C at 155.2 100 after 31 s, 90 °C at 40 40 after 32 s on A]
  violations:
  - {contours: A.outer B.outer, cuts: 2 3, text: "A.outer (cut 2), not B.outer: hot"}
"""


def in_a_file(folder: Path, text: str) -> tuple[Case, ...]:
    path = folder / "cases.yaml"
    path.write_text(text, encoding="utf-8")
    return read_cases(path, RULES["t-max"])


def test_all_that_can_be_said_in_a_file(tmp_path: Path) -> None:
    (case,) = in_a_file(tmp_path, FILE)
    hole, outer, linked, scrap = case.cuts
    assert (case.name, case.kind, case.options.limit_c, case.options.heat_limit_c) == (
        "all that can be said", "boundary", 100.0, 90.0,
    )  # fmt: skip
    assert hole.direction == "cw"
    assert hole.lead_out is not None
    assert hole.lead_out.length_mm == pytest.approx(5, abs=1e-3)
    assert (outer.entry, outer.pierce, outer.join, outer.end) == ((40, 10), (40, 4), (40, 9), (30, 4))
    assert (outer.direction, [(t.at, t.width_mm) for t in outer.tabs]) == ("ccw", [((40, 10), 1), ((50, 10), 2)])
    assert (linked.linked, linked.entry, linked.pierce) == (True, (90, 20), (90, 20))
    assert linked.span is not None
    assert linked.span.end == (150, 20)
    assert [(cut.zone, cut.start_s, cut.end_s) for cut in case.cuts] == [
        (1, 0, 10),
        (1, 11, 12),
        (2, 13, 14),
        (0, 20, 21),
    ]
    assert (case.cuts.start_side, case.cuts.home, scrap.contour) == ("top", (75, 0), "scrap1")
    assert [(s.peak_c, s.at, s.at_s, s.part) for s in case.cuts.hot_spots or ()] == [
        (131.2, (155.2, 100), 31, ""), (90, (40, 40), 32, "A"),
    ]  # fmt: skip
    assert (case.nest.parts[0].tabs[0].width_mm, case.nest.notes[0].contours) == (0.5, ("A.outer", "B.outer"))
    (violation,) = case.violations
    assert (violation.rule, violation.contours, violation.cuts) == ("t-max", ("A.outer", "B.outer"), (2, 3))


MISTAKES_IN_A_FILE = {
    ("- boundary", "- bounds"): r"cases.yaml:9:3: case: unknown key 'bounds': did you mean 'boundary'",
    ("nest: row", "nest: raw"): r"cases.yaml:10:9: all that can be said: unknown nest 'raw': did you mean 'row'",
    ("A.hole1 cw", "A.hole2 cw"): r"11:9: .*, cuts: unknown contour 'A.hole2': did you mean 'A.hole1'",
    ("overcut 5", "overcut 5 6"): r"expected cw, .* each with its numbers, after A.hole1, got 'overcut' with \[5.0, 6",
    ("tab 50 10 2", "tab 50 10"): r"after A.outer, got 'tab' with \[50.0, 10.0\]",
    ("limit: 100 °C", "limits: 100 °C"): r"options: unknown option 'limits': did you mean 'limit'",
    ("heat_limit_c: 90", "heat_limit_c: hot"): r"options.heat_limit_c: expected a value of type float, got 'hot'",
    ("side: top", "side: up"): r"13:15: all that can be said.start_side: expected",
    ("home: 75 0", "home: 75"): r"home: expected 2 numbers, got '75'",
    (", 20 21", ""): r"times: expected 8 numbers, got '0 10, 11 12, 13 14'",
    ("after 31 s", "at 31 s"): r"hot_spots: expected 120 °C at 62.4 99.6 after 31 s",
    ("text:", "txt:"): r"violations: unknown key 'txt': did you mean 'text'",
    ("{contours: A.outer B.outer, cuts: 2 3, ", "{cuts: two, "): r"violations: expected contours, cuts by number, and",
    ("size: 300 x 100, ", ""): r"nests.row.sheet: expected size, such as size: 300 x 100, and scrap, slits or common",
    ("circle 40", "disc 40"): r"4:42: nests.row.A.holes: expected rect x y width height, circle",
    ("40 10 0.5", "40 10"): r"nests.row.A.tabs: expected 3 numbers",
    ("  cuts: A", "  cut: A"): r"expected a name behind one of passes, fails, boundary, a nest and cuts",
    ("nests:", "nests: ["): r"cases.yaml:.*not YAML",
}  # fmt: skip


@pytest.mark.parametrize(("old", "new"), MISTAKES_IN_A_FILE)
def test_mistakes_in_a_file_have_their_place(old: str, new: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as raised:
        in_a_file(tmp_path, FILE.replace(old, new, 1))
    assert re.search(MISTAKES_IN_A_FILE[old, new], "\n".join([str(raised.value), *raised.value.details]))


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cases.yaml: rule t-max has no cases: expected the file"):
        read_cases(tmp_path / "cases.yaml", RULES["t-max"])


RULE = """\
% bars-last: bars are cut last.
int: bars_last_ratio;  % default 4: how long a bar is

array[int] of var bool: bars_last_holds = [before(i, j) | i, j in CONTOUR where long[j] /\\ not long[i]];

"""


def in_a_model(folder: Path, text: str) -> tuple[Case, ...]:
    path = folder / "bars_last.mzn"
    path.write_text(RULE + "".join(f"% {line}\n" for line in text.splitlines()), encoding="utf-8")
    return model_cases(read_model_rule(path), path)


WHOLE = """\
cases:
- nest:
    sheet: 300 x 200
    A: rect 10 10 60 60
    Disc: circle 200 60 30
    Hook: polygon 10 100, 100 100, 100 110, 20 110, 20 180, 10 180
    Frame:
      outer: rect 150 100 80 80
      holes: [circle 190 140 20]
      marks: [160 110, 170 110]
      attributes: {priority: 1, customer: B}
  right:
    - A.outer Disc.outer Hook.outer/ccw Frame.mark1 Frame.hole1 Frame.outer
  wrong:
    - Frame.outer Frame.hole1 Frame.mark1 Hook.outer Disc.outer A.outer
  options: {ratio: 3}
"""


def test_all_that_can_be_said(tmp_path: Path) -> None:
    right, wrong = in_a_model(tmp_path, WHOLE.replace("[160 110, 170 110]", "['160 110, 170 110']"))
    assert (right.kind, wrong.kind) == ("passes", "fails")
    assert [c.id for c in right.nest.contours] == [
        "A.outer", "Disc.outer", "Hook.outer", "Frame.mark1", "Frame.hole1", "Frame.outer",
    ]  # fmt: skip
    assert right.nest.parts[3].attributes == {"priority": 1, "customer": "B"}
    assert [cut.direction for cut in right.cuts][:3] == ["cw", "cw", "ccw"]
    assert wrong.cuts[0].contour == "Frame.outer"
    assert right.options.ratio == 3


def test_a_nest_may_be_a_file(tmp_path: Path) -> None:
    names = [f"{p}.outer" for p in ("B", "C", "L", "G", "S1", "S2", "S3", "R")]
    order = " ".join(["A.mark1 A.hole1 A.hole2 A.outer F.hole1 F.outer", *names])
    (case,) = in_a_model(tmp_path, f"cases:\n- nest: {NEST}\n  right: [{order}]\n")
    assert len(case.nest.parts) == 10


SMALL = "cases:\n- nest: {sheet: 300 x 100, A: rect 10 10 60 60, B: rect 90 10 60 60}\n"
MISTAKES = {
    "": r"bars_last.mzn: the file has no cases: write `% cases:`",
    "cases:\n- right: [A.outer]": r"7:5: cases\[1\]: expected a nest, and orders under right or wrong",
    SMALL: r"7:5: cases\[1\]: expected a nest, and orders under right or wrong",
    SMALL + "  rigth: [A.outer B.outer]": r"8:5: cases\[1\]: unknown key 'rigth': did you mean 'right'",
    SMALL + "  right: [A.outer C.outer]": r"8:13: cases\[1\].right\[1\]: unknown contour 'C.outer'",
    SMALL + "  right: [A.outer]": r"cases\[1\].right\[1\]: expected every contour of the nest once; B.outer is missing",
    SMALL + "  right: [A.outer A.outer B.outer]": r"every contour of the nest once; one is there twice",
    SMALL + "  right: [A.outer/left B.outer]": r"expected cw, ccw, entry, .* or linked, .* after A.outer, got 'left'",
    SMALL + "  right: [A.outer left B.outer]": r"unknown contour 'left' .*; behind a contour may stand cw, ccw, entry",
    SMALL + "  right: [[A.outer]]": r"expected contours in cutting order, such as A.outer B.outer, got a list of 1",
    SMALL + "  right: [A.outer B.outer]\n  options: {rato: 3}": r"options: unknown option 'rato': did you mean 'ratio'",
    SMALL + "  right: [A.outer B.outer]\n  options: {ratio: x}": r"9:22: cases\[1\].options.ratio: expected a whole",
    "cases:\n- {nest: {sheet: 3, A: rect 1 1 1 1}, right: [A.outer]}": r"nest.sheet: expected width x height in mm",
    "cases:\n- {nest: {sheet: 3 x 3}, right: [A.outer]}": r"nest: expected a sheet, such as sheet: 300 x 100",
    "cases:\n- {nest: {sheet: 3 x 3, A: rect 1 1 1}, right: [A.outer]}": r"nest.A: expected rect x y width",
    "cases:\n- {nest: {sheet: 3 x 3, A: {holes: []}}, right: [A.outer]}": r"nest.A: expected rect .* or outer, holes",
    "cases:\n- {nest: {sheet: 3 x 3, A: {outr: rect 1 1 1 1}}, right: [A.outer]}": r"unknown key 'outr'",
    "cases:\n- nest: [": r"bars_last.mzn:.*not YAML",
}  # fmt: skip


@pytest.mark.parametrize("text", MISTAKES)
def test_mistakes_have_their_place(text: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=MISTAKES[text]):
        in_a_model(tmp_path, text)


@pytest.mark.minizinc
def test_orders_are_judged(tmp_path: Path) -> None:
    nest = "cases:\n- nest: {sheet: 300 x 100, A: rect 10 10 60 60, Bar: rect 90 10 100 20}\n"
    in_a_model(tmp_path, f"{nest}  right: [Bar.outer A.outer]\n  wrong: [A.outer Bar.outer]\n")
    rule = read_model_rule(tmp_path / "bars_last.mzn")
    right, wrong = run_cases(rule.id, {rule.id: rule})
    assert right.wrong[0].startswith("it should be right, but: ")
    assert wrong.wrong == ("it should be wrong, and the rule finds nothing",)
    in_a_model(tmp_path, f"{nest}  right: [A.outer Bar.outer]\n")
    missing, fine = run_cases(rule.id, {rule.id: read_model_rule(tmp_path / "bars_last.mzn")})
    assert missing.wrong == ("there is no order under wrong",)
    assert fine.wrong == ()
