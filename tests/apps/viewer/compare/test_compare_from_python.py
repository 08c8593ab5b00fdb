"""kerfwise.compare: two ways to cut a nest, side by side, from Python."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

import kerfwise
from kerfwise.tests.api.plates import CLASH, PAIR, WORK


@pytest.fixture(scope="module")
def planned() -> kerfwise.Result:
    return kerfwise.solve(PAIR, work=WORK)


def test_a_result_and_its_program_make_the_same_cuts(planned: kerfwise.Result, tmp_path: Path) -> None:
    program = planned.save(tmp_path, "pair")[0]
    made = kerfwise.compare(PAIR, planned, program)
    assert made.a.plan is planned.plan
    assert made.b.plan is None
    assert made.changed == ()
    assert made.claim == "both make the same cuts in the same order"
    assert str(made).startswith("A: the plan that is given (plan, profile plasma-carbon-steel)")
    assert not made.interrupted


@pytest.mark.slow
def test_without_a_rule_b_is_planned_anew(planned: kerfwise.Result, tmp_path: Path) -> None:
    made = kerfwise.compare(PAIR, planned, without=["level-ahead"], work=WORK)
    (paid,) = ((a.strength, b.strength) for name, a, b in made.rules if name == "level-ahead")
    assert paid == ("hard", "off")
    assert made.b.name == "without level-ahead"
    files = made.save(tmp_path / "both.svg", tmp_path / "both.html", tmp_path / "both.pdf")
    assert [file.read_bytes()[:4] for file in files] == [b"<svg", b"<!DO", b"%PDF"]
    assert made.picture().content == files[0].read_bytes()
    assert json.loads(json.dumps(made.as_json()))["format"] == "kerfwise-comparison/1"
    with pytest.raises(kerfwise.InputError, match="a comparison is written as"):
        made.save(tmp_path / "both.txt")


def test_each_side_has_its_profile_and_notes(planned: kerfwise.Result) -> None:
    slow = kerfwise.load_profile()
    slow = replace(slow, machine=replace(slow.machine, cut_feed_mm_s=5.0), sha256="slow")
    made = kerfwise.compare(PAIR, planned, planned, None, slow, heat=True)
    assert made.b.times.report.cut_s > 2 * made.a.times.report.cut_s
    (note,) = made.notes
    assert note.startswith("B: the profile is not the one the plan was made with (its sha256 differs): this is ")
    assert None not in (made.a.heat, made.b.heat)


def test_a_side_without_a_plan_says_which() -> None:
    with pytest.raises(kerfwise.NoPlan) as refused:
        kerfwise.compare(PAIR, without="level-ahead", locks=CLASH, work=WORK)
    assert refused.value.__notes__ == ["A: by profile plasma-carbon-steel"]
    made = kerfwise.compare(PAIR, without="level-ahead", locks=CLASH, relax=True, work=WORK)
    assert made.b.plan is not None
    assert made.b.plan.dropped


def test_progress_can_end_it() -> None:
    made = kerfwise.compare(PAIR, without="level-ahead", work=WORK, on_progress=lambda reached: False)
    assert made.interrupted
