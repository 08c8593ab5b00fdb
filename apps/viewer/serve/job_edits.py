"""Changes that a planner makes to a job file: comments and order of keys stay, each checked on the nest."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nearest_name import unknown
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.questions import answers_of
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.nest_job.job import LOCKS, SET, TABS, Job, job_of, with_kept
from kerfwise.jobs.nest_job.request import Names
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.kind import Text
from kerfwise.rules.options.yaml_positions import compose, plain, with_item, with_value, without_item, without_value
from kerfwise.rules.profile.overrides import lines_of, read_lock

from .plan_request import PlanRequest, request_inputs

# Changes that a planner's hands make to a job file: each is checked on the nest before any of them counts.

Undone = list[str]
"""Locks that gave way, in a line each."""


def edited(wanted: PlanRequest, inputs: Inputs, changes: Sequence[dict[str, Any]]) -> tuple[str | None, Undone]:
    """The text of the job file with all changes made, None for no file, and the locks that gave way to new ones.

    A change is `{"lock": LINE}`, `{"unlock": LINE}`, `{"set": KEY, "to": VALUE}`, `{"unset": KEY}`, `{"profile": NAME}`
    or `{"answer": "QUESTION=CHOICE"}`. Raises InputError if one of them cannot be made, or what comes of all does not
    fit the nest: then none counts.
    """
    undone: Undone = []
    text = JobText(wanted.job_text or "")
    if inputs.profile.for_one_nest is not None:
        text = text.without_numbers(dict(inputs.profile.for_one_nest.numbered))
    for change in changes:
        text = _changed(text, inputs.nest, change, undone)
    job_text = text.text or (None if wanted.job_text is None else "")
    request_inputs(replace(wanted, job_text=job_text))
    return job_text, undone


def _changed(text: JobText, nest: Nest, change: dict[str, Any], undone: Undone) -> JobText:
    actions: dict[str, Callable[[str], JobText]] = {
        "lock": lambda line: _locked(text, nest, line, undone),
        "unlock": text.without_lock,
        "set": lambda key: text.with_setting(key, _text(change, "to")),
        "unset": text.without_setting,
        "profile": text.with_profile,
        "answer": lambda said: text.with_answers(dict(answers_of([said]))),
    }
    name = next((name for name in actions if name in change), None)
    if name is None:
        raise InputError(unknown("change", next(iter(change), ""), actions))
    expect_keys(f"a change {name!r}", change, (name, "to") if name == "set" else (name,))
    return actions[name](_text(change, name))


def expect_keys(what: str, fields: Mapping[str, Any], keys: Collection[str]) -> None:
    """InputError if anything has a key that means nothing there."""
    if strange := [key for key in fields if key not in keys]:
        raise InputError(f"{what}: {unknown('key', strange[0], keys)}")


def _text(change: dict[str, Any], key: str) -> str:
    value = change.get(key)
    if not isinstance(value, str) or not value.strip():
        raise InputError(f"{key}: expected a text, got {value!r}")
    return value


def _locked(text: JobText, nest: Nest, line: str, undone: Undone) -> JobText:
    """With one lock more, which takes the place of those that decide the same or the contrary."""
    for old in conflicting_locks(nest, text, [read_lock(line)]):
        text = text.without_lock(old)
        undone.append(old)
    return text.with_lock(line)


def conflicting_locks(nest: Nest, text: JobText, locks: Sequence[Lock]) -> list[str]:
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


# The text of a job file, changed by a planner's hands: all else stays as it is written, comments and order too.


class JobText:
    """A job file's text, "" for none. Each method gives the text with one thing changed.

    Examples
    --------
    >>> text = JobText("quantity: 4  # sheets\\n").with_lock("P2 first").with_setting("leads.lead_in", "4 mm")
    >>> print(text.text, end="")
    quantity: 4  # sheets
    locks:
      - P2 first
    set:
      leads.lead_in: 4 mm
    >>> text.without_lock("P2 first").without_setting("leads.lead_in").text
    'quantity: 4  # sheets\\n'
    """

    def __init__(self, text: str = "") -> None:
        self.text = text.removeprefix("\ufeff").replace("\r\n", "\n")

    def job(self) -> Job:
        """The job that it describes; InputError with line and column if it is wrong."""
        return job_of(self.text, "the job file")

    def lines(self) -> tuple[tuple[str, Lock], ...]:
        """Its locks in a line each, with the lock that each stands for, tabs among them."""
        return tuple((line, lock) for lock in self.job().locks for line in lines_of(lock))

    def with_lock(self, line: str) -> JobText:
        """With one lock more; InputError for a line that is none."""
        wanted = next(lines_of(read_lock(line)))
        if any(wanted == stands for stands, _ in self.lines()):
            return self
        return _expect_job(with_item(self.text, LOCKS, Text().write(wanted)))

    def without_lock(self, line: str) -> JobText:
        """Without a lock; InputError if it has none that says this."""
        said = self.lines()
        found = next((lock for stands, lock in said if stands == line), None)
        if found is None:
            raise InputError(f"there is no lock {line!r} in the job file")
        assert found.place is not None
        entry = [(stands, lock) for stands, lock in said if lock.place == found.place]
        text = without_item(self.text, found.place)
        if text is None:  # one of the tabs of a contour
            path = [TABS, str(found.contour)]
            points = [list(lock.tab) for _, lock in entry if isinstance(lock.tab, tuple) and lock.tab != found.tab]
            return _expect_job(with_value(self.text, path, str(points)) if points else without_value(self.text, path))
        changed = _expect_job(text)
        for stands, _ in entry:
            changed = changed if stands == line else changed.with_lock(stands)
        return changed.without_lock(line) if any(stands == line for stands, _ in changed.lines()) else changed

    def with_setting(self, key: str, value: str) -> JobText:
        """With a value of the profile that this nest has otherwise."""
        if (key, value) in settings_of(self.job()):
            return self
        return _expect_job(with_value(self.text, [SET, key], _value(value)))

    def without_setting(self, key: str) -> JobText:
        """Without it; InputError if the job file does not set it under this key."""
        if key not in dict(settings_of(self.job())):
            raise InputError(f"the job file does not set {key!r}")
        return _expect_job(without_value(self.text, [SET, key]))

    def with_profile(self, name: str) -> JobText:
        """For another profile."""
        return _expect_job(with_value(self.text, ["profile"], Text().write(name)))

    def with_answers(self, answers: Mapping[str, str]) -> JobText:
        """With answers to questions of the drawing, each in the place of one before."""
        if not answers:
            return self
        return JobText(with_kept(self.text, tuple(answers.items()), "the job file"))

    def without_numbers(self, contours: dict[str, str]) -> JobText:
        """With ids in the place of numbers such as #7: once the job file changes, #7 would be of another plan."""
        changed = self
        for line, lock in self.lines():
            named = {key: contours.get(getattr(lock, key) or "") for key in ("contour", "part", "before")}
            known: dict[str, Any] = {key: name for key, name in named.items() if name is not None}
            if known:
                changed = changed.without_lock(line).with_lock(next(lines_of(replace(lock, **known))))
        return changed


def _expect_job(text: str) -> JobText:
    """The text, which has to be that of a job, without blank lines at its end."""
    made = JobText(f"{text.rstrip()}\n" if text.strip() else "")
    made.job()
    return made


def _value(text: str) -> str:
    """A value as its author writes it, in one line."""
    try:
        node = compose(text, "the job file")
        said = None if node is None else plain(node)
    except InputError:
        node = said = None
    in_block = isinstance(node, yaml.CollectionNode) and not node.flow_style
    if said is None or in_block or len(text.splitlines()) > 1:
        raise InputError(f"{text!r} is not a value as a job file holds it")
    return text.strip()


def settings_of(job: Job) -> Iterator[tuple[str, str]]:
    """Keys and values that a job sets."""
    return ((setting.key, setting.text) for setting in job.settings)
