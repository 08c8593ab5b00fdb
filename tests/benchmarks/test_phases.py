"""Benchmarks of speed: phases, sizes, the page."""

from __future__ import annotations

import importlib
import threading
from pathlib import Path
from types import SimpleNamespace

import pytest

from kerfwise.benchmarks import phase_clock, phases
from kerfwise.benchmarks.page import nest_of, plan_of
from kerfwise.benchmarks.phase_clock import ALL, BUT_PLANNING, BY_CLOCK, MEMORY, PHASES, REST, Clock
from kerfwise.benchmarks.phase_tables import Start, phase_table, start_table
from kerfwise.benchmarks.plates import cost
from kerfwise.benchmarks.scale import OTHERS, Job, page, row, run, with_others
from kerfwise.postproc.report import draw

HEADS = (("cold", ", s"), ("kernels", ""), ("warm", ", s"))
PAGE = (Path(__file__).parents[2] / "docs" / "phases.md").read_text(encoding="utf-8")


def test_every_phase_is_made_by_functions_that_there_are() -> None:
    for steps in PHASES.values():
        for module, step in steps:
            assert callable(getattr(importlib.import_module(module), step))


def test_a_phase_within_a_phase_counts_for_itself_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = iter([0.0, 1.0, 3.0, 6.0, 10.0])
    monkeypatch.setattr(phase_clock.time, "process_time", lambda: next(ticks))
    clock = Clock()
    inner = clock.around("problem", lambda: None)
    clock.around("planning", inner)()
    assert (clock.seconds["planning"], clock.seconds["problem"]) == (2.0 + 4.0, 3.0)


def test_what_a_thread_finds_beside_a_phase_counts_for_itself_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    of_process, of_thread = iter([0.0, 1.0, 10.0]), iter([0.0, 2.0])
    monkeypatch.setattr(phase_clock.time, "process_time", lambda: next(of_process))
    monkeypatch.setattr(phase_clock.time, "thread_time", lambda: next(of_thread))
    clock = Clock()
    look = threading.Thread(target=clock.around("looks at whole orders", lambda: None))
    clock.around("planning", lambda: (look.start(), look.join()))()
    assert (clock.seconds["planning"], clock.seconds["looks at whole orders"]) == (9.0 - 2.0, 2.0)


def test_sizes_stand_side_by_side_before_and_after_with_exponents() -> None:
    names = (*PHASES, REST, ALL, BUT_PLANNING, BY_CLOCK, MEMORY)
    runs = [[dict.fromkeys(names, s * k) | {"contours": n} for k in (2, 1)] for n, s in ((100, 1.0), (1000, 10.0))]
    lines = phase_table(runs).splitlines()
    assert lines[0] == "| phase | 100, before | after | ^ | 1000, before | after | ^ |"
    assert "| check | 2.00 | 1.00 |  | 20.00 | 10.00 | 1.0 |" in lines
    assert lines[-1] == f"| {MEMORY} | 2 | 1 |  | 20 | 10 |  |"
    assert phase_table([[run[1]] for run in runs]).splitlines()[0] == "| phase | 100 | ^ | 1000 | ^ |"


def test_what_was_ended_says_so() -> None:
    """The first size was ended in its check, before the picture."""
    names = (*PHASES, REST, ALL, BUT_PLANNING, BY_CLOCK, MEMORY)
    cut = {"ended": True, "running": ["check"], "missing": ["picture"]}
    whole = {"ended": False, "running": [], "missing": []}
    before, after = (dict.fromkeys(names, 10.0) | {"contours": 1000} | how for how in (cut, whole))
    lines = phase_table([[before, after], [after | {"contours": 3000}]]).splitlines()
    assert "| facts | 10.00 | 10.00 |  | 10.00 | 0.0 |" in lines
    assert "| check | > 10.00 | 10.00 |  | 10.00 | 0.0 |" in lines
    assert "| picture | – | 10.00 |  | 10.00 | 0.0 |" in lines
    assert f"| {ALL} | > 10.00 | 10.00 |  | 10.00 | 0.0 |" in lines
    ends = phase_table([[after], [before | {"contours": 3000}]]).splitlines()
    assert "| check | 10.00 |  | > 10.00 |  |" in ends


def test_starts_tell_seconds_and_kernels() -> None:
    cold, warm = Start(15.0, 24), Start(1.0, 0)
    told = start_table([("few", [(cold, warm), (warm, warm)])]).splitlines()
    heads = [f"{head}, {when}{unit}" for when in ("before", "after") for head, unit in HEADS]
    assert told[0] == f"| nest | {' | '.join(heads)} |"
    assert told[-1] == "| few | 15.0 | 24 | 1.0 | 1.0 | 0 | 1.0 |"


@pytest.mark.full
def test_a_plate_is_measured() -> None:
    """In a process of its own, as functions of the package are wrapped."""
    import subprocess
    import sys

    for contours, minutes, ended in (("20", "10", False), ("300", "0.01", True)):
        words = [sys.executable, phase_clock.__file__, contours, "--work", "0.1", "--minutes", minutes]
        done = subprocess.run(words, capture_output=True, encoding="utf-8", check=True)
        spent = phases.json.loads(done.stdout.splitlines()[-1])
        assert spent["contours"] >= 20
        assert spent["ended"] is ended
        assert ended or all(spent[name] > 0 for name in PHASES)


def test_the_page_has_every_phase_and_start() -> None:
    for name in (*PHASES, REST, ALL, BUT_PLANNING, MEMORY):
        assert f"| {name} | " in PAGE
    assert "kernels, after" in PAGE


def test_a_plate_that_is_kept_is_not_run_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[str] = []

    def run(tree: phases.Tree, words: list[str], kept: str, cwd: object) -> object:
        ran.append(words[1])
        return SimpleNamespace(stdout=f'a warning\n{{"contours": {words[1]}}}\n', returncode=0)

    monkeypatch.setattr(phases.Tree, "run", run)
    tree = object.__new__(phases.Tree)
    for _ in range(2):
        assert tree.phases(300, 0.1, 6.0, phases.kept_in(tmp_path, 1, 300)) == {"contours": 300}
    assert ran == ["300"]
    assert phases.kept_in(None, 1, 300) is None
    assert tree.phases(300, 0.1, 6.0) == {"contours": 300}
    assert ran == ["300", "300"]


@pytest.mark.parametrize("zones", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_a_small_plate_is_proven_and_told(zones: bool) -> None:
    job = Job(20, zones, (2.0, 5.0))
    (seen,) = run(job)  # more work is not tried
    assert seen.proven
    assert seen.bound_mm == seen.cost_mm
    line = row(job, seen)
    assert line.startswith(f"| 20 contours{'' if zones else ', no zones'} | ")
    assert f" | {cost(seen.cost_mm)} | yes | " in line
    text = page([job], [line])
    assert line in text
    assert "--plates 20:2,5 --seed 1" in text


def test_what_another_command_made_of_the_page_stays() -> None:
    assert with_others("new\n\n", f"old\n\n{OTHERS}\n\nphases\n") == f"new\n\n{OTHERS}\n\nphases\n"
    assert with_others("new\n\n", "old\n") == "new\n"


def test_made_nests_and_their_order() -> None:
    nest = nest_of(115)
    plan = plan_of(nest)
    assert sorted(p.cut.contour for p in plan.cuts) == sorted(nest.index)
    ends = [p.cut.end_s for p in plan.cuts]
    assert ends == sorted(ends)
    assert plan.totals.time_s == pytest.approx(ends[-1])
    holes = {p.cut.contour: k for k, p in enumerate(plan.cuts)}
    assert all(holes[hole.id] < holes[part.outer.id] for part in nest.parts for hole in part.holes)
    assert draw(nest, plan, ".html").startswith(b"<!DOCTYPE html>")
