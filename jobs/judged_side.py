"""From which side an old program that does not say so is taken to start: the one under which it keeps the rules."""

from __future__ import annotations

from dataclasses import replace

from kerfwise.encoder.cut import Side
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.sides import OPPOSITE
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.verdict.checking import check_program
from kerfwise.rules.profile.profile import Profile

from .given import Tell
from .old_program import OldJob


def judged_by_side(job: OldJob, nest: Nest, text: str, tell: Tell) -> tuple[OldJob, CheckResult]:
    """The job with the side that the old program starts from, and the verdict on `text` by it.

    What the program or the profile says holds. Else the side that the nest asks for does, but for a program that breaks
    hard rules from there and none from the opposite one: the job has that in its profile then, and says so in a note,
    for nearly even nests are decided by tenths of a millimetre.
    """
    side = compute_facts(nest, job.profile.fact_options(nest), ()).start_side
    verdict = _judged(job, nest, text, side)
    name = _left_open(job)
    if name is None or not verdict.broken():
        return job, verdict
    other = replace(job, profile=_from_side(job.profile, name, OPPOSITE[side]))
    opposite = _judged(other, nest, text, OPPOSITE[side])
    if opposite.broken():
        return job, verdict
    note = (
        f"the program does not say from which side cutting starts: both orders are judged from the {OPPOSITE[side]}, "
        f"from where the old one breaks no hard rule, as it does from the {side}; for a check of the new program, "
        f"give the profile rules: {{{name}: {{side: {OPPOSITE[side]}}}}}"
    )
    tell(note)
    return replace(other, notes=(*job.notes, note)), opposite


def _judged(job: OldJob, nest: Nest, text: str, side: Side) -> CheckResult:
    return check_program(nest, text, job.profile, job.name, trusted=job.trusted, side=side)


def _left_open(job: OldJob) -> str | None:
    """The rule that decides the side; None where the program or the profile says it, or nothing asks for one."""
    if any("START SIDE" in comment.upper() for comment in job.program.comments):
        return None
    for name, setting in job.profile.rules.items():
        if getattr(setting.options, "side", None) == "auto" and setting.strength != "off":
            return name
    return None


def _from_side(profile: Profile, name: str, side: Side) -> Profile:
    setting = profile.rules[name]
    fixed = replace(setting, options=replace(setting.options, side=side))
    return replace(profile, rules={**profile.rules, name: fixed})
