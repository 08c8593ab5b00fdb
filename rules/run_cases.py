"""The cases of rules: found, and run."""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Iterator
from dataclasses import dataclass
from typing import get_args

from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.suggest import unknown

from . import cases as folder
from .case import Case, CaseKind
from .registry import RULES


@dataclass(frozen=True, slots=True)
class Outcome:
    """How one case went; `wrong` is empty where it went as it says."""

    rule: str
    case: str
    wrong: tuple[str, ...] = ()


def cases_of(rule: str) -> tuple[Case, ...]:
    """The cases of a rule, tiny nests with cuts and what is wrong with them.

    Raises
    ------
    InputError
        If there is no such rule, or the rule has no file of cases.

    Examples
    --------
    >>> cases_of("hull-before")[0].kind
    'passes'
    """
    if rule not in RULES:
        raise InputError(unknown("rule", rule, RULES))
    name = rule.replace("-", "_")
    module = f"{folder.__name__}.{name}"
    if importlib.util.find_spec(module) is None:
        raise InputError(f"rule {rule} has no cases: expected the file rules/cases/{name}.py")
    cases: tuple[Case, ...] = importlib.import_module(module).CASES
    return cases


def run_cases(rule: str) -> Iterator[Outcome]:
    """Judge every case of a rule and compare to the letter; a rule without a case of each kind is wrong too."""
    cases = cases_of(rule)
    missing = [kind for kind in get_args(CaseKind) if all(case.kind != kind for case in cases)]
    if missing:
        yield Outcome(rule, "all", (f"there is no case of kind {', '.join(missing)}",))
    for case in cases:
        found = tuple(RULES[rule].violations(case.nest, case.cuts, case.options or RULES[rule].Options()))
        if found == case.violations:
            yield Outcome(rule, case.name)
            continue
        lines = [f"expected: {v}" for v in case.violations if v not in found]
        lines += [f"found:    {v}" for v in found if v not in case.violations]
        yield Outcome(rule, case.name, tuple(lines) or ("the same violations, in another order",))
