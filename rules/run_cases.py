"""The cases of rules, found and run."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, get_args

from kerfwise.encoder.errors import InputError, exception_text, file_of, rule_of
from kerfwise.encoder.nearest_name import unknown
from kerfwise.rules.flat.model_rule import ModelRule

from .case import Case, CaseKind
from .case_file import model_cases, read_cases
from .registry import RULES
from .rule import Rule


def cases_of(rule: str, known: Mapping[str, Rule[Any]] = RULES) -> tuple[Case, ...]:
    """The cases of a rule, tiny nests with cuts and what is wrong with them; `known` are the rules that there are.

    Those of a rule from outside are `CASES` in its own module: a tuple, or where there are several rules, by rule id.
    Raises InputError if there is no such rule, or the rule has no cases.

    Examples
    --------
    >>> cases_of("hull-before")[0].kind
    'passes'
    """
    if rule not in known:
        raise InputError(unknown("rule", rule, known))
    if isinstance(own_cases := known[rule], ModelRule):
        return model_cases(own_cases, own_cases.file.path)
    if own_cases.brought:
        return _beside(own_cases)
    return _shipped(known[rule])


@cache
def _shipped(rule: Rule[Any]) -> tuple[Case, ...]:
    return read_cases(Path(file_of(type(rule))).with_name("cases.yaml"), rule)


def error_line(error: Exception) -> str:
    """What a rule has raised, in one line, with the place in its file."""
    if isinstance(error, InputError):
        return str(error)
    at_work = rule_of(error)
    return f"{exception_text(error)}{f', in rule {at_work}' if at_work else ''}"


def _run_model_cases(rule: Rule[Any], cases: Sequence[Case]) -> Iterator[CaseOutcome]:
    """Judge every order of a model file's cases: those that are right, and those that are wrong."""
    for kind, word in (("passes", "right"), ("fails", "wrong")):
        if all(case.kind != kind for case in cases):
            yield CaseOutcome(rule.id, "all", (f"there is no order under {word}",))
    for case in cases:
        try:
            yield CaseOutcome(rule.id, case.name, tuple(_wrong_in(rule, case)))
        except Exception as error:
            yield CaseOutcome(rule.id, case.name, (error_line(error),))


def _wrong_in(rule: Rule[Any], case: Case) -> Iterator[str]:
    options = case.options or rule.Options()
    if (why := rule.unjudged(case.nest, case.cuts, options)) is not None:
        yield f"it cannot be judged: {why}"
        return
    found = rule.violations(case.nest, case.cuts, options)
    if case.kind == "passes":
        yield from (f"it should be right, but: {v.text}" for v in found)
    elif not found:
        yield "it should be wrong, and the rule finds nothing"


def _beside(rule: Rule[Any]) -> tuple[Case, ...]:
    """The cases in the module of a rule from outside."""
    cls = type(rule)
    found = getattr(sys.modules[cls.__module__], "CASES", None)
    cases = found.get(rule.id) if isinstance(found, Mapping) else found
    if not isinstance(cases, Sequence) or not all(isinstance(case, Case) for case in cases):
        raise InputError(
            f"rule {rule.id} has no cases: expected CASES = (Case(…), …) in its file, or CASES = {{'{rule.id}': (…)}} "
            "where there are several rules",
            file=file_of(cls) or None,
        )
    return tuple(cases)


def run_cases(rule: str, known: Mapping[str, Rule[Any]] = RULES) -> Iterator[CaseOutcome]:
    """Judge every case of a rule and compare to the letter; a rule without a case of each kind is wrong too."""
    cases = cases_of(rule, known)
    if isinstance(known[rule], ModelRule):
        yield from _run_model_cases(known[rule], cases)
        return
    missing = [kind for kind in get_args(CaseKind) if all(case.kind != kind for case in cases)]
    if missing:
        yield CaseOutcome(rule, "all", (f"there is no case of kind {', '.join(missing)}",))
    for case in cases:
        try:
            found = tuple(known[rule].violations(case.nest, case.cuts, case.options or known[rule].Options()))
        except Exception as error:
            yield CaseOutcome(rule, case.name, (error_line(error),))
            continue
        if found == case.violations:
            yield CaseOutcome(rule, case.name)
            continue
        lines = [f"expected: {v}" for v in case.violations if v not in found]
        lines += [f"found:    {v}" for v in found if v not in case.violations]
        yield CaseOutcome(rule, case.name, tuple(lines) or ("the same violations, in another order",))


# How one thing that was tried of a rule went.


@dataclass(frozen=True, slots=True)
class CaseOutcome:
    """What was tried of a rule: a case, by its name, or something else; `wrong` is empty where it went as it should.

    `note` says what could not be tried, where that is no fault of the rule's.
    """

    rule: str
    case: str
    wrong: tuple[str, ...] = ()
    is_case: bool = True
    note: str = ""
