"""A picture drawn beside the check is the one that is drawn after it, byte for byte; whatever fails, one is drawn."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from dataclasses import replace
from multiprocessing.process import BaseProcess
from pathlib import Path

import pytest
from click.testing import CliRunner

from kerfwise.cli import program
from kerfwise.commands import page_picture
from kerfwise.commands.page_picture import DrawnBeside, planned_picture
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import read_nest
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.request import options_for
from kerfwise.models.plan.plan import Plan
from kerfwise.pipeline import FinishedPlan, Watchers, plan_nest
from kerfwise.postproc.report import draw
from kerfwise.rules.profile.load import load_profile
from kerfwise.tests.tools.amount import few

SMALL = Path(__file__).parents[2] / "examples" / "nests" / "e1x_6.json"
HOME = (0.0, 0.0)


@pytest.fixture(autouse=True)
def beside_on_small_nests(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page_picture, "FROM_CONTOURS", 1)
    monkeypatch.setattr(page_picture, "LEAST_CORES", 1)


def finished(told: Callable[[Plan], None]) -> FinishedPlan:
    """A small plan that breaks a soft rule, so that its header has something to say of its rules."""
    nest, profile = read_nest(SMALL), load_profile()
    return plan_nest(Inputs(nest, profile), options_for(nest, profile, work=0.1), watchers=Watchers(planned=told))


def signalled(beside: DrawnBeside, sent: signal.Signals) -> BaseProcess:
    """The process, which was sent a signal."""
    assert beside.process is not None
    assert beside.process.pid is not None
    os.kill(beside.process.pid, sent)
    return beside.process


@pytest.fixture(scope="module")
def planned() -> tuple[FinishedPlan, Plan]:
    """A plan, and what it was before it was judged."""
    before: list[Plan] = []
    return finished(before.append), before[0]


@pytest.mark.slow
@pytest.mark.parametrize("suffix", few([".svg", ".PNG", ".pdf"]))
def test_it_is_the_picture_that_is_drawn_afterwards(planned: tuple[FinishedPlan, Plan], suffix: str) -> None:
    done, before = planned
    assert before.rules != done.made.plan.rules
    assert draw(done.given.nest, before, suffix) != draw(done.given.nest, done.made.plan, suffix)
    with DrawnBeside(done.given.nest, suffix, HOME) as beside:
        beside.begin(before)
        assert beside.end(done.made.plan) == draw(done.given.nest, done.made.plan, suffix, HOME)


def test_a_process_that_died_leaves_it_to_this_one(planned: tuple[FinishedPlan, Plan]) -> None:
    done, before = planned
    with DrawnBeside(done.given.nest, ".svg", HOME) as beside:
        beside.begin(before)
        signalled(beside, signal.SIGTERM).join()
        assert beside.end(done.made.plan) is None
        home = done.given.profile.home_on(done.given.nest)
        assert planned_picture(done.given, done.made, ".svg", beside) == draw(
            done.given.nest, done.made.plan, ".svg", home
        )


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="Windows cannot hold Ctrl-C back")
def test_ctrl_c_does_not_reach_a_process_that_still_sets_out(planned: tuple[FinishedPlan, Plan]) -> None:
    done, before = planned
    with DrawnBeside(done.given.nest, ".svg", HOME) as beside:
        beside.begin(before)
        signalled(beside, signal.SIGINT)
        assert beside.end(done.made.plan) == draw(done.given.nest, done.made.plan, ".svg", HOME)
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())


def test_the_process_sets_out_before_there_is_a_plan_and_ends_where_there_is_none(
    planned: tuple[FinishedPlan, Plan],
) -> None:
    done, _ = planned
    with DrawnBeside(done.given.nest, ".svg", HOME) as beside:
        assert beside.process is not None
        assert beside.process.is_alive()
        assert beside.end(done.made.plan) is None
    assert not beside.process.is_alive()


def test_what_cannot_be_drawn_is_left_to_this_one_too(planned: tuple[FinishedPlan, Plan]) -> None:
    """A plan of another nest: here it is refused in words, there nothing is said."""
    done, before = planned
    other = replace(before, cuts=tuple(replace(p, cut=replace(p.cut, contour="none")) for p in before.cuts))
    with DrawnBeside(done.given.nest, ".svg", HOME) as beside:
        beside.begin(other)
        assert beside.end(other) is None


def test_another_plan_is_not_taken_for_it(planned: tuple[FinishedPlan, Plan]) -> None:
    done, before = planned
    with DrawnBeside(done.given.nest, ".svg", HOME) as beside:
        beside.begin(before)
        assert beside.end(replace(before, cuts=before.cuts[:-1])) is None


def test_the_process_ends_with_the_block_whatever_happens(planned: tuple[FinishedPlan, Plan]) -> None:
    done, before = planned
    beside = DrawnBeside(done.given.nest, ".svg", HOME)

    def interrupted() -> None:
        with beside:
            beside.begin(before)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert beside.process is not None
    assert not beside.process.is_alive()


@pytest.mark.parametrize(
    ("suffix", "contours", "cores"), [(None, 1, 1), (".html", 1, 1), (".svg", 9999, 1), (".svg", 1, 9999)]
)
def test_it_is_not_begun_where_it_does_not_pay(
    planned: tuple[FinishedPlan, Plan], monkeypatch: pytest.MonkeyPatch, suffix: str | None, contours: int, cores: int
) -> None:
    done, before = planned
    monkeypatch.setattr(page_picture, "FROM_CONTOURS", contours)
    monkeypatch.setattr(page_picture, "LEAST_CORES", cores)
    with DrawnBeside(done.given.nest, suffix, HOME) as beside:
        beside.begin(before)
        assert beside.process is None
        assert beside.end(done.made.plan) is None


def test_a_nest_is_handed_on_without_what_was_found_out_about_it(planned: tuple[FinishedPlan, Plan]) -> None:
    nest: Nest = planned[0].given.nest
    assert nest.kept
    assert set(nest.__getstate__()) < set(vars(nest))


@pytest.mark.slow
def test_solve_writes_the_same_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made: dict[int, dict[str, bytes]] = {}
    begun: list[Plan] = []
    begin = DrawnBeside.begin
    monkeypatch.setattr(DrawnBeside, "begin", lambda beside, plan: begun.append(plan) or begin(beside, plan))
    for contours in (1, 9999):
        monkeypatch.setattr(page_picture, "FROM_CONTOURS", contours)
        out = tmp_path / str(contours)
        out.mkdir()
        names = ["-o", str(out / "a.nc"), "--plan", str(out / "a.json"), "--picture", str(out / "a.svg")]
        answer = CliRunner().invoke(program, ["solve", str(SMALL), "--work", "0.1", *names])
        assert answer.exit_code == 0, answer.output
        made[contours] = {file.name: file.read_bytes() for file in out.iterdir()}
    assert len(begun) == 2
    assert made[1] == made[9999]
    assert set(made[1]) == {"a.nc", "a.json", "a.svg"}


def test_what_cannot_be_handed_on_is_drawn_by_this_one(planned: tuple[FinishedPlan, Plan]) -> None:
    done, before = planned
    held_back = replace(before, rules=before.rules)
    object.__setattr__(held_back, "rules", lambda: None)
    with DrawnBeside(done.given.nest, ".svg", HOME) as beside:
        beside.begin(held_back)
        assert beside.end(done.made.plan) is None
