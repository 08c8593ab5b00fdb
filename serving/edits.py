"""Changes that a planner's hands make to a job file: each is checked on the nest before any of them counts."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.given import Given
from kerfwise.jobs.nest_job.names import Names
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.profile.lock_text import read_lock

from .job_text import JobText
from .wanted import Wanted, given_of

Undone = list[str]
"""Locks that gave way, in a line each."""


def edited(wanted: Wanted, given: Given, changes: Sequence[dict[str, Any]]) -> tuple[str | None, Undone]:
    """The text of the job file with all changes made, None for no file, and the locks that gave way to new ones.

    A change is `{"lock": LINE}`, `{"unlock": LINE}`, `{"set": KEY, "to": VALUE}`, `{"unset": KEY}` or
    `{"profile": NAME}`.

    Raises
    ------
    InputError
        If one of them cannot be made, or what comes of all does not fit the nest: then none counts.
    """
    undone: Undone = []
    text = JobText(wanted.job_text or "")
    if given.profile.for_one_nest is not None:
        text = text.without_numbers(dict(given.profile.for_one_nest.numbered))
    for change in changes:
        text = _changed(text, given.nest, change, undone)
    made = text.text or (None if wanted.job_text is None else "")
    given_of(replace(wanted, job_text=made))
    return made, undone


def _changed(text: JobText, nest: Nest, change: dict[str, Any], undone: Undone) -> JobText:
    made: dict[str, Callable[[str], JobText]] = {
        "lock": lambda line: _locked(text, nest, line, undone),
        "unlock": text.without_lock,
        "set": lambda key: text.with_setting(key, _text(change, "to")),
        "unset": text.without_setting,
        "profile": text.with_profile,
    }
    name = next((name for name in made if name in change), None)
    if name is None:
        raise InputError(unknown("change", next(iter(change), ""), made))
    expect_keys(f"a change {name!r}", change, (name, "to") if name == "set" else (name,))
    return made[name](_text(change, name))


def expect_keys(what: str, said: Mapping[str, Any], keys: Collection[str]) -> None:
    """InputError if anything has a key that means nothing there."""
    if strange := [key for key in said if key not in keys]:
        raise InputError(f"{what}: {unknown('key', strange[0], keys)}")


def _text(change: dict[str, Any], key: str) -> str:
    value = change.get(key)
    if not isinstance(value, str) or not value.strip():
        raise InputError(f"{key}: expected a text, got {value!r}")
    return value


def _locked(text: JobText, nest: Nest, line: str, undone: Undone) -> JobText:
    """With one lock more, which takes the place of those that decide the same or the contrary."""
    for old in against(nest, text, [read_lock(line)]):
        text = text.without_lock(old)
        undone.append(old)
    return text.with_lock(line)


def against(nest: Nest, text: JobText, locks: Sequence[Lock]) -> list[str]:
    """The locks of a job file, in a line each, that decide the same as new ones, or the contrary."""
    names = Names(nest, _no_number)
    new = [one for lock in locks for one in names.on_nest(lock)]
    return [
        line
        for line, _ in text.lines()
        if not line.startswith("#")
        for old in names.on_nest(read_lock(line))
        if any(one.against(old) for one in new) and not all(one.locks == old.locks for one in new)
    ]


def _no_number(name: str) -> str:
    raise InputError(f"{name}: say which contour it is by its id")
