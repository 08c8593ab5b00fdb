"""What is drawn, timed or explained of a plan is held against its nest first: rows that are none of it are refused."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.fuzz.inputs import seeds

Rows = list[dict[str, Any]]
VERBS = (
    ("time", "plate.json", "plate.plan.json"),
    ("heat", "plate.json", "plate.plan.json", "--set", "heat.grid=20"),
    ("explain", "plate.json", "plate.plan.json", "G.outer"),
    ("plot", "plate.json", "plate.plan.json", "-o", "out.svg"),
    ("plot", "plate.json", "plate.plan.json", "-o", "out.html"),
    ("sheet", "plate.json", "plate.plan.json", "-o", "out.pdf"),
)


def renamed(rows: Rows) -> None:
    rows[0]["contour"] = "D.holetrue"


def other_kind(rows: Rows) -> None:
    rows[0]["kind"] = "outer" if rows[0]["kind"] != "outer" else "hole"


def other_part(rows: Rows) -> None:
    rows[0]["part"] = "Z"


def entered_elsewhere(rows: Rows) -> None:
    rows[0]["entry"] = [390.0, 190.0]


def twice(rows: Rows) -> None:
    rows.append({**rows[0], "order": len(rows) + 1})


WRONG: dict[Callable[[Rows], None], str] = {
    renamed: "cut 1 is of 'D.holetrue', which is no contour of it",
    other_kind: "cut 1 has ",
    other_part: " of Z, and it is ",
    entered_elsewhere: " at (390.0, 190.0), ",
    twice: "as cut 1 is already",
}


@pytest.fixture(scope="module")
def plan() -> dict[str, Any]:
    made: dict[str, Any] = json.loads(seeds.made("rich")[1])
    return made


@pytest.mark.parametrize("verb", VERBS, ids=lambda words: "-".join((words[0], words[-1][-4:])))
@pytest.mark.parametrize("wrong", WRONG, ids=lambda change: change.__name__)
def test_rows_that_are_none_of_the_nest(
    verb: tuple[str, ...],
    wrong: Callable[[Rows], None],
    plan: dict[str, Any],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    rows = [dict(row) for row in plan["cuts"]]
    wrong(rows)
    Path("plate.json").write_bytes(seeds.nest_bytes("rich"))
    Path("plate.plan.json").write_text(json.dumps({**plan, "nest": {"file": "plate.json"}, "cuts": rows}))
    before = sorted(tmp_path.iterdir())
    ended = kerfwise(*verb)
    assert (ended.code, sorted(tmp_path.iterdir())) == (2, before), ended.err
    [line] = [line for line in ended.err.splitlines() if line.startswith("kerfwise: ")]
    assert line.startswith("kerfwise: plate.json: the plan is not one of plate.json: cut ")
    assert WRONG[wrong] in line


@pytest.mark.parametrize("wrong", [other_kind, other_part], ids=lambda change: change.__name__)
def test_the_check_refuses_another_part_or_kind_and_judges_the_rest(
    wrong: Callable[[Rows], None], plan: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("plate.json").write_bytes(seeds.nest_bytes("rich"))
    for change, code in ((wrong, 2), (renamed, 1), (twice, 1)):
        rows = [dict(row) for row in plan["cuts"]]
        change(rows)
        Path("plate.plan.json").write_text(json.dumps({**plan, "nest": {"file": "plate.json"}, "cuts": rows}))
        ended = kerfwise("check", "plate.json", "plate.plan.json")
        assert ended.code == code, ended.err
        assert (WRONG[change] in ended.err) == (code == 2)


SAID = {
    "rules": [{"id": "level-ahead", "strength": "hard", "holds": True,
               "exceptions": [{"contours": ["Q.outer"], "why": ""}]}],
    "dropped": [{"rule": "level-ahead", "contours": ["A.outer", "Q.outer"], "why": "cycle"}],
    "state": {"kind": "kept but for", "count": 1, "places": [
        {"how": "excused", "rule": "part-rigidity", "contours": ["Q.outer"], "why": "thin"}]},
}  # fmt: skip


@pytest.mark.parametrize("what", SAID)
def test_what_a_plan_says_of_contours_that_there_are_not(what: str, plan: dict[str, Any], tmp_path: Path) -> None:
    nest, file = tmp_path / "plate.json", tmp_path / "plate.plan.json"
    nest.write_bytes(seeds.nest_bytes("rich"))
    file.write_text(json.dumps({**plan, what: SAID[what]}))
    for verb in (("time", nest, file), ("plot", nest, file, "-o", tmp_path / "out.svg"), ("check", nest, file)):
        ended = kerfwise(*verb)
        assert ended.code == 2, ended.err
        assert "the plan is not one of " in ended.err
        assert "it says of 'Q.outer', which is no contour of it, that " in ended.err


def test_what_a_plan_says_of_rules_is_held_against_the_check(plan: dict[str, Any], tmp_path: Path) -> None:
    nest, file = tmp_path / "plate.json", tmp_path / "plate.plan.json"
    nest.write_bytes(seeds.nest_bytes("rich"))

    def told(**other: Any) -> str:
        file.write_text(json.dumps({**plan, **other}))
        return "".join(
            line for line in kerfwise("check", nest, file).out.splitlines(True) if line.startswith("warning: ")
        )

    assert told() == ""
    rules = [dict(rule) for rule in plan["rules"]]
    first = rules[0]
    first["strength"] = "soft" if first["strength"] == "hard" else "hard"
    assert f"that the rule {first['id']} is {first['strength']}, and it is " in told(rules=rules)
    first.update(plan["rules"][0], breaches=[{"contours": [plan["cuts"][0]["contour"]], "why": "so"}])
    assert f"of where the rule {first['id']} does not hold is not what is found: " in told(rules=rules)
    place = {"how": "excused", "rule": "part-rigidity", "contours": [plan["cuts"][0]["contour"]], "why": "thin"}
    state = {"kind": "kept but for", "count": 1, "places": [place]}
    assert "says of itself that it is kept but for 1 place, and the check finds: " in told(state=state)


def test_explain_says_that_the_nest_is_another(
    plan: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("plate.json").write_bytes(seeds.nest_bytes("rich"))
    of_another = {"file": "plate.json", "sha256": "0" * 64}
    Path("plate.plan.json").write_text(json.dumps({**plan, "nest": of_another}))
    ended = kerfwise("explain", "plate.json", "plate.plan.json", "G.outer")
    assert ended.code == 0
    assert "note: the nest is not the one the plan was made with" in ended.err


NUMBERS = {
    "a length under 0": (("cuts", 0, "length_mm"), -5, "cuts 1, length_mm"),
    "a time under 0": (("cuts", 1, "start_s"), -1, "cuts 2, start_s"),
    "a cut that ends before it begins": (("cuts", 0, "start_s"), 1e6, "ends at "),
    "a huge time": (("cuts", 0, "end_s"), 1e13, "cuts 1, end_s"),
    "a total under 0": (("totals", "time_s"), -3, "totals, time_s"),
    "pierces under 0": (("totals", "pierces"), -3, "totals, pierces"),
    "pierces past all counting": (("totals", "pierces"), 10**40, "totals, pierces"),
    "a gap under 0": (("solve", "gap"), -0.5, "solve, gap"),
    "times that come to another total": (("time", "cut_s"), 4000.0, "its times come to "),
    "another share of idle travel": (("time", "idle_share"), 0.9, "its share of idle travel is 0.9"),
    "excuses that no cost holds": (("solve", "excuses"), 3, "it says 3 excuses of "),
    "prices that come to another objective": (("prices", "travel"), 9e6, "its prices come to "),
    "a state that its places are not": (
        ("state", "kind"),
        "broken",
        "its state is broken (0 places), and by its places",
    ),
    "places that are not listed": (("state", "count"), 3, "its state is kept (3 places), and by its places it is kept"),
    "no number": (("totals", "idle_mm"), float("nan"), "totals, idle_mm"),
    "an infinite bound": (("solve", "bound"), float("inf"), "solve, bound"),
}


@pytest.mark.parametrize("what", NUMBERS)
def test_numbers_that_no_plan_has_are_refused_in_place(what: str, plan: dict[str, Any], tmp_path: Path) -> None:
    steps, value, said = NUMBERS[what]
    data = json.loads(json.dumps(plan))
    holder: Any = data
    for step in steps[:-1]:
        holder = holder[step]
    holder[steps[-1]] = value
    nest, file = tmp_path / "plate.json", tmp_path / "plate.plan.json"
    nest.write_bytes(seeds.nest_bytes("rich"))
    file.write_text(json.dumps(data))
    for verb in (("time", nest, file), ("plot", nest, file, "-o", tmp_path / "out.svg"), ("check", nest, file)):
        ended = kerfwise(*verb)
        assert ended.code == 2, ended.err
        assert f"{file}" in ended.err
        assert said in ended.err
