"""Rules from outside, in Python: files that a profile names, installed packages, and whose files may run."""

from __future__ import annotations

import hashlib
import importlib.util
import inspect
import os
import sys
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from kerfwise.encoder.errors import InputError, KerfwiseError, RuleFault, exception_text, line_in
from kerfwise.encoder.nearest_name import unknown
from kerfwise.rules.options.kind import Text, Unfit
from kerfwise.rules.options.yaml_positions import Place, Problems, compose, entries, items
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule, RuleFile

from .plugin_classes import rule_of_class, rules_of

# Rules that installed packages bring, by entry points of the group `kerfwise.rules`.

GROUP = "kerfwise.rules"


@cache
def installed_rules() -> Mapping[str, Rule[Any]]:
    """Rule id → rule, of every installed package that brings some, sorted by id. Found once, when first asked for.

    An entry point names a rule's class, or a module: all rules that it defines. Raises RuleFault if one cannot be
    loaded or used, or has the name of another rule: with the package.
    """
    found: dict[str, Rule[Any]] = {}
    points = {(_package(point), point.name, point.value): point for point in entry_points(group=GROUP)}
    for _, point in sorted(points.items()):
        for rule in _rules(point):
            taken = RULES.get(rule.id) or found.get(rule.id)
            if taken is not None and type(taken) is not type(rule):
                other = taken.brought or "kerfwise itself"
                raise RuleFault(
                    f"two rules are called {rule.id!r}: one of {rule.brought}, one of {other}; uninstall one of the "
                    "packages, or have its author choose another name"
                )
            found[rule.id] = rule
    return dict(sorted(found.items()))


def _rules(point: EntryPoint) -> list[Rule[Any]]:
    brought = f"package {_package(point)}"
    try:
        loaded = point.load()
    except KerfwiseError:
        raise
    except (Exception, SystemExit) as error:
        raise RuleFault(
            f"{brought} brings rules that cannot be loaded (entry point "
            f"{point.name} = {point.value}): {exception_text(error)}; "
            f"mend it, or uninstall it: pip uninstall {_package(point).split()[0]}"
        ) from error
    if isinstance(loaded, ModuleType):
        return rules_of(loaded, brought)
    if inspect.isclass(loaded) and issubclass(loaded, Rule):
        return [rule_of_class(loaded, brought)]
    raise RuleFault(
        f"{brought}: entry point {point.name} = {point.value} is no rule: expected a class derived from "
        f"kerfwise.rules.rule.Rule, or a module that defines some, got {type(loaded).__name__}"
    )


def _package(point: EntryPoint) -> str:
    return f"{point.dist.name} {point.dist.version}" if point.dist is not None else point.value.split(":")[0]


# Rules in a Python file that a profile names.

_LOADED: dict[tuple[str, str], tuple[Rule[Any], ...]] = {}


@dataclass(frozen=True, slots=True)
class PythonFile:
    """An entry of a profile's `python`: the file as it is written there, and the full path."""

    file: str
    path: Path
    place: Place | None = field(default=None, compare=False)


def rules_in_file(path: Path) -> tuple[Rule[Any], ...]:
    """The rules that a Python file defines. Its code is run, once for what it holds: ask for trust before.

    Raises InputError if it cannot be read or run, or defines no rule that can be used: with the line.
    """
    full = path.resolve()
    try:
        text = full.read_bytes()
    except (OSError, ValueError) as error:
        raise InputError(f"cannot read the Python file: {getattr(error, 'strerror', error)}", file=path) from None
    key = str(full), hashlib.sha256(text).hexdigest()
    if key not in _LOADED:
        rules = tuple(rules_of(run_file(full, text), f"file {path}"))
        for rule in rules:
            rule.stands_in = RuleFile(path, key[1])
        _LOADED[key] = rules
    return _LOADED[key]


def run_file(path: Path, text: bytes) -> ModuleType:
    """The module that a file makes, run under a name of its own.

    Raises InputError if it is no Python, or an exception ends it: with the line.
    """
    name = f"kerfwise_rules_{path.stem.replace('-', '_')}_{hashlib.sha256(str(path).encode() + text).hexdigest()[:12]}"
    spec = importlib.util.spec_from_loader(name, loader=None, origin=str(path))
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    module.__file__ = str(path)
    sys.modules[name] = module  # dataclasses look their module up
    try:
        with np.errstate(all="ignore"), warnings.catch_warnings():  # numbers of its cases may be any
            warnings.simplefilter("ignore", SyntaxWarning)  # what is wrong fails when it is run, with its line
            exec(compile(text, str(path), "exec"), vars(module))
    except KerfwiseError:
        del sys.modules[name]
        raise
    except SyntaxError as error:
        del sys.modules[name]
        line = error.lineno if error.filename == str(path) else line_in(str(path), error.__traceback__)
        raise InputError(f"not Python: {error.msg}", file=path, line=line) from None
    except (Exception, SystemExit) as error:
        del sys.modules[name]
        line = line_in(str(path), error.__traceback__)
        raise InputError(f"the file of rules cannot be run: {exception_text(error)}", file=path, line=line) from error
    return module


# Whose Python files may run: a rule in Python is code, and a profile alone is not enough to run it.

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

    Raises InputError if the configuration cannot be read: with file, line and column.
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
    paths = os.environ.get(VARIABLE, "").split(os.pathsep)
    return [_full(text, VARIABLE) for text in paths if text.strip()]


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
