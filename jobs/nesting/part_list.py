"""Lists of parts read, YAML or JSON: every mistake with its line and column."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import yaml

from kerfwise.encoder.contents import MOST_BYTES_OF_YAML, contents
from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems, compose, entries, items
from kerfwise.rules.profile.reader import read_fields

from .rows import PartRow, SheetRow

PARTS, SHEETS = "parts", "sheets"


@dataclass(frozen=True, slots=True)
class PartList:
    """What a list says: parts, and sheets if it names any."""

    parts: tuple[PartRow, ...]
    sheets: tuple[SheetRow, ...] = ()


def is_list(path: Path, head: bytes) -> bool:
    """Whether a file is a list of parts: YAML, or JSON that is no nest."""
    return path.suffix.lower() in (".yaml", ".yml") or (
        path.suffix.lower() == ".json" and b"kerfwise-nest/" not in head
    )


def read_list(path: Path) -> PartList:
    """Read a list of parts.

    Raises
    ------
    InputError
        If it cannot be read, or is wrong anywhere, with line and column: all mistakes at once.
    """
    try:
        text = contents(path, MOST_BYTES_OF_YAML).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"not a list of parts: the file is not UTF-8 text ({error.reason})", file=path) from None
    except ValueError as error:
        raise InputError(f"cannot read the list: no file can have this name ({error})", file=path) from None
    except OSError as error:
        raise InputError(f"cannot read the list of parts: {error.strerror}", file=path) from None
    return list_of(text, str(path))


def list_of(text: str, file: str) -> PartList:
    """The list that a text holds.

    Examples
    --------
    >>> found = list_of("parts: [{part: a.dxf, quantity: 3}]", "day.yaml")
    >>> found.parts[0].quantity, str(found.parts[0].place)
    (3, 'day.yaml:1:9')
    """
    problems, root = Problems(file), compose(text, file)
    found: dict[str, yaml.Node] = {}
    for key, key_node, value in entries(root, problems, "list of parts") if root is not None else ():
        if key in (PARTS, SHEETS):
            found[key] = value
        else:
            problems.add(key_node, unknown("key", key, (PARTS, SHEETS)))
    parts = [_part(node, k, problems) for k, node in enumerate(_members(found, PARTS, problems), 1)]
    sheets = [_sheet(node, k, problems) for k, node in enumerate(_members(found, SHEETS, problems), 1)]
    problems.raise_any()
    if not parts:
        raise InputError("names no parts: expected parts: [{part: FILE, quantity: N}, …]", file=file)
    return PartList(tuple(parts), tuple(sheets))


def _members(found: Mapping[str, yaml.Node], key: str, problems: Problems) -> list[yaml.Node]:
    return items(found[key], problems, key) if key in found else []


def _part(node: yaml.Node, number: int, problems: Problems) -> PartRow:
    what, so_far = f"{PARTS}[{number}]", len(problems.found)
    row = read_fields(entries(node, problems, what), PartRow(), problems, what)
    if not row.part and len(problems.found) == so_far:
        problems.add(node, f"{what}: names no file: expected part: FILE")
    return replace(row, place=problems.place(node))


def _sheet(node: yaml.Node, number: int, problems: Problems) -> SheetRow:
    what, so_far = f"{SHEETS}[{number}]", len(problems.found)
    row = read_fields(entries(node, problems, what), SheetRow(), problems, what)
    if bool(row.size) == bool(row.file) and len(problems.found) == so_far:
        problems.add(node, f"{what}: expected either size: 3000x1500 or file: FILE")
    return replace(row, place=problems.place(node))
