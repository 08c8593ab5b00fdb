"""An exception in any hook of a rule from outside is a message with the rule's name, its file and the line."""

from __future__ import annotations

from pathlib import Path

import pytest

import kerfwise as api
from kerfwise import KerfwiseError
from kerfwise.rule_kit import Violation
from kerfwise.tests.commands.run_cli import Ended, kerfwise
from kerfwise.tests.rules.outside.written import NEST, line_of, profile_file, rule_file

NEVER = Violation("bars-last", (), "")
WRONG = "1 / 0  # wrong"
HOOKS = {
    "statements": ("        for i, a in", f"        {WRONG}\n        for i, a in", "solve"),
    "pairs": ("        outers =", f"        {WRONG}\n        outers =", "solve"),
    "reason": ('        return f"', f'        {WRONG}\n        return f"', "solve"),
    "deeper": ("    x0, y0", f"    {WRONG}\n    x0, y0", "solve"),
} | {
    hook: ("    def reason", f"    def {hook}(self, *given):\n        {WRONG}\n\n    def reason", verb)
    for hook, verb in {
        "violations": "solve",
        "together": "together",
        "unjudged": "solve",
        "exempt": "solve",
        "no_goods": "solve",
        "fact_options": "facts",
        "lead_options": "facts",
        "temperature_limit": "solve",
        "check_with": "profile",
        "still_counts": "still_counts",
    }.items()
}
"""Hook → the text that is replaced, by which, and what calls it."""


def run(verb: str, plant: Path, folder: Path) -> Ended:
    outputs = ["-o", folder / "out.nc", "--plan", folder / "out.json"]
    match verb:
        case "solve":
            return kerfwise("solve", NEST, "-p", plant, "--trust", "--work", "1", *outputs)
        case "facts":
            return kerfwise("facts", NEST, "-p", plant, "--trust")
        case "profile":
            return kerfwise("profile", "check", plant, "--trust")
        case _:
            profile = api.load_profile(plant, trust=True)
            nest = api.read_nest(NEST)
            rule = profile.rulebook()["bars-last"]
            ask = {"together": lambda: rule.together(nest, None), "still_counts": lambda: rule.still_counts(NEVER, 0)}
            with pytest.raises(KerfwiseError, match="rule bars-last fails in") as caught:
                ask[verb]()
            return Ended(2, "", str(caught.value))


@pytest.mark.parametrize("hook", HOOKS)
def test_an_exception_is_a_message(hook: str, tmp_path: Path) -> None:
    old, new, verb = HOOKS[hook]
    path = rule_file(tmp_path, (old, new))
    ended = run(verb, profile_file(tmp_path), tmp_path)
    assert ended.code == 2, ended.err
    assert f"{path}:{line_of(path, WRONG)}: rule bars-last fails in " in ended.err
    assert ended.err.rstrip().endswith(": ZeroDivisionError: division by zero")
    assert "Traceback" not in ended.err
    assert not list(tmp_path.glob("kerfwise-fault-*"))
    assert not (tmp_path / "out.nc").exists()


@pytest.mark.parametrize("wrong", ["np.float64(1e200) * 1e200", "np.float64(1) / 0", "np.float64(np.inf) - np.inf"])
@pytest.mark.parametrize("hook", ["statements", "pairs"])
def test_a_number_that_is_none_decides_nothing(wrong: str, hook: str, tmp_path: Path) -> None:
    old, new, verb = HOOKS[hook]
    path = rule_file(tmp_path, (old, new.replace(WRONG, f"import numpy as np; {wrong}  # wrong")))
    ended = run(verb, profile_file(tmp_path), tmp_path)
    assert ended.code == 2, ended.err
    assert f"{path}:{line_of(path, '# wrong')}: rule bars-last fails in {hook}: FloatingPointError: " in ended.err


RUBBISH = {
    "no statements": (("yield self.precede(facts, i, j)", "return 7"), "statements() gives 7, expected statements"),
    "odd statements": (("yield self.precede(facts, i, j)", "yield (i, j)"), r"statements() gives (3, 6), expected"),
    "contours": (
        ("self.precede(facts, i, j)", "__import__('dataclasses').replace(self.precede(facts, i, j), after=99)"),
        "statements() names contour number 99; this nest has 0 to 13",
    ),
    "about": (
        ("self.precede(facts, i, j)", "__import__('dataclasses').replace(self.precede(facts, i, j), about=None)"),
        "statements() gives a statement whose about is None, expected self.about((…), 'a sentence')",
    ),
    "nothing": (
        ("    def pairs", "    def unjudged(self, *given):\n        return 3\n\n    def pairs"),
        "unjudged() gives 3, expected a sentence or None",
    ),
    "violations": (
        ("    def pairs", "    def violations(self, *given):\n        return None\n\n    def pairs"),
        "violations() gives None, expected a list of Violation",
    ),
    "names": (
        ("[(a.id, b.id) for", "[(a.id, 'X') for"), "pairs() names 'X', which is no contour of this nest",
    ),
    "facts": (
        ("    def pairs", "    def fact_options(self, *given):\n        return None\n\n    def pairs"),
        "fact_options() gives None, expected FactOptions",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", RUBBISH)
def test_what_no_engine_could_read_is_a_message(what: str, tmp_path: Path) -> None:
    instead, message = RUBBISH[what]
    path = rule_file(tmp_path, instead)
    ended = run("solve", profile_file(tmp_path), tmp_path)
    assert ended.code == 2, ended.err
    assert message in ended.err
    assert f"kerfwise: {path}:" in ended.err
    assert ": rule bars-last: " in ended.err


def test_options_that_refuse(tmp_path: Path) -> None:
    check = """    def __post_init__(self):
        if self.ratio > 9:
            raise ValueError("too long")


class BarsLast"""
    path = rule_file(tmp_path, ("\n\nclass BarsLast", check))
    ended = kerfwise(
        "profile", "check", profile_file(tmp_path, "python: bars.py\nrules: {bars-last: {ratio: 10}}"), "--trust"
    )
    assert ended.code == 2
    where = f"{path}:{line_of(path, 'too long')}"
    assert f"{where}: rule bars-last fails in its options: ValueError: too long" in ended.err
