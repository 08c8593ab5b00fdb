"""Bridged nests by seed: planned, and burnt by the simulation, which puts outlines and strips together by itself."""

from __future__ import annotations

import json
import math
import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from kerfwise import read_nest
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.metal.drawing import drawing_of


def made(seed: int) -> dict[str, Any]:
    """A row of squares, discs and plates with holes; strips between neighbours, some slanted, one pair with two."""
    chance = random.Random(seed)
    x, parts, bridges = 20.0, [], []
    for k in range(4):
        name, size, y = f"P{k}", chance.uniform(50, 90), chance.uniform(20, 35)
        middle = (x + size / 2, y + size / 2)
        if chance.random() < 0.4:
            outer = [[x, middle[1], 1], [x + size, middle[1], 1]]
        else:
            outer = [[x, y], [x + size, y], [x + size, y + size], [x, y + size]]
        part: dict[str, Any] = {"id": name, "outer": outer}
        if chance.random() < 0.5:
            part["holes"] = [[[middle[0] - 8, middle[1], 1], [middle[0] + 8, middle[1], 1]]]
        if k and chance.random() < 0.8:
            before = parts[-1]
            deep, width = chance.uniform(10, 14), chance.uniform(3, 9)
            level = (before["middle"] + middle[1]) / 2 + chance.uniform(-4, 4)
            start, end = [before["right"] - deep, level], [x + deep, level + chance.uniform(-5, 5)]
            bridges.append({"parts": [before["id"], name], "from": start, "to": end, "width": width})
        parts.append({**part, "middle": middle[1], "right": x + size})
        x += size + chance.uniform(12, 25)
    rows = [{key: value for key, value in part.items() if key not in ("middle", "right")} for part in parts]
    sheet = {"width": math.ceil(x + 20), "height": 160}
    return {"format": "kerfwise-nest/1", "sheet": sheet, "parts": rows, "bridges": bridges}


@pytest.mark.parametrize("seed", range(4))
def test_what_is_joined_is_one_piece_at_the_end(tmp_path: Path, seed: int) -> None:
    nest = made(seed)
    (tmp_path / "nest.json").write_text(json.dumps(nest), encoding="utf-8")
    done = kerfwise("solve", tmp_path / "nest.json", "--work", "0.3", "-o", tmp_path / "nest.nc")
    assert done.code == 0, done.err + done.out
    assert nest["bridges"]
    assert "holds      hard bridges" in done.out


def test_a_hole_that_gets_lost_where_parts_are_joined_is_told(tmp_path: Path) -> None:
    holes = [[[32, 40, 1], [48, 40, 1]]]
    square = [[20, 20], [60, 20], [60, 60], [20, 60]]
    parts = [{"id": "A", "outer": square, "holes": holes}, {"id": "B", "outer": [[x + 60, y] for x, y in square]}]
    bridge = {"parts": ["A", "B"], "from": [55, 40], "to": [85, 40], "width": 6}
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": 150, "height": 80}, "parts": parts, "bridges": [bridge]}
    (tmp_path / "nest.json").write_text(json.dumps(nest), encoding="utf-8")
    read = read_nest(tmp_path / "nest.json")
    assert [c.kind for c in drawing_of(read).contours] == ["hole", "outer"]
    (whole,) = read.parts
    with pytest.raises(AssertionError, match="holes got lost"):
        drawing_of(replace(read, parts=(replace(whole, holes=()),)))
