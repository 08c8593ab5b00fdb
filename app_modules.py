"""The apps that are installed beside the core, and what they offer, found by name: the core imports none of them."""

from __future__ import annotations

import importlib
import importlib.util
from typing import Any

APPS = "kerfwise.apps"


def verbs() -> dict[str, tuple[str, str]]:
    """Verb of an app → the module that has its command, and what it does in a line."""
    return {name: (f"{APPS}.{module}", does) for name, (module, does) in _table("VERBS").items()}


def interface_names() -> dict[str, str]:
    """Name of the Python interface that an app has → its module."""
    return {name: f"{APPS}.{module}" for name, module in _table("NAMES").items()}


def app_module(name: str) -> Any:
    """A module of an app by its name in `kerfwise.apps`, such as `distortion.predict`.

    Raises InputError if the app is not installed.
    """
    try:
        return importlib.import_module(f"{APPS}.{name}")
    except ModuleNotFoundError as error:
        if error.name is None or not error.name.startswith(APPS):
            raise
        raise _missing(name.partition(".")[0]) from None


def expect_app(app: str) -> None:
    """Say at once that an app is not installed, without loading it.

    Raises InputError if it is not.
    """
    try:
        found = importlib.util.find_spec(f"{APPS}.{app}")
    except ModuleNotFoundError:
        found = None
    if found is None:
        raise _missing(app)


def library(name: str, what: str, extra: str) -> Any:
    """A library that comes with an extra.

    Raises InputError where it is not installed: what needs it, and which extra has it.
    """
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError:
        from kerfwise.encoder.errors import InputError

        raise InputError(f"{what} needs {name}: install it with `pip install 'kerfwise[{extra}]'`") from None


def _missing(app: str) -> Exception:
    from kerfwise.encoder.errors import InputError

    return InputError(f"the app {app!r} of kerfwise is not installed: this is its core alone")


def _table(name: str) -> dict[str, Any]:
    try:
        found: dict[str, Any] = getattr(importlib.import_module(APPS), name)
    except ModuleNotFoundError:
        return {}
    return found
