"""Rules made of the classes that a module from outside defines, and what they give back, looked over."""

from __future__ import annotations

import dataclasses
import inspect
import re
from collections.abc import Callable, Iterable, Iterator
from functools import wraps
from types import ModuleType
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from kerfwise.encoder.errors import KerfwiseError, RuleFault, brought_by, exception_text, file_of, rule_hook
from kerfwise.encoder.nest import Nest
from kerfwise.rules.options.kind import OptionKind
from kerfwise.rules.options.option import options_of
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import NoGoodIds, Plant, Rule, Strength, TemperatureLimit, Violation
from kerfwise.rules.statements import About, Statement, candidates_named, contours_named

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts


KEYS_OF_A_RULE = ("strength", "weight")
"""What a profile says of every rule: no option may have such a key."""
ONE_IN_THE_HOUSE = ("of_fallen_metal", "makes_zones", "guards_metal")
"""Marks of single rules of the catalogue that other stages look for."""


def rules_of(module: ModuleType, brought: str) -> list[Rule[Any]]:
    """The rules that a module defines itself, in the order of their ids.

    Raises RuleFault if it defines none, or one that cannot be used: with its file and line, and what is wrong.
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

    Raises RuleFault if it cannot be used: with the class's file and line, and what is wrong.
    """
    try:
        wrong = next(_faults(cls), None)
        rule = None if wrong else cls()
    except KerfwiseError:
        raise
    except (Exception, SystemExit) as error:
        raise _wrong(cls, f"{brought}: rule class {cls.__name__} cannot be used: {exception_text(error)}") from error
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


# What a rule from outside gives back, looked at as it comes out: a mistake is told with the rule's file and line.

KINDS = get_args(Statement)


class _Unfit(Exception):
    """What is wrong with what a hook gave."""


def guard(rule: Rule[Any]) -> Rule[Any]:
    """The rule itself, with what its hooks give looked at."""
    for name, look in _LOOKS.items():
        setattr(rule, name, _guarded(rule, name, getattr(rule, name), look))
    return rule


def _guarded(rule: Rule[Any], name: str, hook: Callable[..., Any], look: Callable[..., Any]) -> Callable[..., Any]:
    """A hook whose numbers must be numbers: what is too large, or divided by 0, would decide without a word."""

    @wraps(hook)
    def guarded(*given: Any) -> Any:
        with rule_hook(rule, name), np.errstate(over="raise", divide="raise", invalid="raise"):
            try:
                return look(rule, hook(*given), *given)
            except _Unfit as unfit:
                raise _fault(rule, name, unfit) from None

    return guarded


def _fault(rule: Rule[Any], name: str, unfit: _Unfit) -> RuleFault:
    hook = getattr(type(rule), name)
    code = inspect.unwrap(hook).__code__
    file = file_of(type(rule))
    line = code.co_firstlineno if code.co_filename == file else None
    return RuleFault(f"rule {rule.id}{brought_by(rule.brought)}: {name}() {unfit}", file=file or None, line=line)


def _statements(rule: Rule[Any], value: Any, facts: Facts, options: Any) -> list[Statement]:
    if not isinstance(value, Iterable):
        raise _Unfit(f"gives {value!r}, expected statements")
    statements = list(value)
    for s in statements:
        if not isinstance(s, KINDS):
            raise _Unfit(f"gives {s!r}, expected a statement such as Precede")
        if not isinstance(s.about, About) or s.about.rule != rule.id:
            raise _Unfit(f"gives a statement whose about is {s.about!r}, expected self.about((…), 'a sentence')")
        for number in contours_named(s):
            if not 0 <= number < facts.n:
                raise _Unfit(f"names contour number {number}; this nest has 0 to {facts.n - 1}")
        for number in candidates_named(s):
            if not 0 <= number < len(facts.candidates):
                raise _Unfit(f"names candidate number {number}; this nest has 0 to {len(facts.candidates) - 1}")
    return statements


def _violations(rule: Rule[Any], value: Any, nest: Nest, cuts: Any, options: Any) -> list[Violation]:
    found = _each(value, Violation, "a list of Violation")
    for v in found:
        if v.rule != rule.id:
            raise _Unfit(f"gives a violation of rule {v.rule!r}, expected self.id")
        _known(nest, v.contours)
        if any(not isinstance(k, int) or not 1 <= k <= len(cuts) for k in v.cuts):
            raise _Unfit(f"gives positions {v.cuts!r}; there are cuts 1 to {len(cuts)}")
    return found


def _pairs(rule: Rule[Any], value: Any, nest: Nest, cuts: Any, options: Any) -> list[tuple[str, str]]:
    pairs = _each(value, tuple, "a list of pairs of contour ids")
    for pair in pairs:
        if len(pair) != 2:
            raise _Unfit(f"gives {pair!r}, expected a pair of contour ids (before, after)")
        _known(nest, pair)
    return pairs


def _together(rule: Rule[Any], value: Any, nest: Nest, options: Any) -> list[tuple[str, ...]]:
    runs = _each(value, tuple, "a list of tuples of contour ids")
    for run in runs:
        _known(nest, run)
    return runs


def _no_goods(rule: Rule[Any], value: Any, nest: Nest, order: Any, options: Any) -> list[NoGoodIds]:
    found = _each(value, NoGoodIds, "a list of NoGoodIds")
    for no_good in found:
        _known(nest, (*no_good.out, *no_good.left))
    return found


def _known(nest: Nest, names: Iterable[str]) -> None:
    for name in names:
        if name not in nest.index:
            raise _Unfit(f"names {name!r}, which is no contour of this nest")


def _each(value: Any, kind: type, expected: str) -> list[Any]:
    if not isinstance(value, Iterable) or isinstance(value, str):
        raise _Unfit(f"gives {value!r}, expected {expected}")
    found = list(value)
    for one in found:
        if not isinstance(one, kind):
            raise _Unfit(f"gives {one!r}, expected {expected}")
    return found


def _exempt(rule: Rule[Any], value: Any, facts: Any, options: Any) -> list[About]:
    return _each(value, About, "self.about(…) of each contour")


def _text(rule: Rule[Any], value: Any, *asked: Any) -> str | None:
    if value is not None and not isinstance(value, str):
        raise _Unfit(f"gives {value!r}, expected a sentence or None")
    return value


def _same_kind(rule: Rule[Any], value: Any, before: Any, *asked: Any) -> Any:
    if type(value) is not type(before):
        raise _Unfit(f"gives {value!r}, expected {type(before).__name__}: what was given, or dataclasses.replace of it")
    return value


def _limit(rule: Rule[Any], value: Any, *asked: Any) -> TemperatureLimit | None:
    if value is not None and not isinstance(value, TemperatureLimit):
        raise _Unfit(f"gives {value!r}, expected a TemperatureLimit or None")
    return value


def _said(rule: Rule[Any], value: Any, *asked: Any) -> list[tuple[str, str]]:
    found = _each(value, tuple, "pairs of an option's key and a sentence")
    for pair in found:
        if len(pair) != 2 or not all(isinstance(text, str) for text in pair):
            raise _Unfit(f"gives {pair!r}, expected an option's key and a sentence")
    return found


_LOOKS: dict[str, Callable[..., Any]] = {
    "statements": _statements,
    "violations": _violations,
    "pairs": _pairs,
    "together": _together,
    "no_goods": _no_goods,
    "exempt": _exempt,
    "unjudged": _text,
    "excuse": _text,
    "fact_options": _same_kind,
    "lead_options": _same_kind,
    "temperature_limit": _limit,
    "check_with": _said,
}
"""Hook → what looks at what it gives; it is handed the rule, what the hook gave, and what the hook was asked with."""


# Names that rules may have.

RESERVED = ("new", "page", "test")
"""Verbs of `kerfwise rules`."""


def wrong_name(name: object) -> str | None:
    """What is wrong with a rule's name; None where nothing is.

    Examples
    --------
    >>> wrong_name("long-parts-last")
    >>> wrong_name("Long parts")
    "'Long parts' is not a name of a rule: expected small letters and digits such as long-parts-last"
    """
    if not isinstance(name, str) or not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", name):
        return f"{name!r} is not a name of a rule: expected small letters and digits such as long-parts-last"
    if name in RESERVED:
        return f"a rule cannot be called {name!r}: `kerfwise rules {name}` means something else"
    return None
