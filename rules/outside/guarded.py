"""What a rule from outside gives back, looked at as it comes out: a mistake is told with the rule's file and line."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from functools import wraps
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from kerfwise.encoder.faults import RuleFault, at_work, by, file_of
from kerfwise.encoder.nest import Nest
from kerfwise.rules.named import candidates_named, contours_named
from kerfwise.rules.rule import NoGoodIds, Rule, Violation
from kerfwise.rules.statements import (
    About,
    Statement,
)
from kerfwise.rules.temperature_limit import TemperatureLimit

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts

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
        with at_work(rule, name), np.errstate(over="raise", divide="raise", invalid="raise"):
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
    return RuleFault(f"rule {rule.id}{by(rule.brought)}: {name}() {unfit}", file=file or None, line=line)


def _statements(rule: Rule[Any], given: Any, facts: Facts, options: Any) -> list[Statement]:
    if not isinstance(given, Iterable):
        raise _Unfit(f"gives {given!r}, expected statements")
    statements = list(given)
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


def _violations(rule: Rule[Any], given: Any, nest: Nest, cuts: Any, options: Any) -> list[Violation]:
    found = _each(given, Violation, "a list of Violation")
    for v in found:
        if v.rule != rule.id:
            raise _Unfit(f"gives a violation of rule {v.rule!r}, expected self.id")
        _known(nest, v.contours)
        if any(not isinstance(k, int) or not 1 <= k <= len(cuts) for k in v.cuts):
            raise _Unfit(f"gives positions {v.cuts!r}; there are cuts 1 to {len(cuts)}")
    return found


def _pairs(rule: Rule[Any], given: Any, nest: Nest, cuts: Any, options: Any) -> list[tuple[str, str]]:
    pairs = _each(given, tuple, "a list of pairs of contour ids")
    for pair in pairs:
        if len(pair) != 2:
            raise _Unfit(f"gives {pair!r}, expected a pair of contour ids (before, after)")
        _known(nest, pair)
    return pairs


def _together(rule: Rule[Any], given: Any, nest: Nest, options: Any) -> list[tuple[str, ...]]:
    runs = _each(given, tuple, "a list of tuples of contour ids")
    for run in runs:
        _known(nest, run)
    return runs


def _no_goods(rule: Rule[Any], given: Any, nest: Nest, order: Any, options: Any) -> list[NoGoodIds]:
    found = _each(given, NoGoodIds, "a list of NoGoodIds")
    for no_good in found:
        _known(nest, (*no_good.out, *no_good.left))
    return found


def _known(nest: Nest, names: Iterable[str]) -> None:
    for name in names:
        if name not in nest.index:
            raise _Unfit(f"names {name!r}, which is no contour of this nest")


def _each(given: Any, kind: type, expected: str) -> list[Any]:
    if not isinstance(given, Iterable) or isinstance(given, str):
        raise _Unfit(f"gives {given!r}, expected {expected}")
    found = list(given)
    for one in found:
        if not isinstance(one, kind):
            raise _Unfit(f"gives {one!r}, expected {expected}")
    return found


def _exempt(rule: Rule[Any], given: Any, facts: Any, options: Any) -> list[About]:
    return _each(given, About, "self.about(…) of each contour")


def _text(rule: Rule[Any], given: Any, *asked: Any) -> str | None:
    if given is not None and not isinstance(given, str):
        raise _Unfit(f"gives {given!r}, expected a sentence or None")
    return given


def _same_kind(rule: Rule[Any], given: Any, before: Any, *asked: Any) -> Any:
    if type(given) is not type(before):
        raise _Unfit(f"gives {given!r}, expected {type(before).__name__}: what was given, or dataclasses.replace of it")
    return given


def _limit(rule: Rule[Any], given: Any, *asked: Any) -> TemperatureLimit | None:
    if given is not None and not isinstance(given, TemperatureLimit):
        raise _Unfit(f"gives {given!r}, expected a TemperatureLimit or None")
    return given


def _said(rule: Rule[Any], given: Any, *asked: Any) -> list[tuple[str, str]]:
    found = _each(given, tuple, "pairs of an option's key and a sentence")
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
