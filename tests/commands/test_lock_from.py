"""kerfwise solve --lock-from: after a stop only what is not cut yet is planned and written, and judged so."""

from __future__ import annotations

import json
import re
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
rules: {start-side: {side: left}, zone-order: {zone_contours: 4}}
"""
N = 6


@pytest.fixture(scope="module")
def old(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("old") / "old.json"
    assert kerfwise("solve", NEST, "--plan", path, "-o", path.with_suffix(".nc"), "--work", "2").code == 0
    return path


def plan_of(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(path.read_text())
    return found


def made(rows: list[dict[str, Any]]) -> list[tuple[Any, ...]]:
    keys = ("order", "contour", "entry", "pierce", "lead_in", "lead_out", "direction")
    return [tuple(row[key] for key in keys) for row in rows]


def numbers(program: str) -> list[int]:
    return [int(k) for k in re.findall(r"^\((?:CUT|MARK) (\d+) \S+ ZONE", program, re.MULTILINE)]


@pytest.mark.slow
def test_only_the_rest_is_planned_and_written(old: Path, tmp_path: Path) -> None:
    new, nc, picture = tmp_path / "new.json", tmp_path / "new.nc", tmp_path / "new.svg"
    files = ("--plan", new, "-o", nc, "--picture", picture)
    done = kerfwise("solve", NEST, "--lock-from", old, "--upto", N, *files, "--work", "2")
    assert done.code == 0, done.err
    assert f"resumed after cut {N}" in done.out.splitlines()[0]
    plan, before = plan_of(new), plan_of(old)
    assert plan["resumed_after"] == N
    assert made(plan["already_cut"]) == made(before["cuts"][:N])
    assert [cut["order"] for cut in plan["cuts"]] == list(range(N + 1, len(before["cuts"]) + 1))
    assert {cut["contour"] for cut in plan["cuts"]} == {cut["contour"] for cut in before["cuts"][N:]}
    program = nc.read_text()
    assert f"(RESUME AFTER CUT {N})" in program
    assert numbers(program) == list(range(N + 1, len(before["cuts"]) + 1))
    assert program.count("M3 $0") == len(plan["cuts"])
    assert max(map(len, program.splitlines())) <= 250
    assert f"resumed after cut {N}" in picture.read_text()
    for file in (new, nc):
        checked = kerfwise("check", NEST, file)
        assert checked.code == 0, checked.out
        assert f"resumed after cut {N}" in checked.out


@pytest.mark.slow
def test_the_old_program_tells_as_much_as_its_plan(old: Path, tmp_path: Path) -> None:
    asked = ("--upto", N, "--work", "2", "--plan")
    assert kerfwise("solve", NEST, "--lock-from", old, *asked, tmp_path / "a.json").code == 0
    assert kerfwise("solve", NEST, "--lock-from", old.with_suffix(".nc"), *asked, tmp_path / "b.json").code == 0
    of_plan, of_program = plan_of(tmp_path / "a.json"), plan_of(tmp_path / "b.json")
    assert of_plan["cuts"] == of_program["cuts"]
    for a, b in zip(of_plan["already_cut"], of_program["already_cut"], strict=True):
        assert (a["contour"], a["direction"], a["zone"]) == (b["contour"], b["direction"], b["zone"])
        assert a["pierce"] == pytest.approx(b["pierce"], abs=1e-3)
        assert a["entry"] == pytest.approx(b["entry"], abs=1e-2)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["json", "nc"])
def test_a_program_that_was_resumed_may_be_stopped_again(old: Path, tmp_path: Path, kind: str) -> None:
    first, again = tmp_path / "first.json", tmp_path / "again.json"
    files = ("--plan", first, "-o", first.with_suffix(".nc"))
    assert kerfwise("solve", NEST, "--lock-from", old, "--upto", "4", *files, "--work", "2").code == 0
    stopped = first.with_suffix(f".{kind}")
    files = ("--plan", again, "-o", tmp_path / "again.nc")
    assert kerfwise("solve", NEST, "--lock-from", stopped, "--upto", "7", *files, "--work", "2").code == 0
    plan, before = plan_of(again), plan_of(first)
    out = [*before["already_cut"], *before["cuts"][:3]]
    assert [(c["order"], c["contour"]) for c in plan["already_cut"]] == [(c["order"], c["contour"]) for c in out]
    assert numbers((tmp_path / "again.nc").read_text())[0] == 8
    early = kerfwise("solve", NEST, "--lock-from", stopped, "--upto", "3")
    assert (early.code, "goes on after cut 4 itself" in early.err) == (2, True)


@pytest.mark.slow
def test_another_start_side_and_other_zones_do_not_refuse_what_is_cut(old: Path, tmp_path: Path) -> None:
    (tmp_path / "turned.yaml").write_text(TURNED)
    profile, new = ("-p", tmp_path / "turned.yaml"), tmp_path / "new.json"
    files = ("--plan", new, "-o", tmp_path / "new.nc")
    done = kerfwise("solve", NEST, *profile, "--lock-from", old, "--upto", N, *files, "--work", "2")
    assert done.code == 0, done.err + done.out
    assert plan_of(new)["start_side"] == "left" != plan_of(old)["start_side"]
    for file in files[1::2]:
        checked = kerfwise("check", NEST, *profile, file)
        assert checked.code == 0, checked.out


@pytest.mark.slow
def test_a_cut_that_broke_off_is_made_again_first_and_pierced_elsewhere(old: Path, tmp_path: Path) -> None:
    new, nc = tmp_path / "new.json", tmp_path / "new.nc"
    files = ("--plan", new, "-o", nc)
    done = kerfwise("solve", NEST, "--lock-from", old, "--upto", N, "--redo-last", *files, "--work", "2")
    assert done.code == 0, done.err
    plan, before = plan_of(new), plan_of(old)
    broken, again = before["cuts"][N - 1], plan["cuts"][0]
    assert plan["resumed_after"] == N - 1
    assert made([plan["broken_off"]]) == made([broken])
    assert (again["order"], again["contour"]) == (N, broken["contour"])
    assert again["pierce"] != broken["pierce"]
    assert f"(RESUME AFTER CUT {N - 1}, CUT {N} AGAIN)" in nc.read_text()
    assert kerfwise("check", NEST, nc).code == kerfwise("check", NEST, new).code == 0


def outer_before_hole(old: Path, folder: Path) -> tuple[Path, str]:
    """The old plan with the outline of a part cut first, and its hole cut much later."""
    plan = plan_of(old)
    hole = next(cut for cut in plan["cuts"] if cut["kind"] == "hole")
    outer = next(cut for cut in plan["cuts"] if cut["contour"] == f"{hole['part']}.outer")
    rest = [cut for cut in plan["cuts"] if cut is not hole and cut is not outer]
    plan["cuts"] = [cut | {"order": k} for k, cut in enumerate([outer, *rest, hole], 1)]
    path = folder / "turned.json"
    path.write_text(json.dumps(plan))
    return path, str(hole["contour"])


@pytest.mark.slow
@pytest.mark.scrap("the hole is left out")
def test_a_hole_left_in_a_part_that_is_out_is_refused_or_left_out(old: Path, tmp_path: Path) -> None:
    turned, hole = outer_before_hole(old, tmp_path)
    asked = ("solve", NEST, "--lock-from", turned, "--upto", "2", "--work", "2")
    files = ("--plan", tmp_path / "new.json", "-o", tmp_path / "new.nc")
    refused = kerfwise(*asked, *files, "--conflict-picture", tmp_path / "conflict.svg")
    assert refused.code == 1
    assert f"{hole} cannot be cut any more" in refused.err
    assert not (tmp_path / "new.nc").exists()
    done = kerfwise(*asked, *files, "--relax")
    assert done.code == 0, done.out
    assert hole not in {cut["contour"] for cut in plan_of(tmp_path / "new.json")["cuts"]}
    for file in files[1::2]:
        checked = kerfwise("check", NEST, file)
        assert checked.code == 0, checked.out
        assert f"relaxed: inner-before-outer about {hole}" in checked.out


@pytest.mark.slow
def test_what_a_program_says_is_out_is_held_against_the_nest(old: Path, tmp_path: Path) -> None:
    nc = tmp_path / "new.nc"
    assert kerfwise("solve", NEST, "--lock-from", old, "--upto", N, "-o", nc, "--work", "2").code == 0
    lines = nc.read_text().splitlines(keepends=True)
    nc.write_text("".join(line for line in lines if not line.startswith("(OUT 2 ")))
    missing = kerfwise("check", NEST, nc)
    assert (missing.code, f"goes on after cut {N}, but lists {N - 1} cuts" in missing.out) == (1, True)
    first = next(cut["contour"] for cut in plan_of(old)["cuts"])
    last = plan_of(old)["cuts"][-1]["contour"]
    nc.write_text("".join(lines).replace(f"(OUT 1 {first} ".replace("#", "_"), f"(OUT 1 {last} ".replace("#", "_")))
    twice = kerfwise("check", NEST, nc)
    assert twice.code == 1
    assert f"{last} is cut again as cut" in twice.out


@pytest.mark.slow
def test_a_contour_without_metal_left_to_pierce_is_named(tmp_path: Path) -> None:
    """Two parts 3 mm apart in a hole, 3 mm from its edge: their kerfs leave the hole nothing to be pierced in."""

    def square(x: float, y: float, w: float, h: float) -> list[list[float]]:
        return [[x, y], [x + w, y], [x + w, y + h], [x, y + h]]

    parts = [
        {"id": "host", "outer": square(10, 10, 56, 79), "holes": [square(25, 25, 26, 49)]},
        {"id": "G0", "outer": square(28, 28, 20, 20)},
        {"id": "G1", "outer": square(28, 51, 20, 20)},
    ]
    sheet = {"width": 76, "height": 99}
    (tmp_path / "nest.json").write_text(json.dumps({"format": "kerfwise-nest/1", "sheet": sheet, "parts": parts}))
    paths = {"G0.outer": square(27.25, 27.25, 21.5, 21.5), "G1.outer": square(27.25, 50.25, 21.5, 21.5)}
    lines = ["G21", "G90 G17 G40"]
    for ring in paths.values():
        lines += ["G0 X{} Y{}".format(*ring[0]), "M3 $0 S1", *("G1 X{} Y{} F2500".format(*p) for p in ring[1:])]
        lines += ["G1 X{} Y{}".format(*ring[0]), "M5 $0"]
    (tmp_path / "old.nc").write_text("\n".join([*lines, "M2", ""]))
    refused = kerfwise(
        "solve", tmp_path / "nest.json", "--lock-from", tmp_path / "old.nc", "--upto", "2", "-o", tmp_path / "new.nc"
    )
    assert (refused.code, (tmp_path / "new.nc").exists()) == (2, False)
    assert "host.hole1 at (25.0, 25.0): what is already cut leaves no metal to pierce near it" in refused.err


@pytest.mark.slow
def test_an_old_plan_alone_is_the_one_that_numbers_count_in(old: Path, tmp_path: Path) -> None:
    plan, third = tmp_path / "new.plan.json", json.loads(old.read_text())["cuts"][2]["contour"]
    for file in (old, old.with_suffix(".nc")):
        ended = kerfwise(
            "solve", NEST, "--work", 1, "--relax", "--lock", "#3 first", "--lock-from", file, "--plan", plan
        )
        assert ended.code == 0, ended.err
        assert f"note: #3 is {third}, as in {file}" in ended.err
        assert json.loads(plan.read_text())["cuts"][0]["contour"] == third
    alone = kerfwise("solve", NEST, "--lock-from", old)
    assert (alone.code, "OLD alone is for locks that call a cut by its number there" in alone.err) == (2, True)


def test_wrong_use_is_said(old: Path, tmp_path: Path) -> None:
    alone = kerfwise("solve", NEST, "--upto", "3")
    assert (alone.code, "--lock-from OLD and --upto N go together" in alone.err) == (2, True)
    alone = kerfwise("solve", NEST, "--redo-last")
    assert (alone.code, "--lock-from OLD and --upto N go together" in alone.err) == (2, True)
    program = old.with_suffix(".nc")
    for file, what in ((old, "plan"), (program, "program")):
        many = kerfwise("solve", NEST, "--lock-from", file, "--upto", "99")
        assert (many.code, f"the {what} has 16 cuts only" in many.err) == (2, True)
        whole = kerfwise("solve", NEST, "--lock-from", file, "--upto", "16", "-o", tmp_path / "none.nc")
        assert (whole.code, "nothing is left" in whole.err) == (2, True)
    assert not (tmp_path / "none.nc").exists()
    other = NEST.parent / "e1x_1.json"
    if other.exists():
        stranger = kerfwise("solve", other, "--lock-from", program, "--upto", "2")
        assert (stranger.code, "another nest" in stranger.err) == (2, True)
