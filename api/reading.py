"""Nests, profiles and plans, read from files or taken as they are."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.inputs import DrawingSaid, ProfileLike, drawn_nest, plant_of
from kerfwise.jobs.nest_job import Job
from kerfwise.jobs.nest_job import read_job as read_job_file
from kerfwise.jobs.nest_job.job import day_of
from kerfwise.jobs.nest_job.request import JobLike, NestRequest, answered
from kerfwise.jobs.result import Result
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import read_plan as read_plan_file
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.load import DEFAULT
from kerfwise.rules.profile.overrides import Setting, read_lock, read_setting
from kerfwise.rules.profile.profile import Profile

if TYPE_CHECKING:
    from kerfwise.encoder.readers.options import FrameName


LockLike = Lock | str | Mapping[str, Any]
"""A lock, a line such as `P1.outer before P2.outer`, or a mapping as in a profile."""

Settings = Mapping[str, Any] | Iterable[str]
"""Keys of the profile with values, or lines such as `leads.lead_in=4mm`."""

PlanOrResult = Result | Plan | str | Path
"""A result, a plan, or the path of a plan (.json) or of an NC program."""


def read_nest(
    path: str | Path,
    profile: ProfileLike = DEFAULT,
    *,
    units: str | None = None,
    sheet_mm: tuple[float, float] | None = None,
    frame: FrameName | None = None,
    repair: bool = False,
    refit_arcs_mm: float | None = None,
    answers: Mapping[str, str] | None = None,
) -> Nest:
    """Read a nest from a DXF, SVG or JSON file, by the layers and units that the profile's section `drawing` names.

    Parameters
    ----------
    path
        The file; its ending says which kind it is.
    profile
        Name, path or object.
    units
        Unit of the drawing, instead of the one that it names: mm, cm, m, in, ft, pt, px, or dots an inch as 90dpi.
    sheet_mm
        Width and height of the sheet, in the place of the one that the file has.
    frame
        What a single rectangle around everything is, "sheet" or "part", where no layer names the sheet.
    repair
        Mend what can be mended.
    refit_arcs_mm
        Make arcs of outlines that were flattened into short lines, this near to them.
    answers
        Answers to questions that the drawing raises: {"frame": "sheet"}. They go before those of the profile.

    Returns
    -------
    Nest
        In mm, y up, as it is drawn; `notes` say what was doubtful and what was mended, `contours` lists what is cut.

    Raises
    ------
    Questions
        If the drawing raises questions that nobody has answered; its `questions` list them with their choices.
    InputError
        If the file cannot be read, or what it holds cannot be cut; the one error lists all that is wrong.

    Examples
    --------
    >>> import kerfwise
    >>> nest = kerfwise.read_nest("examples/nests/e1x_6.json")
    >>> len(nest.parts), len(nest.contours), nest.contours[0].id
    (8, 16, 'part#1.hole1')
    """
    plant = answered(plant_of(profile), None, tuple((answers or {}).items()))
    return drawn_nest(path, plant, DrawingSaid(units, sheet_mm, frame, repair, refit_arcs_mm))


def load_profile(
    profile: str | Path = DEFAULT, *, locks: Iterable[LockLike] | LockLike = (), trust: bool = False
) -> Profile:
    """Load a plant's profile: the shipped one of that name, or the one in that file.

    Parameters
    ----------
    profile
        Name or path.
    locks
        More locks, added to those of the profile: see `solve`.
    trust
        Run the Python files of rules that the profile names. Without it only those run that the machine's
        configuration allows: see "A rule in Python" in the docs.

    Raises
    ------
    InputError
        If there is none (with the nearest name), or it is wrong anywhere: with file, line and column. Also if it names
        a Python file that is not trusted, or a rule from outside cannot be used.

    Examples
    --------
    >>> import kerfwise
    >>> profile = kerfwise.load_profile("laser-wood")
    >>> profile.material.kerf_mm, profile.rules["level-ahead"].strength
    (0.7, 'hard')
    >>> kerfwise.load_profile("lasr-wood")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    kerfwise.encoder.errors.InputError: unknown profile 'lasr-wood': did you mean 'laser-wood'? ...
    """
    return locked(plant_of(profile, trust), locks)


def read_plan(path: str | Path) -> Plan:
    """Read a plan that `Result.save` or `kerfwise solve` has written.

    Raises
    ------
    InputError
        If the file cannot be read or is no plan, with line and column.
    """
    return read_plan_file(path)


def read_job(path: str | Path) -> Job:
    """Read a job file, `NEST.job.yaml`: what a planner has written down about one nest.

    Functions that take the path of a nest read the file beside it by themselves; give them `job=False` to go without.

    Returns
    -------
    Job
        `profile`, `machine`, `quantity`, `order`, `due`, `locks`, `settings`.

    Raises
    ------
    InputError
        If the file cannot be read, or is wrong anywhere: with file, line and column.
    """
    return read_job_file(path)


def plan_or_path(plan: PlanOrResult) -> Plan | str | Path:
    if isinstance(plan, Plan | str | Path):
        return plan
    if isinstance(plan, Result):
        return plan.plan
    raise InputError(f"expected a plan, a result or a path, got {type(plan).__name__}")


def plan_of(plan: PlanOrResult) -> Plan:
    found = plan_or_path(plan)
    return found if isinstance(found, Plan) else read_plan(found)


def nest_request(
    profile: ProfileLike | None,
    job: JobLike = None,
    settings: Settings = (),
    locks: Iterable[LockLike] | LockLike = (),
    last: Plan | Result | str | Path | None = None,
    answers: Mapping[str, str] | None = None,
    date: str = "",
) -> NestRequest:
    """What is asked for a nest; `last` is the plan in which contours have the numbers that locks call them by."""
    plan = None if last is None else plan_or_path(last)
    laid = tuple(map(lock_of, _listed(locks)))
    answered = tuple((answers or {}).items())
    return NestRequest(profile, job, settings_of(settings), laid, answered, plan, day_of(date))


def _listed(locks: Iterable[LockLike] | LockLike) -> list[LockLike]:
    return [locks] if isinstance(locks, Lock | str | Mapping) else list(locks)


def settings_of(settings: Settings) -> tuple[Setting, ...]:
    if isinstance(settings, Mapping):
        lines = [f"{key}={value if isinstance(value, str) else json.dumps(value)}" for key, value in settings.items()]
    else:
        lines = [settings] if isinstance(settings, str) else list(settings)
    return tuple(map(read_setting, lines))


def locked(profile: Profile, locks: Iterable[LockLike] | LockLike) -> Profile:
    """The profile with further locks."""
    listed = _listed(locks)
    return replace(profile, locks=(*profile.locks, *map(lock_of, listed))) if listed else profile


def lock_of(lock: LockLike) -> Lock:
    if isinstance(lock, str):
        return read_lock(lock)
    if isinstance(lock, Mapping):
        return read_lock(json.dumps(dict(lock), ensure_ascii=False))
    if not isinstance(lock, Lock):
        raise InputError(f"locks: expected a Lock, a line of text or a mapping, got {type(lock).__name__}")
    if wrong := lock.wrong():
        raise InputError(wrong)
    return lock
