"""kerfwise explain, and what solve says of rules that cannot all hold."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.rule_kit import rect
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.nest_file import nest_file

NEST = Path(package.__file__).parent / "examples" / "nests" / "e1x_6.json"


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("plan") / "plan.json"
    path.write_text(package.solve(NEST, work=2).plan.to_json())
    return path


def test_explain_says_why(plan: Path) -> None:
    told = kerfwise("explain", NEST, plan, "part#1.outer")
    assert told.code == 0, told.err
    assert told.out.startswith("part#1.outer is cut ")
    assert "if it were moved\n" in told.out
    assert "note:" not in told.out
    assert json.loads(kerfwise("explain", NEST, plan, "part#1.outer", "--json").out)["contour"] == "part#1.outer"


def test_explain_warns_of_another_profile(plan: Path) -> None:
    told = kerfwise("explain", NEST, plan, "part#1.outer", "-p", "laser-amg3m-1mm")
    assert told.code == 0
    says = "note: the profile is not the one the plan was made with (its sha256 differs): this is 'laser-amg3m-1mm', "
    assert f"{says}that was 'plasma-carbon-steel', whose sha256 begins " in told.out


def test_explain_of_an_unknown_contour(plan: Path) -> None:
    told = kerfwise("explain", NEST, plan, "part1.outer")
    assert told.code == 2
    assert "did you mean 'part#1.outer'?" in told.err
    assert told.out == ""


def test_a_conflict_is_told_and_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    sides = [{"id": f"P{k}", "outer": rect(100 * k - 90, 10, 80, 80)} for k in (1, 2)]
    nest_file("plate.json", sides, (300, 100))
    locks = ("--lock", "P2.outer before P1.outer", "--lock", "P1.outer first")
    ended = kerfwise("solve", "plate.json", "--work", 1, *locks)
    assert (ended.code, ended.out) == (1, "")
    assert ended.err.splitlines() == [
        "kerfwise: these hard rules cannot all hold; without any one of them the others can:",
        "  - locks: P2.outer is cut before P1.outer: locked by the operator (--lock 'P2.outer before P1.outer')",
        "  - locks: P1.outer is cut before P2.outer: P1.outer is first, locked by the operator "
        "(--lock 'P1.outer first')",
        "the cheapest way out:",
        "  relax locks: 1 statement about P2.outer, P1.outer",
        "--relax takes this way out, and says so in the plan and in the program",
        "the contours in conflict: plate.conflict.svg",
    ]
    assert "in conflict: locks" in Path("plate.conflict.svg").read_text()


def test_a_wait_is_told_with_its_reason(plan: Path, tmp_path: Path) -> None:
    data = json.loads(plan.read_text())
    cut = data["cuts"][3]
    cut["dwell_s"] = 12.5
    waiting = tmp_path / "plan.json"
    waiting.write_text(json.dumps(data))
    second = kerfwise("explain", NEST, waiting, cut["contour"]).out.splitlines()[1]
    assert second == "waits 12.5 s first, so that metal may cool"
    cut["because"].append("waits 12.5 s first: without, a part gets hot")
    waiting.write_text(json.dumps(data))
    told = kerfwise("explain", NEST, waiting, cut["contour"])
    assert told.out.splitlines()[1] == "waits 12.5 s first: without, a part gets hot"
    assert json.loads(kerfwise("explain", NEST, waiting, cut["contour"], "--json").out)["dwell_s"] == 12.5
    assert "waits" not in kerfwise("explain", NEST, waiting, data["cuts"][0]["contour"]).out


@pytest.mark.full
def test_solve_and_time_tell_of_waits(tmp_path: Path) -> None:
    profile = tmp_path / "cool.yaml"
    profile.write_text(
        "based_on: plasma-carbon-steel\n"
        "rules: {t-max: {strength: hard, limit: 105, dwells: true, longest_dwell: 240}}\n"
    )
    program = tmp_path / "out.nc"
    solved = kerfwise("solve", NEST, "-p", profile, "--work", 2, "-o", program)
    assert solved.code == 0, solved.err
    found = re.search(
        r"waits for metal to cool: \d+, ([\d.]+) s in all, the longest ([\d.]+) s before \S+\n", solved.out
    )
    assert found is not None
    all_s, longest_s = float(found[1]), float(found[2])
    assert 0 < longest_s <= min(all_s, 240)
    table = kerfwise("time", NEST, program, "-p", profile).out
    assert re.search(rf"\nwait +{found[1]} s   for metal to cool, the torch off\ntotal ", table)
    data = json.loads(kerfwise("time", NEST, program, "-p", profile, "--json").out)
    parts = [data[key] for key in ("cut_s", "idle_s", "pierce_s", "dwell_s")]
    assert (data["dwell_s"], data["total_s"]) == pytest.approx((all_s, sum(parts)), abs=0.01)
