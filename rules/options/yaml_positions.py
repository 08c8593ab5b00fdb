"""YAML with the line and column of every node, and every mistake of a file collected before it is reported."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import MOST_BYTES_OF_YAML, is_file, read_limited

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


def wrong_at(place: Place | None, message: str, file: str = "") -> InputError:
    """The error for a mistake that stands at a place, where that is known, else somewhere in a file."""
    if place is None:
        return InputError(message, file=file or None)
    return InputError(message, file=place.file, line=place.line, column=place.column)


def raise_together(errors: Iterable[InputError]) -> None:
    """Raise InputError with the first of these, and what the others say as details; nothing where there is none."""
    found = list(errors)
    if len(found) == 1:
        raise found[0]
    if found:
        first, others = found[0], found[1:]
        details = (*first.details, *(line for e in others for line in (str(e).splitlines()[0], *e.details)))
        raise InputError(first.message, file=first.file, line=first.line, column=first.column, details=details)


@dataclass(slots=True)
class Problems:
    """The mistakes found so far in one file; `raise_any` reports them all in one `InputError`.

    `elsewhere` are those of files that it names.
    """

    file: str
    found: list[tuple[int, int, str]] = field(default_factory=list)
    elsewhere: list[InputError] = field(default_factory=list)

    def add(self, node: yaml.Node, message: str) -> None:
        """Note a mistake at a node."""
        place = self.place(node)
        self.found.append((place.line, place.column, message))

    def place(self, node: yaml.Node) -> Place:
        """Where a node stands in this file."""
        return Place(self.file, node.start_mark.line + 1, node.start_mark.column + 1)

    def raise_any(self) -> None:
        """Raise InputError with the first mistake and the others as details, if there are any."""
        own = (InputError(text, file=self.file, line=line, column=column) for line, column, text in sorted(self.found))
        raise_together((*own, *self.elsewhere))


def compose(text: str, file: str) -> yaml.Node | None:
    """The node tree of a YAML document, None for an empty one.

    Raises InputError if the text is not YAML, with the place and PyYAML's words for it.

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
        message = ", ".join(part for part in (error.context, error.problem) if part)
        if "'\\t'" in message:
            message = "a tab; YAML is indented with spaces"
        raise InputError(f"not YAML: {message}", file=file, line=line, column=column) from None
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

    Raises InputError if the node has a tag or a key that plain data cannot have.

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
    """Where a file has the first of these keys that it has at all; None where it has none or cannot be read.

    No pipe is read: nobody knows whether anything comes out of it.
    """
    try:
        root = compose(read_limited(file, MOST_BYTES_OF_YAML).decode("utf-8-sig"), file) if is_file(file) else None
    except (OSError, UnicodeDecodeError, InputError):
        return None
    for path in paths:
        holder = deepest(root, *path[:-1]) if root is not None else None
        node = deepest(holder, path[-1]) if holder is not None else None
        if node is not None and node is not holder:
            return Problems(file).place(node)
    return None


# One value of a YAML text set, or taken out, with all else as it is: comments, order and spacing.


def with_value(text: str, path: Sequence[str], value: str) -> str:
    """The text with `value`, as YAML, under the keys of `path`; keys that are missing are added.

    Raises InputError if the text is not YAML.

    Examples
    --------
    >>> print(with_value("material:\\n  kerf: 1.5 mm  # wide\\n", ["material", "kerf"], "2 mm"), end="")
    material:
      kerf: 2 mm  # wide
    >>> with_value("material: {kerf: 1.5 mm}\\n", ["material", "thickness"], "8 mm")
    'material: {thickness: 8 mm, kerf: 1.5 mm}\\n'
    """
    node, begins = compose(text, ""), 0
    for depth, key in enumerate(path):
        if not isinstance(node, yaml.MappingNode) or not node.value:
            return _begun(text, node, begins, path[depth:], value, depth)
        found = next(((at, inner) for at, inner in node.value if at.value == key), None)
        if found is None:
            return _added(text, node, path[depth:], value)
        begins, node = text.index(":", found[0].end_mark.index) + 1, found[1]
    assert node is not None
    return _replaced(text, node, begins, value)


def with_item(text: str, key: str, value: str) -> str:
    """The text with `value`, as YAML, as one entry more of the list under a key; a list that is missing is added.

    Raises InputError if the text is not YAML.

    Examples
    --------
    >>> print(with_item("locks:\\n  - P1 first  # hot\\nquantity: 2\\n", "locks", "P2 last"), end="")
    locks:
      - P1 first  # hot
      - P2 last
    quantity: 2
    >>> with_item("{locks: [P1 first]}\\n", "locks", "P2 last"), with_item("", "locks", "P2 last")
    ('{locks: [P1 first, P2 last]}\\n', 'locks:\\n  - P2 last\\n')
    """
    root = compose(text, "")
    node = root if root is None else deepest(root, key)
    rows = node.value if isinstance(node, yaml.SequenceNode) else []
    if node is root or not isinstance(node, yaml.SequenceNode) or not rows:
        if isinstance(root, yaml.MappingNode) and root.flow_style:
            return with_value(text, [key], f"[{value}]")
        return with_value(text, [key], f"\n  - {value}").replace(f"{_key(key)}: \n", f"{_key(key)}:\n", 1)
    ends = _end(rows[-1])
    if node.flow_style:
        return f"{text[:ends]}, {value}{text[ends:]}"
    first = rows[0].start_mark
    dash = text[first.index - first.column : first.index].rstrip(" ")
    at = text.find("\n", ends)
    at = len(text) if at < 0 else at
    return f"{text[:at]}\n{dash} {value}{text[at:]}"


def without_value(text: str, path: Sequence[str]) -> str:
    """The text without the last key of `path`, and without what stood there; a mapping that is then empty goes too.

    Nothing is changed where there is no such key. Raises InputError if the text is not YAML.

    Examples
    --------
    >>> without_value("material: {kerf: 1.5 mm, thickness: 8 mm}  # plate\\n", ["material", "thickness"])
    'material: {kerf: 1.5 mm}  # plate\\n'
    >>> without_value("material:\\n  kerf: 1.5 mm  # wide\\nname: plant\\n", ["material", "kerf"])
    'name: plant\\n'
    """
    node = compose(text, "")
    found: tuple[yaml.MappingNode, int] | None = None
    for key in path:
        if not isinstance(node, yaml.MappingNode):
            return text
        at = next((k for k, (name, _) in enumerate(node.value) if name.value == key), None)
        if at is None:
            return text
        if found is None or len(node.value) > 1:
            found = node, at
        node = node.value[at][1]
    return text if found is None else _cut_out(text, *found)


def without_item(text: str, place: Place) -> str | None:
    """The text without the entry of a list that begins at a place; where it was the only one, without the list's key.

    None where no entry begins there. Raises InputError if the text is not YAML.

    Examples
    --------
    >>> without_item("locks:\\n  - P1 first\\n  - P2 last  # hot\\n", Place("", 3, 5))
    'locks:\\n  - P1 first\\n'
    >>> without_item("locks: [P1 first, P2 last]\\n", Place("", 1, 9))
    'locks: [P2 last]\\n'
    """
    root = compose(text, "")
    for key, node in root.value if isinstance(root, yaml.MappingNode) else ():
        rows: list[yaml.Node] = node.value if isinstance(node, yaml.SequenceNode) else []
        marks = [(item.start_mark.line + 1, item.start_mark.column + 1) for item in rows]
        if (place.line, place.column) not in marks:
            continue
        if len(rows) == 1:
            return without_value(text, [key.value])
        at = marks.index((place.line, place.column))
        if not node.flow_style:
            dash = text.rfind("-", 0, rows[at].start_mark.index)
            ends = text.find("\n", _end(rows[at]))
            return text[: text.rfind("\n", 0, dash) + 1] + (text[ends + 1 :] if ends >= 0 else "")
        if at:
            return text[: _end(rows[at - 1])] + text[_end(rows[at]) :]
        return text[: rows[0].start_mark.index] + text[rows[1].start_mark.index :]
    return None


def _cut_out(text: str, node: yaml.MappingNode, at: int) -> str:
    """Without one entry of a mapping; in a block, without the rest of its last line too."""
    key, value = node.value[at]
    if not node.flow_style:
        line = text.rfind("\n", 0, key.start_mark.index) + 1
        ends = text.find("\n", max(_end(value), key.end_mark.index))
        return text[:line] + (text[ends + 1 :] if ends >= 0 else "")
    if at:
        return text[: _end(node.value[at - 1][1])] + text[_end(value) :]
    after = node.value[1][0].start_mark.index if len(node.value) > 1 else _end(value)
    return text[: key.start_mark.index] + text[after:]


def _replaced(text: str, node: yaml.Node, begins: int, value: str) -> str:
    """Another value after the colon of its key, at `begins`; comments between that and a block stay."""
    between = text[begins : node.start_mark.index]
    line, newline, _ = between.partition("\n")
    kept = f"  {line.strip()}" if newline and line.strip() else ""
    return f"{text[:begins]} {value}{kept}{text[_end(node) :]}"


def _end(node: yaml.Node) -> int:
    """Where the last word of a value ends; PyYAML lets a block end where the next one begins."""
    while isinstance(node, yaml.CollectionNode) and not node.flow_style and node.value:
        last = node.value[-1]
        node = last[1] if isinstance(node, yaml.MappingNode) else last
    return node.end_mark.index


def _added(text: str, node: yaml.MappingNode, path: Sequence[str], value: str) -> str:
    """The key before the first one of a mapping; at the end of the text where that is the whole.

    There an empty line parts it from what stands before, where empty lines part other keys too.
    """
    if node.flow_style:
        at = node.start_mark.index + 1
        return f"{text[:at]}{_flow(path, value)}, {text[at:]}"
    first = node.value[0][0].start_mark
    if first.column == 0:
        apart = "\n" if re.search(r"\n[ \t]*\n", text.rstrip()) else ""
        return f"{text.rstrip()}\n{apart}{_block(path, value, 0)}\n"
    line = first.index - first.column
    return f"{text[:line]}{_block(path, value, first.column)}\n{text[line:]}"


def _begun(text: str, node: yaml.Node | None, begins: int, path: Sequence[str], value: str, depth: int) -> str:
    """The first key under one that has none yet, or of an empty text."""
    if node is None or is_empty(node):
        at = len(text.rstrip()) if node is None else node.start_mark.index
        start = "" if node is None and not text.strip() else "\n"
        return f"{text[:at]}{start}{_block(path, value, 2 * depth)}{text[at:] or chr(10)}"
    return _replaced(text, node, begins, f"{{{_flow(path, value)}}}")


def _flow(path: Sequence[str], value: str) -> str:
    *outer, last = map(_key, path)
    return "".join(f"{key}: {{" for key in outer) + f"{last}: {value}" + "}" * len(outer)


def _block(path: Sequence[str], value: str, indent: int) -> str:
    *outer, last = map(_key, path)
    lines = [f"{' ' * (indent + 2 * k)}{key}:" for k, key in enumerate(outer)]
    return "\n".join([*lines, f"{' ' * (indent + 2 * len(outer))}{last}: {value}"])


def _key(name: str) -> str:
    """A name as a key: in quotes where YAML would not read it as it stands."""
    return name if re.fullmatch(r"\w[\w./-]*", name) else json.dumps(name, ensure_ascii=False)
