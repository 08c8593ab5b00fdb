"""The cases in the comments of a model file: read, placed where they are wrong, and run."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.rules.case import Case
from kerfwise.rules.flat.model_rule import read_model_rule
from kerfwise.rules.run_cases import model_cases, run_cases
from kerfwise.tests.rules.outside.written import NEST

RULE = """\
% bars-last: bars are cut last.
int: bars_last_ratio;  % default 4: how long a bar is

array[int] of var bool: bars_last_holds = [before(i, j) | i, j in CONTOUR where long[j] /\\ not long[i]];

"""


def cases(folder: Path, text: str) -> tuple[Case, ...]:
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
    right, wrong = cases(tmp_path, WHOLE.replace("[160 110, 170 110]", "['160 110, 170 110']"))
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
    (case,) = cases(tmp_path, f"cases:\n- nest: {NEST}\n  right: [{order}]\n")
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
    SMALL + "  right: [A.outer/left B.outer]": r"expected a way round, cw or ccw, after A.outer/, got 'left'",
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
        cases(tmp_path, text)


@pytest.mark.minizinc
def test_orders_are_judged(tmp_path: Path) -> None:
    nest = "cases:\n- nest: {sheet: 300 x 100, A: rect 10 10 60 60, Bar: rect 90 10 100 20}\n"
    cases(tmp_path, f"{nest}  right: [Bar.outer A.outer]\n  wrong: [A.outer Bar.outer]\n")
    rule = read_model_rule(tmp_path / "bars_last.mzn")
    right, wrong = run_cases(rule.id, {rule.id: rule})
    assert right.wrong[0].startswith("it should be right, but: ")
    assert wrong.wrong == ("it should be wrong, and the rule finds nothing",)
    cases(tmp_path, f"{nest}  right: [A.outer Bar.outer]\n")
    missing, fine = run_cases(rule.id, {rule.id: read_model_rule(tmp_path / "bars_last.mzn")})
    assert missing.wrong == ("there is no order under wrong",)
    assert fine.wrong == ()
