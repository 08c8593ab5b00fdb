"""`kerfwise rules test` bites: each damage to a rule fails it, with a message that says what is wrong."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from kerfwise.apps.authoring.trials import agreement, rules_to_try, try_rule
from kerfwise.apps.authoring.trials.try_rules import ENGINES, OPTIONS, ORDERS, TEXT, Bench
from kerfwise.encoder.errors import InputError
from kerfwise.models.engines import minizinc_model
from kerfwise.models.engines.solution import Solution
from kerfwise.rules.pages import new_outside_rule
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.run_cases import CaseOutcome, cases_of
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.tools.amount import full

NAME = "long-parts-last"
WITH_ENGINES = ("[fine]",)
"""The damage of a model file whose test is about the engines too: none."""


@pytest.fixture
def engines() -> None:
    """For the tests that are about the engines."""


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> None:
    """Engines take long; no other tests ask them."""
    asked = "engines" in request.fixturenames or request.node.name.endswith(WITH_ENGINES)
    if not asked:
        monkeypatch.setattr(agreement, "compare_engines", lambda *given: iter(()))
        monkeypatch.setattr("kerfwise.apps.authoring.trials.try_rules.compare_engines", lambda *given: iter(()))


def tried(path: Path, cases_only: bool = False) -> dict[str, CaseOutcome]:
    profile, names = rules_to_try(load_profile(), [str(path)])
    return {outcome.case: outcome for name in names for outcome in try_rule(name, profile, cases_only)}


def damaged(folder: Path, *instead: tuple[str, str]) -> Path:
    path = new_outside_rule(NAME, "python", folder)
    made = path.read_text(encoding="utf-8")
    for old, new in instead:
        assert old in made, old
        made = made.replace(old, new)
    path.write_text(made, encoding="utf-8")
    return path


@pytest.mark.slow
def test_a_new_rule_is_fine(tmp_path: Path) -> None:
    found = tried(damaged(tmp_path))
    assert [name for name, outcome in found.items() if outcome.wrong] == []
    assert [name for name, outcome in found.items() if not outcome.is_case] == [ORDERS, TEXT, ENGINES, OPTIONS]
    assert found[TEXT].note == "it has none"


IDLE = (
    "    ratio: float = field(",
    '    idle: float = field(default=1.0, metadata=option(Number(0), "nothing"))\n    ratio: float = field(',
)
DAMAGES = {
    "statements reversed": (
        [("self.precede(facts, i, j)", "self.precede(facts, j, i)")], ORDERS,
        r"its statements admit .*Bar.outer, Plate.outer; its violations do not \(the only such plan\)",
    ),
    "statements that say nothing": (
        [("j in long and i not in long", "j in long and i not in long and False")], ORDERS,
        r"its statements admit .*; its violations do not",
    ),
    "statements that say too much": (
        [("and i not in long:", "and i not in long or i < j:")], ORDERS,
        r"its violations admit .*; its statements do not",
    ),
    "statements that crash": (
        [("        outers = [facts", "        1 / 0\n        outers = [facts")], ORDERS,
        r"long_parts_last.py:\d+: rule long-parts-last fails in statements: ZeroDivisionError",
    ),
    "violations reversed": (
        [("then.id in long and first.id not in long", "first.id in long and then.id not in long")], "the bar first",
        "expected: Violation",
    ),
    "violations that crash": (
        [("        at = places", "        {}['x']\n        at = places")], ORDERS,
        r"long_parts_last.py:\d+: rule long-parts-last fails in pairs: KeyError: 'x'",
    ),
    "an option that does nothing": ([IDLE], OPTIONS, r"option idle does nothing: the rule states and blames the same"),
    "an option that only statements obey": (
        [("then.id in long and first.id not in long", "is_long(then, 4) and not is_long(first, 4)")], OPTIONS,
        r"with ratio: [\d.]+, its (statements|violations) admit",
    ),
    "a case less": ([('"boundary"', '"passes"')], "all", "there is no case of kind boundary"),
    "another text": ([("is long\",", "is too long\",")], "the bar first", "expected: Violation"),
}  # fmt: skip


ALIKE = ("statements that say too much", "statements that crash", "another text", "a case less")
"""Each has a like one: statements that say nothing, violations that crash or are reversed, no cases at all."""
IN_PYTHON = [full(name) if name in ALIKE else name for name in DAMAGES]


@pytest.mark.slow
@pytest.mark.parametrize("damage", IN_PYTHON)
def test_a_damage_in_python(damage: str, tmp_path: Path) -> None:
    instead, where, message = DAMAGES[damage]
    path = damaged(tmp_path, *instead)
    found = tried(path)
    assert re.search(message, "\n".join(found[where].wrong)), {k: o.wrong for k, o in found.items()}


def test_no_cases(tmp_path: Path) -> None:
    path = damaged(tmp_path, ("CASES = (", "KASES = ("))
    ended = kerfwise("rules", "test", path)
    assert ended.code == 2
    assert f"{path}: rule long-parts-last has no cases: expected CASES = (Case(…), …) in its file" in ended.err


FILES = {
    "reversed": ("before(j, i)", "before(i, j)"),
    "weakened": ("where level_ahead[j, i]", "where level_ahead[j, i] /\\ i < j"),
    "strengthened": ("where level_ahead[j, i]", "where level_ahead[j, i] \\/ i = 1 /\\ j = 2"),
    "stale": ("level_ahead[j, i]", "level_behind[j, i]"),
    "not MiniZinc": ("array[int]", "array[ind"),
}


@pytest.mark.minizinc
@pytest.mark.parametrize(
    "damage", [pytest.param(d, marks=pytest.mark.slow if d in ("weakened", "strengthened") else ()) for d in FILES]
)
def test_a_damage_in_minizinc(damage: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        minizinc_model, "rule_file", lambda rule, real=minizinc_model.rule_file: _copied(real(rule), damage, tmp_path)
    )
    bench = Bench(load_profile().known_rules()["level-ahead"], load_profile(), cases_of("level-ahead"))
    if damage in ("stale", "not MiniZinc"):
        with pytest.raises(InputError, match=r"level_ahead.mzn:\d+:\d+: MiniZinc: "):
            bench.text()
        (outcome,) = (o for o in try_rule("level-ahead", load_profile()) if o.case == TEXT)
        assert "level_ahead.mzn" in outcome.wrong[0]
        return
    wrong, _ = bench.text()
    assert re.search(r"its text in MiniZinc (admits|does not)|; its text in MiniZinc does not", wrong[0]), wrong


def _copied(file: Path, damage: str, folder: Path) -> Path:
    if file.stem != "level_ahead":
        return file
    old, new = FILES[damage]
    made = file.read_text(encoding="utf-8")
    assert old in made
    copy = folder / file.name
    copy.write_text(made.replace(old, new), encoding="utf-8")
    return copy


OF_A_PLANT = {
    "fine": ((), "", ""),
    "reversed": ((("before(i, j)", "before(j, i)"),), "1, right: Plate.outer Bar.outer", "it should be right, but: "),
    "weakened": ((("not long[i]", "not long[i] /\\ j < i"),), "1, wrong: Bar.outer Plate.outer", "finds nothing"),
    "strengthened": (
        (("/\\ long[j]", "/\\ i < j /\\ (long[j] \\/ i = 1)"),), "2, right: Almost.outer Plate.outer", "right, but",
    ),
    "stale": ((("long[j]", "longish[j]"),), ORDERS, r"long_parts_last.mzn:\d+:\d+: .*longish"),
    "idle": (
        (("array[int] of var", "int: long_parts_last_idle;  % default 3: nothing\narray[int] of var"),), OPTIONS,
        "option idle does nothing",
    ),
}  # fmt: skip


LONG = ("fine", "idle")
"""Everything is tried of these, with all engines and options; the tests above try it of a rule in Python."""


@pytest.mark.minizinc
@pytest.mark.parametrize("damage", [full(name) if name in LONG else name for name in OF_A_PLANT])
def test_a_damage_in_a_model_file_of_a_plant(damage: str, tmp_path: Path) -> None:
    instead, where, message = OF_A_PLANT[damage]
    path = new_outside_rule(NAME, "mzn", tmp_path)
    made = path.read_text(encoding="utf-8")
    for old, new in instead:
        assert old in made, old
        made = made.replace(old, new)
    path.write_text(made, encoding="utf-8")
    found = tried(path, cases_only=damage in ("reversed", "weakened", "strengthened"))
    if not where:
        assert [name for name, outcome in found.items() if outcome.wrong] == []
        return
    assert re.search(message, "\n".join(found[where].wrong)), {k: o.wrong for k, o in found.items()}


def test_without_minizinc_a_rule_that_has_a_text_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    def none() -> Any:
        raise InputError("MiniZinc is not installed: apt-get install minizinc")

    monkeypatch.setattr(agreement, "driver", none)
    monkeypatch.setattr(agreement, "solver_named", lambda name: none())
    (outcome,) = (o for o in try_rule("level-ahead", load_profile()) if o.case == TEXT)
    assert outcome.wrong == ("MiniZinc is not installed: apt-get install minizinc",)


@pytest.mark.slow
@pytest.mark.minizinc
@pytest.mark.usefixtures("engines")
@pytest.mark.parametrize(
    ("lie", "message"),
    [
        (
            lambda s: replace(s, objective=s.objective - 10),
            r"portfolio says .* under",
        ),
        (lambda s: replace(s, objective=s.objective + 10, status="optimal"), r"calls .* the best of"),
    ],
)
def test_an_engine_that_lies_is_named(lie: Any, message: str, monkeypatch: pytest.MonkeyPatch) -> None:
    rightly = agreement.solve

    def wrongly(*given: Any, **more: Any) -> Solution:
        return lie(rightly(*given, **more))

    monkeypatch.setattr(agreement, "solve", wrongly)
    bench = Bench(load_profile().known_rules()["level-ahead"], load_profile(), cases_of("level-ahead"))
    wrong, _ = bench.engines()
    assert re.search(message, wrong[0]), wrong


@pytest.mark.slow
@pytest.mark.minizinc
@pytest.mark.usefixtures("engines")
def test_the_command(tmp_path: Path) -> None:
    ended = kerfwise("rules", "test", damaged(tmp_path), "level-ahead")
    assert ended.code == 0, ended.out
    assert ended.out.endswith("12 cases and 8 comparisons, 0 failed\n")
    (tmp_path / "more").mkdir()
    ended = kerfwise("rules", "test", damaged(tmp_path / "more", *DAMAGES["statements reversed"][0]))
    assert ended.code == 1
    assert "FAILED  long-parts-last: every engine finds" not in ended.out
    assert ended.out.endswith("4 cases and 4 comparisons, 1 failed\n"), ended.out
