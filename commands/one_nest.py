"""What a person says of one nest on the command line, or has said in its job file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from kerfwise.encoder.errors import InputError

if TYPE_CHECKING:
    from kerfwise.jobs.nest_job.asked import Asked

Verb = Callable[..., Any]

JOB = click.option("--job", metavar="JOB", help="The job file, instead of NEST.job.yaml beside the nest.")
NO_JOB = click.option("--no-job", is_flag=True, help="Go without the job file beside the nest.")
SET = click.option("--set", "settings", multiple=True, metavar="KEY=VALUE",
                   help="A value of the profile for this nest only: leads.lead_in=4mm; may be repeated.")  # fmt: skip
LOCK = click.option("--lock", multiple=True, metavar="LOCK",
                    help="A decision of your own, such as 'P2 first' or '#7 before P3'; may be repeated.")  # fmt: skip


ANSWER = click.option("--answer", "answers", multiple=True, metavar="QUESTION=CHOICE",
                      help="Answer a question of the drawing, as frame=sheet; kept in the job file.")  # fmt: skip


def asked_of(
    profile: str | None,
    job: str | None = None,
    no_job: bool = False,
    settings: Sequence[str] = (),
    lock: Sequence[str] = (),
    answers: Sequence[str] = (),
    last: str | None = None,
) -> Asked:
    """What these options ask for; `last` is the plan in which contours have the numbers that locks call them by.

    Raises
    ------
    InputError
        Naming the option, the word that is wrong, and what was expected.
    """
    from kerfwise.encoder.questions import answers_of
    from kerfwise.jobs.nest_job.asked import Asked
    from kerfwise.rules.profile.lock_text import read_lock
    from kerfwise.rules.profile.one_nest import read_setting

    if job is not None and no_job:
        raise click.UsageError("--job names a job file, and --no-job goes without one: give one of them")
    try:
        said = tuple(replace(read_lock(one), reason=f"locked by the operator (--lock {one!r})") for one in lock)
    except InputError as error:
        raise InputError(f"--{error.message}") from None
    return Asked(profile, False if no_job else job, tuple(map(read_setting, settings)), said, answers_of(answers), last)
