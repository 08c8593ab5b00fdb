"""Nests whose metal would be burnt or whose features would be lost, by the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kerfwise.tests.commands.run_cli import Ended, kerfwise

Row = list[list[float]]


def rect(x: float, y: float, w: float, h: float) -> Row:
    return [[x, y], [x + w, y], [x + w, y + h], [x, y + h]]


def nest_file(folder: Path, **outers: Row) -> Path:
    parts = [{"id": name, "outer": outer} for name, outer in outers.items()]
    nest = {"format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": 300, "height": 150}, "parts": parts}
    (folder / "nest.json").write_text(json.dumps(nest), encoding="utf-8")
    return folder / "nest.json"


def solve(nest: Path, *words: str) -> Ended:
    folder = nest.parent
    return kerfwise("solve", nest, "-o", folder / "nest.nc", "--conflict-picture", folder / "c.svg", *words)


def test_parts_nearer_than_the_kerf_are_refused_with_their_pair(tmp_path: Path) -> None:
    nest = nest_file(tmp_path, A=rect(20, 20, 60, 60), B=rect(81.39, 20, 60, 60))
    done = solve(nest, "--work", "1")
    assert done.code == 1
    assert (
        "  - shared-metal: A.outer and B.outer are 1.390 mm apart at (80.7, 20.0): the kerf of 1.5 mm reaches 0.110 mm "
        "into the other part\n"
    ) in done.err
    assert not (tmp_path / "nest.nc").exists()


@pytest.mark.scrap("what --relax lets go is burnt")
def test_relax_lets_them_go_and_marks_them(tmp_path: Path) -> None:
    nest = nest_file(tmp_path, A=rect(20, 20, 60, 60), B=rect(81, 20, 60, 60))
    done = kerfwise(
        "solve", nest, "-o", tmp_path / "nest.nc", "--conflict-picture", tmp_path / "c.svg", "--work", "1", "--relax"
    )
    assert done.code == 0, done.err
    assert "shared-metal, relaxed: A.outer and B.outer are 1.000 mm apart" in done.out
    assert "(RELAXED 1 shared-metal A.outer B.outer)" in (tmp_path / "nest.nc").read_text(encoding="utf-8")
    checked = kerfwise("check", nest, tmp_path / "nest.nc")
    assert checked.code == 0
    assert "warning: relaxed: shared-metal about A.outer, B.outer" in checked.out


def test_touching_wood_is_cut_with_a_warning(tmp_path: Path) -> None:
    nest = nest_file(tmp_path, A=rect(20, 20, 60, 60), B=rect(80, 20, 60, 60))
    done = kerfwise(
        "solve",
        nest,
        "-o",
        tmp_path / "nest.nc",
        "--conflict-picture",
        tmp_path / "c.svg",
        "-p",
        "laser-wood",
        "--work",
        "1",
    )
    assert done.code == 0, done.err
    assert "A and B are less than the kerf of 0.7 mm apart: each cut takes metal of both, up to 0.700 mm" in done.out


def test_a_deep_slot_that_the_kerf_does_not_enter_is_asked_about_with_its_place(tmp_path: Path) -> None:
    slot = [[20, 20], [80, 20], [80, 120], [50.5, 120], [50.5, 40], [49.5, 40], [49.5, 120], [20, 120]]
    nest = nest_file(tmp_path, A=slot, B=rect(120, 20, 60, 60))
    done = solve(nest, "--work", "1")
    assert done.code == 3
    assert (
        "A.outer, slot, notch or neck at (50.0, 120.0), 1.00 mm wide and 80.0 mm deep: what should be done?" in done.err
    )
    assert not (tmp_path / "nest.nc").exists()
