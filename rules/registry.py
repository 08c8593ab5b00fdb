"""Every rule there is: one folder of `catalogue/` each, found without being listed anywhere."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Iterable, Mapping
from types import ModuleType
from typing import Any

from . import catalogue
from .rule import Rule


def collect(modules: Iterable[ModuleType]) -> dict[str, Rule[Any]]:
    """Rule id → rule, for every concrete rule class that these modules define, sorted by id.

    Raises ValueError if two rules claim the same id: a mistake of the rule's author.
    """
    rules: dict[str, Rule[Any]] = {}
    for module in modules:
        for _, cls in inspect.getmembers(module, inspect.isclass):
            if not issubclass(cls, Rule) or inspect.isabstract(cls) or cls.__module__ != module.__name__:
                continue
            if cls.id in rules:
                raise ValueError(
                    f"two rules have the id {cls.id!r}: {type(rules[cls.id]).__module__}, {cls.__module__}"
                )
            rules[cls.id] = cls()
    return dict(sorted(rules.items()))


def catalogue_modules() -> list[ModuleType]:
    """The rules' packages in `catalogue/`, by name."""
    names = sorted(m.name for m in pkgutil.iter_modules(catalogue.__path__))
    return [importlib.import_module(f"{catalogue.__name__}.{name}") for name in names]


RULES: Mapping[str, Rule[Any]] = collect(catalogue_modules())
