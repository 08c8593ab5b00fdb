"""YAML with the line and column of every node, and every mistake of a file collected before it is reported."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from kerfwise.encoder.errors import InputError

SHORT = 8000
"""Characters of a text whose nodes are kept: a shipped profile or dialect, which one command reads several times."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where something stands: file, line and column, both counted from 1."""

    file: str
    line: int
    column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


def wrong_at(place: Place | None, message: str) -> InputError:
    """The error for a mistake that stands at a place, where that is known."""
    if place is None:
        return InputError(message)
    return InputError(message, file=place.file, line=place.line, column=place.column)


@dataclass(slots=True)
class Problems:
    """The mistakes found so far in one file; `raise_any` reports them all in one `InputError`."""

    file: str
    found: list[tuple[int, int, str]] = field(default_factory=list)

    def add(self, node: yaml.Node, message: str) -> None:
        """Note a mistake at a node."""
        place = self.place(node)
        self.found.append((place.line, place.column, message))

    def place(self, node: yaml.Node) -> Place:
        """Where a node stands in this file."""
        return Place(self.file, node.start_mark.line + 1, node.start_mark.column + 1)

    def raise_any(self) -> None:
        """Raise InputError with the first mistake and the others as details, if there are any."""
        if not self.found:
            return
        (line, column, message), *rest = sorted(self.found)
        details = tuple(f"{self.file}:{ln}:{col}: {text}" for ln, col, text in rest)
        raise InputError(message, file=self.file, line=line, column=column, details=details)


def compose(text: str, file: str) -> yaml.Node | None:
    """The node tree of a YAML document, None for an empty one.

    Raises
    ------
    InputError
        If the text is not YAML, with the place and PyYAML's words for it.

    Examples
    --------
    >>> node = compose("kerf: 1.5", "plant.yaml")
    >>> [(key.value, value.value, value.start_mark.column + 1) for key, value in node.value]
    [('kerf', '1.5', 7)]
    """
    return _kept(text, file) if len(text) <= SHORT else _composed(text, file)


@lru_cache(maxsize=32)
def _kept(text: str, file: str) -> yaml.Node | None:
    """Nobody changes a node: all readers share it."""
    return _composed(text, file)


def _composed(text: str, file: str) -> yaml.Node | None:
    try:
        return yaml.compose(text, Loader=yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line, column = (mark.line + 1, mark.column + 1) if mark else (None, None)
        said = ", ".join(part for part in (error.context, error.problem) if part)
        if "'\\t'" in said:
            said = "a tab; YAML is indented with spaces"
        raise InputError(f"not YAML: {said}", file=file, line=line, column=column) from None
    except yaml.reader.ReaderError as error:
        raise InputError(f"not YAML: {error.reason} (character {error.character!r})", file=file) from None
    except RecursionError:
        raise InputError("not a profile: the YAML is nested too deeply", file=file) from None


def entries(node: yaml.Node, problems: Problems, what: str) -> Iterator[tuple[str, yaml.Node, yaml.Node]]:
    """Key text, key node and value node of a mapping; anything else, and a key given twice, is a problem."""
    if is_empty(node):
        return
    if not isinstance(node, yaml.MappingNode):
        problems.add(node, f"{what}: expected a mapping (key: value), got {shape(node)}")
        return
    seen: set[str] = set()
    for key, value in node.value:
        if not isinstance(key, yaml.ScalarNode):
            problems.add(key, f"{what}: expected a name as the key, got {shape(key)}")
        elif key.value in seen:
            problems.add(key, f"{what}: key {key.value!r} is given twice")
        else:
            seen.add(key.value)
            yield key.value, key, value


def items(node: yaml.Node, problems: Problems, what: str) -> list[yaml.Node]:
    """The members of a sequence; anything else is a problem."""
    if is_empty(node):
        return []
    if not isinstance(node, yaml.SequenceNode):
        problems.add(node, f"{what}: expected a list, got {shape(node)}")
        return []
    return list(node.value)


def is_empty(node: yaml.Node) -> bool:
    """Whether a value was left out (`key:` with nothing behind it, or null)."""
    return isinstance(node, yaml.ScalarNode) and node.tag == "tag:yaml.org,2002:null"


def shape(node: yaml.Node) -> str:
    """What a node is, for messages."""
    if isinstance(node, yaml.MappingNode):
        return "a mapping"
    if isinstance(node, yaml.SequenceNode):
        return f"a list of {len(node.value)}"
    return "nothing" if is_empty(node) else repr(node.value)


def plain(node: yaml.Node) -> Any:
    """The ordinary Python value of a node.

    Raises
    ------
    InputError
        If the node has a tag or a key that plain data cannot have.

    Examples
    --------
    >>> plain(compose("[1, two, {three: 3.0}]", "plant.yaml"))
    [1, 'two', {'three': 3.0}]
    """
    loader = yaml.SafeLoader("")
    try:
        return loader.construct_document(node)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or node.start_mark
        raise InputError(f"expected plain data: {error.problem}", line=mark.line + 1, column=mark.column + 1) from None
    except (ValueError, TypeError, LookupError, AttributeError, RecursionError) as error:
        # what a tag promises and the text does not keep, a date that there is not, a number of thousands of digits
        mark, said = node.start_mark, str(error)[:100]
        raise InputError(f"expected plain data: {said}", line=mark.line + 1, column=mark.column + 1) from None
    finally:
        loader.dispose()


def deepest(node: yaml.Node, *path: str) -> yaml.Node:
    """The node that the keys lead to, or the last one on the way that the file has."""
    for key in path:
        members = node.value if isinstance(node, yaml.MappingNode) else ()
        step = next((value for name, value in members if name.value == key), None)
        if step is None:
            return node
        node = step
    return node


def place_in(file: str, *paths: tuple[str, ...]) -> Place | None:
    """Where a file has the first of these keys that it has at all; None where it has none or cannot be read."""
    try:
        root = compose(Path(file).read_text(encoding="utf-8-sig"), file)
    except (OSError, UnicodeDecodeError, InputError):
        return None
    for path in paths:
        holder = deepest(root, *path[:-1]) if root is not None else None
        node = deepest(holder, path[-1]) if holder is not None else None
        if node is not None and node is not holder:
            return Problems(file).place(node)
    return None
