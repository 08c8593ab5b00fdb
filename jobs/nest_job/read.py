"""Job files read: every mistake with its line and column."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import yaml

from kerfwise.encoder.contents import MOST_BYTES_OF_YAML, contents
from kerfwise.encoder.errors import InputError
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.kind import Unfit
from kerfwise.rules.options.quantities import PointOrOff
from kerfwise.rules.options.yaml_positions import Problems, compose, entries, is_empty, items
from kerfwise.rules.profile.lock_text import read_lock
from kerfwise.rules.profile.one_nest import read_settings
from kerfwise.rules.profile.reader import read_fields, read_locks

from .job import Job

LOCKS, TABS, SET = "locks", "tabs", "set"


def read_job(path: str | Path) -> Job:
    """Read a job file.

    What it names (a profile, contours, keys of the profile) is looked up where the job is used: see `jobs/given.py`.

    Raises
    ------
    InputError
        If the file cannot be read, or is wrong anywhere, with line and column: all mistakes at once.
    """
    try:
        data = contents(path, MOST_BYTES_OF_YAML)
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"not a job file: the file is not UTF-8 text ({error.reason})", file=path) from None
    except ValueError as error:  # a NUL, or half a character
        raise InputError(f"cannot read the job file: no file can have this name ({error})", file=path) from None
    except OSError as error:
        raise InputError(f"cannot read the job file: {error.strerror}", file=path) from None
    return replace(job_of(text, str(path)), sha256=hashlib.sha256(data).hexdigest())


def job_of(text: str, file: str) -> Job:
    """The job that a text describes.

    Raises
    ------
    InputError
        As `read_job` does.

    Examples
    --------
    >>> job = job_of("quantity: 4\\ndue: 2026-12-24\\nlocks: [P2 first]\\n", "plate.job.yaml")
    >>> job.quantity, job.due.day, job.locks[0].contour, str(job.locks[0].place)
    (4, 24, 'P2', 'plate.job.yaml:3:9')
    """
    problems, root = Problems(file), compose(text, file)
    members = list(entries(root, problems, "job file")) if root is not None else []
    own = {key: value for key, _, value in members if key in (LOCKS, TABS, SET)}
    rest = [member for member in members if member[0] not in own]
    said_at = {key: problems.place(key_node) for key, key_node, _ in members}
    job = read_fields(rest, Job(file=file, said_at=said_at), problems, "job file", other=(LOCKS, TABS, SET))
    locks = [*_locks(own[LOCKS], problems)] if LOCKS in own else []
    locks += _tabs(own[TABS], problems) if TABS in own else []
    settings = read_settings(own[SET], problems) if SET in own else ()
    problems.raise_any()
    return replace(job, locks=tuple(locks), settings=settings)


def _locks(node: yaml.Node, problems: Problems) -> Iterator[Lock]:
    """Each entry is a line in words, or a mapping as in a profile."""
    for number, entry in enumerate(items(node, problems, LOCKS), 1):
        if is_empty(entry):
            problems.add(
                entry,
                f"{LOCKS}[{number}]: expected a lock, got nothing; write '#7 first' in quotes: # begins a comment",
            )
        elif isinstance(entry, yaml.ScalarNode):
            try:
                yield replace(read_lock(str(entry.value)), place=problems.place(entry))
            except InputError as error:
                problems.add(entry, f"{LOCKS}[{number}]: {error.message}")
        else:
            own = Problems(problems.file)
            yield from read_locks(yaml.SequenceNode("tag:yaml.org,2002:seq", [entry], entry.start_mark), own)
            for line, column, said in own.found:
                problems.found.append((line, column, said.replace(f"{LOCKS}[1]", f"{LOCKS}[{number}]", 1)))


def _tabs(node: yaml.Node, problems: Problems) -> Iterator[Lock]:
    """A contour or part, and where tabs hold it: a point, several, or off."""
    for name, key_node, value in entries(node, problems, TABS):
        several = isinstance(value, yaml.SequenceNode) and any(isinstance(v, yaml.SequenceNode) for v in value.value)
        for one in value.value if several else (value,):
            try:
                yield Lock(contour=name, tab=PointOrOff().read(one), place=problems.place(key_node))  # type: ignore[arg-type]
            except Unfit as error:
                problems.add(error.node or one, f"{TABS}.{name}: {error}")
