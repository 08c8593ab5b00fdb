"""kerfwise solve --lock-from: what is already cut stays, and the rest is planned anew around it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import kerfwise as package
from kerfwise.tests.commands.run_cli import kerfwise

NEST = Path(package.__file__).parent / "examples" / "nests" / "e1x_6.json"
TURNED = """
name: turned
based_on: plasma-carbon-steel
machine: {home: [0, 300]}
rules: {heat-lag: off, level-ahead: off, zone-order: off}
"""


@pytest.fixture(scope="module")
def old(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("old") / "old.json"
    assert kerfwise("solve", NEST, "--plan", path, "--work", "2").code == 0
    return path


def cuts(path: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(path.read_text())["cuts"]
    return found


def ways(path: Path) -> list[tuple[Any, ...]]:
    return [(cut["contour"], cut["entry"], cut["direction"]) for cut in cuts(path)]


def test_the_first_cuts_stay_and_the_rest_is_planned_anew(old: Path, tmp_path: Path) -> None:
    (tmp_path / "turned.yaml").write_text(TURNED)
    new, free = tmp_path / "new.json", tmp_path / "free.json"
    common = ("solve", NEST, "-p", tmp_path / "turned.yaml", "--work", "2")
    assert kerfwise(*common, "--plan", free).code == 0
    done = kerfwise(*common, "--plan", new, "--lock-from", old, "--upto", "6")
    assert done.code == 0, done.err
    assert ways(new)[:6] == ways(old)[:6]
    assert ways(free)[:6] != ways(old)[:6]
    assert sorted(c for c, _, _ in ways(new)) == sorted(c for c, _, _ in ways(free))


def test_a_lock_that_the_rules_do_not_allow_is_named(old: Path, tmp_path: Path) -> None:
    """The outline of a part first, then its hole."""
    plan = json.loads(old.read_text())
    inner = next(k for k, cut in enumerate(plan["cuts"]) if cut["kind"] == "hole")
    outer = next(k for k, cut in enumerate(plan["cuts"]) if cut["contour"] == f"{plan['cuts'][inner]['part']}.outer")
    turned = [plan["cuts"][outer], plan["cuts"][inner]]
    rest = [cut for k, cut in enumerate(plan["cuts"]) if k not in (inner, outer)]
    plan["cuts"] = [cut | {"order": k} for k, cut in enumerate([*turned, *rest], 1)]
    (tmp_path / "turned.json").write_text(json.dumps(plan))
    picture = tmp_path / "conflict.svg"
    command = ("solve", NEST, "--lock-from", tmp_path / "turned.json", "--upto", "2", "-o", tmp_path / "out.nc")
    done = kerfwise(*command, "--conflict-picture", picture)
    assert done.code == 1
    assert f"{turned[0]['contour']} is cut 1 in order: kept as cut 1 of" in done.err
    assert not (tmp_path / "out.nc").exists()


def test_wrong_use_is_said(old: Path) -> None:
    alone = kerfwise("solve", NEST, "--upto", "3")
    assert (alone.code, "--lock-from PLAN.json and --upto N go together" in alone.err) == (2, True)
    many = kerfwise("solve", NEST, "--lock-from", old, "--upto", "99")
    assert (many.code, "the plan has 16 cuts only" in many.err) == (2, True)
