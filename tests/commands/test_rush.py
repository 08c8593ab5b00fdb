"""Rush orders: a part is locked first or before another on nests with marks, and a due date moves it forward."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.nest_file import nest_file


def square(name: str, y: float, **more: Any) -> dict[str, Any]:
    """A square with a hole and a mark; one above the other, none is ahead of another as seen from the left."""
    return {
        "id": name,
        "outer": [[20, y], [100, y], [100, y + 80], [20, y + 80]],
        "holes": [[[50, y + 30], [80, y + 30], [80, y + 60], [50, y + 60]]],
        "marks": [[[28, y + 10], [40, y + 10]]],
        **more,
    }


def order_of(*words: object) -> list[str]:
    """The contours in the order in which `kerfwise solve plate.json WORDS` cuts them."""
    ended = kerfwise("solve", "plate.json", "--work", 0.5, "--plan", "plan.json", "-o", "out.nc", *words)
    assert ended.code == 0, ended.err + ended.out
    checked = kerfwise("check", "plate.json", "out.nc", *words)
    assert checked.code == 0, checked.out
    return [cut["contour"] for cut in json.loads(Path("plan.json").read_text())["cuts"]]


@pytest.fixture
def plate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Three squares in a column, each with a hole and a mark."""
    monkeypatch.chdir(tmp_path)
    return nest_file(tmp_path / "plate.json", [square(f"P{k}", 20 + 100 * (k - 1)) for k in (1, 2, 3)], (120, 340))


def test_a_part_is_first_after_the_marks(plate: Path) -> None:
    cuts = [one for one in order_of("--lock", "P3 first") if ".mark" not in one]
    assert cuts[:2] == ["P3.hole1", "P3.outer"]


def test_a_part_is_last_and_its_marks_are_not(plate: Path) -> None:
    order = order_of("--lock", "P1 last")
    assert order[-2:] == ["P1.hole1", "P1.outer"]
    assert order.index("P1.mark1") < 3


def test_a_part_comes_before_another(plate: Path) -> None:
    order = order_of("--lock", "P3 before P1", "--lock", "P2 before P3")
    assert [one for one in order if one.endswith("outer")] == ["P2.outer", "P3.outer", "P1.outer"]
    assert all(".mark" in one for one in order[:3])


def test_a_due_part_comes_sooner_at_a_price(plate: Path) -> None:
    free = ("--set", "rules.level-ahead=off", "--set", "rules.part-rigidity=off")
    last = [one for one in order_of(*free) if one.endswith("outer")][-1]
    parts = [
        square(f"P{k}", 100 * k - 80, **({"due": "2026-12-01"} if f"P{k}.outer" == last else {})) for k in (1, 2, 3)
    ]
    nest_file(plate, parts, (120, 340))
    outer = [one for one in order_of(*free, "--set", "objective.completion=1000") if one.endswith("outer")]
    assert outer[0] == last


RULE = """based_on: plasma-carbon-steel
rules: {level-ahead: off}
own_rules:
  - name: rush order out early
    why: the truck leaves
    select: {attribute.order: "77"}
    within_time: 40 %
  - name: heavy parts last
    select: {part: P1, kind: outer, weight_kg: "> 0.1", thickness_mm: "< 8", process: plasma, material: "S*"}
    last: true
"""


def test_a_rule_says_the_time_by_which_an_order_is_out(plate: Path) -> None:
    parts = [square("P1", 20), square("P2", 120), square("P3", 220, order="77")]
    nest_file(plate, parts, (120, 340))
    Path("plant.yaml").write_text(RULE)
    outer = [one for one in order_of("-p", "plant.yaml") if one.endswith("outer")]
    assert outer[0] == "P3.outer"
    late = kerfwise("solve", "plate.json", "--work", 0.5, "-o", "late.nc")
    assert late.code == 0
    judged = kerfwise("check", "plate.json", "late.nc", "-p", "plant.yaml")
    assert (judged.code, "of cutting, not 40 % of the cutting time" in judged.out) == (1, True), judged.out
    Path("plant.yaml").write_text(RULE.replace("40 %", "1 %"))
    never = kerfwise("solve", "plate.json", "--work", 0.5, "-p", "plant.yaml", "-o", "never.nc")
    assert (never.code, "own:rush order out early" in never.out + never.err) == (1, True)
    Path("plant.yaml").write_text(RULE.replace("40 %", "soon"))
    assert "expected a share such as 40 %" in kerfwise("profile", "check", "plant.yaml").err
