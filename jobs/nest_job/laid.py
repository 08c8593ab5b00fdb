"""A profile with what belongs to one nest laid over it: profile < job file < command line."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.given import Tell
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.checks import at_odds
from kerfwise.rules.profile.for_one_nest import ForOneNest
from kerfwise.rules.profile.lock_text import lines_of
from kerfwise.rules.profile.one_nest import Setting, with_settings
from kerfwise.rules.profile.profile import Profile

from .job import Job
from .last_plan import LastPlan
from .names import Names, OnNest


def with_values(profile: Profile, job: Job | None, settings: Sequence[Setting], locks: Sequence[Lock]) -> Profile:
    """The profile with what the job file sets, then what was set beside it; its locks come later, on the nest.

    Raises
    ------
    InputError
        If a key or value is wrong: with its place.
    """
    if job is not None:
        profile = with_settings(profile, job.settings, job.file)
    profile = with_settings(profile, settings)
    if job is None and not settings and not locks:
        return profile
    old = profile.for_one_nest or ForOneNest()
    lines = (*old.locks, *(line for lock in locks for line in lines_of(lock)))
    file, sha256, read = (old.file, old.sha256, ()) if job is None else (job.name, job.sha256, (job.file,))
    made_with = ForOneNest(file, sha256, (*old.settings, *map(str, settings)), lines)
    return replace(profile, for_one_nest=made_with, read_from=(*profile.read_from, *read))


def with_locks(
    profile: Profile, nest: Nest, job: Job | None, locks: Sequence[Lock], last: Callable[[], LastPlan], tell: Tell
) -> Profile:
    """The profile with the locks of the job file, and those that were said beside it, on the contours of the nest.

    Where two decide the same, the later stands, and that is told; within one place both stand, and clash.

    Raises
    ------
    InputError
        If a lock names what the nest does not have, with its place, or asks for what a rule would make that is off.
    """
    layers = [layer for layer in ((() if job is None else job.locks), locks) if layer]
    if not layers:
        return profile
    made_with = profile.for_one_nest or ForOneNest()
    names = Names(nest, lambda name: last().contour(name, made_with))
    found = [[one for lock in layer for one in names.on_nest(lock)] for layer in (profile.locks, *layers)]
    for number, contour in names.numbered.items():
        tell(f"{number} is {contour}, as in {last().name}")
    told = replace(made_with, numbered=dict(names.numbered))
    laid = replace(profile, locks=_standing(found, tell), for_one_nest=told)
    for _, _, text in at_odds(laid.plant, laid.rules, laid.known_rules()):
        raise InputError(text, file=job.file if job is not None and job.locks else None)
    return laid


def _standing(layers: Sequence[Sequence[OnNest]], tell: Tell) -> tuple[Lock, ...]:
    """The locks of all layers but those that one of a later layer decides otherwise."""
    kept: list[Lock] = []
    for k, layer in enumerate(layers):
        later = [one for further in layers[k + 1 :] for one in further]
        for one in layer:
            by = next((other for other in later if other.against(one)), None)
            if by is None:
                kept += one.locks
            elif by.locks != one.locks:
                tell(f"{_told(one)} gives way to {_told(by)}")
    return tuple(kept)


def _told(one: OnNest) -> str:
    where = f" ({one.said.place})" if one.said.place else f" ({one.said.reason})" if one.said.reason else ""
    return f"the lock {next(lines_of(one.said))!r}{where}"
