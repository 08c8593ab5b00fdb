"""Whose Python files may run: a rule in Python is code, and a profile alone is not enough to run it."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.kind import Unfit
from kerfwise.rules.options.plain_values import Text
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems, compose, entries, items

VARIABLE = "KERFWISE_TRUST"
"""Environment variable: files and folders whose Python rules may run, separated as those of PATH are."""
KEYS = ("trust",)


def configuration() -> Path:
    """The file in which a machine says whose rules may run.

    `config.yaml` in the folder `kerfwise` of `$XDG_CONFIG_HOME`, else of `~/.config`; on Windows of `%APPDATA%`.
    """
    home = os.environ.get("APPDATA") if sys.platform == "win32" else os.environ.get("XDG_CONFIG_HOME")
    return (Path(home) if home else Path.home() / ".config") / "kerfwise" / "config.yaml"


def is_trusted(path: Path) -> bool:
    """Whether the machine's configuration or the environment says that a file's code may run.

    Raises
    ------
    InputError
        If the configuration cannot be read: with file, line and column.
    """
    full = path.resolve()
    trusted = [*_of_environment(), *_of_configuration(configuration())]
    return any(full == place or place in full.parents for place in trusted)


def refusal(path: Path) -> str:
    """Why a file is not run, and what to do where its rules are wanted."""
    folder = path.resolve().parent
    return (
        f"{path} is code, and a profile alone may not run code: if you trust it, say --trust (in Python: trust=True), "
        f"or allow its folder on this machine for good, with `trust: [{folder}]` in {configuration()} or "
        f"{VARIABLE}={folder}"
    )


def _of_environment() -> list[Path]:
    given = os.environ.get(VARIABLE, "").split(os.pathsep)
    return [_full(text, VARIABLE) for text in given if text.strip()]


def _full(text: str, where: str) -> Path:
    try:
        path = Path(text).expanduser()
        if path.is_absolute():
            return path.resolve()
    except (ValueError, RuntimeError):  # a NUL, or no home
        pass
    raise InputError(f"{where}: expected full paths of files or folders, got {text!r}")


def _of_configuration(file: Path) -> list[Path]:
    try:
        text = file.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        return []
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot read the configuration: {error}", file=file) from None
    root, problems = compose(text, str(file)), Problems(str(file))
    found: list[Path] = []
    for key, key_node, value in entries(root, problems, "configuration") if root is not None else ():
        if key not in KEYS:
            problems.add(key_node, unknown("key", key, KEYS))
            continue
        for node in items(value, problems, key):
            try:
                found.append(_full(Text().read(node), key))
            except Unfit as error:
                problems.add(node, f"{key}: {error}")
            except InputError as error:
                problems.add(node, error.message)
    problems.raise_any()
    return found
