"""Locks as a person writes them in one line: `P1.outer before P2.outer`."""

from __future__ import annotations

import re
from dataclasses import replace

import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.yaml_positions import Problems, compose

from .reader import read_locks

_KEYS = "before|position|entry|direction|linked|tab|zone"
_SHORT = re.compile(rf"\s*(?P<id>\S.*?)\s+(?P<key>{_KEYS})\s+(?P<value>\S.*?)\s*")
_NUMBERED = re.compile(r"^locks\[1\](\.|: )")
EXPECTED = (
    "expected ID before ID, ID position first|last|N, ID entry [X, Y], ID direction cw|ccw, ID linked false, "
    "ID tab [X, Y]|off or PART zone N, or a lock as a profile has it, such as {contour: P1.outer, before: P2.outer}"
)


def read_lock(text: str) -> Lock:
    """The lock that a line of text stands for: a contour or part, what is locked of it, and how; or a YAML mapping.

    Raises
    ------
    InputError
        With the text, and what was expected.

    Examples
    --------
    >>> read_lock("P1.outer before P2.outer") == Lock(contour="P1.outer", before="P2.outer")
    True
    >>> read_lock("P1.outer position last").position, read_lock("P1.outer entry [10, 20.5]").entry
    ('last', (10.0, 20.5))
    >>> read_lock("P1 zone 2") == read_lock("{part: P1, zone: 2}")
    True
    """
    problems = Problems("")
    try:
        short = None if text.lstrip().startswith("{") else _SHORT.fullmatch(text)
        node = compose(text, "") if short is None else _mapping(short)
        if not isinstance(node, yaml.MappingNode):
            raise InputError(EXPECTED)
        locks = read_locks(yaml.SequenceNode("tag:yaml.org,2002:seq", [node], node.start_mark), problems)
        problems.raise_any()
    except InputError as error:
        raise InputError(f"lock {text!r}: {_NUMBERED.sub('', error.message)}") from None
    return replace(locks[0], place=None)


def _mapping(short: re.Match[str]) -> yaml.Node:
    """The YAML of a short form; an id may hold what YAML would want quoted."""
    start = yaml.Mark("", 0, 0, 0, "", 0)

    def scalar(value: str) -> yaml.Node:
        return yaml.ScalarNode("tag:yaml.org,2002:str", value, start, start)

    value = compose(short["value"], "") if short["value"].startswith("[") else scalar(short["value"])
    about = "part" if short["key"] == "zone" else "contour"
    members = [(scalar(about), scalar(short["id"])), (scalar(short["key"]), value)]
    return yaml.MappingNode("tag:yaml.org,2002:map", members, start, start)
