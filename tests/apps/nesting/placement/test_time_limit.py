"""A limit in seconds holds in the first round, too: what lies there then is the layout, and what is missing is said."""

from __future__ import annotations

import os
import signal
from itertools import count
from pathlib import Path

import pytest

from kerfwise.apps.nesting.placement import rounds
from kerfwise.apps.nesting.placement.demand import Demand, PartType, Spacing, Stock
from kerfwise.apps.nesting.placement.layout import Layout
from kerfwise.apps.nesting.placement.rounds import Effort, layouts
from kerfwise.apps.nesting.verbs import NestProgress
from kerfwise.encoder.nest import Sheet
from kerfwise.encoder.readers.json_nest import nest_json
from kerfwise.rules.case import nest, part, rect
from kerfwise.tests.commands.run_cli import kerfwise

KINDS = tuple(PartType(f"s{k}", part(f"s{k}", rect(0, 0, 50 + k, 50)), 1) for k in range(40))
SQUARES = Demand(KINDS, (Stock("s", Sheet.rectangle(300, 300)),))


@pytest.fixture
def ticking(monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock that goes on by a tenth of a second whenever it is looked at."""
    ticks = count()
    monkeypatch.setattr(rounds.time, "monotonic", lambda: next(ticks) / 10)


def test_the_first_round_ends_with_the_limit(ticking: None) -> None:
    best = layouts(SQUARES, Spacing(5.0, 5.0), Effort(time_s=1.5))[0]
    assert 0 < sum(best.missing) < 40
    enough = layouts(SQUARES, Spacing(5.0, 5.0), Effort(time_s=500.0), lambda number, best: number < 2)[0]
    assert sum(enough.missing) == 0


@pytest.fixture
def square(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A part in the folder that is worked in."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "square.json").write_text(nest_json(nest(100, 100, part("square", rect(10, 10, 50, 50)))))
    return tmp_path


def test_what_the_limit_left_is_said(square: Path, ticking: None) -> None:
    for k in range(30):
        made = part(f"s{k}", rect(10, 10, 50 + k, 50))
        Path(f"s{k}.json").write_text(nest_json(nest(200, 100, made)))
    words = ("nest", *(f"s{k}.json" for k in range(30)), "--sheet", "300x300", "-o", "out", "--time-limit")
    ended = kerfwise(*words, 1.5)
    assert ended.code == 1
    assert "the limit of 1.5 s ended the first round:" in ended.err
    assert Path("out/sheet1.json").exists()
    never = kerfwise(*words, 0.01)
    assert (never.code, "was over before a part was laid" in never.err) == (2, True)


def test_a_signal_that_ends_jobs_keeps_the_best(square: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    told = NestProgress.__call__

    def ended(self: NestProgress, number: int, best: Layout) -> bool:
        os.kill(os.getpid(), signal.SIGTERM)
        return told(self, number, best)

    monkeypatch.setattr(NestProgress, "__call__", ended)
    done = kerfwise("nest", "square.json=4", "--sheet", "300x300", "-o", "out", "--rounds", 500)
    assert done.code == 130
    assert Path("out/sheet1.json").exists()
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL
