"""Nothing that only one system has: what Windows lacks, does otherwise, or takes from its settings.

The source is read, not run: this says that a known mistake is not made, and not that kerfwise runs there.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import kerfwise

ROOT = Path(kerfwise.__file__).resolve().parent
FOLDERS = ("api", "encoder", "rules", "models", "postproc", "jobs", "apps", "commands", "benchmarks", "examples")
POSIX_MODULES = {"fcntl", "resource", "pwd", "grp", "termios", "tty", "pty", "posix", "syslog", "readline"}
POSIX_CALLS = {
    "chown",
    "fchmod",
    "fork",
    "forkpty",
    "geteuid",
    "getgid",
    "getloadavg",
    "getpgid",
    "getuid",
    "kill",
    "killpg",
    "mkfifo",
    "mknod",
    "nice",
    "pread",
    "pwrite",
    "readlink",
    "rename",
    "sched_getaffinity",
    "sched_setaffinity",
    "setpgid",
    "setsid",
    "statvfs",
    "symlink",
    "sync",
    "uname",
    "wait",
    "wait3",
    "wait4",
}
"""Of `os`: not on Windows or, as `kill`, `symlink` and `rename` over a file, not the same there."""
SIGNALS = {"SIGINT", "SIGTERM", "SIGABRT", "SIGFPE", "SIGILL", "SIGSEGV", "SIG_IGN", "SIG_DFL"}
"""Those that Windows has too, and the two ways to take them."""
PLACES = ("/dev/", "/tmp", "/etc/", "/proc/", "/usr/", "/home/")
TEXT_FILES = {"open", "fdopen", "read_text", "write_text", "TemporaryFile", "NamedTemporaryFile"}

ALLOWED = {
    ("apps/bench/bench_child.py", "import resource"): "not on Windows, where its twin asks the system itself",
    ("benchmarks/heat_speed.py", "os.wait4"): "a figure for the docs, made on Linux; no part of what is installed",
    ("benchmarks/checkout.py", "symlink_to"): "compares two checkouts, for developers; no part of what is installed",
    ("commands/page_picture.py", "os.nice"): "only where the system has it",
    ("models/jit.py", "os.sched_getaffinity"): "asked for only where the system has it",
    ("jobs/process_pool.py", "os.sched_setaffinity"): "only where the system has it",
    ("jobs/process_pool.py", "signal.SIG_BLOCK"): "only where threads have a mask of signals",
    ("jobs/process_pool.py", "signal.SIG_SETMASK"): "only where threads have a mask of signals",
    ("apps/bench/bench_child.py", "the place '/proc/self/status'"): "on Linux alone",
    ("encoder/files.py", "os.getuid"): "only where files have owners",
    ("encoder/files.py", "import grp"): "only where files have owners",
    ("encoder/files.py", "import pwd"): "only where files have owners",
    ("apps/viewer/serve/worker.py", "os.setpgid"): "only where the system has it",
    ("apps/viewer/serve/worker.py", "os.killpg"): "only where the system has it",
    ("apps/viewer/serve/worker.py", "signal.SIGKILL"): "only where os.killpg is",
    ("apps/viewer/serve/verbs.py", "os.geteuid"): "only where the system has it",
    ("models/numba_cache.py", "os.path"): "commonpath, of which paths have no twin",
    ("encoder/files.py", "os.path"): "answers for every name, where paths raise",
    ("postproc/output_files.py", "os.path"): "samefile",
    ("commands/crash_report.py", "os.path"): "isfile and expanduser answer for every name, where paths raise",
    ("apps/authoring/profile_check.py", "os.path"): "relpath: paths go up only from Python 3.12 on",
    ("apps/edit/edits.py", "os.path"): "relpath: paths go up only from Python 3.12 on",
    ("apps/nesting/nest_list.py", "os.path"): "relpath: paths go up only from Python 3.12 on",
    ("rules/profile/linked_files.py", "os.path"): "paths keep `..`, and raise for links in a circle",
    ("encoder/readers/read.py", "os.path"): "isdir answers for every name, where paths raise",
}
"""File and offence → why it is none."""


def sources() -> Iterator[Path]:
    yield from ROOT.glob("*.py")
    for folder in FOLDERS:
        yield from (ROOT / folder).rglob("*.py")


def offences(text: str) -> Iterator[tuple[int, str]]:
    """Line and name of all that may not work on another system."""
    tree = ast.parse(text)
    docstrings = {
        id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    for node in ast.walk(tree):
        match node:
            case ast.Import(names=names):
                yield from ((node.lineno, f"import {n.name}") for n in names if n.name in POSIX_MODULES)
            case ast.ImportFrom(module=str(module)) if node.level == 0 and module in POSIX_MODULES:
                yield node.lineno, f"import {module}"
            case ast.ImportFrom(module="os" | "signal" as module, names=names):
                yield from ((node.lineno, f"from {module} import {n.name}") for n in names)
            case ast.Attribute(value=ast.Name(id="os"), attr=name) if name in POSIX_CALLS | {"path"}:
                yield node.lineno, f"os.{name}"
            case ast.Attribute(value=ast.Name(id="signal"), attr=name) if (
                name.startswith("SIG") and name not in SIGNALS
            ):
                yield node.lineno, f"signal.{name}"
            case ast.Constant(value=str(value)) if id(node) not in docstrings:
                if value.startswith(PLACES):
                    yield node.lineno, f"the place {value!r}"
                if "%H:%M" in value:
                    yield node.lineno, f"a colon in {value!r}, which no file name may have on Windows"
            case ast.Call():
                yield from ((node.lineno, said) for said in _of_call(node))


def _of_call(node: ast.Call) -> Iterator[str]:
    """What a call leaves to the settings of the system: the encoding of a text, the end of its lines."""
    called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
    owner = getattr(node.func.value, "id", "") if isinstance(node.func, ast.Attribute) else ""
    given = {word.arg for word in node.keywords}
    if owner == "subprocess" and {"text", "universal_newlines"} & given and "encoding" not in given:
        yield f"subprocess.{called} of text without encoding"
    if called == "symlink_to" or (called == "rename" and len(node.args) == 1 and not given):
        yield f"{called}"
    if called not in TEXT_FILES or (owner == "os" and called == "open"):
        return
    writes_text = called == "write_text"
    if not called.endswith("_text"):
        mode = _mode(node, called, owner)
        if mode is None or "b" in mode:
            return
        writes_text = any(sign in mode for sign in "wax+")
    if "encoding" not in given:
        yield f"{called} of text without encoding"
    if writes_text and "newline" not in given:
        yield f"{called} of text without newline"


def _mode(node: ast.Call, called: str, owner: str) -> str | None:
    """The mode in which a file is opened; None for what opens none."""
    first = 1 if called == "fdopen" or (called == "open" and not isinstance(node.func, ast.Attribute)) else 0
    if owner in {"gzip", "zipfile", "webbrowser", "tarfile", "Image"}:
        first = 1
    stated = next((word.value for word in node.keywords if word.arg == "mode"), None)
    if stated is None and len(node.args) > first:
        stated = node.args[first]
    if stated is None:
        return "b" if called.endswith("TemporaryFile") or owner == "gzip" else "r"
    return str(stated.value) if isinstance(stated, ast.Constant) else None


@pytest.mark.slow
def test_nothing_that_another_system_lacks() -> None:
    found = [
        (path.relative_to(ROOT).as_posix(), line, what)
        for path in sources()
        for line, what in offences(path.read_text(encoding="utf-8"))
    ]
    wrong = [f"{file}:{line}: {what}" for file, line, what in found if (file, what) not in ALLOWED]
    assert not wrong, "\n".join(wrong)
    unused = sorted(set(ALLOWED) - {(file, what) for file, _, what in found})
    assert not unused, f"no longer needed in ALLOWED: {unused}"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("import fcntl", "import fcntl"),
        ("from resource import getrusage", "import resource"),
        ("from os import fork", "from os import fork"),
        ("os.fork()", "os.fork"),
        ("os.rename(a, b)", "os.rename"),
        ("Path(a).rename(b)", "rename"),
        ("os.kill(1, signal.SIGKILL)", "signal.SIGKILL"),
        ("x = '/tmp/x'", "the place '/tmp/x'"),
        ("x = f'{now:%H:%M}'", "a colon in '%H:%M', which no file name may have on Windows"),
        ("open(p)", "open of text without encoding"),
        ("p.open('w', encoding='utf-8')", "open of text without newline"),
        ("os.fdopen(f, 'w', newline='')", "fdopen of text without encoding"),
        ("p.read_text()", "read_text of text without encoding"),
        ("p.write_text(t, encoding='utf-8')", "write_text of text without newline"),
        ("tempfile.TemporaryFile('w+', newline='')", "TemporaryFile of text without encoding"),
        ("subprocess.run(c, text=True)", "subprocess.run of text without encoding"),
    ],
)
def test_each_is_found(text: str, expected: str) -> None:
    assert expected in [what for _, what in offences(text)]


@pytest.mark.parametrize(
    "text",
    [
        "'''Writes to /tmp/x.'''",
        "signal.signal(signal.SIGINT, f)",
        "open(p, 'rb')",
        "p.open('rb')",
        "os.open(p, os.O_RDONLY)",
        "os.replace(a, b)",
        "tempfile.TemporaryFile()",
        "p.write_text(t, encoding='utf-8', newline='\\n')",
        "subprocess.run(c, encoding='utf-8')",
        "gzip.open(p)",
    ],
)
def test_what_is_well_is_left_alone(text: str) -> None:
    assert list(offences(text)) == []
