"""Rules made of the classes that a module from outside defines, each looked over before it is used."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Iterator
from types import ModuleType
from typing import Any, get_args

from kerfwise.encoder.errors import KerfwiseError
from kerfwise.encoder.faults import RuleFault, file_of, said
from kerfwise.rules.options.kind import OptionKind
from kerfwise.rules.options.option import options_of
from kerfwise.rules.plant import Plant
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule, Strength

from .guarded import guard
from .names import wrong_name

KEYS_OF_A_RULE = ("strength", "weight")
"""What a profile says of every rule: no option may have such a key."""
ONE_IN_THE_HOUSE = ("of_fallen_metal", "makes_zones", "guards_metal")
"""Marks of single rules of the catalogue that other stages look for."""


def rules_of(module: ModuleType, brought: str) -> list[Rule[Any]]:
    """The rules that a module defines itself, in the order of their ids.

    Raises
    ------
    RuleFault
        If it defines none, or one that cannot be used: with its file and line, and what is wrong.
    """
    classes = [cls for _, cls in inspect.getmembers(module, inspect.isclass) if issubclass(cls, Rule)]
    own = [cls for cls in classes if cls.__module__ == module.__name__ and hasattr(cls, "id")]
    if not own:
        raise RuleFault(
            f"{brought} defines no rule: expected a class such as `class MyRule(OrderRule[NoOptions])` with an `id`",
            file=module.__file__,
        )
    rules = [rule_of_class(cls, brought) for cls in own]
    taken: dict[str, str] = {}
    for rule in rules:
        if rule.id in taken:
            raise _wrong(type(rule), f"{brought}: two rules are called {rule.id!r}: {taken[rule.id]} and this one")
        taken[rule.id] = type(rule).__name__
    return sorted(rules, key=lambda rule: rule.id)


def rule_of_class(cls: type[Rule[Any]], brought: str) -> Rule[Any]:
    """The rule that a class makes, with its hooks guarded.

    Raises
    ------
    RuleFault
        If it cannot be used: with the class's file and line, and what is wrong.
    """
    try:
        wrong = next(_faults(cls), None)
        rule = None if wrong else cls()
    except KerfwiseError:
        raise
    except (Exception, SystemExit) as error:
        raise _wrong(cls, f"{brought}: rule class {cls.__name__} cannot be used: {said(error)}") from error
    if rule is None:
        raise _wrong(cls, f"{brought}: rule class {cls.__name__}: {wrong}")
    rule.brought = brought
    return guard(rule)


def _wrong(cls: type, message: str) -> RuleFault:
    try:
        line = inspect.getsourcelines(cls)[1]
    except (OSError, TypeError):
        line = None
    return RuleFault(message, file=file_of(cls) or None, line=line)


def _faults(cls: type[Rule[Any]]) -> Iterator[str]:
    """What is wrong with a rule's class, the most telling first."""
    if missing := sorted(getattr(cls, "__abstractmethods__", ())):
        yield f"{', '.join(f'{name}()' for name in missing)} is missing"
    if wrong := wrong_name(getattr(cls, "id", None)):
        yield f"id: {wrong}"
    for name in ("sentence", "source"):
        if not isinstance(text := getattr(cls, name, None), str) or not text.strip():
            yield f"{name} is missing: expected a text"
    strengths = get_args(Strength)
    if not cls.strengths or not set(cls.strengths) <= set(strengths):
        yield f"strengths: expected some of {', '.join(strengths)}, got {cls.strengths!r}"
    if cls.default not in cls.strengths:
        yield f"default: expected one of its strengths {', '.join(cls.strengths)}, got {cls.default!r}"
    if "off" not in cls.strengths:
        yield "strengths: a rule from outside can be switched off; add 'off'"
    for mark in ONE_IN_THE_HOUSE:
        if getattr(cls, mark):
            yield f"{mark}: only a rule of the catalogue can say this"
    yield from _options_faults(getattr(cls, "Options", None))


def _options_faults(options: Any) -> Iterator[str]:
    if not (isinstance(options, type) and dataclasses.is_dataclass(options)):
        yield "Options is missing: expected a frozen dataclass, or NoOptions"
        return
    known = {f.name for f in dataclasses.fields(Plant)} | {name for rule in RULES.values() for name in rule.shares}
    for field in dataclasses.fields(options):
        if field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING:
            yield f"Options.{field.name} has no default"
        if "kind" not in field.metadata and field.name not in known:
            yield (
                f"Options.{field.name} has no kind: write field(default=…, metadata=option(LENGTH, 'what it does')); "
                f"without one it is filled in by the profile, which knows {', '.join(sorted(known))}"
            )
        elif "kind" in field.metadata and not isinstance(field.metadata["kind"], OptionKind):
            yield f"Options.{field.name}: expected a kind such as LENGTH, got {field.metadata['kind']!r}"
    for option in options_of(options):
        if option.key in KEYS_OF_A_RULE:
            yield f"Options.{option.name}: a profile's key {option.key!r} means something else; choose another name"
        if not option.help:
            yield f"Options.{option.name} has no line of help"
    if options.__dataclass_params__.frozen is False:  # type: ignore[attr-defined]
        yield "Options is not frozen: write @dataclass(frozen=True)"
