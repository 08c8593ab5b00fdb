"""The cases of rules: found, and run."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, get_args

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.faults import file_of
from kerfwise.rules.options.suggest import unknown

from . import cases as folder
from .case import Case, CaseKind
from .outcome import Outcome
from .registry import RULES
from .rule import Rule


def cases_of(rule: str, known: Mapping[str, Rule[Any]] = RULES) -> tuple[Case, ...]:
    """The cases of a rule, tiny nests with cuts and what is wrong with them; `known` are the rules that there are.

    Those of a rule from outside are `CASES` in its own module: a tuple, or where there are several rules, by rule id.

    Raises
    ------
    InputError
        If there is no such rule, or the rule has no cases.

    Examples
    --------
    >>> cases_of("hull-before")[0].kind
    'passes'
    """
    if rule not in known:
        raise InputError(unknown("rule", rule, known))
    if known[rule].brought:
        return _beside(known[rule])
    name = rule.replace("-", "_")
    module = f"{folder.__name__}.{name}"
    if importlib.util.find_spec(module) is None:
        raise InputError(f"rule {rule} has no cases: expected the file rules/cases/{name}.py")
    cases: tuple[Case, ...] = importlib.import_module(module).CASES
    return cases


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


def run_cases(rule: str, known: Mapping[str, Rule[Any]] = RULES) -> Iterator[Outcome]:
    """Judge every case of a rule and compare to the letter; a rule without a case of each kind is wrong too."""
    cases = cases_of(rule, known)
    missing = [kind for kind in get_args(CaseKind) if all(case.kind != kind for case in cases)]
    if missing:
        yield Outcome(rule, "all", (f"there is no case of kind {', '.join(missing)}",))
    for case in cases:
        found = tuple(known[rule].violations(case.nest, case.cuts, case.options or known[rule].Options()))
        if found == case.violations:
            yield Outcome(rule, case.name)
            continue
        lines = [f"expected: {v}" for v in case.violations if v not in found]
        lines += [f"found:    {v}" for v in found if v not in case.violations]
        yield Outcome(rule, case.name, tuple(lines) or ("the same violations, in another order",))
