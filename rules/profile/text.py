"""A profile as YAML with nothing left implicit: every value, its unit, and a comment of one line."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import yaml

from kerfwise.rules.lock import Lock
from kerfwise.rules.options.members import Members
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.plain_values import Text
from kerfwise.rules.options.quantities import LENGTH
from kerfwise.rules.rule import Rule

from .profile import Profile
from .said_at import Sources
from .sections import SECTIONS, RuleSetting

COMMENT_COLUMN = 44


def profile_yaml(profile: Profile, sources: bool = False) -> str:
    """The whole profile; loading this text gives the same profile. With `sources` each value says where it is from."""
    told = Sources(profile) if sources else None
    lines = [_line(0, f"name: {Text().write(profile.name)}", "what plans and programs call this profile")]
    for section in SECTIONS:
        lines += ["", f"{section}:", *_options(getattr(profile, section), 2, told, section)]
    lines += ["", *_python(profile), "", *_models(profile)]
    known = profile.known_rules()
    lines += ["", "rules:"]
    for name in sorted(profile.rules):
        lines += _rule(known[name], profile.rules[name], told)
    lines += ["", *_locks(profile.locks, sources)]
    own = [rule.plain() for rule in profile.own_rules]
    lines += ["", yaml.safe_dump({"own_rules": own}, allow_unicode=True, sort_keys=False).rstrip()]
    return "\n".join(lines) + "\n"


def _python(profile: Profile) -> Iterator[str]:
    written = ", ".join(Text().write(str(file.path)) for file in profile.python)
    yield _line(0, f"python: [{written}]", "files of rules in Python; they run only where they are trusted")


def _models(profile: Profile) -> Iterator[str]:
    written = ", ".join(Text().write(str(source.path)) for source in profile.models)
    yield _line(0, f"models: [{written}]", "files of rules in MiniZinc")


def _rule(rule: Rule[Any], setting: RuleSetting, told: Sources | None = None) -> Iterator[str]:
    said = f" ({told.of(f'rules.{rule.id}')})" if told is not None else ""
    yield f"  # {rule.sentence}" + (f" From {rule.brought}." if rule.brought else "") + said
    yield f"  {rule.id}:"
    yield _line(4, f"strength: {setting.strength}", " | ".join(rule.strengths))
    if setting.weight is not None:
        yield _line(4, f"weight: {LENGTH.write(setting.weight)}", "cost of breaking it once, in idle travel")
    yield from _options(setting.options, 4, told, f"rules.{rule.id}", said_only=True)


def _options(
    owner: Any, indent: int, told: Sources | None = None, path: str = "", said_only: bool = False
) -> Iterator[str]:
    """The options of a section, or of a rule or a group, which name their place only if somebody said them."""
    for option in options_of(owner):
        if isinstance(option.kind, Members):
            yield _line(indent, f"{option.key}:", option.help)
            yield from _options(getattr(owner, option.name), indent + 2, told, f"{path}.{option.key}", True)
            continue
        value = option.kind.write(getattr(owner, option.name))
        key = f"{path}.{option.key}"
        said = f"; {told.of(key)}" if told is not None and (told.says(key) or not said_only) else ""
        yield _line(indent, f"{option.key}: {value}", f"{option.help}{said}")


def _locks(locks: tuple[Lock, ...], sources: bool) -> Iterator[str]:
    yield "locks:" if locks else "locks: []"
    for lock in locks:
        yield _line(2, f"- {lock_text(lock)}", str(lock.place or "--lock")) if sources else f"  - {lock_text(lock)}"


def lock_text(lock: Lock) -> str:
    """A lock as a profile has it."""
    given = [(o.key, o.kind, getattr(lock, o.name)) for o in options_of(lock)]
    return f"{{{', '.join(f'{key}: {kind.write(value)}' for key, kind, value in given if value is not None)}}}"


def _line(indent: int, text: str, comment: str) -> str:
    return f"{' ' * indent + text:<{COMMENT_COLUMN}}  # {comment}"
