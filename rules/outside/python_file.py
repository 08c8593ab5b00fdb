"""Rules in a Python file that a profile names."""

from __future__ import annotations

import hashlib
import importlib.util
import sys
import warnings
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from kerfwise.encoder.errors import InputError, KerfwiseError
from kerfwise.encoder.faults import line_in, said
from kerfwise.rules.options.yaml_positions import Place
from kerfwise.rules.rule import Rule
from kerfwise.rules.rule_file import RuleFile

from .made import rules_of

_LOADED: dict[tuple[str, str], tuple[Rule[Any], ...]] = {}


@dataclass(frozen=True, slots=True)
class PythonFile:
    """An entry of a profile's `python`: the file as it is written there, and the full path."""

    file: str
    path: Path
    place: Place | None = field(default=None, compare=False)


def rules_in_file(path: Path) -> tuple[Rule[Any], ...]:
    """The rules that a Python file defines. Its code is run, once for what it holds: ask for trust before.

    Raises
    ------
    InputError
        If it cannot be read or run, or defines no rule that can be used: with the line.
    """
    full = path.resolve()
    try:
        text = full.read_bytes()
    except (OSError, ValueError) as error:
        raise InputError(f"cannot read the Python file: {getattr(error, 'strerror', error)}", file=path) from None
    key = str(full), hashlib.sha256(text).hexdigest()
    if key not in _LOADED:
        made = tuple(rules_of(run_file(full, text), f"file {path}"))
        for rule in made:
            rule.stands_in = RuleFile(path, key[1])
        _LOADED[key] = made
    return _LOADED[key]


def run_file(path: Path, text: bytes) -> ModuleType:
    """The module that a file makes, run under a name of its own.

    Raises
    ------
    InputError
        If it is no Python, or an exception ends it: with the line.
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
        raise InputError(f"the file of rules cannot be run: {said(error)}", file=path, line=line) from error
    return module
