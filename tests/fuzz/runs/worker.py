"""A process that runs case after case, within a limit of memory, watched by the one that asked for it."""

from __future__ import annotations

import contextlib
import faulthandler
import gc
import multiprocessing
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import kerfwise
from kerfwise.apps.bench.bench_child import load_kernels
from kerfwise.tests.fuzz.inputs.case import Case

from .judge import OWN_FAULT, differences, findings
from .run import run, run_apart

LIMIT_S = 10.0
"""A case that takes longer is hanging. The seconds are the processor's: other work on the machine is no fault."""
MOST_S = 60.0
"""And so is one that waits for a minute, whatever for."""
LIMIT_BYTES = 3_000_000_000
SLOW_S = 5.0
ROOT = f"{Path(kerfwise.__file__).parent}{os.sep}"
"""What the files of kerfwise lie in."""
CASES_A_LIFE = 3000
AGAIN_EVERY, APART_EVERY = 20, 1000
"""Of so many cases one is run twice, and one in a process of its own; what comes of it must be the same."""


@dataclass(frozen=True, slots=True)
class Report:
    """What came of a case: the exit code (None where there is none) and what is wrong."""

    case: Case
    code: int | None
    findings: tuple[str, ...]
    seconds: float = 0.0


class Worker:
    """The process, started again where a case has ended it."""

    def __init__(self, limit_s: float = LIMIT_S) -> None:
        self.limit_s = limit_s
        self._process: Any = None
        self._pipe: Connection | None = None
        self._asked = 0

    def ask(self, case: Case, again: bool = False, apart: bool = False) -> Report:
        """Have a case run, twice or in a process of its own as well."""
        if self._process is None or self._asked >= CASES_A_LIFE:
            self._start()
        assert self._pipe is not None
        self._asked += 1
        began_s, spent_s = time.monotonic(), _processor_s(self._process.pid)
        runs = 1 + again
        try:
            self._pipe.send((case, again, apart))
            while not self._pipe.poll(0.5):
                used_s = _processor_s(self._process.pid) - spent_s
                if used_s > runs * self.limit_s or time.monotonic() - began_s > MOST_S * (runs + 2 * apart):
                    where = _where(self._process.pid, self._notes)
                    self.stop()
                    return Report(case, None, (f"hang: over {self.limit_s:g} s{where}",), self.limit_s)
            report: Report = self._pipe.recv()
            return report
        except (EOFError, ConnectionError):
            self._process.join(5)
            code = self._process.exitcode
            self.stop()
            return Report(case, None, (f"died: the process ended with {code}",))

    def state(self) -> str:
        """How much of the machine the process has had since it was started."""
        if self._process is None:
            return "not running"
        held = Path(f"/proc/{self._process.pid}/statm").read_text().split()[1]
        megabytes = int(held) * os.sysconf("SC_PAGE_SIZE") // 1_000_000
        return f"{self._asked} cases of this process: {_processor_s(self._process.pid):.0f} s, {megabytes} MB"

    def stop(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process = None
            self._folder.cleanup()

    def _start(self) -> None:
        self.stop()
        self._folder = tempfile.TemporaryDirectory(prefix="kerfwise-fuzz-", ignore_cleanup_errors=True)
        self._notes = Path(self._folder.name) / "where.txt"
        context = multiprocessing.get_context("spawn")
        self._pipe, there = context.Pipe()
        self._process = context.Process(target=_serve, args=(there, self._folder.name), daemon=True)
        self._process.start()
        there.close()
        self._asked = 0
        if not self._pipe.poll(1800):  # kernels may have to be compiled first
            raise RuntimeError("the process that runs cases does not start")
        self._pipe.recv()


def _serve(pipe: Connection, folder: str) -> None:
    os.environ |= {"TMPDIR": folder, "HOME": folder, "XDG_CONFIG_HOME": folder}
    os.fsync = lambda handle: None  # type: ignore[assignment]  # a hundred thousand cases would wait for the disk
    tempfile.tempdir = None
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    load_kernels()
    with open(Path(folder) / "where.txt", "w", encoding="utf-8") as notes:
        faulthandler.register(signal.SIGUSR1, notes, all_threads=False)
        resource.setrlimit(resource.RLIMIT_AS, (LIMIT_BYTES, LIMIT_BYTES))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        void = os.open(os.devnull, os.O_RDWR)
        os.dup2(void, 0)
        pipe.send("ready")
        with contextlib.suppress(EOFError):
            while True:
                case, again, apart = pipe.recv()
                pipe.send(reported(case, Path(folder) / "case", again, apart))


def reported(case: Case, folder: Path, again: bool = False, apart: bool = False) -> Report:
    """Run a case in this process, and judge it."""
    try:
        ended = run(case, folder)
        found = findings(case, ended)
        if ended.code == OWN_FAULT:
            found += [f"at: {_place(text)}" for name, text in ended.files.items() if name.startswith("kerfwise-fault-")]
            if any("MemoryError" in text for text in found):
                found[0] = f"over 3 GB: {found[0]}"
        if again:
            found += differences(case, ended, run(case, folder))
        if apart and (other := run_apart(case, folder)) is not None:
            found += [f"apart: {text}" for text in (*findings(case, other), *differences(case, ended, other))]
        return Report(case, ended.code, tuple(found), ended.seconds)
    except MemoryError as error:
        gc.collect()
        return Report(case, None, (f"over 3 GB: {_last_place(error)}",))
    except BaseException as error:
        return Report(case, None, (f"traceback: {type(error).__name__}: {error} {_last_place(error)}",))


def _place(report: bytes) -> str:
    """The last place of kerfwise's own in a report's traceback."""
    lines = [
        line.strip() for line in report.decode("utf-8", "replace").splitlines() if line.strip().startswith("File ")
    ]
    own = [line for line in lines if _is_own(line)]
    return (own or lines or [""])[-1].rpartition(ROOT)[2]


def _is_own(line: str) -> bool:
    """Whether a line of a traceback is about a file of kerfwise's own, whatever its folder is called."""
    return ROOT in line and "site-packages" not in line


def _last_place(error: BaseException) -> str:
    frame = (traceback.extract_tb(error.__traceback__) or [None])[-1]
    return "" if frame is None else f"{Path(frame.filename).name}:{frame.lineno}"


def _processor_s(process: int) -> float:
    """Seconds of the processor that a process has had, its ended children's too."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")


def _where(process: int, notes: Path) -> str:
    """Where a process is just now."""
    with contextlib.suppress(OSError):
        os.kill(process, signal.SIGUSR1)
        time.sleep(0.5)
        lines = [line for line in notes.read_text(encoding="utf-8").splitlines() if "File" in line]
        own = [line for line in lines if _is_own(line)]
        return f", at {(own or lines)[0].strip().rpartition(ROOT)[2]}" if lines else ""
    return ""


if sys.platform == "win32":  # pragma: no cover
    raise ImportError("limits of memory are set as POSIX systems do")
