"""Rules that installed packages bring, by entry points of the group `kerfwise.rules`."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from types import ModuleType
from typing import Any

from kerfwise.encoder.errors import KerfwiseError
from kerfwise.encoder.faults import RuleFault, said
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule

from .made import rule_of_class, rules_of

GROUP = "kerfwise.rules"


@cache
def installed_rules() -> Mapping[str, Rule[Any]]:
    """Rule id → rule, of every installed package that brings some, sorted by id. Found once, when first asked for.

    An entry point names a rule's class, or a module: all rules that it defines.

    Raises
    ------
    RuleFault
        If one cannot be loaded or used, or has the name of another rule: with the package.
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
            f"{brought} brings rules that cannot be loaded (entry point {point.name} = {point.value}): {said(error)}; "
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
