"""What --lock-from, --upto and --redo-last say: what a stopped program has cut, so that only the rest is planned."""

from __future__ import annotations

from dataclasses import replace

import click

from kerfwise.encoder.already_cut import NOTHING_CUT, AlreadyCut, rest_of
from kerfwise.encoder.errors import InputError
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.profile import Profile

from .given import Given, program_text


def already_cut(given: Given, lock_from: str | None, upto: int | None, redo_last: bool) -> AlreadyCut:
    """What is cut already, by an old plan or program as far as it has come.

    Raises
    ------
    InputError
        If one of the two is given without the other, the file cannot be read or does not fit the nest, or nothing is
        left to cut.
    """
    from kerfwise.jobs.stopped import stopped_plan, stopped_program
    from kerfwise.models.plan.reader import read_plan

    if lock_from is None and upto is None and not redo_last:
        return NOTHING_CUT
    if lock_from is None or upto is None:
        raise InputError(
            "--lock-from OLD and --upto N go together: which plan or program was stopped, and how many of its cuts are "
            "cut (--redo-last: the last of them broke off)"
        )
    if lock_from.lower().endswith(".json"):
        plan = read_plan(lock_from)
        if plan.nest.get("sha256") != given.nest.sha256:
            click.echo(f"note: the nest is not the one {lock_from} was made with (its sha256 differs)", err=True)
        already = stopped_plan(plan, given.nest, upto, redo_last, lock_from)
    else:
        already = stopped_program(program_text(lock_from), given.nest, given.profile, upto, redo_last, lock_from)
    if not rest_of(given.nest, already.contours).contours:
        raise InputError(f"--upto {upto}: every contour of the nest is cut, nothing is left; no program is written")
    return already


def again_first(profile: Profile, already: AlreadyCut) -> Profile:
    """The profile with a lock on the cut that broke off: it comes first of what is left."""
    cut = already.broken_off
    if cut is None:
        return profile
    place = len(already.cuts) + 1
    lock = Lock(contour=cut.contour, position=place, reason=f"it broke off as cut {place} and is cut again")
    return replace(profile, locks=(*profile.locks, lock))
