"""What two profiles say differently, key by key."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import yaml

from kerfwise.rules.options.members import Members
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.quantities import LENGTH

from .profile import Profile
from .said_at import Sources
from .sections import SECTIONS
from .text import lock_text

ABSENT = "-"
"""Where one of them has no such key."""


@dataclass(frozen=True, slots=True)
class Difference:
    """One key, such as `material.kerf`, its value in both as YAML, and where each has it from."""

    key: str
    a: str
    b: str
    a_from: str
    b_from: str


def differences(a: Profile, b: Profile) -> tuple[Difference, ...]:
    """Every key whose value differs, in the order of `profile show`; names and comments do not count.

    Examples
    --------
    >>> from kerfwise.rules.profile.load import load_profile
    >>> found = differences(load_profile("laser-wood"), load_profile("water-jet"))
    >>> next((one.a, one.b) for one in found if one.key == "machine.process")
    ('laser', 'water-jet')
    """
    first, second = dict(flat(a)), dict(flat(b))
    one, other = Sources(a), Sources(b)
    return tuple(
        Difference(key, first.get(key, ABSENT), second.get(key, ABSENT), _said(one, key), _said(other, key))
        for key in dict.fromkeys([*first, *second])
        if first.get(key) != second.get(key)
    )


def flat(profile: Profile) -> Iterator[tuple[str, str]]:
    """Every key of a profile with its value as YAML, nested keys joined by dots."""
    for section in SECTIONS:
        yield from _options(getattr(profile, section), section)
    for name in sorted(profile.rules):
        setting = profile.rules[name]
        yield f"rules.{name}", setting.strength
        if setting.weight is not None:
            yield f"rules.{name}.weight", LENGTH.write(setting.weight)
        yield from _options(setting.options, f"rules.{name}")
    for file in profile.python:
        yield f"python {file.path.name}", "named"
    for source in profile.models:
        yield f"models {source.path.name}", "named"
    for rule in profile.own_rules:
        yield f"own_rules {rule.name}", yaml.safe_dump(rule.plain(), width=1e9, default_flow_style=True).strip()
    for lock in profile.locks:
        yield f"locks {lock_text(lock)}", "locked"


def _options(owner: Any, path: str) -> Iterator[tuple[str, str]]:
    for option in options_of(owner):
        value, key = getattr(owner, option.name), f"{path}.{option.key}"
        if isinstance(option.kind, Members):
            yield from _options(value, key)
        else:
            yield key, option.kind.write(value)


def _said(sources: Sources, key: str) -> str:
    """Where a key is from; what stands in lists has no place of its own."""
    return sources.of(key) if key.split(".")[0] in (*SECTIONS, "rules") else ABSENT
