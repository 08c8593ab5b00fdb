"""Parameters of a rule in a model file, set by its entry in `own_rules` or for one nest."""

from __future__ import annotations

from pathlib import Path

import pytest

import kerfwise
from kerfwise import InputError, Profile, load_profile
from kerfwise.rule_kit import nest, part, rect
from kerfwise.tests.commands.run_cli import kerfwise as command_line

MODEL = """% rivets-first: small holes of a part are cut before its others
int: rivets_first_most;  % default 100: no longer round than this, mm
bool: rivets_first_turned;  % default false: the large ones first
array[int] of var bool: rivets_first_holds =
  [before(i, j) | i, j in CONTOUR where kind[i] = HOLE /\\ kind[j] = HOLE /\\ part[i] = part[j]
     /\\ ((contour_length[i] <= 100 * rivets_first_most) != rivets_first_turned)
     /\\ ((contour_length[j] > 100 * rivets_first_most) != rivets_first_turned)];
"""
HOLES = nest(
    420, 200, part("A", rect(10, 10, 300, 100), [rect(30, 30, 50, 50), rect(130, 30, 70, 50), rect(240, 30, 40, 40)])
)


def loaded(folder: Path, entry: str) -> Profile:
    (folder / "rivets_first.mzn").write_text(MODEL)
    (folder / "plant.yaml").write_text(f"name: plant\nown_rules: [{entry}]\n")
    return load_profile(folder / "plant.yaml")


def options(profile: Profile) -> tuple[object, object]:
    found = profile.settings()["own:rivets_first"].options
    return found.most, found.turned


def test_what_an_entry_does_not_set_is_the_files(tmp_path: Path) -> None:
    assert options(loaded(tmp_path, "{file: rivets_first.mzn}")) == (100, False)
    assert options(loaded(tmp_path, "{file: rivets_first.mzn, parameters: {most: 170}}")) == (170, False)
    assert options(loaded(tmp_path, "{file: rivets_first.mzn, parameters: {turned: true}}")) == (100, True)


def test_they_are_shown(tmp_path: Path) -> None:
    loaded(tmp_path, "{file: rivets_first.mzn, parameters: {most: 170}}")
    (tmp_path / "shown.yaml").write_text(command_line("profile", "show", tmp_path / "plant.yaml").out)
    assert options(load_profile(tmp_path / "shown.yaml")) == (170, False)


@pytest.mark.minizinc
def test_they_are_set_for_one_nest(tmp_path: Path) -> None:
    plant = loaded(tmp_path, "{file: rivets_first.mzn, parameters: {most: 170}}")
    made = kerfwise.solve(HOLES, plant, settings=["own_rules.rivets_first.parameters.turned=true"], work=0.5)
    assert options(made.profile) == (170, True)


@pytest.mark.minizinc
@pytest.mark.parametrize(
    ("entry", "first"),
    [
        ("{most: 170}", {"A.hole3"}),
        ("{most: 200}", {"A.hole1", "A.hole3"}),
        ("{most: 170, turned: true}", {"A.hole1", "A.hole2"}),
    ],
)
def test_a_plan_obeys_them(tmp_path: Path, entry: str, first: set[str]) -> None:
    profile = loaded(tmp_path, f"{{file: rivets_first.mzn, parameters: {entry}}}")
    plan = kerfwise.solve(HOLES, profile, work=0.5).plan
    order = [planned.cut.contour for planned in plan.cuts]
    assert set(order[: len(first)]) == first


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ("{file: rivets_first.mzn, parameters: {mots: 3}}", "unknown parameter 'mots': did you mean 'most'?"),
        ("{file: rivets_first.mzn, parameters: {most: high}}", "own_rules[1].parameters.most: expected a whole number"),
        ("{file: rivets_first.mzn, parameters: {turned: 3}}", "own_rules[1].parameters.turned: expected true or false"),
        ("{file: rivets_first.mzn, parameters: 3}", "own_rules[1].parameters: expected a mapping"),
        ("{name: r, first: true, parameters: {most: 3}}", "unknown key 'parameters'"),
    ],
)
def test_what_is_wrong_is_said_at_its_place(tmp_path: Path, entry: str, said: str) -> None:
    with pytest.raises(InputError) as error:
        loaded(tmp_path, entry)
    assert said in error.value.message
    assert error.value.line == 2
    assert error.value.column is not None


def test_a_file_without_parameters_says_so(tmp_path: Path) -> None:
    (tmp_path / "bare.mzn").write_text("array[int] of var bool: bare_holds = [before(1, 2)];\n")
    (tmp_path / "plant.yaml").write_text("own_rules: [{file: bare.mzn, parameters: {most: 3}}]\n")
    with pytest.raises(InputError, match=r"bare\.mzn declares no parameter"):
        load_profile(tmp_path / "plant.yaml")
