"""Every verb that takes a plan says so where the plan has been changed by a hand, and none ends in a fault."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from kerfwise.tests.commands.run_cli import Ended, kerfwise
from kerfwise.tests.fuzz.inputs import seeds
from kerfwise.tests.mutations.tree_mutants import tree_mutants

VERBS: dict[str, str] = {
    "check": "check nest.json MADE",
    "time": "time nest.json MADE",
    "explain": "explain nest.json MADE A.outer",
    "plot": "plot nest.json MADE -o made.svg",
    "page": "plot nest.json MADE -o made.html",
    "heat": "heat nest.json MADE --json",
    "distort": "distort nest.json MADE --grid 25mm --json",
    "sheet": "sheet nest.json MADE -o made.pdf",
    "compare": "compare nest.json good.plan.json MADE",
    "edit": "edit nest.json --move A 1 0 --lock-from MADE --upto 2 -o other.json",
    "start": "solve nest.json --start MADE --work 0.01 -o rest.nc --plan rest.plan.json",
    "resume": "solve nest.json --lock-from MADE --upto 3 --redo-last --work 0.01 -o rest.nc --plan rest.plan.json",
}
QUICK = ("time", "explain", "plot", "edit", "start", "resume")
TELLS = ("the plan is damaged", "the check refuses the plan", "is not one of", "FAILED", "the plan says", "damaged")


def _moved_pierce(plan: Any) -> None:
    plan["cuts"][3]["pierce"][0] += 5


def _later(plan: Any) -> None:
    plan["cuts"][2]["end_s"] += 5


def _of_another_part(plan: Any) -> None:
    plan["cuts"][3]["part"] = "D"


def _longer(plan: Any) -> None:
    plan["cuts"][1]["length_mm"] *= 2


DAMAGES = (_moved_pierce, _later, _of_another_part, _longer)


@pytest.fixture(autouse=True)
def in_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("nest.json").write_bytes(seeds.nest_bytes("rich"))
    Path("good.plan.json").write_bytes(seeds.made("rich")[1])


def _run(verb: str, plan: str) -> Ended:
    for file in ("made.svg", "made.html", "made.pdf", "other.json", "rest.nc", "rest.plan.json"):
        Path(file).unlink(missing_ok=True)
    return kerfwise(*VERBS[verb].replace("MADE", plan).split())


def _told(done: Ended) -> bool:
    lines = [line for line in (done.out + done.err).splitlines() if not line.startswith("holds")]
    return any(text in line for line in lines for text in TELLS)


@pytest.mark.parametrize(
    "verb", [v if v in QUICK else pytest.param(v, marks=[pytest.mark.full, pytest.mark.slow]) for v in VERBS]
)
def test_a_damaged_plan_is_told_by_every_verb_that_takes_one(verb: str) -> None:
    good = _run(verb, "good.plan.json")
    assert (good.code, _told(good)) == (0, False), good
    for damage in DAMAGES[:2] if verb in QUICK else DAMAGES:
        _expect_told(verb, damage)


def _expect_told(verb: str, damage: Callable[[Any], None]) -> None:
    plan = json.loads(seeds.made("rich")[1])
    damage(plan)
    Path("changed.plan.json").write_text(json.dumps(plan))
    assert _told(_run(verb, "changed.plan.json")), damage.__name__


def test_a_plan_that_does_not_say_its_profile_is_looked_at_too() -> None:
    plan = json.loads(seeds.made("rich")[1])
    del plan["profile"]["sha256"]
    Path("silent.plan.json").write_text(json.dumps(plan))
    assert "damaged" not in _run("resume", "silent.plan.json").err
    _moved_pierce(plan)
    Path("silent.plan.json").write_text(json.dumps(plan))
    assert (
        "the plan is damaged, or made with another profile (it does not say" in _run("resume", "silent.plan.json").err
    )


@pytest.mark.full
@pytest.mark.slow
@pytest.mark.parametrize("verb", VERBS)
def test_no_verb_ends_in_a_fault(verb: str) -> None:
    tree = json.loads(seeds.made("rich")[1])
    for what, changed in tree_mutants(tree, 150, f"verb {verb}"):
        Path("changed.plan.json").write_text(json.dumps(changed))
        done = _run(verb, "changed.plan.json")
        assert done.code in (0, 1, 2), (what, done)
