"""Rules that installed packages bring: found, used, refused; and kerfwise's own pages and tests stay as they are."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from importlib.metadata import EntryPoint, EntryPoints, PathDistribution
from pathlib import Path

import pytest

from kerfwise.encoder.errors import RuleFault
from kerfwise.rules import outside
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.registry import RULES
from kerfwise.tests.rules.outside.written import NEST, ROOT, package, profile_file, python, rule_file
from kerfwise.tests.tools.amount import full

KEPT_TESTS = (
    "tests/rules/test_registry.py",
    "tests/rules/profile/test_profile_yaml.py",
    "tests/rules/test_pages.py",
    "tests/rules/profile/test_profile.py",
    "tests/rules/test_cases.py",
    "tests/test_drawn_options.py",
    "tests/models/engines/test_minizinc_model.py",
    "tests/apps/authoring/test_verbs.py",
)
"""Tests over all rules there are, and of what is made from them."""
BETWEEN = "\n=== the next command ===\n"
ONE_AFTER_THE_OTHER = f"""
import json, sys
from kerfwise.cli import main
for words in json.loads(sys.argv[1]):
    try:
        main(words)
    except SystemExit as ended:
        assert not ended.code, words
    print(end={BETWEEN!r}, flush=True)
"""
"""Commands in one process: it starts once."""


@pytest.fixture
def plant(tmp_path: Path) -> Path:
    """A folder with an installed package that brings the rule bars-last."""
    rule_file(tmp_path, name="plant_rules.py")
    package(tmp_path)
    return tmp_path


@pytest.mark.slow
def test_a_package_brings_a_rule(plant: Path) -> None:
    profile = str(profile_file(plant, "rules: {bars-last: {strength: hard, ratio: 3}}"))
    asked = [
        ["rules"],
        ["rules", "bars-last"],
        ["profile", "show", profile],
        ["profile", "schema"],
        ["solve", str(NEST), "-p", profile, "--work", "1", "-o", "a.nc", "--plan", "a.json"],
    ]
    ended = python(plant, "-c", ONE_AFTER_THE_OTHER, json.dumps(asked))
    assert ended.returncode == 0, ended.stderr
    listed, page, shown, schema, solved = ended.stdout.split(BETWEEN)[:-1]
    assert "bars-last                 off           Bars are cut after the other parts." in listed
    assert "Brought by package plant-rules 1.0." in page
    assert "From package plant-rules 1.0." in shown
    assert "bars-last" in json.loads(schema)["properties"]["rules"]["properties"]
    assert "holds      hard bars-last" in solved
    order = [cut["contour"] for cut in json.loads((plant / "empty" / "a.json").read_text(encoding="utf-8"))["cuts"]]
    assert order[-1] == "L.outer"


@pytest.mark.slow
@pytest.mark.parametrize("kept_tests", [KEPT_TESTS[:2], full(KEPT_TESTS[2:])], ids=["some", "others"])
def test_pages_and_tests_of_kerfwise_do_not_change(plant: Path, kept_tests: tuple[str, ...]) -> None:
    assert python(plant, "-m", "kerfwise.rules.pages").stdout == (ROOT / "docs" / "rules.md").read_text(
        encoding="utf-8"
    )
    schema = ROOT / "rules" / "profile" / "profile.schema.json"
    assert python(plant, "-m", "kerfwise.rules.profile.schema").stdout == schema.read_text(encoding="utf-8")
    known = "from kerfwise.rules.outside import installed_rules; print(*installed_rules())"
    assert python(plant, "-c", known).stdout == "bars-last\n"
    tested = python(plant, "-m", "pytest", "-q", "-p", "no:cacheprovider", *kept_tests, at=ROOT)
    assert tested.returncode == 0, tested.stdout[-3000:]


@pytest.fixture
def found(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[pytest.MonkeyPatch]:
    """Looks for packages in the folder of the test alone; nothing is known of it afterwards."""

    def here(group: str) -> EntryPoints:
        made = [point for path in sorted(tmp_path.glob("*.dist-info")) for point in PathDistribution(path).entry_points]
        return EntryPoints(point for point in made if point.group == group)

    before = set(sys.modules)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(outside, "entry_points", here)
    outside.installed_rules.cache_clear()
    yield monkeypatch
    outside.installed_rules.cache_clear()
    for name in set(sys.modules) - before:
        if name.startswith("plant_rules"):
            del sys.modules[name]


def test_it_is_off_until_a_profile_names_it(plant: Path, found: object) -> None:
    assert load_profile().rules["bars-last"].strength == "off"
    assert "bars-last" not in load_profile().settings()
    assert load_profile(profile_file(plant, "rules: {bars-last: soft}")).rules["bars-last"].weight == 1000.0
    with pytest.raises(Exception, match=r"rules.bars-last: rules from outside are off .* give its strength too"):
        load_profile(profile_file(plant, "rules: {bars-last: {ratio: 3}}"))


def test_its_code_is_loaded_once(plant: Path, found: pytest.MonkeyPatch) -> None:
    one = load_profile().further_rules["bars-last"]
    found.setattr(EntryPoint, "load", lambda self: 1 / 0)
    assert load_profile().further_rules["bars-last"] is one


def test_a_module_may_bring_several(tmp_path: Path, found: object) -> None:
    second = "\n\nclass Second(BarsLast):\n    id = 'bars-first'\n\n\ndef bar("
    rule_file(tmp_path, ("def bar(", second), name="plant_rules.py")
    package(tmp_path, points="all = plant_rules")
    assert list(outside.installed_rules()) == ["bars-first", "bars-last"]


BROKEN = {
    "no module": (
        "bars = plant_rulez:BarsLast", (),
        "brings rules that cannot be loaded (entry point bars = plant_rulez:BarsLast): ModuleNotFoundError",
    ),
    "no class": (
        "bars = plant_rules:Bars", (), "cannot be loaded (entry point bars = plant_rules:Bars): AttributeError",
    ),
    "raises": (
        "bars = plant_rules", (("def bar(", "1 / 0\n\n\ndef bar("),),
        "cannot be loaded (entry point bars = plant_rules): ZeroDivisionError",
    ),
    "no rule": (
        "bars = plant_rules:bar", (), "entry point bars = plant_rules:bar is no rule: expected a class derived",
    ),
    "empty": ("bars = plant_rules", (('id = "bars-last"', ""),), "defines no rule"),
    "incomplete": ("bars = plant_rules", (("def pairs", "def pears"),), "rule class BarsLast: pairs() is missing"),
    "shipped": (
        "bars = plant_rules", (('id = "bars-last"', 'id = "pierce"'),),
        "two rules are called 'pierce': one of package plant-rules 1.0, one of kerfwise itself",
    ),
}  # fmt: skip


@pytest.mark.parametrize("how", BROKEN)
def test_a_broken_package_is_named(how: str, tmp_path: Path, found: object) -> None:
    points, instead, message = BROKEN[how]
    rule_file(tmp_path, *instead, name="plant_rules.py")
    package(tmp_path, points=points)
    with pytest.raises(RuleFault) as caught:
        load_profile()
    assert "package plant-rules 1.0" in str(caught.value)
    assert message in str(caught.value)


@pytest.mark.slow
def test_a_broken_package_ends_the_command_with_a_message(tmp_path: Path) -> None:
    package(tmp_path, points="bars = plant_rules:BarsLast")
    ended = python(tmp_path, "-m", "kerfwise", "facts", str(NEST))
    assert (ended.returncode, ended.stdout) == (2, "")
    assert ended.stderr.startswith("kerfwise: package plant-rules 1.0 brings rules that cannot be loaded")
    assert ended.stderr.endswith("mend it, or uninstall it: pip uninstall plant-rules\n")


def test_two_packages_with_one_name(tmp_path: Path, found: object) -> None:
    rule_file(tmp_path, name="plant_rules.py")
    rule_file(tmp_path, name="plant_rules_2.py")
    package(tmp_path)
    package(tmp_path, "other-rules", "bars = plant_rules_2")
    message = "two rules are called 'bars-last': one of package plant-rules 1.0, one of package other-rules 1.0"
    with pytest.raises(RuleFault, match=message):
        load_profile()


def test_the_catalogue_stays_what_it_is(plant: Path, found: object) -> None:
    assert "bars-last" in outside.installed_rules()
    assert "bars-last" not in RULES
