"""What stands on the work sheet of one nest, in words and numbers."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.shown import shown
from kerfwise.jobs.given import Given, Tell, differences, program_text, silent
from kerfwise.jobs.times import Times, time_made
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.as_written import held_to_plan
from kerfwise.postproc.verdict.checking import check_plan, check_program
from kerfwise.postproc.verdict.dialect_read_back import trusted_dialect
from kerfwise.rules.profile.profile import Profile


@dataclass(frozen=True, eq=False, slots=True)
class WorkSheet:
    """One nest with its plan, as the operator has it on paper.

    Attributes
    ----------
    nest, profile
        The nest as the profile has it cut, and the profile.
    plan
        Of the nest; it passed the check.
    times
        What it takes, and costs.
    program, program_name
        The text of the NC program, and the name of its file.
    about
        More to say at the top, such as an order and when it is due: names and values.
    changed
        What is not as it was when the plan was made, a sentence each: the settings above may be others than its own.
    """

    nest: Nest
    profile: Profile
    plan: Plan
    times: Times
    program: str
    program_name: str
    about: Mapping[str, str] = field(default_factory=dict)
    changed: tuple[str, ...] = ()

    @property
    def program_sha256(self) -> str:
        """The hash of the program's file, as `sha256sum` says it."""
        return hashlib.sha256(self.program.encode("utf-8")).hexdigest()

    @property
    def not_kept(self) -> tuple[str, ...]:
        """What the plan does not keep of its rules, a sentence each: excuses, breaches, dropped and relaxed orders."""
        return tuple(_not_kept(self.plan))


def work_sheet(
    given: Given,
    plan: Plan,
    program: str | Path | None = None,
    *,
    name: str = "",
    about: Mapping[str, str] | None = None,
    tell: Tell = silent,
) -> WorkSheet:
    """The work sheet of a plan.

    Parameters
    ----------
    given
        Nest and profile.
    plan
        The plan of the nest.
    program
        The file of its NC program; where none is given, the program is written anew from the plan, as `solve` does.
    name
        What the program's file is called, where no file is given; else it is named after the nest.
    about
        More to say at the top.
    tell
        Told what is not as it was when the plan was made; it stands on the sheet, too.

    Raises
    ------
    InputError
        If the plan or the program is of another nest, or the program cannot be read.
    RulesConflict
        If the check refuses the plan, or the program does not follow it: nobody should cut by such a sheet.
    """
    trusted_dialect(given.profile)
    changed = tuple(differences(plan, given))
    for text in changed:
        tell(text)
    times = time_made(given, plan)  # refuses the plan of another nest
    verdict = check_plan(given.nest, plan, given.profile)
    if not verdict.ok:
        raise RulesConflict(f"the check refuses the plan: {', '.join(verdict.broken())}; no work sheet is made")
    if program is None:
        text = write_program(plan, given.nest, given.profile)
        file = name or f"{Path(given.nest.file or 'nest').stem}.nc"
    else:
        text, file = program_text(program), Path(program).name
        followed = check_program(given.nest, text, given.profile, str(program), plan)
        followed = held_to_plan(followed, given.nest, text, plan, given.profile)
        if not followed.ok:
            wrong = ", ".join(followed.broken())
            raise RulesConflict(f"{program}: the program does not follow the plan, or breaks rules: {wrong}")
    return WorkSheet(given.nest, given.profile, plan, times, text, shown(file), about or {}, changed)


def _not_kept(plan: Plan) -> Iterator[str]:
    for rule in plan.rules:
        for contours, why in rule.exceptions:
            yield f"excused, {rule.id}: {', '.join(contours)}: {why}"
    for dropped in plan.dropped:
        named = f" ({' before '.join(dropped.contours)})" if dropped.contours else ""
        yield f"{'RELAXED' if dropped.relaxed else 'dropped'}, {dropped.rule}{named}: {dropped.why}"
    for rule in plan.rules:
        if rule.breaches:
            first = rule.breaches[0][1]
            more = f" (and {len(rule.breaches) - 1} more)" if len(rule.breaches) > 1 else ""
            yield f"soft rule {rule.id} is broken: {first}{more}"
