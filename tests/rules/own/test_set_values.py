"""What a job file sets in the plant's own rules and in those of its model files, for one nest."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.nest_job.job import job_of
from kerfwise.rules.own import OwnRule
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.overrides import read_setting, with_settings
from kerfwise.rules.profile.profile import Profile

PLANT = """
name: plant
own_rules:
  - name: narrow slots first
    why: they warp
    select: {kind: hole, short_side_mm: "< 8"}
    before: {kind: hole, not: {short_side_mm: "< 8"}}
    scope: part
  - {name: v1.2, strength: soft, weight: 70 mm, apart: {cuts: 2, within: 50 mm}, select: {kind: hole}}
"""


@pytest.fixture
def plant(tmp_path: Path) -> Profile:
    (tmp_path / "plant.yaml").write_text(PLANT)
    return load_profile(str(tmp_path / "plant.yaml"))


def laid(plant: Profile, text: str) -> dict[str, OwnRule]:
    """The own rules of the plant with what a job file sets, by name."""
    made = with_settings(plant, job_of(text, "plate.job.yaml").settings, "plate.job.yaml")
    return {rule.name: rule for rule in made.own_rules if isinstance(rule, OwnRule)}


def test_what_is_set_takes_its_place_and_the_rest_stays(plant: Profile) -> None:
    before = {rule.name: rule for rule in plant.own_rules}
    text = 'set:\n  own_rules.narrow slots first.select.short_side_mm: "< 6"\n  own_rules.v1.2.apart.cuts: 3\n'
    after = laid(plant, text)
    slots, spread = after["narrow slots first"].plain(), after["v1.2"].plain()
    assert slots["select"] == {"kind": "hole", "short_side_mm": "< 6"}
    assert (slots["why"], slots["scope"]) == ("they warp", "part")
    assert spread["apart"] == {"cuts": 3, "within": "50 mm"}
    assert (spread["strength"], spread["weight"]) == ("soft", "70 mm")
    assert after["v1.2"].place == before["v1.2"].place


@pytest.mark.parametrize(
    "text",
    [
        "set: {own_rules.narrow slots first: soft, 'own:v1.2': off}",
        "set: {own_rules: {narrow slots first: soft, v1.2: {strength: off}}}",
        "set: {own_rules: {narrow slots first: {strength: soft}}, own_rules.v1.2.strength: off}",
    ],
)
def test_a_rule_is_made_soft_or_off(plant: Profile, text: str) -> None:
    after = laid(plant, text)
    assert (after["narrow slots first"].strength, after["narrow slots first"].weight) == ("soft", 1000.0)
    assert (after["v1.2"].strength, after["v1.2"].weight) == ("off", None)


@pytest.mark.parametrize(
    ("text", "place", "said"),
    [
        ("set: {own_rules.narrow slot first: off}", (1, 7), "did you mean 'narrow slots first'?"),
        (
            "set: {own_rules.narrow slots first.wight: 3 mm}",
            (1, 7),
            ": unknown key 'wight'",
        ),
        (
            "set: {own_rules.narrow slots first.weight: 3 mm}",
            (1, 44),
            "only a soft rule has a weight, this one is hard",
        ),
        ("set:\n  own_rules.v1.2.weight: heavy\n", (2, 26), "own_rules.v1.2.weight: "),
        ("set: {own_rules.v1.2.first: true}", (1, 7), "a rule asks one thing, this one asks apart and first"),
        ("set: {own_rules.v1.2.name: x}", (1, 7), "a rule keeps its name"),
        ("set: {own_rules: off}", (1, 7), "unknown own rule ''"),
        (
            "set:\n  own_rules.v1.2: {weight: 3 mm}\n  own_rules.v1.2.weight: 4 mm\n",
            (3, 3),
            "own_rules.v1.2.weight is set twice",
        ),
        ("set:\n  own:v1.2: soft\n  own_rules.v1.2.strength: off\n", (3, 3), "own_rules.v1.2.strength is set twice"),
        (
            "set:\n  own_rules.v1.2.apart: {cuts: 3}\n  own_rules.v1.2.apart.cuts: 4\n",
            (3, 3),
            "own_rules.v1.2.apart.cuts is set twice",
        ),
    ],
)
def test_what_is_wrong_is_said_at_its_place(plant: Profile, text: str, place: tuple[int, int], said: str) -> None:
    with pytest.raises(InputError) as error:
        laid(plant, text)
    assert said in error.value.message
    assert (error.value.file, error.value.line, error.value.column) == ("plate.job.yaml", *place)


def test_on_the_command_line(plant: Profile) -> None:
    made = with_settings(plant, [read_setting("own_rules.narrow slots first=soft")])
    assert made.own_rules[0].strength == "soft"
    with pytest.raises(InputError, match=r"--set \(in Python: settings\): unknown own rule 'v1.strength'"):
        with_settings(plant, [read_setting("own_rules.v1.strength=off")])
    with pytest.raises(InputError, match="the profile has no own rules"):
        with_settings(load_profile(), [read_setting("own:v1=off")])


def test_a_rule_in_a_file_and_the_parameters_of_a_model_file(tmp_path: Path) -> None:
    model = "% {0}: rivet holes are cut first\nint: {1}_most;  % default 800: no longer round than this, 0.01 mm\n"
    rest = "array[int] of var bool: {1}_holds = [true];\narray[int] of int: {1}_contour = [1];\n"
    for name in ("rivets-first", "beside"):
        (tmp_path / f"{name}.mzn").write_text((model + rest).format(name, name.replace("-", "_")))
    (tmp_path / "plant.yaml").write_text("models: rivets-first.mzn\nown_rules: [{file: beside.mzn, strength: soft}]\n")
    plant = load_profile(str(tmp_path / "plant.yaml"))
    job = job_of("set: {rules.rivets-first.most: 700, own_rules.beside.weight: 40 mm}", "plate.job.yaml")
    made = with_settings(plant, job.settings, "plate.job.yaml")
    assert made.rules["rivets-first"].options != plant.rules["rivets-first"].options
    assert (made.own_rules[0].strength, made.own_rules[0].weight) == ("soft", 40.0)
    assert with_settings(plant, [read_setting("own:beside=hard")]).own_rules[0].weight is None
    with pytest.raises(InputError, match="unknown key of a rule in a file 'select'"):
        with_settings(plant, [read_setting("own:beside.select=x")])
