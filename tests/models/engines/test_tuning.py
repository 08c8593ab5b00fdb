"""The numbers that the engines go by stand in one file, each with its unit and reason, and all are read."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import kerfwise

ENGINES = Path(kerfwise.__file__).parent / "models" / "engines"
TABLE = ENGINES / "tuning.py"
FIXED = {
    "bounds/completion.py": {"GRAIN", "DEAREST"},
    "bounds/flow.py": {"FAR", "BY_DUAL", "BY_PRIMAL", "MOST_ROUNDS"},
    "bounds/network.py": {"MARGIN_UM"},
    "bounds/reduced_costs.py": {"NEVER", "MOST_UM", "GRAIN"},
    "bounds/separation.py": {"UNIT", "ALL"},
    "ideals/kernels.py": {"TOGETHER"},
    "ideals/prove.py": {"ROUNDING"},
    "ideals/stretch.py": {"HARD", "ALL"},
    "ideals/stretches/stretch_bounds.py": {"NOWHERE"},
    "ideals/stretches/stretch_tables.py": {"NARROW", "WIDE", "LANES", "HOME", "FAR"},
    "search/anneal.py": {"DEAREST"},
    "search/state/chains.py": {"HARD"},
    "search/state/conditions.py": {"NO_SITE", "WITHIN"},
    "search/moves/insertion.py": {"FAR"},
    "search/moves/lin_kernighan_tables.py": {"UNLAWFUL", "FRONT", "LOW", "HIGH"},
    "search/state/route_state.py": {
        *("LENGTH", "COST", "BROKEN", "BEST", "PRICE", "WORK", "TAKEN", "UNITS"),
        *("STAMP", "TRIES", "LAWLESS", "CLIMBS", "TRADES", "TRADED", "NUMBERS", "ROWS_AT_ONCE"),
        *("WHOLE", "WHOLE_BROKEN"),
    },
    "search/state/travel.py": {"NO_LINK", "SPREAD", "DEAREST"},
    "solution.py": {"BYTES_PER_GB"},
}
"""Marks in tables, what stands for none or for too much, grains that keep sums exact, units: nothing to tune."""

SHARING = {
    "adaptive_zones": set(),
    "cooler_orders": set(),
    "heat_control": {"LATER", "LISTED"},
    "first_plan": {"STAYED_MM"},
    "by_engine": set(),
    "plan_without_zones": set(),
    "request": set(),
    "time_limits": set(),
    "warm_up": set(),
}
"""Jobs that share out work and time, and what else they have: a share that follows from others, what is printed,
what counts as the same place."""


def constants(source: str) -> Iterator[str]:
    """Names of a module that are numbers, or rows of numbers, by what is written there."""
    for node in ast.parse(source).body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            inner = list(ast.walk(node.value))
            called = any(isinstance(part, ast.Call | ast.Dict | ast.Subscript) for part in inner)
            if not called and any(
                isinstance(part, ast.Constant) and type(part.value) in (int, float) for part in inner
            ):
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                yield from (part.id for target in targets for part in ast.walk(target) if isinstance(part, ast.Name))


@pytest.mark.parametrize("file", sorted(ENGINES.rglob("*.py")), ids=lambda file: str(file.relative_to(ENGINES)))
def test_no_number_to_tune_stands_anywhere_else(file: Path) -> None:
    if file != TABLE:
        found = set(constants(file.read_text(encoding="utf-8")))
        assert found == FIXED.get(file.relative_to(ENGINES).as_posix(), set()), (
            "numbers go into models/engines/tuning.py"
        )


@pytest.mark.parametrize("name", SHARING)
def test_no_share_of_work_or_time_stands_in_a_job(name: str) -> None:
    found = set(constants((ENGINES.parents[1] / "jobs" / f"{name}.py").read_text(encoding="utf-8")))
    assert found == SHARING[name], "numbers go into models/engines/tuning.py"


def test_a_number_elsewhere_would_be_noticed() -> None:
    assert list(constants("A, B = 1, 2.0\nC: int = 3\nD = E + 1\nF = make(1)\nG = 'h'\nI = True")) == [
        "A",
        "B",
        "C",
        "D",
    ]


def test_each_number_has_a_reason() -> None:
    lines = TABLE.read_text(encoding="utf-8").splitlines()
    bare = [
        line
        for line, after in zip(lines, [*lines[1:], ""], strict=True)
        if re.match(r"[A-Z].* = ", line) and "  # " not in line and not after.startswith('"""')
    ]
    assert bare == []


def test_each_number_is_read() -> None:
    root = Path(kerfwise.__file__).parent
    text = "\n".join(
        file.read_text(encoding="utf-8")
        for folder in ("models", "jobs", "apps")
        for file in (root / folder).rglob("*.py")
        if file != TABLE
    )
    assert [name for name in constants(TABLE.read_text(encoding="utf-8")) if not re.search(rf"\b{name}\b", text)] == []
