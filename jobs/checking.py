"""A plan or a program judged by every rule, independently of whatever made it."""

from __future__ import annotations

from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.reader import read_plan
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.reader.old import Trusted
from kerfwise.postproc.verdict.as_written import held_to_plan
from kerfwise.postproc.verdict.checking import check_plan, check_program
from kerfwise.postproc.verdict.dialect_read_back import trusted_dialect

from .given import Given, Tell, differences, is_plan_file, program_text, silent
from .old_program import OldJob


def check_made(
    given: Given,
    made: Plan | str | Path,
    tell: Tell = silent,
    plan: Plan | str | Path | None = None,
    trusted: Trusted | None = None,
) -> CheckResult:
    """The verdict on a plan, or on the plan or NC program in a file.

    With `plan`, a program has to follow that plan too, which says what the program's own comments do not. What it
    leaves to the machine's material is refused, unless that is `trusted`.

    Raises
    ------
    InputError
        If the file cannot be read or understood, or the dialect does not fit the profile.
    """
    trusted_dialect(given.profile)  # a plan is worth nothing on a machine whose programs would not run
    if not isinstance(made, Plan) and not is_plan_file(made):
        followed = read_plan(plan) if isinstance(plan, str | Path) else plan
        for text in differences(followed, given) if followed is not None else ():
            tell(text)
        text = program_text(made)
        result = check_program(given.nest, text, given.profile, str(made), followed, trusted=trusted)
        if followed is None or trusted is not None:
            return result
        return held_to_plan(result, given.nest, text, followed, given.profile)
    if plan is not None:
        raise InputError("a plan is held against no other plan: expected an NC program, with the plan it was made from")
    judged = made if isinstance(made, Plan) else read_plan(made)
    for text in differences(judged, given):
        tell(text)
    return check_plan(given.nest, judged, given.profile)


def check_old(job: OldJob) -> CheckResult:
    """The verdict on an old program, on the nest that is told from its burns.

    Raises
    ------
    InputError
        If they make no nest.
    """
    return check_program(job.nest, job.text, job.profile, job.name, trusted=job.trusted)
