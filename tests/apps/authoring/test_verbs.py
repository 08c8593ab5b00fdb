"""kerfwise rules: the list, a page, a picture, a new rule's files and the cases."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner

from kerfwise.apps.authoring.verbs import rules_command as command
from kerfwise.encoder.errors import InputError
from kerfwise.rules import run_cases as runner
from kerfwise.rules.pages import new_rule, rule_page
from kerfwise.rules.registry import RULES


def said(*words: str) -> str:
    result = CliRunner().invoke(command, list(words), catch_exceptions=False, standalone_mode=False)
    return result.output


def test_list_has_every_rule_with_its_strength(tmp_path: Path) -> None:
    lines = said("-p", "water-jet").splitlines()
    assert [line.split()[0] for line in lines][: len(RULES)] == list(RULES), "rules from outside come after them"
    assert lines[list(RULES).index("cut-direction")].split()[1] == "off"
    path = tmp_path / "plant.yaml"
    path.write_text("own_rules: [{name: bars last, why: asked, last: true, strength: soft}]", encoding="utf-8")
    assert said("-p", str(path)).splitlines()[-1].split() == ["own:bars", "last", "soft", "1000", "mm", "asked"]


def test_page_of_a_rule() -> None:
    assert said("hull-before") == rule_page("hull-before")
    assert said("hull-before", "-p", "water-jet") == rule_page("hull-before")


def test_unknown_rule() -> None:
    with pytest.raises(InputError, match="unknown rule 'hull-befor': did you mean 'hull-before'"):
        said("hull-befor")


@pytest.mark.parametrize("rule", RULES)
def test_every_rule_can_be_drawn(rule: str, tmp_path: Path) -> None:
    path = tmp_path / "rule.svg"
    assert said(rule, "--picture", str(path)) == f"written: {path}\n"
    text = path.read_text(encoding="utf-8")
    assert re.findall(r"<text[^>]*>(wrong|right): ", text) == ["wrong", "right"]
    assert "nothing is wrong" in text


def test_picture_shows_order_and_what_is_wrong(tmp_path: Path) -> None:
    path = tmp_path / "rule.svg"
    said("marks-first", "--picture", str(path))
    text = path.read_text(encoding="utf-8")
    assert [f">{k}</text>" in text for k in range(1, 7)] == [True] * 5 + [False]
    assert "B.mark1 (cut 4) must be made before A.hole1 (cut 2)" in text


def test_cases_are_run() -> None:
    lines = said("test", "marks-first", "--cases").splitlines()
    assert lines[0] == "ok      marks-first: all marks first"
    assert lines[-1] == "6 cases, 0 failed"


def test_case_that_fails_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    first, *others = runner.cases_of("marks-first")
    wrong = replace(others[0], violations=())
    monkeypatch.setattr(runner, "cases_of", lambda rule, known: (first, wrong))
    outcomes = list(runner.run_cases("marks-first"))
    assert [outcome.case for outcome in outcomes] == ["all", first.name, wrong.name]
    assert outcomes[0].wrong == ("there is no case of kind boundary",)
    assert outcomes[1].wrong == ()
    assert outcomes[2].wrong[0].startswith("found:    Violation(rule='marks-first'")


def checkout(root: Path) -> Path:
    (root / "rules" / "catalogue").mkdir(parents=True)
    (root / "pyproject.toml").write_text('packages = [\n    "kerfwise.rules.catalogue",\n]\n', encoding="utf-8")
    return root


def test_new_rule_is_three_files(tmp_path: Path) -> None:
    out = said("new", "bars-last", "--into", str(checkout(tmp_path)))
    made = sorted(str(p.relative_to(tmp_path)) for p in tmp_path.rglob("*.*") if p.suffix in (".py", ".mzn", ".yaml"))
    assert made == [
        "rules/catalogue/bars_last/__init__.py",
        "rules/catalogue/bars_last/bars_last.mzn",
        "rules/catalogue/bars_last/cases.yaml",
    ]
    assert '    "kerfwise.rules.catalogue.bars_last",\n' in (tmp_path / "pyproject.toml").read_text(encoding="utf-8")
    assert f"pip install -e {tmp_path.resolve()}" in out
    assert "next: kerfwise rules test bars-last" in out
    assert "class BarsLast(OrderRule[NoOptions]):" in (tmp_path / made[0]).read_text(encoding="utf-8")
    assert "bars_last_holds =" in (tmp_path / made[1]).read_text(encoding="utf-8")
    assert "$" not in "".join((tmp_path / name).read_text(encoding="utf-8") for name in made)


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    taken = checkout(tmp_path) / "rules/catalogue/bars_last/cases.yaml"
    taken.parent.mkdir()
    taken.write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match="the file is there already"):
        new_rule("bars-last", tmp_path)
    assert [p for p in tmp_path.rglob("*") if p.suffix in (".py", ".mzn", ".yaml")] == [taken]


NAMES = {
    "Bars": "not a name of a rule",
    "bars_last": "not a name of a rule",
    "new": "cannot be called 'new'",
    "test": "cannot be called 'test'",
    "pierce": "there is a rule 'pierce' already",
}


@pytest.mark.parametrize("name", NAMES)
def test_names_that_a_rule_cannot_have(name: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=NAMES[name]):
        new_rule(name, checkout(tmp_path))


def test_a_checkout_is_needed(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is no source checkout of kerfwise: say --python or --mzn for a rule of your"):
        new_rule("bars-last", tmp_path)


@pytest.mark.parametrize(("language", "ending", "key"), [("python", "py", "python"), ("mzn", "mzn", "models")])
def test_a_rule_of_a_plant_is_one_file_in_any_folder(language: str, ending: str, key: str, tmp_path: Path) -> None:
    folder = tmp_path / "plant" / "rules"
    out = said("new", "bars-last", f"--{language}", "-o", str(folder))
    (made,) = folder.iterdir()
    assert made == folder / f"bars_last.{ending}"
    assert f"written: {made}\n" in out
    assert f"next: kerfwise rules test {made}, then in your profile: {key}: [bars_last.{ending}]" in out
    assert "$" not in made.read_text(encoding="utf-8")
    with pytest.raises(InputError, match=r"bars_last.*: the file is there already"):
        said("new", "bars-last", f"--{language}", "-o", str(folder))
    with pytest.raises(InputError, match="there is a rule 'pierce' already"):
        said("new", "pierce", f"--{language}", "-o", str(folder))


def test_where_a_rule_is_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="say -o FOLDER with --python or --mzn"):
        said("new", "bars-last", "--mzn", "--into", str(tmp_path))
    with pytest.raises(InputError, match="-o goes with --python or --mzn"):
        said("new", "bars-last", "-o", str(tmp_path))
    (tmp_path / "taken").touch()
    with pytest.raises(InputError, match="cannot write here"):
        said("new", "bars-last", "--mzn", "-o", str(tmp_path / "taken"))


def test_what_is_to_be_tried_must_be_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="unknown rule 'hull-befor': did you mean 'hull-before'"):
        said("test", "hull-befor")
    with pytest.raises(InputError, match=r"a file of rules ends in \.py or \.mzn"):
        said("test", "plant/bars")
    with pytest.raises(InputError, match="cannot read the Python file"):
        said("test", str(tmp_path / "bars.py"))
    with pytest.raises(InputError, match="cannot read the rule"):
        said("test", str(tmp_path / "bars.mzn"))
