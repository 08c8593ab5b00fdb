"""A nest with all that is asked for it: by the profile, by the job file beside it, and by whoever runs kerfwise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Literal

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.questions import Answers, with_answers
from kerfwise.jobs.as_it_was_read import refit_as_made
from kerfwise.jobs.given import Given, NestLike, ProfileLike, Tell, drawn_nest, plant_of, silent
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.yaml_positions import wrong_at
from kerfwise.rules.profile.load import DEFAULT
from kerfwise.rules.profile.one_nest import Setting
from kerfwise.rules.profile.profile import Profile

from .beside import beside_name, job_beside, misnamed
from .job import Job
from .laid import with_locks, with_values
from .last_plan import last_plan
from .read import read_job

JobLike = Job | str | Path | Literal[False] | None
"""A job, the path of its file, False for none, or None for the one beside the nest."""


@dataclass(frozen=True, slots=True)
class Asked:
    """What is asked for a nest by whoever runs kerfwise; what is not, its job file says, or else its profile.

    `last` is the plan (or program, or its path) in which contours have the numbers that locks call them by; None for
    the plan beside the nest.
    """

    profile: ProfileLike | None = None
    job: JobLike = None
    settings: tuple[Setting, ...] = ()
    locks: tuple[Lock, ...] = ()
    answers: Answers = ()
    last: Plan | str | Path | None = None


NOTHING = Asked()
"""Nothing is asked: the job file beside the nest, or the default profile."""


def job_for(nest: NestLike, job: JobLike, tell: Tell = silent) -> Job | None:
    """The job that is given, or the one in the file beside the nest, which is then told.

    Raises
    ------
    InputError
        If a job file cannot be read or is wrong anywhere.
    """
    if isinstance(job, Job) or job is False:
        return job or None
    if job is not None:
        return read_job(job)
    beside = job_beside(nest) if isinstance(nest, str | Path) else None
    if beside is None:
        if isinstance(nest, str | Path) and (other := misnamed(nest)) is not None:
            tell(f"{other} is not read: the job file of {Path(nest).name} is called {beside_name(nest)}")
        return None
    tell(f"the job file {beside} belongs to the nest and is read (--no-job, in Python job=False, goes without it)")
    return read_job(beside)


def profile_for(
    asked: Asked, job: Job | None, tell: Tell = silent, load: Callable[[ProfileLike], Profile] = plant_of
) -> Profile:
    """The profile that is given, else that of the job file, else the default, with what job and asker set in it.

    Raises
    ------
    InputError
        If there is no such profile, or it or a setting is wrong: with its place.
    """
    named = None if job is None else job.profile_path
    if asked.profile is None and job is not None and named is not None:
        try:
            plant = load(named)
        except InputError as error:
            if error.line is not None or not error.message.startswith(("unknown profile", "cannot read the profile")):
                raise
            raise wrong_at(job.said_at.get("profile"), f"profile: {error}") from None
    else:
        plant = load(DEFAULT if asked.profile is None else asked.profile)
    if job is not None and asked.profile is not None and named is not None:
        tell(f"{job.name} names the profile {job.profile}: the one that is given, {plant.name}, goes before it")
    if job is not None and job.machine is not None and job.machine.casefold() != plant.name.casefold():
        tell(f"{job.name} is for the machine {job.machine}, and the profile is {plant.name}")
    return with_values(answered(plant, job, asked.answers), job, asked.settings, asked.locks)


def answered(plant: Profile, job: Job | None, answers: Answers) -> Profile:
    """The profile with the answers of the job file, and those given beside it, to questions that the drawing raises."""
    told = with_answers(() if job is None else job.answers, answers)
    if not told:
        return plant
    drawing = replace(plant.drawing, answers=with_answers(plant.drawing.answers, told))
    return replace(plant, drawing=drawing)


def locked_for(
    nest: Nest, nest_file: str | Path | None, plant: Profile, asked: Asked, job: Job | None, tell: Tell = silent
) -> Given:
    """The nest, and the profile with the locks of job and asker on the nest's contours.

    Raises
    ------
    InputError
        If a lock names what the nest does not have: with its place.
    """
    last = cache(lambda: last_plan(asked.last, nest, nest_file, plant))
    return Given(nest, with_locks(plant, nest, job, asked.locks, last, tell), job)


def laid_for(plant: Profile, asked: Asked, job: Job | None) -> Profile:
    """The profile with the locks of job and asker as they are written, where there is no nest to find them on."""
    return replace(plant, locks=(*plant.locks, *(() if job is None else job.locks), *asked.locks))


def given_for(nest: NestLike, asked: Asked = NOTHING, tell: Tell = silent) -> Given:
    """A nest as it is to be cut, and its profile, with all that is asked for it.

    Raises
    ------
    InputError
        If something given cannot be read, or is wrong: with its place.
    """
    laid = isinstance(asked.profile, Profile) and asked.profile.for_one_nest is not None
    job = None if laid and asked.job is None else job_for(nest, asked.job, tell)
    plant = profile_for(asked, job, tell)
    refit_mm = None if isinstance(nest, Nest) else refit_as_made(None, asked.last, plant, tell)
    read = plant.as_cut(drawn_nest(nest, plant, refit_arcs_mm=refit_mm))
    return locked_for(read, None if isinstance(nest, Nest) else nest, plant, asked, job, tell)


def locks_told(profile: Profile) -> str:
    """That a profile has locks, which belong to one nest each, in a sentence; "" where it has none of its own file."""
    placed = [
        lock.place for lock in profile.locks if lock.place is not None and not lock.place.file.endswith(".job.yaml")
    ]
    if not placed:
        return ""
    return f"{placed[0]}: the profile has locks; they belong to one nest: write them in its job file, NEST.job.yaml"
