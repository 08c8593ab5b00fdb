"""kerfwise explain, and what solve says of rules that cannot all hold."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.commands.solve import print_conflict
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.readers import read_nest
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.request import NoPlan, facts_of, options_for
from kerfwise.pipeline import plan_nest
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.load import load_profile
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.models.solved import plant, proven_plan

NEST = Path(package.__file__).parent / "examples" / "nests" / "e1x_6.json"
PLATE = nest(300, 100, part("P1", rect(10, 10, 80, 80)), part("P2", rect(110, 10, 80, 80)))


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("plan") / "plan.json"
    _, _, made = proven_plan(read_nest(NEST), load_profile())
    path.write_text(made.to_json())
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


def test_a_conflict_is_told_and_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    profile = plant(Lock(contour="P2.outer", before="P1.outer"), Lock(contour="P1.outer", position=1))
    picture = tmp_path / "plate.conflict.svg"
    with pytest.raises(NoPlan) as found:
        plan_nest(Inputs(PLATE, profile), options_for(PLATE, profile, work=1.0))
    assert print_conflict(found.value, picture) == 1
    said = capsys.readouterr().err.splitlines()
    assert said == [
        "kerfwise: these hard rules cannot all hold; without any one of them the others can:",
        "  - locks: P2.outer is cut before P1.outer: locked by the operator",
        "  - locks: P1.outer is cut before P2.outer: P1.outer is first, locked by the operator",
        "the cheapest way out:",
        "  relax locks: 1 statement about P1.outer, P2.outer",
        "--relax takes this way out, and says so in the plan and in the program",
        f"the contours in conflict: {picture}",
    ]
    assert "in conflict: locks" in picture.read_text()


def test_without_a_contradiction_the_error_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    profile = plant()
    picture = tmp_path / "none.svg"
    assert print_conflict(NoPlan(RulesConflict("none was found"), facts_of(PLATE, profile), profile), picture) == 1
    assert capsys.readouterr().err == "kerfwise: none was found\n"
    assert not picture.exists()


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
