"""Every rule has cases, and every case gives the violations it says, to the letter."""

from __future__ import annotations

import inspect
from dataclasses import replace
from pathlib import Path

import pytest

from kerfwise import InputError
from kerfwise.rule_kit import Case
from kerfwise.rules import catalogue
from kerfwise.rules.flat.model_rule import read_model_rule
from kerfwise.rules.options.option import options_of
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import HEADINGS, OTHER_CUTS
from kerfwise.rules.run_cases import cases_of, model_cases, run_cases
from kerfwise.tests.rules.outside.written import NEST

ALL = [pytest.param(rule, case, id=f"{rule}: {case.name}") for rule in RULES for case in cases_of(rule)]


@pytest.mark.parametrize(("rule", "case"), ALL)
def test_violations(rule: str, case: Case) -> None:
    options = case.options or RULES[rule].Options()
    assert tuple(RULES[rule].violations(case.nest, case.cuts, options)) == case.violations


@pytest.mark.parametrize("rule", RULES)
def test_rule_has_a_case_of_each_kind(rule: str) -> None:
    its = cases_of(rule)
    assert {case.kind for case in its} == {"passes", "fails", "boundary"}
    assert all(case.violations for case in its if case.kind == "fails")
    assert not any(case.violations for case in its if case.kind == "passes")
    assert len({case.name for case in its}) == len(its)


BY_THEIR_DEFAULT = {
    "cut-direction": {"mark"},
    "heat-lag": {"heat_radius", "lag_cuts"},
    "locks": {"entry_tolerance"},
    "no-narrow-strips": {"strip", "strip_thicknesses"},
    "part-rigidity": {"rigid_min", "tail_share", "head_share", "head_rigid_max", "head_weight", "web"},
    "pierce": {"clearance", "splash"},
    "start-side": {"edge_band", "long_ratio", "offcut_share"},
    "t-max": {"dwells", "longest_dwell"},
    "zone-order": {"zone_contours", "square_ratio"},
}
"""Options that cases show by their default alone: most are thresholds that a case stands on. Add none."""


@pytest.mark.parametrize("rule", RULES)
def test_each_option_is_shown_by_a_case(rule: str) -> None:
    given = [case.options for case in cases_of(rule) if case.options is not None]
    unseen = {
        option.key
        for option in options_of(RULES[rule].Options)
        if all(getattr(options, option.name) == option.default for options in given)
    }
    file = f"rules/catalogue/{rule.replace('-', '_')}/cases.py"
    assert unseen == BY_THEIR_DEFAULT.get(rule, set()), f"{file}: no case gives these another value than their default"


@pytest.mark.parametrize("rule", RULES)
def test_a_rule_has_all_that_is_its_own_in_its_folder(rule: str) -> None:
    folder = Path(catalogue.__path__[0], rule.replace("-", "_"))
    files = {path.name for path in folder.iterdir() if path.is_file()}
    assert files >= {"__init__.py", "cases.py"}  # that there is a picture is a test of the docs
    own = {
        "no-narrow-strips": {"strips.py"},
        "scrap-last": {"skeleton.py"},
    }  # how it judges, and facts that it alone reads
    known = {"__init__.py", "cases.py", "model_data.py", "picture.svg"} | own.get(rule, set())
    assert {name for name in files if not name.endswith(".mzn")} <= known


def test_comparison_can_fail() -> None:
    case = next(case for case in cases_of("hull-before") if case.kind == "fails")
    found = tuple(RULES["hull-before"].violations(case.nest, case.cuts, RULES["hull-before"].Options()))
    assert found != (replace(case.violations[0], text="another text"),)
    assert found != (replace(case.violations[0], cuts=(2, 1)),)
    assert found != ()


@pytest.mark.parametrize("rule", RULES)
def test_docstring_has_its_headings(rule: str) -> None:
    page = inspect.getdoc(type(RULES[rule])) or ""
    assert page.splitlines()[0] == RULES[rule].sentence
    assert tuple(line.removeprefix("## ") for line in page.splitlines() if line.startswith("## ")) == HEADINGS
    sections = page.split("## ")[1:]
    assert all(len(section.splitlines()) > 2 for section in sections), "a heading without text"


@pytest.mark.parametrize("kind", ["Links", "Tabs", "Common cuts", "Scrap lines"])
@pytest.mark.parametrize("rule", RULES)
def test_page_says_what_the_rule_means_for_other_cuts(rule: str, kind: str) -> None:
    page = inspect.getdoc(type(RULES[rule])) or ""
    section = page.split(f"## {OTHER_CUTS}")[1].split("## ")[0]
    (said,) = (text for text in section.split("- **") if text.startswith(f"{kind}**:"))
    assert len(said.split()) > 3, f"say under '{OTHER_CUTS}' what {rule} means for {kind.lower()}"


@pytest.mark.parametrize("rule", RULES)
def test_empty_sequence_breaks_nothing(rule: str) -> None:
    case = cases_of(rule)[0]
    nothing = replace(case.cuts, cuts=())
    options = RULES[rule].Options()
    broken = RULES[rule].violations(case.nest, nothing, options)
    assert [v.rule for v in broken if rule != "start-side"] == []


UNJUDGED = {
    "level-ahead": "the side that cutting starts from is not stated",
    "start-side": "the side that cutting starts from is not stated",
    "zone-order": "the zones of the cuts are not stated",
}


@pytest.mark.parametrize("rule", RULES)
def test_what_cannot_be_judged_is_said(rule: str) -> None:
    case = cases_of(rule)[0]
    blind = replace(case.cuts, cuts=tuple(replace(cut, zone=0) for cut in case.cuts), start_side=None)
    seeing = replace(case.cuts, cuts=tuple(replace(cut, zone=1) for cut in case.cuts), start_side="left")
    options = RULES[rule].Options()
    assert RULES[rule].unjudged(case.nest, blind, options) == UNJUDGED.get(rule)
    assert RULES[rule].unjudged(case.nest, seeing, options) is None


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
