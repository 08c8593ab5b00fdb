"""The cases of rules, which live with the tests of a source checkout: found, and run."""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from ..encoder.errors import InputError
from ..rules.registry import RULES
from ..rules.suggest import unknown

KINDS = ("passes", "fails", "boundary")


@dataclass(frozen=True, slots=True)
class Outcome:
    """How one case went; `wrong` is empty where it went as it says."""

    rule: str
    case: str
    wrong: tuple[str, ...] = ()


def cases_of(rule: str) -> tuple[Any, ...]:
    """The cases of a rule, tiny nests with cuts and what is wrong with them.

    Raises
    ------
    InputError
        If there is no such rule, no tests are installed beside the package, or the rule has no file of cases.
    """
    if rule not in RULES:
        raise InputError(unknown("rule", rule, RULES))
    package = f"{__package__.split('.')[0]}.tests.rules"
    name = rule.replace("-", "_")
    try:
        found = importlib.util.find_spec(f"{package}.case")
    except ModuleNotFoundError:
        found = None
    if found is None:
        raise InputError("the cases of rules are not installed beside kerfwise: install it anew, or run a checkout")
    if importlib.util.find_spec(f"{package}.cases.{name}") is None:
        raise InputError(f"rule {rule} has no cases: expected the file tests/rules/cases/{name}.py")
    cases: tuple[Any, ...] = importlib.import_module(f"{package}.cases.{name}").CASES
    return cases


def run_cases(rule: str) -> Iterator[Outcome]:
    """Judge every case of a rule and compare to the letter; a rule without a case of each kind is wrong too."""
    cases = cases_of(rule)
    missing = [kind for kind in KINDS if all(case.kind != kind for case in cases)]
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
