"""A dialect: how one family of controls wants its program spelt. Read from data, a file each."""

from __future__ import annotations

import dataclasses
import difflib
import string
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any, Literal, get_args, get_origin, get_type_hints

import yaml

from ...encoder.errors import InputError

SHORTEST_LINE = 60


@dataclass(frozen=True, slots=True)
class LineNumbers:
    """The N word of the first block and the step from block to block."""

    start: int
    step: int


@dataclass(frozen=True, slots=True)
class Dialect:
    """What a control wants to read.

    Parameters
    ----------
    name, title, suffix
        The name a profile uses, the control's own name, and the ending of its files.
    header, footer
        Blocks before the first cut and after the last; the footer ends the program.
    torch_on, torch_off, mark_on, mark_off
        Blocks that start and stop the torch, and the tool that marks.
    rapid, line, arc_cw, arc_ccw
        Motion words.
    arc_centre
        Whether I and J count from the arc's start ("relative") or from the origin ("absolute").
    feed, dwell
        The feed word, with `{mm_min}`, and the block that waits, with `{seconds}`.
    pierce_dwell
        "program": the program waits for the profile's pierce time; "machine": the control does so by itself.
    comment
        A block that only a person reads, with `{text}`.
    line_numbers
        N words, or None for a program without.
    decimals
        Digits after the decimal point of a coordinate, mm.
    max_line
        Longest block the control takes, characters.
    """

    name: str
    title: str
    suffix: str
    header: tuple[str, ...]
    footer: tuple[str, ...]
    torch_on: str
    torch_off: str
    mark_on: str
    mark_off: str
    rapid: str
    line: str
    arc_cw: str
    arc_ccw: str
    arc_centre: Literal["relative", "absolute"]
    feed: str
    dwell: str
    pierce_dwell: Literal["machine", "program"]
    comment: str
    line_numbers: LineNumbers | None
    decimals: int
    max_line: int


def dialect_names() -> tuple[str, ...]:
    """The dialects that come with kerfwise.

    Examples
    --------
    >>> "linuxcnc-qtplasmac" in dialect_names()
    True
    """
    files = resources.files(__package__).iterdir()
    return tuple(sorted(f.name.removesuffix(".yaml") for f in files if f.name.endswith(".yaml")))


def load_dialect(name: str) -> Dialect:
    """The dialect of that name, or of a plant's own file when `name` ends in .yaml.

    Raises
    ------
    InputError
        For a name that is not there, and for a file that lacks a key, has one too many or one of the wrong type.

    Examples
    --------
    >>> load_dialect("linuxcnc-qtplasmac").torch_on
    'M3 $0 S1'
    """
    if name.endswith((".yaml", ".yml")):
        try:
            text = Path(name).read_text(encoding="utf-8")
        except OSError as error:
            raise InputError(f"cannot read the dialect: {error.strerror}", file=name) from None
        except UnicodeDecodeError:
            raise InputError("not a dialect: the file is not UTF-8 text", file=name) from None
        return parse_dialect(text, name)
    if name not in dialect_names():
        raise InputError(f"unknown dialect '{name}'{_nearest(name, dialect_names())}; a plant's own ends in .yaml")
    text = resources.files(__package__).joinpath(f"{name}.yaml").read_text(encoding="utf-8")
    return parse_dialect(text, f"{name}.yaml")


def parse_dialect(text: str, file: str) -> Dialect:
    """Read a dialect from YAML text; `file` is the name for messages (see `load_dialect`)."""
    try:
        node = yaml.compose(text, Loader=yaml.SafeLoader)
        data = yaml.safe_load(text)
    except yaml.YAMLError as error:
        mark = error.problem_mark if isinstance(error, yaml.MarkedYAMLError) else None
        reason = error.problem if isinstance(error, yaml.MarkedYAMLError) else "special characters are not allowed"
        raise InputError(f"not YAML: {reason}", file=file, line=mark.line + 1 if mark else None) from None
    if not isinstance(node, yaml.MappingNode):
        raise InputError("not a dialect: expected keys such as torch_on and line", file=file)
    lines = {key.value: key.start_mark.line + 1 for key, _ in node.value}
    hints = get_type_hints(Dialect)
    for key in data:
        if key not in hints:
            raise InputError(f"unknown key '{key}'{_nearest(str(key), tuple(hints))}", file=file, line=lines[str(key)])
    if missing := [key for key in hints if key not in data]:
        raise InputError(f"the dialect lacks {', '.join(missing)}", file=file)
    values = {}
    for key, hint in hints.items():
        try:
            values[key] = _value(data[key], hint)
        except ValueError as error:
            raise InputError(f"{key}: expected {error}, got {data[key]!r}", file=file, line=lines[key]) from None
    for key, hole in (("feed", "mm_min"), ("dwell", "seconds"), ("comment", "text")):
        if [field for _, field, _, _ in string.Formatter().parse(values[key]) if field is not None] != [hole]:
            raise InputError(f"{key}: expected one {{{hole}}}, got {values[key]!r}", file=file, line=lines[key])
    if values["max_line"] < SHORTEST_LINE:
        raise InputError(
            f"max_line: expected at least {SHORTEST_LINE}, got {values['max_line']}", file=file, line=lines["max_line"]
        )
    return Dialect(**values)


def _value(value: object, hint: Any) -> Any:
    """`value` as the field's type; ValueError says what was expected."""
    if get_origin(hint) is Literal:
        if value not in get_args(hint):
            raise ValueError(" or ".join(get_args(hint)))
        return value
    if get_origin(hint) is tuple:
        if not isinstance(value, list) or not all(isinstance(v, str) for v in value):
            raise ValueError("a list of blocks")
        return tuple(value)
    if hint in (str, int):
        if not isinstance(value, hint) or isinstance(value, bool) or value == "":
            raise ValueError("text" if hint is str else "a whole number")
        return value
    keys = {f.name for f in dataclasses.fields(LineNumbers)}
    if value is None:
        return None
    if not isinstance(value, dict) or set(value) != keys or not all(type(v) is int and v > 0 for v in value.values()):
        raise ValueError("{start: 10, step: 10} or null")
    return LineNumbers(**value)


def _nearest(word: str, names: tuple[str, ...]) -> str:
    close = difflib.get_close_matches(word, names, 1, 0.4)
    return f"; did you mean '{close[0]}'?" if close else f"; expected one of {', '.join(names)}"
