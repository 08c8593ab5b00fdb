"""Rules in Python files that a profile names: read, trusted, switched, shown."""

from __future__ import annotations

import json
import re
import warnings
from pathlib import Path

import jsonschema
import pytest

import kerfwise as api
from kerfwise import InputError, Profile, load_profile
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.rules.outside.written import NEST, line_of, profile_file, rule_file


@pytest.fixture(autouse=True)
def nobody_is_trusted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("APPDATA", str(tmp_path / "config"))
    monkeypatch.delenv("KERFWISE_TRUST", raising=False)


def configured(folder: Path, text: str) -> None:
    """What the machine's own configuration says."""
    path = folder / "config" / "kerfwise" / "config.yaml"
    path.parent.mkdir(parents=True)
    path.write_text(text, encoding="utf-8")


def plant(folder: Path, text: str = "python: bars.py") -> Profile:
    rule_file(folder)
    return load_profile(profile_file(folder, text), trust=True)


def test_the_rule_is_on_with_its_own_strength(tmp_path: Path) -> None:
    profile = plant(tmp_path)
    setting = profile.settings()["bars-last"]
    assert (setting.strength, setting.weight, setting.options.ratio) == ("hard", None, 4.0)
    assert profile.rulebook()["bars-last"].brought == f"file {tmp_path / 'bars.py'}"
    assert "bars-last" not in load_profile().rulebook()


def test_what_python_warns_of_is_not_printed(tmp_path: Path) -> None:
    rule_file(tmp_path)
    file = tmp_path / "bars.py"
    file.write_text(f"{file.read_text()}\n\ndef never():\n    return 1[0]\n")  # a SyntaxWarning
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        load_profile(profile_file(tmp_path, "python: bars.py"), trust=True)


@pytest.mark.parametrize(
    ("said", "strength", "weight", "ratio"),
    [
        ("bars-last: off", "off", None, 4.0),
        ("bars-last: {ratio: 2.5}", "hard", None, 2.5),
        ("bars-last: {strength: soft, weight: 200 mm, ratio: 3}", "soft", 200.0, 3.0),
    ],
)
def test_strength_and_options(said: str, strength: str, weight: float | None, ratio: float, tmp_path: Path) -> None:
    setting = plant(tmp_path, f"python: [bars.py]\nrules: {{{said}}}").rules["bars-last"]
    assert (setting.strength, setting.weight, setting.options.ratio) == (strength, weight, ratio)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("python: bars.py\nrules: {bars-last: {ratio: 0.5}}", r"plant.yaml:2:28: rules.bars-last.ratio: expected"),
        (
            "python: bars.py\nrules: {bars-last: {rato: 2}}",
            r"rules.bars-last: unknown key 'rato': did you mean 'ratio'",
        ),
        ("python: bars.py\nrules: {bar-last: off}", r"rules: unknown rule 'bar-last': did you mean 'bars-last'"),
        ("python: barz.py", r"plant.yaml:1:9: python: there is no file '.*barz.py'"),
        ("python: bars.yaml", r"plant.yaml:1:9: python: expected a Python file such as my_rule.py, got 'bars.yaml'"),
        ("python: {a: b}", r"plant.yaml:1:9: python: expected a list, got a mapping"),
        ("python: [[a]]", r"plant.yaml:1:10: python: expected a text, got a list of 1"),
    ],
)
def test_mistakes_of_the_profile(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        plant(tmp_path, text)


def test_a_file_that_is_not_trusted_is_not_run(tmp_path: Path) -> None:
    rule_file(tmp_path, ("from dataclasses", "open('ran', 'w')\nfrom dataclasses"))
    path = profile_file(tmp_path)
    with pytest.raises(InputError) as refused:
        api.load_profile(path)
    assert re.search(r"plant.yaml:1:9: python: .*bars.py is code.*--trust.*trust=True", str(refused.value))
    assert str(tmp_path / "config" / "kerfwise" / "config.yaml") in str(refused.value)
    assert not list(tmp_path.glob("**/ran"))
    for verb in ("check", "show", "schema"):
        ended = kerfwise("profile", verb, path)
        assert (ended.code, ended.out) == (2, "")
        assert "say --trust" in ended.err
    assert kerfwise("rules", "-p", path).code == 2
    assert kerfwise("facts", NEST, "-p", path).code == 2


def test_what_allows_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rule_file(tmp_path)
    path = profile_file(tmp_path)
    assert "bars-last" in api.load_profile(path, trust=True).rules
    assert kerfwise("profile", "check", path, "--trust").code == 0
    for place in (tmp_path, tmp_path / "bars.py"):
        monkeypatch.setenv("KERFWISE_TRUST", str(place))
        assert kerfwise("profile", "check", path).code == 0
    monkeypatch.setenv("KERFWISE_TRUST", str(tmp_path / "other"))
    assert kerfwise("profile", "check", path).code == 2
    monkeypatch.setenv("KERFWISE_TRUST", "other")
    assert (
        "KERFWISE_TRUST: expected full paths of files or folders, got 'other'" in kerfwise("profile", "check", path).err
    )
    monkeypatch.delenv("KERFWISE_TRUST")
    configured(tmp_path, f"trust: ['{tmp_path}']")
    assert kerfwise("profile", "check", path).code == 0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("trust: [plant]", r"config.yaml:1:9: trust: expected full paths of files or folders, got 'plant'"),
        ("trust: [[a]]", r"config.yaml:1:9: trust: expected a text, got a list of 1"),
        ("thrust: [a]", r"config.yaml:1:1: unknown key 'thrust': did you mean 'trust'"),
        ("trust: [", r"config.yaml:.*not YAML"),
    ],
)
def test_mistakes_of_the_configuration(text: str, message: str, tmp_path: Path) -> None:
    rule_file(tmp_path)
    configured(tmp_path, text)
    with pytest.raises(InputError, match=message):
        load_profile(profile_file(tmp_path))
    assert load_profile().name, "a profile without Python never asks for it"


def test_a_profile_that_is_based_on_it_has_the_rule(tmp_path: Path) -> None:
    plant(tmp_path)
    (tmp_path / "deeper").mkdir()
    path = tmp_path / "deeper" / "other.yaml"
    path.write_text("based_on: ../plant.yaml\npython: ../bars.py\nrules: {bars-last: soft}", encoding="utf-8")
    profile = load_profile(path, trust=True)
    assert profile.rules["bars-last"].strength == "soft"
    assert len(profile.python) == 1
    with pytest.raises(InputError, match="is code"):
        load_profile(path)


def test_what_is_shown_reads_back_the_same(tmp_path: Path) -> None:
    profile = plant(tmp_path, "python: bars.py\nrules: {bars-last: {strength: soft, ratio: 3}}")
    shown = kerfwise("profile", "show", tmp_path / "plant.yaml", "--trust").out
    assert f"  # Bars are cut after the other parts. From file {tmp_path / 'bars.py'}.\n  bars-last:\n" in shown
    (tmp_path / "shown.yaml").write_text(shown, encoding="utf-8")
    again = load_profile(tmp_path / "shown.yaml", trust=True)
    assert again.rules == profile.rules
    assert again.further_rules == profile.further_rules


def test_it_is_listed_and_has_a_page_and_a_place_in_the_schema(tmp_path: Path) -> None:
    plant(tmp_path)
    path = tmp_path / "plant.yaml"
    assert "bars-last                 hard          Bars are cut" in kerfwise("rules", "-p", path, "--trust").out
    page = kerfwise("rules", "bars-last", "-p", path, "--trust").out
    assert f"Brought by file {tmp_path / 'bars.py'}." in page
    assert "| `ratio` | `4` | how many times longer than wide a bar is |" in page
    schema = json.loads(kerfwise("profile", "schema", path, "--trust").out)
    jsonschema.validate({"python": ["bars.py"], "rules": {"bars-last": {"ratio": 2}}}, schema)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"rules": {"bars-last": {"ratio": 2}}}, json.loads(kerfwise("profile", "schema").out))


def test_it_is_never_written_over(tmp_path: Path) -> None:
    path = rule_file(tmp_path)
    ended = kerfwise("facts", NEST, "-p", profile_file(tmp_path), "--trust", "-o", path.with_suffix(".json"))
    assert ended.code == 0
    (tmp_path / "link.json").symlink_to(path)
    assert kerfwise("facts", NEST, "-p", profile_file(tmp_path), "--trust", "-o", tmp_path / "link.json").code == 2


MISTAKES = {
    "syntax": (("id = ", "id == ="), "not Python: invalid syntax", "id == ="),
    "import": (("import dataclass, field", "import dataclass, feeld"), "cannot be run: ImportError", "feeld"),
    "no rule": (("class BarsLast(OrderRule[BarsLastOptions])", "class BarsLast"), "defines no rule", None),
    "no id": (('id = "bars-last"', ""), "defines no rule", None),
    "odd id": (('id = "bars-last"', 'id = "Bars"'), "id: 'Bars' is not a name of a rule", "class BarsLast("),
    "reserved": (('id = "bars-last"', 'id = "test"'), "cannot be called 'test'", "class BarsLast("),
    "abstract": (("def pairs", "def pears"), r"BarsLast: pairs\(\) is missing", "class BarsLast("),
    "no sentence": (("sentence = ", "sentense = "), "sentence is missing", "class BarsLast("),
    "no options": (("    Options = BarsLastOptions", ""), "Options is missing", "class BarsLast("),
    "options": (("Options = BarsLastOptions", "Options = dict"), "Options is missing", "class BarsLast("),
    "no kind": (
        ("field(default=4.0, metadata=option(Number(1), \"how many times longer than wide a bar is\"))", "4.0"),
        "Options.ratio has no kind", "class BarsLast(",
    ),
    "melts": (("frozen=True, ", ""), "Options is not frozen", "class BarsLast("),
    "key": (("ratio", "weight"), "key 'weight' means something else", "class BarsLast("),
    "default": (("source =", 'default = "gentle"\n    source ='), "default: expected one of", "class BarsLast("),
    "always": (("source =", 'strengths = ("hard",)\n    source ='), "add 'off'", "class BarsLast("),
    "mark": (("source =", "of_fallen_metal = True\n    source ="), "only a rule of the catalogue", "class BarsLast("),
    "init": (
        ("source =", "def __init__(self): raise KeyError('x')\n    source ="), "cannot be used: KeyError: 'x'",
        "class BarsLast(",
    ),
    "taken": (('id = "bars-last"', 'id = "pierce"'), "two rules are called 'pierce'.* one of kerfwise itself", None),
    "leaves": (("def bar(", "raise SystemExit(3)\n\n\ndef bar("), "cannot be run: SystemExit: 3", "raise SystemExit"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistakes_of_the_file(mistake: str, tmp_path: Path) -> None:
    instead, message, at = MISTAKES[mistake]
    path = rule_file(tmp_path, instead)
    with pytest.raises(InputError, match=message) as caught:
        load_profile(profile_file(tmp_path), trust=True)
    if at is not None:
        assert (caught.value.file, caught.value.line) == (type(caught.value.file)(path), line_of(path, at))
    ended = kerfwise("profile", "check", tmp_path / "plant.yaml", "--trust")
    assert ended.code == 2
    assert "Traceback" not in ended.err


def test_two_files_with_one_name(tmp_path: Path) -> None:
    rule_file(tmp_path)
    rule_file(tmp_path, name="others.py")
    with pytest.raises(
        InputError, match=r"plant.yaml:1:19: .*'bars-last': one of file .*others.py, one of file .*bars"
    ):
        load_profile(profile_file(tmp_path, "python: [bars.py, others.py]"), trust=True)


def test_a_changed_file_is_read_again(tmp_path: Path) -> None:
    assert plant(tmp_path).rulebook()["bars-last"] is plant(tmp_path).rulebook()["bars-last"]
    rule_file(tmp_path, ("default=4.0", "default=5.0"))
    assert load_profile(tmp_path / "plant.yaml", trust=True).rules["bars-last"].options.ratio == 5.0
