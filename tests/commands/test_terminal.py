"""Questions of a drawing on a real terminal: asked there, answered, remembered; in a pipe they end the command."""

from __future__ import annotations

import os
import pty
import select
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

from kerfwise import read_job
from kerfwise.tests.encoder.readers.drawings import save_dxf
from kerfwise.tests.encoder.readers.test_frame import framed

WAIT_S = 120.0
SOLVE = ("solve", "drawing.dxf", "--work", "0.1")
CTRL_C, CTRL_D = b"\x03", b"\x04"


def at_terminal(folder: Path, words: Sequence[str], typed: Sequence[bytes]) -> tuple[int, str]:
    """Run the command as a person does, who types each of these when a prompt is there: exit code, and what is seen."""
    pid, terminal = pty.fork()
    if pid == 0:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # a suite in the background ignores it, and so would this
        os.chdir(folder)
        os.execv(sys.executable, [sys.executable, "-m", "kerfwise", *words])
    seen, answered, ends_s, left = b"", 0, time.monotonic() + WAIT_S, list(typed)
    while time.monotonic() < ends_s:
        if not select.select([terminal], [], [], 0.2)[0]:
            continue
        try:
            data = os.read(terminal, 65536)
        except OSError:  # its last process has gone
            break
        if not data:
            break
        seen += data
        if left and seen.rstrip(b" ").endswith(b"):") and seen.count(b"Which (") > answered:
            answered = seen.count(b"Which (")
            os.write(terminal, left.pop(0))
    os.close(terminal)
    _, status = os.waitpid(pid, 0)
    assert not left, seen.decode()
    return os.waitstatus_to_exitcode(status), seen.decode("utf-8").replace("\r\n", "\n")


def files(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


@pytest.mark.slow
def test_a_question_is_asked_answered_and_remembered(tmp_path: Path) -> None:
    save_dxf(tmp_path, framed)
    code, seen = at_terminal(tmp_path, SOLVE, [b"2\r"])
    assert code == 0, seen
    assert "is drawn around everything" in seen
    assert "  1  part   a part; what is in it is openings: 1 part, 1 hole" in seen
    assert "  2  sheet  the sheet; what is in it is parts: 1 part" in seen
    assert "kept in drawing.job.yaml: frame=sheet" in seen
    assert read_job(tmp_path / "drawing.job.yaml").answers == (("frame", "sheet"),)
    assert "drawing.nc" in files(tmp_path)
    code, again = at_terminal(tmp_path, ("read", "drawing.dxf"), [])
    assert (code, "Which" in again) == (0, False)
    assert "answered: frame=sheet" in again


@pytest.mark.slow
def test_a_wrong_answer_is_asked_again(tmp_path: Path) -> None:
    save_dxf(tmp_path, framed)
    code, seen = at_terminal(tmp_path, ("facts", "drawing.dxf"), [b"3\r", b"door\r", b"\r", b" part \r"])
    assert code == 0, seen
    for said in ("3", "door"):
        assert f"Error: '{said}' is none of the choices: type 1 to 2, or the word behind it" in seen
    assert seen.count("Which (1-2)") == 4
    assert '"P1.hole1"' in seen


@pytest.mark.parametrize("key", [CTRL_C, CTRL_D])
def test_who_ends_it_there_has_nothing_written(tmp_path: Path, key: bytes) -> None:
    save_dxf(tmp_path, framed)
    code, seen = at_terminal(tmp_path, SOLVE, [key])
    assert code == 130
    assert "not answered, nothing is written: --answer frame=part answers it" in seen
    assert "Traceback" not in seen
    assert files(tmp_path) == {"drawing.dxf"}


def test_in_a_pipe_it_ends_with_the_questions(tmp_path: Path) -> None:
    save_dxf(tmp_path, framed)
    words = [sys.executable, "-m", "kerfwise", *SOLVE]
    ended = subprocess.run(
        words, cwd=tmp_path, input="2\n", capture_output=True, text=True, timeout=WAIT_S, check=False
    )
    assert (ended.returncode, ended.stdout) == (3, "")
    assert "--answer frame=part" in ended.stderr
    assert "Which" not in ended.stderr
    assert files(tmp_path) == {"drawing.dxf"}
