"""Locks as a person says them in one line: `P1.outer before P2.outer`, `P2 first`, `no link P3.outer`."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.suggest import nearest
from kerfwise.rules.options.yaml_positions import Problems, compose

from .reader import read_locks

_QUOTED = r'"(?:[^"]|"")*"'
_WORD = re.compile(_QUOTED + r'|[(\[][^)\]]*[)\]]|[^\s"(\[]\S*|\S')
_NTH = re.compile(r"([1-9]\d{0,8})(?:st|nd|rd|th)")
_NUMBERED = re.compile(r"^locks\[1\](\.|: )")
_BY_ITSELF = {"first": "position", "last": "position", "cw": "direction", "ccw": "direction"}
"""Words that say all by themselves, and the key of a lock that they stand for."""
_WITH_VALUE = {
    "position": "first, last or a position counted from 1",
    "direction": "cw or ccw",
    "linked": "false",
    "zone": "a number",
    "entry": "a point such as (10, 20)",
    "tab": "a point such as (10, 20), or off",
}
"""Keys that a value follows, and what that is."""
_WITH_NAME = ("before", "after")
_DECISIONS = (*_BY_ITSELF, *_WITH_VALUE, *_WITH_NAME)
_RULED_OUT = {"link": ("linked", "false"), "tab": ("tab", "off")}
"""What can follow `no`, and the key and value that it stands for."""
EXPECTED = (
    "expected ID before ID, ID after ID, ID first, ID last, ID 5th, ID entry (X, Y), ID cw, ID ccw, no link ID, "
    "ID tab (X, Y), no tab ID or PART in zone N, where ID is a contour, a part, or #7 for cut 7 of the last plan; or a "
    "mapping such as {contour: P1.outer, before: P2.outer}"
)


def read_lock(text: str) -> Lock:
    """The lock that a line of text stands for, with the names as they are written; or that of a YAML mapping.

    Names that hold blanks and a word of the language stand in double quotes; in them a double quote is written twice.

    Raises
    ------
    InputError
        With the text, the word that is wrong, and what was expected.

    Examples
    --------
    >>> read_lock("P1.outer before P2.outer") == Lock(contour="P1.outer", before="P2.outer")
    True
    >>> read_lock("P1.outer last").position, read_lock("P1.outer 5th").position, read_lock("no link P1").linked
    ('last', 5, False)
    >>> read_lock("P1.outer entry (10, 20.5)").entry, read_lock('"last one" tab off').contour
    ((10.0, 20.5), 'last one')
    >>> read_lock('"3"" pipe" first').contour
    '3" pipe'
    >>> read_lock("P1 in zone 2") == read_lock("{part: P1, zone: 2}")
    True
    """
    problems = Problems("")
    try:
        node = compose(text, "") if text.lstrip().startswith("{") else _mapping(*_said(_WORD.findall(text)))
        if not isinstance(node, yaml.MappingNode):
            raise InputError(EXPECTED)
        locks = read_locks(yaml.SequenceNode("tag:yaml.org,2002:seq", [node], node.start_mark), problems)
        problems.raise_any()
    except InputError as error:
        raise InputError(f"lock {text!r}: {_NUMBERED.sub('', error.message)}") from None
    return replace(locks[0], place=None)


def lines_of(lock: Lock) -> Iterator[str]:
    """A lock in lines that read back as it, one for each thing that it decides.

    Examples
    --------
    >>> list(lines_of(Lock(contour="P1.outer", position="first", direction="cw", entry=(1.0, 2.5))))
    ['P1.outer first', 'P1.outer entry (1, 2.5)', 'P1.outer cw']
    """
    name = _written(lock.contour or lock.part or "")
    if lock.before is not None:
        yield f"{name} before {_written(lock.before)}"
    if lock.position is not None:
        yield f"{name} {lock.position}" if isinstance(lock.position, str) else f"{name} position {lock.position}"
    if lock.entry is not None:
        yield f"{name} entry {_point(lock.entry)}"
    if lock.direction is not None:
        yield f"{name} {lock.direction}"
    if lock.linked is not None:
        yield f"no link {name}"
    if lock.tab is not None:
        yield f"no tab {name}" if lock.tab == "off" else f"{name} tab {_point(lock.tab)}"
    if lock.zone is not None:
        yield f"{name} in zone {lock.zone}"


def _said(words: Sequence[str]) -> tuple[str, str, str]:
    """Name, key of a lock, and its value, of a line in words."""
    if len(words) > 2 and words[0] == "no" and words[1] in _RULED_OUT:
        return _name(words[2:]), *_RULED_OUT[words[1]]
    for at in range(1, len(words)):
        word, name, rest = words[at], _name(words[:at]), words[at + 1 :]
        if word in _BY_ITSELF or _NTH.fullmatch(word):
            if rest:
                raise InputError(f"nothing more was expected after {word!r}, got {' '.join(rest)!r}")
            nth = _NTH.fullmatch(word)
            return name, ("position" if nth else _BY_ITSELF[word]), (nth[1] if nth else word)
        if word in _WITH_NAME:
            if not rest:
                raise InputError(f"expected a contour, a part or #7 after {word!r}")
            return (name, "before", _name(rest)) if word == "before" else (_name(rest), "before", name)
        if word == "in" and rest[:1] == ["zone"]:
            word, rest = "zone", rest[1:]
        if word in _WITH_VALUE:
            return name, word, _value(word, rest)
    raise InputError(_says_nothing(words))


def _value(word: str, rest: Sequence[str]) -> str:
    if rest[:1] == ["at"] and word in ("entry", "tab"):
        rest = rest[1:]
    if not rest:
        raise InputError(f"expected {_WITH_VALUE[word]} after {word!r}")
    if len(rest) > 1:
        raise InputError(f"expected {_WITH_VALUE[word]} after {word!r}, got {' '.join(rest)!r}")
    return rest[0]


def _says_nothing(words: Sequence[str]) -> str:
    """A message for a line without any word that decides something; a name alone is answered with all there are."""
    if len(words) < 2:
        return EXPECTED
    guesses = ((word, nearest(word, _DECISIONS)) for word in words[1:])
    word, guess = next((found for found in guesses if found[1] is not None), (words[-1], None))
    hint = f"{word!r}: did you mean {guess!r}? " if guess else f"{word!r} decides nothing: "
    return hint + EXPECTED


def _name(words: Sequence[str]) -> str:
    """The name that words are: one in double quotes stands for what is between them."""
    name = " ".join(words)
    return name[1:-1].replace('""', '"') if re.fullmatch(_QUOTED, name) else name


def _written(name: str) -> str:
    """A name so that it is read as one."""
    words = _WORD.findall(name)
    plain = " ".join(words) == name and not any(word in (*_DECISIONS, "no", "in") for word in words)
    plain = plain and not any(_NTH.fullmatch(word) for word in words) and not name.startswith(("{", '"', "(", "["))
    doubled = name.replace('"', '""')
    return name if plain and name else f'"{doubled}"'


def _point(point: Point) -> str:
    return "(" + ", ".join(repr(int(v) if v == int(v) else v) for v in point) + ")"


def _mapping(name: str, key: str, value: str) -> yaml.Node:
    """The YAML of a line; a name may hold what YAML would want quoted."""
    start = yaml.Mark("", 0, 0, 0, "", 0)

    def scalar(text: str) -> yaml.Node:
        return yaml.ScalarNode("tag:yaml.org,2002:str", text, start, start)

    point = key in ("entry", "tab") and value.startswith(("(", "["))
    told = compose(f"[{value[1:-1]}]", "") if point else scalar(value)
    members = [(scalar("part" if key == "zone" else "contour"), scalar(name)), (scalar(key), told)]
    return yaml.MappingNode("tag:yaml.org,2002:map", members, start, start)
