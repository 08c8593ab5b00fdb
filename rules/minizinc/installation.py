"""The MiniZinc that is installed on this machine, and its solvers."""

from __future__ import annotations

import contextlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from kerfwise.encoder.errors import ToolFault
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.nearest_name import unknown

if TYPE_CHECKING:
    from minizinc import Driver, Solver


# Whether the MiniZinc that is found answers as one does: asked with a limit, before anything relies on it.

OLDEST = (2, 6, 0)
LIMIT_S = 10.0
"""A MiniZinc that is well answers in a tenth of a second."""
MOST_BYTES = 10_000_000
SMALLEST_MODEL = "var 1..2: x;\nconstraint x > 1;\nsolve satisfy;\n"
SMALLEST_ANSWER = "x = 2;"
HOW_TO_INSTALL = (
    "MiniZinc 2.6 or later is not installed: `apt-get install minizinc` on Debian and Ubuntu, else see "
    "https://www.minizinc.org/software.html, and make sure that `minizinc` is on the PATH"
)
_HOW_TO_REPAIR = (
    "install MiniZinc 2.6 or later anew: `apt-get install --reinstall minizinc` on Debian and Ubuntu, else see "
    "https://www.minizinc.org/software.html, and make sure that it is the first `minizinc` on the PATH"
)


def unusable(program: str, what: str) -> ToolFault:
    """The error that says what is wrong with a MiniZinc that was found, and what to do."""
    return ToolFault(f"the MiniZinc at {escape_text(program)} cannot be used: {what}; {_HOW_TO_REPAIR}")


def found_program() -> str | None:
    """The first `minizinc` on the PATH; None where there is none.

    Raises InputError if there is only one that may not be executed.
    """
    program = shutil.which("minizinc")
    if program is None:
        for folder in filter(None, os.environ.get("PATH", "").split(os.pathsep)):
            if (there := Path(folder, "minizinc")).is_file():
                raise unusable(str(there), "it is no program that may be executed")
    return program


@lru_cache(maxsize=16)
def version_of(program: str) -> str:
    """What the program says of its version, in full; asked once. Raises InputError if it does not answer."""
    return _answer(program, "--version")


@lru_cache(maxsize=16)
def expect_usable(program: str) -> None:
    """Ask for the version and the solvers; what answered well once is not asked again.

    Raises InputError if it is too old, or answers otherwise than MiniZinc does, or not within `LIMIT_S`.
    """
    installed = version_of(program)
    version = re.search(r"version (\d+)\.(\d+)\.(\d+)", installed)
    if version is None:
        raise unusable(program, f"asked for its version, it {_quoted(installed)}")
    numbers = tuple(int(number) for number in version.groups())
    if numbers < OLDEST:
        raise unusable(program, f"it is version {'.'.join(map(str, numbers))}")
    installed = _answer(program, "--solvers-json")
    try:
        solvers = json.loads(installed)
    except ValueError:
        solvers = None
    if not _is_list_of_solvers(solvers):
        raise unusable(program, f"asked for its solvers, it {_quoted(installed)}")
    if not solvers:
        raise unusable(program, "it has no solvers")


@lru_cache(maxsize=64)
def expect_solving(program: str, solver: str) -> None:
    """Have a solver solve the smallest of models; what answered well once is not asked again.

    Raises InputError if it does not, or not within `LIMIT_S`.
    """
    with tempfile.TemporaryDirectory(prefix="kerfwise-", ignore_cleanup_errors=True) as folder:
        model = Path(folder, "smallest.mzn")
        model.write_text(SMALLEST_MODEL, encoding="utf-8", newline="\n")
        reply = _answer(program, "--solver", solver, str(model), asked="a model of one line")
    if SMALLEST_ANSWER not in reply:
        raise unusable(program, f"asked to solve a model of one line by {solver}, it {_quoted(reply)}")


def _answer(program: str, *words: str, asked: str = "") -> str:
    """What the program prints; it gets nothing to read, and no more time and room than it needs."""
    what = f"asked for {asked or words[0]}, it"
    ran = run(program, words, LIMIT_S)
    if ran.code is None:
        raise unusable(
            program, f"{what} {'prints without end' if ran.endless else f'gives no answer within {LIMIT_S:g} s'}"
        )
    if ran.code != 0:
        raise unusable(program, f"{what} ends with exit code {ran.code} and {_quoted(ran.complaint or ran.said)}")
    return ran.said


@dataclass(frozen=True, slots=True)
class Ran:
    """How a run of the program ended: its exit code, None where it was ended, for printing without end or else late."""

    code: int | None
    said: str
    complaint: str
    endless: bool


def run(program: str, words: Sequence[str], limit_s: float) -> Ran:
    """Run the program with nothing to read, for so long at the most, in no more memory than `MOST_GB`.

    It prints into files, not pipes: one that hangs may have left children that hold a pipe open. It ends with all that
    it has begun where this process ends, however that is ended, but on Windows.

    Raises InputError if it cannot be started.
    """
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        try:
            if supervised := os.name == "posix":
                command = [sys.executable, "-I", "-S", "-c", SUPERVISOR, str(int(MOST_GB * 1e9)), program, *words]
                child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=out, stderr=err)
            else:
                child = subprocess.Popen([program, *words], stdin=subprocess.DEVNULL, stdout=out, stderr=err)
        except (OSError, ValueError) as error:
            strerror = getattr(error, "strerror", None) or str(error)
            raise unusable(program, f"it cannot be started ({strerror})") from None
        try:
            code = _ended(child, (out, err), limit_s)
        finally:
            if child.stdin is not None:
                child.stdin.close()  # whoever supervises it ends it then
                with contextlib.suppress(subprocess.TimeoutExpired):
                    child.wait(1.0)
            _end(child)
        if supervised and code == CANNOT_START:
            raise unusable(program, f"it cannot be started ({_read(err).strip()})")
        return Ran(code, _read(out), _read(err), any(_size(file) > MOST_BYTES for file in (out, err)))


MOST_GB = 2.0
"""What the program may hold, with each that it begins: one that compiles a rule of too many sums grows without end."""
CANNOT_START = 199
SUPERVISOR = """
import os, resource, select, signal, subprocess, sys
most = int(sys.argv[1])
def limit():
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
try:
    child = subprocess.Popen(sys.argv[2:], stdin=subprocess.DEVNULL, start_new_session=True, preexec_fn=limit)
except (OSError, ValueError) as error:
    print(getattr(error, "strerror", None) or error, file=sys.stderr)
    sys.exit(199)
woken, waking = os.pipe()
signal.signal(signal.SIGCHLD, lambda *_: os.write(waking, b"c"))
for number in (signal.SIGTERM, signal.SIGINT):
    signal.signal(number, lambda *_: os.write(waking, b"e"))
while child.poll() is None:
    ready = select.select([0, woken], [], [])[0]
    if 0 in ready or b"e" in os.read(woken, 100):
        break
code = child.poll()
try:
    os.killpg(child.pid, signal.SIGKILL)
except OSError:
    pass
if code is not None and code < 0:
    if -code != signal.SIGKILL:
        signal.signal(-code, signal.SIG_DFL)
    os.kill(os.getpid(), -code)
sys.exit(1 if code is None else code)
"""
"""Runs a program in a group of its own, and ends all of it once nobody holds the other end of its standard input."""


def _ended(child: subprocess.Popen[bytes], files: tuple[BinaryIO, BinaryIO], limit_s: float) -> int | None:
    """The exit code; None where it takes too long, or prints too much."""
    until_s = time.monotonic() + limit_s
    while time.monotonic() < until_s and all(_size(file) <= MOST_BYTES for file in files):
        with contextlib.suppress(subprocess.TimeoutExpired):
            return child.wait(0.05)
    return None


def _end(child: subprocess.Popen[bytes]) -> None:
    """End the program if it still runs: kindly, so that it can end its solver, and then for sure."""
    for end in (child.terminate, child.kill):
        if child.poll() is None:
            end()
            with contextlib.suppress(subprocess.TimeoutExpired):
                child.wait(1.0)


def _size(file: BinaryIO) -> int:
    return os.fstat(file.fileno()).st_size


def _read(file: BinaryIO) -> str:
    file.seek(0)
    return file.read(MOST_BYTES).decode("utf-8", errors="replace")


def _quoted(text: str) -> str:
    """What it printed, in words: its first line that is not empty."""
    line = next((line.strip() for line in text.splitlines() if line.strip()), "")
    return f"prints {escape_text(line[:100])!r}" if line else "prints nothing"


def _is_list_of_solvers(solvers: Any) -> bool:
    return isinstance(solvers, list) and all(
        isinstance(s, dict) and all(isinstance(s.get(key), str) for key in ("id", "name", "version")) for s in solvers
    )


@dataclass(frozen=True, slots=True)
class InstalledSolver:
    """A solver that MiniZinc can use: the name to ask for it by, what it calls itself, its version."""

    name: str
    title: str
    version: str


def driver() -> Driver:
    """The installed MiniZinc.

    It is asked before the package that drives it is imported, which would wait for its version for ever. Raises
    InputError if there is none, an older one than 2.6, or one that does not answer as MiniZinc does; the message says
    how to install it.
    """
    if program := found_program():
        expect_usable(program)
    with warnings.catch_warnings():  # without a program the package warns when imported; the error here says more
        warnings.simplefilter("ignore")
        try:
            import minizinc
        except Exception as error:  # the program has changed meanwhile, or one of another place is broken
            raise unusable(program or "minizinc", f"it fails ({type(error).__name__}: {error})") from None
    if minizinc.default_driver is None:
        raise ToolFault(HOW_TO_INSTALL)
    return minizinc.default_driver


def solver_named(name: str) -> Solver:
    """The solver of that name (`gecode`), full id (`org.gecode.gecode`) or tag (`mip`).

    Raises InputError if MiniZinc has no such solver, knows it but not where it is, or it does not solve the smallest of
    models.
    """
    ready = _ready()
    if name not in ready:
        raise ToolFault(f"MiniZinc here: {unknown('solver', name, {s.name for s in installed_solvers()})}")
    chosen = ready[name]
    expect_solving(str(driver().executable), str(chosen.id))
    return chosen


def installed_solvers() -> tuple[InstalledSolver, ...]:
    """The solvers that can be used, by name. Raises InputError if MiniZinc is not installed."""
    found = {s.id: InstalledSolver(_short(s), s.name, s.version) for s in _ready().values()}
    return tuple(sorted(found.values(), key=lambda s: s.name))


def _ready() -> dict[str, Solver]:
    """Name, id or tag → solver; without those that only open a window, and those whose library is missing."""
    ready: dict[str, Solver] = {}
    here = driver()
    try:
        known = here.available_solvers()
    except Exception as error:  # the program has changed since it was asked
        raise unusable(
            str(here.executable), f"it does not list its solvers ({type(error).__name__}: {error})"
        ) from None
    for name, solvers in known.items():
        usable = [s for s in solvers if not s.isGUIApplication and s.version != "<unknown version>"]
        if usable:
            ready[name] = usable[0]
    if not ready:
        raise unusable(str(here.executable), "none of its solvers can be used")
    return ready


def _short(solver: Solver) -> str:
    return str(solver.id).rpartition(".")[2]
