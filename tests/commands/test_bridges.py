"""Bridged parts by the command line; the check and the simulation put the union together by themselves."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from kerfwise import Nest, read_nest
from kerfwise.rule_kit import Curve
from kerfwise.tests.checked import checked
from kerfwise.tests.commands.run_cli import Ended, kerfwise
from kerfwise.tests.encoder.test_bridges import A, B, C, bridge
from kerfwise.tests.metal.simulate import simulate
from kerfwise.tests.tools import canon

ROWS = [bridge("A", "B", [120, 70], [142, 70], 8), bridge("C", "B", [240, 70], [215, 70], 8)]


def nest_file(folder: Path, bridges: list[Any], name: str = "nest.json") -> Path:
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": 400, "height": 200}, "parts": [A, B, C], "bridges": bridges}
    (folder / name).write_text(json.dumps(nest), encoding="utf-8")
    return folder / name


def solve(nest: Path, *words: str | Path) -> Ended:
    files = ("-o", nest.with_suffix(".nc"), "--plan", nest.with_suffix(".plan.json"))
    return kerfwise("solve", nest, *files, "--work", "1", *words)


@pytest.mark.linuxcnc
def test_they_are_cut_as_one(tmp_path: Path) -> None:
    """The simulation burns the program besides; LinuxCNC's interpreter reads as much torch-on length in it."""
    nest = nest_file(tmp_path, ROWS)
    done = solve(nest, "--picture", tmp_path / "nest.svg")
    assert done.code == 0, done.err
    plan = json.loads((tmp_path / "nest.plan.json").read_text(encoding="utf-8"))
    assert [(c["contour"], c["part"]) for c in plan["cuts"][1:]] == [("A.hole1", "A+B+C"), ("A+B+C.outer", "A+B+C")]
    text = (tmp_path / "nest.nc").read_text(encoding="utf-8")
    assert sum(burn.length_mm for burn in canon.run(text).cuts) == pytest.approx(
        sum(cut["length_mm"] for cut in plan["cuts"] if cut["kind"] != "mark"), abs=0.1
    )
    for made in ("nest.nc", "nest.plan.json"):
        judged = kerfwise("check", nest, tmp_path / made)
        assert judged.code == 0, judged.out
        assert "holds      hard bridges" in judged.out
    assert kerfwise("explain", nest, tmp_path / "nest.plan.json", "A+B+C.outer").code == 0


@pytest.mark.slow
def test_a_program_that_cuts_the_parts_apart_is_told(tmp_path: Path) -> None:
    """The program of the nest without bridges, or with one left out, is judged against the nest with both."""
    nest = nest_file(tmp_path, ROWS)
    for name, rows in (("none.json", []), ("one.json", ROWS[:1])):
        assert solve(nest_file(tmp_path, rows, name)).code == 0
        judged = kerfwise("check", nest, (tmp_path / name).with_suffix(".nc"))
        assert judged.code == 1
        assert "broken     hard bridges" in judged.out
        text = (tmp_path / name).with_suffix(".nc").read_text(encoding="utf-8")
        assert "bridge-cut" in {found.kind for found in simulate(read_nest(nest), text, kerf_mm=1.5)}


def test_a_wrong_union_cannot_hide(tmp_path: Path) -> None:
    """A nest whose joined outline is elsewhere than its parts and strips are is told."""
    assert solve(nest_file(tmp_path, ROWS[:1], "one.json")).code == 0
    text = (tmp_path / "one.nc").read_text(encoding="utf-8")
    sound = read_nest(tmp_path / "one.json")
    assert checked(sound, text).ok
    rows = sound.contour("A+B.outer").curve.vertices.copy()
    moved = Curve(rows).moved(0.3, 0)
    part = replace(sound.parts[0], outer=replace(sound.parts[0].outer, curve=moved))
    wrong: Nest = replace(sound, parts=(part, *sound.parts[1:]))
    told = {j.id for j in checked(wrong, text).rules if j.violations}
    assert "bridges" in told


@pytest.mark.parametrize(
    ("row", "told"),
    [
        (bridge("A", "C", [110, 70], [250, 70], 6), "nest.json:1: bridge 1 (A to C) meets a third part, B"),
        (bridge("A", "B", [120, 70], [142, 70], 1), "bridge 1 (A to B) is 1 mm wide, less than the kerf of 1.5 mm"),
    ],
)
def test_bad_bridges_are_refused_and_nothing_is_written(tmp_path: Path, row: dict[str, Any], told: str) -> None:
    done = solve(nest_file(tmp_path, [row]))
    assert (done.code, "Traceback" in done.err) == (2, False)
    assert told in done.err
    assert len(done.err.strip().splitlines()) == 1
    assert sorted(p.name for p in tmp_path.iterdir()) == ["nest.json"]
