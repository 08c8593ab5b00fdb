"""What takes long says once what it is doing, on standard error, and is stopped by Ctrl-C."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import warnings
from collections.abc import Iterator
from pathlib import Path

import pytest

import kerfwise
from kerfwise.encoder import progress_notice
from kerfwise.encoder.errors import Advice
from kerfwise.encoder.progress_notice import amount, notice_if_long
from kerfwise.jobs.request import facts_of
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile


@pytest.fixture
def told(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """What is said; every stage takes long."""
    monkeypatch.setattr(progress_notice, "AFTER_S", 0.0)
    said: list[str] = []

    class AtOnce(threading.Timer):
        """Says what there is to say when the stage ends."""

        def start(self) -> None:
            pass

        def cancel(self) -> None:
            self.function()

        def join(self, timeout: float | None = None) -> None:
            pass

    monkeypatch.setattr(progress_notice.threading, "Timer", AtOnce)
    with warnings.catch_warnings():
        warnings.simplefilter("always", Advice)
        monkeypatch.setattr(warnings, "showwarning", lambda message, *more, **named: said.append(str(message)))
        yield said


def test_reading_measuring_and_checking_say_what_they_do_once_each(told: list[str], tmp_path: Path) -> None:
    file = tmp_path / "two.json"
    squares = [{"id": name, "outer": rect(x, 20, 50, 50)} for name, x in (("A", 20), ("B", 90))]
    sheet = {"width": 300, "height": 200}
    file.write_text(json.dumps({"format": "kerfwise-nest/1", "sheet": sheet, "parts": squares}), encoding="utf-8")
    drawn = kerfwise.read_nest(file)
    assert told == ["reading two.json: 2 parts, still going"]
    profile = load_profile()
    facts_of(drawn, profile)
    assert told[1:] == ["measuring two.json: 2 contours, still going"]
    check_program(drawn, "G21\nM2\n", profile, "two.nc")
    assert told[2:] == ["checking two.nc: 2 lines, still going"]


def test_drawings_say_how_much_is_in_them(told: list[str]) -> None:
    kerfwise.read_nest("examples/nests/e1x_6.dxf")
    kerfwise.read_nest("examples/nests/marked.svg")
    assert [text.split(":")[0] for text in told] == ["reading e1x_6.dxf", "reading marked.svg"]
    assert "entities" in told[0]
    assert "shapes" in told[1]


def test_what_is_quick_says_nothing(recwarn: pytest.WarningsRecorder) -> None:
    with notice_if_long("reading NEST"):
        amount(1, "entity", "entities")
    facts_of(nest(300, 200, part("A", rect(20, 20, 50, 50))), load_profile())
    assert not recwarn.list


SLOW = """
import signal
import threading
import time
signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background begins with Ctrl-C ignored
from kerfwise.encoder.readers import read
from kerfwise.encoder import progress_notice as still_going
still_going.AFTER_S = 0.2
plain, tell, told = read._Door._nest, still_going._Stage.tell, threading.Event()
def tell_and_say_so(stage):
    tell(stage)
    told.set()
still_going._Stage.tell = tell_and_say_so
def slow(*given):
    nest = plain(*given)
    told.wait()
    time.sleep({seconds})
    return nest
read._Door._nest = slow
from kerfwise.cli import main
main(["facts", {nest!r}])
"""


def slow_facts(nest: Path, seconds: float) -> subprocess.Popen[str]:
    """The command line in a process of its own, reading so long after it has said so; both its outputs are pipes."""
    return subprocess.Popen(
        [sys.executable, "-c", SLOW.format(seconds=seconds, nest=str(nest))],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)},
    )


@pytest.mark.slow
def test_in_a_pipe_the_line_goes_to_standard_error_alone() -> None:
    out, err = slow_facts(Path("examples/nests/e1x_6.json").resolve(), 0.0).communicate(timeout=300)
    (reading,) = [line for line in err.splitlines() if line.startswith("note: reading e1x_6.json")]
    assert reading.endswith(", still going")
    assert json.loads(out)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="Ctrl-C is sent in another way there")
def test_ctrl_c_ends_what_takes_long() -> None:
    running = slow_facts(Path("examples/nests/e1x_6.json").resolve(), 600.0)
    assert running.stderr is not None
    assert "still going" in running.stderr.readline()
    running.send_signal(signal.SIGINT)
    out, err = running.communicate(timeout=300)
    assert (running.returncode, out, err.strip()) == (130, "", "")
