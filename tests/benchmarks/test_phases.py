"""The table of phases: every phase is there, a phase within another counts once, and the page is one it prints."""

from __future__ import annotations

import importlib
from pathlib import Path
from types import SimpleNamespace

import pytest

from kerfwise.benchmarks import phase_clock, phases
from kerfwise.benchmarks.phase_clock import ALL, BUT_PLANNING, BY_CLOCK, MEMORY, PHASES, REST, Clock
from kerfwise.benchmarks.phase_tables import Start, phase_table, start_table

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
