"""The main job from end to end: every example nest becomes a program that passes every check, the same each time."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.tools import canon
from kerfwise.tests.tools.amount import full

EXAMPLES = Path(package.__file__).parent / "examples"
NESTS = sorted(p for p in (EXAMPLES / "nests").iterdir() if p.suffix in (".dxf", ".json", ".svg"))
SLOW = ("s8877", "plate40")
STEMS = [p.stem for p in NESTS]
BY_NAME = [pytest.param(p, id=p.name, marks=[pytest.mark.slow] if p.stem in SLOW else []) for p in NESTS]
ONCE = [full(row) if STEMS.index(p.stem) < k else row for k, (p, row) in enumerate(zip(NESTS, BY_NAME, strict=True))]
"""A nest that is there as a drawing and as JSON is planned always in the one, and with `--all` in the other too."""
SHOP = EXAMPLES / "profiles" / "shop.yaml"


@pytest.mark.slow
@pytest.mark.linuxcnc
@pytest.mark.parametrize("nest", ONCE)
def test_every_example_is_solved_checked_and_read_by_linuxcnc(nest: Path, tmp_path: Path) -> None:
    profile = ["-p", SHOP] if nest.name in ("plate40.json", "marked.svg") else []
    program, plan, picture = tmp_path / "out.nc", tmp_path / "out.plan.json", tmp_path / "out.svg"
    done = kerfwise("solve", nest, *profile, "-o", program, "--plan", plan, "--picture", picture)
    assert done.code == 0, done.err
    assert done.out.splitlines()[-2] == "ok: every hard rule holds"
    assert picture.read_text().startswith("<?xml") or picture.read_text().startswith("<svg")

    assert kerfwise("check", nest, program, *profile).code == 0
    assert kerfwise("check", nest, plan, *profile).code == 0

    written = json.loads(plan.read_text())
    assert written["solve"]["status"] == "optimal"
    assert all(rule["holds"] for rule in written["rules"] if rule["strength"] == "hard")
    read = canon.run(program.read_text())
    assert read.error is None
    assert read.warnings == []
    assert len(read.cuts) == sum(cut["kind"] != "mark" for cut in written["cuts"])
    assert len(read.marks) == sum(cut["kind"] == "mark" for cut in written["cuts"])
    assert read.idle_mm == pytest.approx(written["totals"]["idle_mm"], abs=0.05)


@pytest.mark.slow
def test_the_same_input_gives_the_same_bytes(tmp_path: Path) -> None:
    nest = EXAMPLES / "nests" / "e1x_6.dxf"
    for name in ("a", "b"):
        assert kerfwise("solve", nest, "-o", tmp_path / f"{name}.nc", "--plan", tmp_path / f"{name}.json").code == 0
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()


def test_without_an_output_named_all_three_are_written_here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert kerfwise("solve", EXAMPLES / "nests" / "e1x_6.json").code == 0
    assert sorted(p.name for p in tmp_path.iterdir()) == ["e1x_6.nc", "e1x_6.plan.json", "e1x_6.svg"]


def test_a_drawing_is_not_written_over_by_its_picture(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    drawn = (EXAMPLES / "nests" / "marked.svg").read_bytes()
    Path("marked.svg").write_bytes(drawn)
    assert kerfwise("solve", "marked.svg", "-p", SHOP).code == 0
    assert sorted(p.name for p in tmp_path.iterdir()) == [
        "marked.nc",
        "marked.plan.json",
        "marked.plan.svg",
        "marked.svg",
    ]
    assert Path("marked.svg").read_bytes() == drawn


def test_a_damaged_plan_or_program_fails_the_check(tmp_path: Path) -> None:
    nest = EXAMPLES / "nests" / "e1x_6.json"
    plan, program = tmp_path / "plan.json", tmp_path / "plan.nc"
    kerfwise("solve", nest, "-o", program, "--plan", plan)
    damaged = json.loads(plan.read_text())
    damaged["cuts"][0]["order"], damaged["cuts"][-1]["order"] = 16, 1
    plan.write_text(json.dumps(damaged))
    judged = kerfwise("check", nest, plan)
    assert judged.code == 1
    assert "broken     hard inner-before-outer" in judged.out
    lines = program.read_text().splitlines()
    cuts = [k for k, line in enumerate(lines) if line.startswith("(CUT ") and "ZONE" in line]
    program.write_text("\n".join(lines[: cuts[3]] + lines[cuts[4] :]) + "\n")
    judged = kerfwise("check", nest, program)
    assert judged.code == 1
    assert "every-contour-once" in judged.out.splitlines()[-1]


def test_facts_and_pictures_of_a_nest(tmp_path: Path) -> None:
    nest = EXAMPLES / "nests" / "marked.svg"
    assert json.loads(kerfwise("facts", nest).out)["format"].startswith("kerfwise-facts")
    assert kerfwise("facts", nest, "-o", tmp_path / "f.dzn").code == 0
    assert "n_contours = 8;" in (tmp_path / "f.dzn").read_text()
    for suffix in ("svg", "png", "html"):
        assert kerfwise("plot", nest, "-o", tmp_path / f"nest.{suffix}").code == 0
        assert (tmp_path / f"nest.{suffix}").stat().st_size > 1000
