"""The text of a job file, changed by a planner's hands: comments and the order of keys stay as they are written."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.error import YAMLError
from ruamel.yaml.scalarstring import DoubleQuotedScalarString

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.nest_job.job import Job
from kerfwise.jobs.nest_job.read import LOCKS, SET, TABS, job_of
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.lock_text import lines_of, read_lock

_WIDE = 4096
"""No line is broken that was not."""


@dataclass(frozen=True, slots=True)
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

    text: str = ""

    def job(self) -> Job:
        """The job that it describes; InputError with line and column if it is wrong."""
        return job_of(self.text.removeprefix("\ufeff"), "the job file")

    def lines(self) -> tuple[tuple[str, Lock], ...]:
        """Its locks in a line each, with the lock that each stands for, tabs among them."""
        return tuple((line, lock) for lock in self.job().locks for line in lines_of(lock))

    def with_lock(self, line: str) -> JobText:
        """With one lock more; InputError for a line that is none."""
        wanted = next(lines_of(read_lock(line)))
        if any(wanted == stands for stands, _ in self.lines()):
            return self
        root = self._root()
        root.setdefault(LOCKS, CommentedSeq())
        if root[LOCKS] is None:
            root[LOCKS] = CommentedSeq()
        root[LOCKS].append(_scalar(wanted))
        return _written(root)

    def without_lock(self, line: str) -> JobText:
        """Without a lock; InputError if it has none that says this."""
        if all(line != stands for stands, _ in self.lines()):
            raise InputError(f"there is no lock {line!r} in the job file")
        root = self._root()
        locks = root.get(LOCKS) or CommentedSeq()
        for k in reversed(range(len(locks))):
            said = [line for line, _ in JobText(_dumped({LOCKS: [locks[k]]})).lines()]
            if line in said:
                locks[k : k + 1] = [_scalar(other) for other in said if other != line]
        tabs = root.get(TABS) or CommentedMap()
        for name in list(tabs):
            held = job_of(_dumped({TABS: {name: tabs[name]}}), "the job file").locks
            left = [lock.tab for lock in held if next(lines_of(lock)) != line]
            if len(left) < len(held):
                tabs[name] = _points(left)
                if not left:
                    del tabs[name]
        return _written(_swept(root))

    def with_setting(self, key: str, value: str) -> JobText:
        """With a value of the profile that this nest has otherwise."""
        root = self._root()
        if root.get(SET) is None:
            root[SET] = CommentedMap()
        if not (key in root[SET] and str(root[SET][key]) == value):
            root[SET][key] = _value(value)
        return _written(root)

    def without_setting(self, key: str) -> JobText:
        """Without it; InputError if the job file does not set it under this key."""
        root = self._root()
        if key not in (root.get(SET) or {}):
            raise InputError(f"the job file does not set {key!r}")
        del root[SET][key]
        return _written(_swept(root))

    def with_profile(self, name: str) -> JobText:
        """For another profile."""
        root = self._root()
        root["profile"] = name
        return _written(root)

    def without_numbers(self, contours: dict[str, str]) -> JobText:
        """With ids in the place of numbers such as #7: once the job file changes, #7 would be of another plan."""
        changed = self
        for line, lock in self.lines():
            named = {key: contours.get(getattr(lock, key) or "") for key in ("contour", "part", "before")}
            known: dict[str, Any] = {key: name for key, name in named.items() if name is not None}
            if known:
                changed = changed.without_lock(line).with_lock(next(lines_of(replace(lock, **known))))
        return changed

    def _root(self) -> CommentedMap:
        self.job()  # what is wrong is said with its place
        root = _yaml().load(self.text.removeprefix("\ufeff"))
        return CommentedMap() if root is None else root


def _points(tabs: Iterable[Any]) -> CommentedSeq:
    points = CommentedSeq([list(point) for point in tabs if isinstance(point, tuple)])
    points.fa.set_flow_style()
    return points


def _swept(root: CommentedMap) -> CommentedMap:
    for key in (LOCKS, TABS, SET):
        if key in root and not root[key]:
            del root[key]
    return root


def _yaml() -> YAML:
    yaml = YAML()
    yaml.preserve_quotes = True
    yaml.width = _WIDE
    yaml.indent(mapping=2, sequence=4, offset=2)
    return yaml


def _dumped(data: Any) -> str:
    out = io.StringIO()
    _yaml().dump(data, out)
    return out.getvalue()


def _written(root: CommentedMap) -> JobText:
    text = JobText(_dumped(root) if root else "")
    text.job()
    return text


def _scalar(line: str) -> str:
    return DoubleQuotedScalarString(line) if any(sign in line for sign in "#\"'{[:") else line


def _value(text: str) -> Any:
    """A value as its author writes it: numbers stay numbers, `[1, 2]` a list."""
    try:
        return YAML(typ="safe").load(text) if text.strip() else text
    except (YAMLError, ValueError):
        raise InputError(f"{text!r} is not a value as a job file holds it") from None


def settings_of(job: Job) -> Iterator[tuple[str, str]]:
    """Keys and values that a job sets."""
    return ((setting.key, setting.text) for setting in job.settings)
