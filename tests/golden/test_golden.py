"""The corpus notices what changes and says it in words; a quick case is as it is kept, and all are in the slow test."""

from __future__ import annotations

import copy
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from kerfwise.tests.golden import __main__ as golden
from kerfwise.tests.golden import kept
from kerfwise.tests.golden.compare import changes
from kerfwise.tests.golden.run import ROOT, cases, run


@pytest.fixture
def bridges() -> dict[str, Any]:
    """A kept case with two cuts."""
    means, _ = kept.read("bridges")
    assert means is not None
    return means


def plan_of(means: dict[str, Any]) -> dict[str, Any]:
    """The plan of a case's first step."""
    found: dict[str, Any] = means["steps"][0]["written"]["nest.plan.json"]
    return found


def test_what_is_the_same_is_no_change(bridges: dict[str, Any]) -> None:
    assert changes(bridges, copy.deepcopy(bridges)) == []


def test_two_cuts_swapped(bridges: dict[str, Any]) -> None:
    now = copy.deepcopy(bridges)
    plan_of(now)["cuts"].reverse()
    for place, cut in enumerate(plan_of(now)["cuts"], 1):
        cut["order"] = place
    (line,) = changes(bridges, now)
    assert "A+B.outer is cut 1 now, was cut 2" in line or "A.hole1 is cut 2 now, was cut 1" in line


def test_an_entry_that_moved_by_a_hundredth(bridges: dict[str, Any]) -> None:
    now = copy.deepcopy(bridges)
    plan_of(now)["cuts"][1]["entry"][0] += 0.01
    (line,) = changes(bridges, now)
    assert line.startswith("`solve nest.json --work 1`: ")
    assert "cuts: A+B.outer (cut 2) entry moved by 0.010 mm, (120, 20) → (120.01, 20)" in line


def test_a_verdict_that_flipped(bridges: dict[str, Any]) -> None:
    now = copy.deepcopy(bridges)
    rules = now["steps"][0]["verdict"]["rules"]
    rules["hard holds"].remove("level-ahead")
    rules["hard broken 1: A.hole1"] = ["level-ahead"]
    (line,) = changes(bridges, now)
    assert line.endswith("verdict rules level-ahead: hard holds → hard broken 1: A.hole1")


def test_what_compare_says_of_rules_that_changed() -> None:
    said = changes(
        {"steps": [{"run": "compare", "rules": {"both hold": 20}}]}, {"steps": [{"run": "compare", "rules": {}}]}
    )
    assert said == ["`compare`: rules both hold: is not there any more, was 20"]


def test_figures_times_and_contours(bridges: dict[str, Any]) -> None:
    now = copy.deepcopy(bridges)
    plan_of(now)["totals"]["idle_mm"] += 1.5
    for cut in plan_of(now)["cuts"]:
        cut["start_s"] += 0.25
    del now["steps"][0]["written"]["nest.nc"]
    told = "\n".join(changes(bridges, now))
    assert "totals idle_mm: 282.73 → 284.23 (+1.5)" in told
    assert "times of 2 cuts, from A.hole1 (cut 1) on, there by +0.250 s" in told
    assert "written nest.nc: is not there any more" in told
    del plan_of(now)["cuts"][0]
    assert any("A.hole1 is not cut any more (was cut 1)" in line for line in changes(bridges, now))


def test_another_program_and_another_exit_code(bridges: dict[str, Any]) -> None:
    now = copy.deepcopy(bridges)
    now["steps"][0]["written"]["nest.nc"]["digest"] = "0"
    now["steps"][1]["exit"] = 1
    assert changes(bridges, now) == [
        "`solve nest.json --work 1`: written nest.nc: what it holds has changed (digest)",
        "`check nest.json nest.nc`: exit: 0 → 1 (+1)",
    ]


def test_each_case_is_kept_and_nothing_else() -> None:
    assert kept.names() == set(cases())
    assert all(None not in kept.read(name) for name in cases())


def test_a_missing_case_and_other_words(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    means, texts = kept.read("refusals")
    assert means is not None
    assert texts is not None
    monkeypatch.setattr(kept, "MEANS", tmp_path / "kept")
    monkeypatch.setattr(kept, "TEXTS", tmp_path / "texts")
    monkeypatch.setattr(golden, "_all", lambda *_: [(golden.Ran("refusals", means, texts), 0.0)])
    assert golden.main(["refusals"]) == 1
    assert "nothing is kept of this case yet" in capsys.readouterr().out
    kept.write("refusals", means, texts.replace("did you mean", "is it"))
    assert golden.main(["refusals"]) == 0
    assert "0 changed, 1 with other texts" in capsys.readouterr().out
    assert golden.main(["refusals", "--texts"]) == 1
    assert golden.main(["refusals", "--texts", "--renew"]) == 0
    assert kept.read("refusals") == (means, texts)


def test_one_case_is_as_it_is_kept() -> None:
    means, _ = kept.read("bridges")
    assert means is not None
    assert changes(means, run("bridges", cases()["bridges"]).means) == []


def as_kept(*names: str) -> None:
    command = [sys.executable, "-m", "kerfwise.tests.golden", *names]
    done = subprocess.run(command, cwd=ROOT.parent, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
def test_some_quick_cases_are_as_they_are_kept() -> None:
    as_kept("dialects", "locks", "origin", "refusals", "slits", "tabs")


@pytest.mark.full
@pytest.mark.minizinc
def test_all_cases_are_as_they_are_kept() -> None:
    as_kept()
