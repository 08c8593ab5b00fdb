"""A plan or a program judged by every rule, independently of whatever made it."""

from __future__ import annotations

from pathlib import Path

from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.reader import read_plan
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.verdict.checking import check_plan, check_program
from kerfwise.postproc.verdict.dialect_read_back import trusted_dialect

from .given import Given, Tell, differences, is_plan_file, program_text, silent


def check_made(given: Given, made: Plan | str | Path, tell: Tell = silent) -> CheckResult:
    """The verdict on a plan, or on the plan or NC program in a file.

    Raises
    ------
    InputError
        If the file cannot be read or understood, or the dialect does not fit the profile.
    """
    trusted_dialect(given.profile)  # a plan is worth nothing on a machine whose programs would not run
    if not isinstance(made, Plan) and not is_plan_file(made):
        return check_program(given.nest, program_text(made), given.profile, str(made))
    plan = made if isinstance(made, Plan) else read_plan(made)
    for text in differences(plan, given):
        tell(text)
    return check_plan(given.nest, plan, given.profile)
