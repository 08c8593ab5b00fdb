"""`kerfwise check NEST OUT.nc --plan PLAN.json`: programs that say nothing are held against their plan."""

from __future__ import annotations

import json
import re
from pathlib import Path

from kerfwise.tests.commands.run_cli import kerfwise

ROW = {
    "format": "kerfwise-nest/1",
    "units": "mm",
    "sheet": {"width": 300, "height": 200},
    "parts": [
        {"id": name, "outer": [[x, 40], [x + 80, 40], [x + 80, 140], [x, 140]], "holes": [], "marks": []}
        for name, x in (("A", 30), ("B", 150))
    ],
}


def test_a_program_without_comments_is_judged_by_its_plan(tmp_path: Path) -> None:
    nest, program, plan = (tmp_path / name for name in ("nest.json", "out.nc", "out.plan.json"))
    nest.write_text(json.dumps(ROW), encoding="utf-8")
    assert kerfwise("solve", nest, "-o", program, "--plan", plan, "--work", "0.1").code == 0
    text = program.read_text(encoding="utf-8")
    program.write_text(re.sub(r"(?m)^\(.*\n", "", text), encoding="utf-8")
    alone = kerfwise("check", nest, program)
    assert "not judged hard zone-order" in alone.out
    held = kerfwise("check", nest, program, "--plan", plan)
    assert held.code == 0, held.out + held.err
    assert "not judged" not in held.out
    assert re.search(r"(?m)^holds +hard +follows-plan", held.out)

    other = json.loads(plan.read_text(encoding="utf-8"))
    for cut in other["cuts"]:
        cut["order"] = 3 - cut["order"]
    plan.write_text(json.dumps(other), encoding="utf-8")
    strayed = kerfwise("check", nest, program, "--plan", plan)
    assert strayed.code == 1
    assert "cut 1 is of " in strayed.out


def test_a_plan_is_held_against_no_plan(tmp_path: Path) -> None:
    nest, program, plan = (tmp_path / name for name in ("nest.json", "out.nc", "out.plan.json"))
    nest.write_text(json.dumps(ROW), encoding="utf-8")
    kerfwise("solve", nest, "-o", program, "--plan", plan, "--work", "0.1")
    ended = kerfwise("check", nest, plan, "--plan", plan)
    assert ended.code == 2
    assert ended.err.strip().endswith(
        "a plan is held against no other plan: expected an NC program, with the plan it was made from"
    )
