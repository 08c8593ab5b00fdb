"""Where a profile says something, and where a key belongs that stands in the wrong place, or is misspelt."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from difflib import SequenceMatcher
from typing import Any

from kerfwise.encoder.nearest_name import nearest
from kerfwise.rules.options.option import Members, options_of
from kerfwise.rules.options.yaml_positions import Place, place_in
from kerfwise.rules.rule import Rule

from .sections import SECTIONS
from .values import ProfileValues

_MOST_PLACES = 4
"""Places that a message names for a key."""
_ALIKE = 0.85
"""So much like a valid key of its section a key is a misspelling of that, whatever others there are."""
_LIKE_ELSEWHERE = 0.7
"""A key of another section is named only where it is as much like what stands there."""
_TOP = ("based_on", "locks", "models", "own_rules", "python", "rules")
"""Keys of a profile that are no sections."""


def where_it_belongs(key: str, valid: Sequence[str], rules: Mapping[str, Rule[Any]], section: str = "") -> str:
    """Where a profile has a key that is not valid where it stands, or one that is called nearly so; "" where nowhere.

    `section` is the one in which it stands: a key of a group of another section, as `colour` of `drawing.layers`, says
    too little by its name alone to be what was meant there.

    Examples
    --------
    >>> from kerfwise.rules.registry import RULES
    >>> where_it_belongs("kerf", ["travel"], RULES)
    "there is no key 'kerf' here, it belongs under material: {kerf: …}"
    """
    guess = nearest(key, valid)
    if guess is not None and (key in SECTIONS or SequenceMatcher(None, key, guess).ratio() > _ALIKE):
        return ""  # `machine` in prices is a beginning of machine_hour, not that section
    if places := where_keys_stand(key, rules, section):
        return f"there is no key {key!r} here, it belongs under {_either(places)}"
    guess = nearest(key, _every_key(rules)) if guess is None else None
    if guess is not None and SequenceMatcher(None, key, guess).ratio() < _LIKE_ELSEWHERE:
        return ""
    places = where_keys_stand(guess, rules, section) if guess is not None else ()
    return f"there is no key {key!r} here; did you mean {_either(places)}?" if places else ""


def _either(places: Sequence[str]) -> str:
    shown = places[:_MOST_PLACES]
    listed = " or ".join((", ".join(shown[:-1]), shown[-1])) if shown[1:] else shown[0]
    return listed + (", …" if len(places) > len(shown) else "")


def _every_key(rules: Mapping[str, Rule[Any]]) -> Iterator[str]:
    yield from rules
    owners = [*SECTIONS.values(), *(rule.Options for rule in rules.values())]
    for owner in owners:
        yield from (one.key for one in options_of(owner))
        owners += [one.kind.owner for one in options_of(owner) if isinstance(one.kind, Members)]


def where_keys_stand(key: str, rules: Mapping[str, Rule[Any]], section: str = "") -> tuple[str, ...]:
    """Every place where a profile has a key of this name, a section, an option or a rule, as YAML that leads there.

    With a `section`, of groups only those in it.

    Examples
    --------
    >>> from kerfwise.rules.registry import RULES
    >>> where_keys_stand("kerf", RULES), where_keys_stand("level-ahead", RULES), where_keys_stand("longest", RULES)
    (('material: {kerf: …}',), ('rules: {level-ahead: …}',), ('cuts: {links: {longest: …}}',))
    """
    found = [f"{key}: {{…}}" if key in SECTIONS else f"{key}: …"] if key in (*SECTIONS, *_TOP) else []
    found += [text for name, owner in SECTIONS.items() for text in _groups(name, owner, key, section in ("", name))]
    found += [f"rules: {{{key}: …}}"] if key in rules else []
    found += [f"rules: {{{name}: {{{key}: …}}}}" for name, rule in rules.items() if _has(rule.Options, key)]
    return tuple(found)


def _groups(name: str, owner: Any, key: str, deep: bool) -> Iterator[str]:
    for one in options_of(owner):
        if one.key == key:
            yield f"{name}: {{{key}: {'{…}' if isinstance(one.kind, Members) else '…'}}}"
        if deep and isinstance(one.kind, Members):
            yield from (f"{name}: {{{inner}}}" for inner in _groups(one.key, one.kind.owner, key, deep))


def _has(owner: Any, key: str) -> bool:
    return any(one.key == key for one in options_of(owner))


def where_said(profile: ProfileValues, *paths: tuple[str, ...]) -> Place | None:
    """Where the profile's file has the first of these keys that it has, else where one that it is based on has."""
    files = (profile.file, *reversed(profile.read_from))
    return next((place for file in files if file and (place := place_in(file, *paths)) is not None), None)
