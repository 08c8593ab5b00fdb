"""A MiniZinc that is too old, broken, silent or hanging gets one clear message, before any work, and soon."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.rules.minizinc import installation
from kerfwise.rules.minizinc.installation import driver
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.tools.amount import few, full

NEST = str(Path(__file__).parents[3] / "examples" / "nests" / "e1x_6.dxf")
pytestmark = pytest.mark.skipif(os.name != "posix", reason="the programs are shell scripts")
WELL = "echo 'MiniZinc to FlatZinc converter, version 2.8.5'"
SOLVERS = '[{"id": "org.gecode.gecode", "name": "Gecode", "version": "6.3.0"}]'
SAYS_VERSION = f'[ "$1" = --version ] && {{ {WELL}; exit; }}'


def fake(folder: Path, script: str, mode: int = 0o755) -> Path:
    """A program `minizinc` in a folder."""
    path = folder / "minizinc"
    path.write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
    path.chmod(mode)
    return path


BROKEN = {
    "too old": ("echo 'MiniZinc to FlatZinc converter, version 2.3.1'", "it is version 2.3.1"),
    "silent": ("exit 0", "asked for its version, it prints nothing"),
    "garbage": ("echo; echo 'hello \\033[31m'", "asked for its version, it prints 'hello"),
    "no text": ("printf '\\377\\376\\n'", "asked for its version, it prints"),
    "exit 1": ("echo 'no such library' >&2; exit 1", "exit code 1 and prints 'no such library'"),
    "killed": ("kill -9 $$", "ends with exit code -9 and prints nothing"),
    "hangs": ("exec sleep 1000", "asked for --version, it gives no answer within 1 s"),
    "hangs, with a child": ("sleep 1000", "gives no answer within 1 s"),
    "waits for input": ("cat; exit 3", "exit code 3 and prints nothing"),
    "floods": ("exec yes", "prints without end"),
    "no solvers": (f"{SAYS_VERSION}; echo '[]'", "it has no solvers"),
    "no list": (f"{SAYS_VERSION}; echo none", "asked for its solvers, it prints 'none'"),
    "no such list": (f"{SAYS_VERSION}; echo '[1]'", "asked for its solvers, it prints '[1]'"),
    "no answer of solvers": (f"{SAYS_VERSION}; exit 0", "asked for its solvers, it prints nothing"),
    "hangs at solvers": (f"{SAYS_VERSION}; exec sleep 1000", "asked for --solvers-json, it gives no answer within 1 s"),
}
WAITED_FOR = ("hangs, with a child", "hangs at solvers")
"""Seconds pass before these are given up; one that hangs is always tried."""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("script", "message"), [full(*row) if name in WAITED_FOR else row for name, row in BROKEN.items()], ids=BROKEN
)
def test_solve_says_what_was_found_and_how_to_install(
    script: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bin").mkdir()
    program = fake(tmp_path / "bin", script)
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}")
    if "solvers-json" in message:
        installation.version_of(str(program))  # it is known from now on
    if "no answer within" in message:
        monkeypatch.setattr(installation, "LIMIT_S", 1.0)
    began_s = time.monotonic()
    ended = kerfwise("solve", NEST, "--engine", "minizinc", "-o", "cut.nc")
    assert time.monotonic() - began_s < 500
    assert ended.code == 2, ended.err
    assert ended.err.count("\n") == 1
    assert f"the MiniZinc at {program} cannot be used: " in ended.err
    assert message in ended.err
    assert "apt-get install" in ended.err
    assert not Path("cut.nc").exists()
    listed = kerfwise("engines")
    assert listed.code == 0
    assert message in listed.out


def test_one_that_may_not_be_executed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake(tmp_path, WELL, mode=0o644)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match="it is no program that may be executed"):
        driver()


def test_one_that_is_no_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = tmp_path / "minizinc"
    program.write_bytes(b"\x7fELF\x00\x01")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match="it cannot be started"):
        driver()


def test_one_that_vanishes_between_look_and_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    gone = tmp_path / "minizinc"
    monkeypatch.setattr("shutil.which", lambda name: str(gone))
    with pytest.raises(InputError, match=r"it cannot be started \(No such file"):
        driver()


@pytest.mark.parametrize(
    ("script", "message"),
    [
        ("exec sleep 1000", "asked for a model of one line, it gives no answer within 1 s"),
        ("exit 0", "by org.gecode.gecode, it prints nothing"),
        ("echo 'x = 1;'", "it prints 'x = 1;'"),
        ("echo 'cannot find the standard library' >&2; exit 1", "prints 'cannot find the standard library'"),
    ],
)
def test_a_solver_that_does_not_solve(
    script: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if "no answer within" in message:
        monkeypatch.setattr(installation, "LIMIT_S", 1.0)
    program = fake(tmp_path, script)
    with pytest.raises(InputError, match="cannot be used") as error:
        installation.expect_solving(str(program), "org.gecode.gecode")
    assert message in str(error.value)


def test_one_that_is_well_passes(tmp_path: Path) -> None:
    program = fake(tmp_path, f"{SAYS_VERSION}; [ \"$1\" = --solvers-json ] && echo '{SOLVERS}' || echo 'x = 2;'")
    installation.expect_usable(str(program))
    installation.expect_solving(str(program), "org.gecode.gecode")


@pytest.mark.slow
@pytest.mark.parametrize("script", few(["exec sleep 1000", f"{SAYS_VERSION}; exec sleep 1000"]))
def test_the_package_is_not_imported_before(script: str, tmp_path: Path) -> None:
    """The package asks for the version when it is imported, and would wait for ever."""
    fake(tmp_path, script)
    code = (
        "from kerfwise.rules.minizinc import installation as trial\n"
        "from kerfwise.cli import main\n"
        "trial.LIMIT_S = 1.0\n"
        f"main(['solve', {NEST!r}, '--engine', 'minizinc', '-o', 'cut.nc'])\n"
    )
    env = {**os.environ, "PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}"}
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        env=env,
        capture_output=True,
        encoding="utf-8",
        timeout=300,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert "gives no answer within 1 s" in done.stderr
    assert "Traceback" not in done.stderr
