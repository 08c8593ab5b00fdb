"""Runs one case: the command line itself, in a folder of its own, in this process or in one of its own."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from kerfwise.apps.bench import bench, bench_child
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.fuzz.inputs.case import Case

PATIENCE_S = 60.0


@dataclass(frozen=True, slots=True)
class Ended:
    """What came of a case: exit code, what was printed, and every file that is in the folder now."""

    code: int
    out: str
    err: str
    files: Mapping[str, bytes]
    seconds: float


def run(case: Case, folder: Path) -> Ended:
    """Run a case in this process, in a folder that is made anew.

    What the command line lets through, but for its own way to leave, comes out here too.
    """
    _lay_out(case, folder)
    before = os.getcwd()
    os.chdir(folder)
    try:
        with _bench_here():
            began_s = time.perf_counter()
            ended = kerfwise(*case.words)
            seconds = time.perf_counter() - began_s
    finally:
        os.chdir(before)
    return Ended(ended.code, ended.out, ended.err, _found(folder), seconds)


def run_apart(case: Case, folder: Path) -> Ended | None:
    """Run a case as users do, in a process of its own; None where no command can be given such words (a NUL)."""
    _lay_out(case, folder)
    began_s = time.perf_counter()
    try:
        done = subprocess.run(
            [sys.executable, "-X", "utf8", "-m", "kerfwise.cli", *case.words],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=PATIENCE_S,
            check=False,
        )
    except (ValueError, UnicodeEncodeError, OSError):
        return None
    seconds = time.perf_counter() - began_s
    out, err = (text.decode("utf-8", "backslashreplace") for text in (done.stdout, done.stderr))
    return Ended(done.returncode, out, err, _found(folder), seconds)


def _lay_out(case: Case, folder: Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name, content in case.files.items():
        if content is None:
            (folder / name).mkdir()
        else:
            (folder / name).write_bytes(content)


def _found(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@contextmanager
def _bench_here() -> Iterator[None]:
    """`bench` starts a process for each run, which takes seconds; here the run's code is called in its place."""
    real = bench.measure
    bench.measure = bench_child.run_in_child
    try:
        yield
    finally:
        bench.measure = real
