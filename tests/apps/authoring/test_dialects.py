"""kerfwise dialects: the list, one file, and a plant's own to begin with."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

import kerfwise as package
from kerfwise.tests.commands.run_cli import kerfwise

NEST = (
    '{"format": "kerfwise-nest/1", "sheet": {"width": 200, "height": 120}, '
    '"parts": [{"id": "A", "outer": [[20, 30], [80, 30], [80, 90]]%s}]}'
)
SHIPPED = {
    path.stem: yaml.safe_load(path.read_text())
    for path in Path(*package.__path__, "postproc", "dialects").glob("*.yaml")
}
MARKED = NEST % ', "marks": [[[30, 40], [60, 40]]]'


@pytest.fixture(autouse=True)
def empty(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_the_list_names_each_with_who_agrees() -> None:
    said = kerfwise("dialects")
    assert said.code == 0
    for name, dialect in SHIPPED.items():
        assert f"\n{name} " in f"\n{said.out}"
        assert all(reader in said.out for reader in dialect["verified_by"])
    assert "not verified by any reader" not in said.out


def test_one_is_shown_as_it_is() -> None:
    shown = kerfwise("dialects", "show", "eia").out
    assert shown.startswith("# Hypertherm EDGE Connect")
    assert yaml.safe_load(shown) == SHIPPED["eia"]


@pytest.mark.parametrize("name", sorted(SHIPPED))
def test_a_copy_says_the_same_under_its_own_name_and_claims_no_reader(name: str) -> None:
    assert kerfwise("dialects", "new", "shop", "--like", name).code == 0
    copy, old = yaml.safe_load(Path("shop.yaml").read_text()), SHIPPED[name]
    assert copy == old | {"name": "shop", "verified_by": []}
    again = kerfwise("dialects", "new", "second", "--like", "shop.yaml")
    assert (again.code, yaml.safe_load(Path("second.yaml").read_text())["name"]) == (0, "second")
    process = old["processes"][0]
    Path("plant.yaml").write_text(f"machine: {{process: {process}, dialect: shop.yaml, accept_dialect: true}}\n")
    assert kerfwise("profile", "check", "plant.yaml").code == 0


@pytest.mark.parametrize(
    ("argv", "message"),
    [
        (["new", "grbl", "--like", "grbl"], "is the name of a dialect that comes with kerfwise"),
        (["new", "a b", "--like", "grbl"], "cannot be a dialect's name"),
        (["new", "shop", "--like", "gbrl"], "did you mean 'grbl'"),
        (["new", "shop", "--like", "none.yaml"], "cannot read the dialect"),
        (["new", "shop", "--like", "grbl", "-o", "shop.txt"], "ends in .yaml"),
        (["new", "there", "--like", "grbl"], "is there already"),
        (["show", "gbrl"], "did you mean 'grbl'"),
    ],
)
def test_what_cannot_be_begun(argv: list[str], message: str) -> None:
    Path("there.yaml").write_text("x\n")
    ended = kerfwise("dialects", *argv)
    assert ended.code == 2
    assert message in ended.err
    assert [path.name for path in Path().iterdir()] == ["there.yaml"]


def test_a_dialect_without_marks_refuses_a_nest_with_them_before_it_is_planned() -> None:
    Path("a.json").write_text(MARKED)
    Path("b.yaml").write_text("machine: {dialect: burny}\n")
    ended = kerfwise("solve", "a.json", "-p", "b.yaml")
    assert ended.code == 2
    assert "b.yaml:1:20: machine.dialect: 'burny' has no words for marking, and the nest has 1 (A.mark1)" in ended.err


def test_a_dialect_without_comments_cannot_go_on_after_a_stop() -> None:
    Path("a.json").write_text(NEST % '}, {"id": "B", "outer": [[120, 30], [180, 30], [180, 90]]')
    Path("b.yaml").write_text("machine: {dialect: burny}\n")
    assert kerfwise("solve", "a.json", "--work", 1, "--plan", "a.plan.json").code == 0
    ended = kerfwise("solve", "a.json", "-p", "b.yaml", "--lock-from", "a.plan.json", "--upto", 1, "-o", "b.nc")
    assert ended.code == 2
    assert "'burny' knows no comments" in ended.err


@pytest.mark.parametrize("name", sorted(SHIPPED))
def test_each_dialects_program_is_solved_and_checked_by_the_command_line(name: str) -> None:
    Path("a.json").write_text(NEST % '}, {"id": "B", "outer": [[120, 30], [180, 30], [180, 90]]')
    process = SHIPPED[name]["processes"][0]
    Path("b.yaml").write_text(f"machine: {{process: {process}, dialect: {name}, accept_dialect: true}}\n")
    solved = kerfwise("solve", "a.json", "-p", "b.yaml", "--work", 1, "-o", "a.nc", "--plan", "a.plan.json")
    assert solved.code == 0, solved.err + solved.out
    assert "not judged" not in solved.out
    alone = kerfwise("check", "a.json", "a.nc", "-p", "b.yaml")
    silent = SHIPPED[name]["comment"] is None
    assert ("not judged hard zone-order" in alone.out, alone.code) == (silent, 0)
    held = kerfwise("check", "a.json", "a.nc", "-p", "b.yaml", "--plan", "a.plan.json")
    assert held.code == 0, held.out
    rows = Path("a.nc").read_text().splitlines(keepends=True)
    letterless = {"essi": (r"^[+-]()(\d+)[+-]", 10), "hpgl": (r"^(P[UD])(\d+),", 40)}
    moves, a_mm = letterless.get(name, (r"\b(X)([0-9.]+)", 1))
    at = [k for k, row in enumerate(rows) if re.search(moves, row) and row[0] != "("][3]  # in the middle of a path
    rows[at] = re.sub(r"(X|^[+-]|^P[UD])([0-9.]+)", lambda x: f"{x[1]}{float(x[2]) + a_mm:g}", rows[at], count=1)
    Path("a.nc").write_text("".join(rows))
    damaged = kerfwise("check", "a.json", "a.nc", "-p", "b.yaml", "--plan", "a.plan.json")
    assert damaged.code in (1, 2)  # another path, or an arc that is none
    assert "contour-geometry" in damaged.out or "the arc's radius" in damaged.err
