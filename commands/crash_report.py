"""What nobody foresaw ends in one line and a report file, whatever it is."""

from __future__ import annotations

import itertools
import os
import platform
import re
import sys
import tempfile
import traceback
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path

from kerfwise import __version__
from kerfwise.encoder.errors import rule_of
from kerfwise.encoder.escape import escape_lines, escape_text

LIBRARIES = ("click", "ezdxf", "jsonschema", "llvmlite", "matplotlib", "numba", "numpy", "ortools", "pyyaml", "rich",
             "scipy", "segno", "shapely", "svgelements")  # fmt: skip
_SECRET = re.compile(
    r"(?i)((?:[\w-]*(?:password|passwd|token|secret|api[-_]?key))\s*[=:]\s*|(?<=://))[^\s@/]+(?=@|\s|$)"
)


def crash_message(error: BaseException, argv: Sequence[str]) -> str:
    """One line on an exception that nobody foresaw, with the file that a report of it is in.

    Examples
    --------
    >>> crash_message(MemoryError(), []).split(";")[0]
    'a fault of kerfwise itself: MemoryError'
    """
    text = escape_text(" ".join(str(error).split()))
    what = type(error).__name__ + (f": {text[:200]}" if text else "")
    rule = rule_of(error)
    where = f", in rule {rule}" if rule else ""
    file = next(
        (f"{escape_text(word)}: " for word in argv[1:] if not word.startswith("-") and os.path.isfile(word)), ""
    )
    try:
        kept = f"please send {escape_text(str(_kept(_report(error, argv))))} to whoever looks after kerfwise"
    except Exception as another:  # a full disk, or no memory left
        kept = f"a report of it could not be written ({type(another).__name__})"
    return f"{file}a fault of kerfwise itself{where}: {what}; {kept}"


def _report(error: BaseException, argv: Sequence[str]) -> str:
    """Traceback, versions and command; of the environment and of what files hold, nothing."""
    rule = rule_of(error)
    lines = [
        f"kerfwise {__version__} ended with a fault of its own.",
        "",
        f"command: {' '.join(['kerfwise', *map(escape_text, argv)])}",
        f"python {platform.python_version()} on {platform.platform()}",
        *_versions(),
        *([f"rule: {rule}"] if rule else []),
        "",
        escape_lines("".join(traceback.format_exception(error))),
    ]
    return _without_secrets("\n".join(lines))


def _versions() -> Iterator[str]:
    for name in LIBRARIES:
        try:
            yield f"{name} {metadata.version(name)}"
        except metadata.PackageNotFoundError:
            continue


def _without_secrets(text: str) -> str:
    """The text without the name of the user's folder, and without what looks like a password."""
    home = os.path.expanduser("~")
    if len(home) > 1:
        text = text.replace(home, "~")
    return _SECRET.sub(lambda found: f"{found.group(1)}***", text)


def _kept(text: str) -> Path:
    """The report in a new file, here or, where nothing may be written here, where temporary files are."""
    stem = f"kerfwise-fault-{datetime.now(UTC):%Y%m%d-%H%M%S}"
    failed: OSError | None = None
    for folder in (Path(), Path(tempfile.gettempdir())):
        for number in itertools.count(1):
            path = folder / (f"{stem}.txt" if number == 1 else f"{stem}-{number}.txt")
            try:
                handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            except FileExistsError:
                continue
            except OSError as error:
                failed = error
                break
            try:
                with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as file:
                    file.write(text)
            except OSError as error:
                failed = error
                path.unlink(missing_ok=True)
                break
            return path
    raise failed or OSError("no place for a report")


def arguments(argv: Sequence[str] | None) -> list[str]:
    """The words of the command line."""
    return list(sys.argv[1:] if argv is None else argv)
