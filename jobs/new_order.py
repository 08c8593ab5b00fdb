"""Burns in a new order: read back, each as it was, and held against the old order; or the old order, which stays."""

from __future__ import annotations

from collections.abc import Sequence

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.reader.on_machine import moved, old_on_machine
from kerfwise.postproc.check.reader.program import NcProgram
from kerfwise.postproc.old.pieces import TakenApart
from kerfwise.postproc.old.reordered import expect_same
from kerfwise.rules.profile.profile import Profile

from .listening import Listener
from .old_program import OldJob
from .resequenced import Measured, Resequenced

SLACK_MM = 0.01
"""Idle travel that is not worth another order."""


def stays(job: OldJob, before: Measured, nest: Nest | None, proven: bool, ends: str, listener: Listener) -> Resequenced:
    """The old program as it is."""
    text, ended = job.old.text, listener.interrupted
    return Resequenced(job.name, "keep", text, before, before, nest, None, proven, ends, job.notes, job.home, ended)


def broken_more(one: CheckResult | None, other: CheckResult | None) -> list[str]:
    """Hard rules that one order breaks oftener than another does, excuses counted: what none can keep is no fault."""
    if one is None or other is None:
        return []
    least = {judgement.id: len(judgement.violations) + len(judgement.excused) for judgement in other.rules}
    return [
        judgement.id
        for judgement in one.rules
        if judgement.strength == "hard" and len(judgement.violations) > least.get(judgement.id, 0)
    ]


def no_better(before: Measured, after: Measured, profile: Profile) -> str:
    """Before and after in words, where contours planned afresh gain nothing; else "".

    It is idle travel that counts. Where the pierces are others, or the profile lets cuts be linked or shared, the time
    of all does, at the profile's speeds.
    """
    machine = profile.machine
    in_time = profile.link_options() is not None or profile.common_options() is not None

    def cost_mm(of: Measured) -> float:
        if not in_time and before.pierces == after.pierces:
            return of.idle_mm
        burning_s = of.pierces * machine.pierce_time_s + of.cut_mm / machine.cut_feed_mm_s
        return of.idle_mm + burning_s * machine.travel_mm_s

    if cost_mm(after) < cost_mm(before) - SLACK_MM:
        return ""
    figures = (f"{of.idle_mm / 1000:.3f} m of idle travel and {of.pierces} pierces" for of in (before, after))
    return "before {}, after {}".format(*figures)


def read_back(text: str, job: OldJob, apart: TakenApart, order: Sequence[int]) -> NcProgram:
    """The new program in the coordinates of the drawing, with every burn as it was.

    Raises
    ------
    InputError
        If it cannot be read back, or if a burn is not what it was.
    """
    try:
        written = old_on_machine(text, job.profile, job.trusted)
    except InputError as error:
        line = text.split("\n")[error.line - 1] if error.line else ""
        raise InputError(
            f"the burns in their new order cannot be read back ({line!r}: {error.message}); nothing is written",
            file=job.name,
        ) from None
    expect_same(apart, order, written)
    return moved(written.program, job.program.zero or (0.0, 0.0))
