"""Which plans of a trial a rule's text in MiniZinc admits: its solver lists all plans and judges each."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

from kerfwise.jobs.solve_options import options_for
from kerfwise.models.engines.minizinc.asked import AskedArray, arrays_of, asked
from kerfwise.models.engines.minizinc.data import data_text
from kerfwise.models.engines.minizinc.engine import clear_errors
from kerfwise.models.engines.minizinc.installation import driver, solver_named
from kerfwise.models.engines.minizinc.model_text import model_text
from kerfwise.rules.flat.model_rule import ModelRule
from kerfwise.rules.minizinc.twin import rule_file
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule
from kerfwise.rules.statements import EXEMPTION_MM, About, IdleTravel
from kerfwise.rules.stating.state_rules import Stated

from .trial import PlanOf, Trial


def text_of(rule: Rule[Any]) -> Path | None:
    """The file that states the rule in MiniZinc; None where there is none."""
    if isinstance(rule, ModelRule):
        return rule.file.path
    file = rule_file(rule.id)
    return file if rule.id in RULES and not rule.brought and file.exists() else None


def admitted_by_text(trial: Trial) -> frozenset[PlanOf]:
    """The plans in which every element of the rule's arrays is true.

    Raises
    ------
    InputError
        If MiniZinc is not installed, or finds a mistake in the file: with its line.
    """
    from minizinc import Instance
    from minizinc.error import MiniZincWarning

    own = arrays_of(trial.rule, trial.profile.settings()[trial.rule.id])
    arrays = [array for array in own if array.weight_mm in (None, EXEMPTION_MM)]  # others have a price of their own
    stated = Stated((IdleTravel(About("trial", (), "")),), ())
    limits = options_for(trial.nest, trial.profile)
    goal = [
        f"array[1..{len(arrays)}] of var bool: verdict :: add_to_output;",
        *(f"constraint verdict[{k}] = {_holds(array)};" for k, array in enumerate(arrays, 1)),
        "solve satisfy;",
    ]
    # None is asked, all are judged; the data is that of every rule that is on.
    every = [replace(array, weight_mm=0.0) for array in asked(trial.profile, stated)]
    clock = any(array.most_ms for array in every)
    with clear_errors(), warnings.catch_warnings():
        warnings.simplefilter("ignore", MiniZincWarning)
        instance = Instance(solver_named("gecode"), driver=driver())
        instance.add_string(
            model_text(every, "\n".join(goal)) + data_text(trial.facts, trial.profile, stated, limits, clock=clock)
        )
        solutions = instance.solve(all_solutions=True).solution
    return frozenset(tuple(c - 1 for c in one.stop if c > 0) for one in solutions if all(one.verdict))


def _holds(array: AskedArray) -> str:
    return f"forall(ms in {array.name})(ms = 0)" if array.most_ms else f"forall({array.name})"
