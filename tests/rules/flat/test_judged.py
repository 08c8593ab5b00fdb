"""What the check can evaluate of a model file it evaluates; where it cannot, a hard rule fails and says what to do."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from itertools import permutations
from pathlib import Path

import pytest

from kerfwise.apps.authoring.trials.agreement import compare_with_violations
from kerfwise.apps.authoring.trials.trial import profile_with_rule_alone, trial_of
from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.export import CONTOURS_MAX
from kerfwise.jobs.request import facts_of, make_request
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.pipeline import VerifiedPlan, solve_and_verify
from kerfwise.postproc.check import CheckResult, check_cuts, check_program, report
from kerfwise.rules.case import in_order, nest, part, rect
from kerfwise.rules.case_file import model_cases
from kerfwise.rules.flat import model_rule
from kerfwise.rules.flat.model_rule import ModelRule, read_model_rule
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.run_cases import run_cases

pytestmark = pytest.mark.minizinc

ROW = nest(300, 120, *(part(name, rect(10 + 90 * k, 20, 60, 60)) for k, name in enumerate("ABC")))
ORDER = "A.outer B.outer C.outer"
OFF = "rules: {zone-order: {zone_contours: 1}, part-rigidity: off, no-islands: off, no-narrow-strips: off"
ZONES = "[before(i, j) | i, j in CONTOUR where zone[i] < zone[j]]"
SIDES = "[before(i, j) | i, j in CONTOUR where level_ahead[i, j]]"


def plant(folder: Path, text: str, strength: str = "hard", name: str = "in_turn") -> Profile:
    """A profile with a rule in a file; `text` is its array."""
    (folder / f"{name}.mzn").write_text(f"% {name}: asked\narray[int] of var bool: {name}_holds = {text};\n")
    path = folder / "plant.yaml"
    path.write_text(f"models: {name}.mzn\n{OFF}, {name.replace('_', '-')}: {strength}}}\n")
    return load_profile(path)


@cache
def made() -> VerifiedPlan:
    profile = load_profile()
    return solve_and_verify(make_request(facts_of(ROW, profile), profile), profile, SolveOptions(work=1.0))


def told(result: CheckResult, rule: str = "in-turn") -> str:
    return result.rule(rule).unjudged or ""


@pytest.mark.parametrize(
    ("text", "missing"),
    [(ZONES, "the zone of cut 1 of A.outer is not stated"), (SIDES, "the side that cutting starts from is not stated")],
)
def test_a_program_that_states_too_little_fails(tmp_path: Path, text: str, missing: str) -> None:
    profile, program = plant(tmp_path, text), made().program
    assert check_program(ROW, program, profile).rule("in-turn").verdict == "holds"
    bare = re.sub(r" ZONE \d+ CW|START SIDE \w+", "", program)
    result = check_program(ROW, bare, profile)
    assert result.rule("in-turn").verdict == "not judged"
    assert not result.ok
    assert result.broken() == ("in-turn",)
    assert told(result).startswith(missing)
    assert "a program says it in" in told(result)
    assert report(result).endswith("FAILED: 1 hard rules cannot be judged: in-turn")


def test_a_soft_rule_that_cannot_be_judged_fails_nothing(tmp_path: Path) -> None:
    profile = plant(tmp_path, ZONES, "{strength: soft, weight: 10}")
    result = check_program(ROW, re.sub(r" ZONE \d+ CW", "", made().program), profile)
    assert result.rule("in-turn").verdict == "not judged"
    assert result.ok


def test_shipped_rules_stay_as_they_are() -> None:
    result = check_program(ROW, re.sub(r" ZONE \d+ CW|START SIDE \w+", "", made().program), load_profile())
    assert result.rule("zone-order").verdict == "not judged"
    assert result.ok


def test_one_cut_without_a_zone_is_not_guessed(tmp_path: Path) -> None:
    profile = plant(tmp_path, ZONES)
    cuts = in_order(ROW, ORDER, "left", {"A": 1, "B": 1, "C": 0})
    assert told(check_cuts(ROW, cuts, profile)).startswith("the zone of cut 3 of C.outer is not stated")
    cuts = in_order(ROW, ORDER, "left", {"A": 2, "B": 1, "C": 1})
    assert [v.contours for v in check_cuts(ROW, cuts, profile).rule("in-turn").violations] == [
        ("B.outer", "A.outer"),
        ("C.outer", "A.outer"),
    ]


def test_a_file_needs_what_it_names_and_not_what_its_comments_say(tmp_path: Path) -> None:
    text = (
        "[before(1, 2)] /* of each zone */;\n% the zone, the start_side\narray[int] of string: in_turn_says = ['zone']"
    )
    rule = plant(tmp_path, text.replace("'", '"')).rulebook()["in-turn"]
    assert rule.unjudged(ROW, in_order(ROW, ORDER), rule.Options()) is None
    inside = plant(tmp_path, '[before(1, 2)];\narray[int] of string: in_turn_says = ["zone \\(zone[1])"]')
    rule = inside.rulebook()["in-turn"]
    assert rule.unjudged(ROW, in_order(ROW, ORDER), rule.Options()) is not None


def test_what_is_not_cut_counts_as_cut_last(tmp_path: Path) -> None:
    """The check says by itself that it is not cut; all else is judged."""
    profile = plant(tmp_path, "[before(3, 2), before(1, 3), position[2] = 1]")
    cuts = in_order(ROW, "A.outer B.outer", "left", {"A": 1, "B": 1})
    result = check_cuts(ROW, cuts, profile)
    assert "every-contour-once" in result.broken()
    assert [(v.contours, v.cuts) for v in result.rule("in-turn").violations] == [
        (("C.outer", "B.outer"), (2,)),
        (("B.outer", "A.outer"), (1, 2)),
    ]
    alone = plant(tmp_path, "[before(3, 2), before(2, 3)]")
    nothing = check_cuts(ROW, CutSequence(cuts.cuts[:1], "left"), alone)
    assert nothing.rule("in-turn").violations == ()


def test_times_are_those_of_the_cuts(tmp_path: Path) -> None:
    profile = plant(tmp_path, "[pause_ms(1, 2) >= 10000]")
    cuts = in_order(ROW, ORDER, "left", {"A": 1, "B": 1, "C": 1})
    assert told(check_cuts(ROW, cuts, profile)).startswith("the times of the cuts are not stated")

    def after(pause_s: float) -> CutSequence:
        timed = (replace(c, start_s=k * pause_s, end_s=k * pause_s) for k, c in enumerate(cuts, 1))
        return replace(cuts, cuts=tuple(timed))

    assert check_cuts(ROW, after(9.9), profile).rule("in-turn").verdict == "broken"
    assert check_cuts(ROW, after(10.0), profile).rule("in-turn").verdict == "holds"


def test_a_file_in_the_place_of_a_rule_that_gives_way_may_ask_for_more_than_orders(tmp_path: Path) -> None:
    """What is broken then is no order of two contours, and no contradiction of orders excuses it."""
    profile = plant(tmp_path, "[before(1, 2) \\/ before(1, 3), position[3] = 1]", name="level_ahead")
    cuts = in_order(ROW, "C.outer B.outer A.outer", "left", {"A": 1, "B": 1, "C": 1})
    assert [v.contours for v in check_cuts(ROW, cuts, profile).rule("level-ahead").violations] == [
        ("A.outer", "B.outer", "C.outer")
    ]


CASES = """
% cases:
% - nest: {sheet: 300 x 100, A: rect 10 10 60 60, B: rect 90 10 60 60}
"""


def rule_with_cases(folder: Path, text: str, case: str) -> ModelRule:
    path = folder / "in_turn.mzn"
    array = f"array[int] of var bool: in_turn_holds = {text};\n"
    path.write_text(f"{array}{CASES}" + "".join(f"%   {line}\n" for line in case.splitlines()))
    return read_model_rule(path)


@pytest.mark.parametrize(
    ("text", "stated", "wrong"),
    [
        (ZONES, "zones: {A: 1, B: 2}", "B.outer A.outer"),
        (SIDES, "start_side: left", "B.outer A.outer"),
        ("[pause_ms(1, 2) >= 10000]", "pause: 10 s", None),
    ],
)
def test_a_case_states_what_a_program_does(tmp_path: Path, text: str, stated: str, wrong: str | None) -> None:
    case = f"right: [A.outer B.outer]\nwrong: [{wrong or 'B.outer A.outer'}]\n"
    rule = rule_with_cases(tmp_path, text, case)
    assert any("it cannot be judged: the " in line for o in run_cases(rule.id, {rule.id: rule}) for line in o.wrong)
    rule = rule_with_cases(tmp_path, text, f"{case}{stated}\n")
    wrong_lines = [line for o in run_cases(rule.id, {rule.id: rule}) for line in o.wrong]
    assert wrong_lines == ([] if wrong else ["it should be wrong, and the rule finds nothing"])


def test_what_a_case_states_is_looked_over(tmp_path: Path) -> None:
    case = "right: [A.outer B.outer]\nzones: {C: 1, A: x}\nstart_side: lef\npause: long\n"
    rule = rule_with_cases(tmp_path, ZONES, case)
    with pytest.raises(Exception, match=r"cases\[1\].zones: unknown part 'C'") as raised:
        model_cases(rule, rule.file.path)
    details = "\n".join(raised.value.details)  # type: ignore[attr-defined]
    assert "cases[1].zones.A: expected" in details
    assert "cases[1].start_side: expected" in details
    assert "cases[1].pause: expected" in details


def test_a_plate_that_is_too_large_is_refused_before_any_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    profile = plant(tmp_path, "[before(1, 2)]")
    assert model_rule.MOST_CONTOURS == CONTOURS_MAX
    monkeypatch.setattr(model_rule, "MOST_CONTOURS", 2)
    monkeypatch.setattr("kerfwise.jobs.request.CandidateBuilder", None)
    said = (
        "rule in-turn: the nest has 3 contours, and rules in model files bear 2 at the most: set rules: {in-turn: off}"
    )
    with pytest.raises(InputError, match=re.escape(said)):
        facts_of(ROW, profile)
    with pytest.raises(InputError, match=re.escape(said)):
        check_cuts(ROW, in_order(ROW, ORDER), profile)


MANY = """[before(1, 2) \\/ before(3, 2), position[3] <= 2, directly_before(2, 3), cuts_between(1, 3) <= 0,
  pause_ms(1, 2) >= 4000, zone[1] = 1, breaches([before(1, 2), before(2, 3)]) <= 1];
constraint position[2] != 3"""


@pytest.mark.slow
def test_many_orders_are_judged_as_each_is(tmp_path: Path) -> None:
    """One run of MiniZinc's solver says of every order what the check says of it alone."""
    rule = plant(tmp_path, MANY).rulebook()["in-turn"]
    assert isinstance(rule, ModelRule)
    orders = []
    for zones, pause_s in (({"A": 1, "B": 1, "C": 1}, 3.0), ({"A": 2, "B": 1, "C": 1}, 5.0)):
        for names in permutations(ORDER.split()):
            cuts = in_order(ROW, " ".join(names), "left", zones)
            timed = (replace(c, start_s=k * pause_s, end_s=k * pause_s) for k, c in enumerate(cuts, 1))
            orders.append(replace(cuts, cuts=tuple(timed)))
    together = rule.violations_of_each(ROW, orders, rule.Options())
    one_by_one = [tuple(rule.violations(ROW, cuts, rule.Options())) for cuts in orders]
    assert together == one_by_one
    assert len({len(found) for found in one_by_one}) > 3
    assert any("a constraint of the file does not hold" in v.text for found in one_by_one for v in found)


def test_a_file_that_is_wrong_in_one_order_only_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    chain = " /\\ ".join(f"before({k}, {k + 1})" for k in range(1, 5))
    profile = plant(tmp_path, f"[not ({chain})]")
    plate = nest(560, 120, *(part(name, rect(10 + 110 * k, 20, 60, 60)) for k, name in enumerate("ABCDE")))
    trial = trial_of("plate", plate, profile_with_rule_alone(profile, "in-turn"), "in-turn")
    assert trial is not None
    assert len(trial.plans) == 120
    assert list(compare_with_violations([trial])) == []
    monkeypatch.setattr(ModelRule, "statements", lambda *given: iter(()))
    (line,) = compare_with_violations([trial])
    assert line == (
        "its statements admit plate: A.outer, B.outer, C.outer, D.outer, E.outer; its violations do not "
        "(the only such plan)"
    )
