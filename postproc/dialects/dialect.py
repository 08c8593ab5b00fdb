"""A dialect: how one family of controls wants its program spelt. Read from data, a file each."""

from __future__ import annotations

import dataclasses
import string
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from typing import Any, Literal, get_args, get_origin, get_type_hints

import yaml

from kerfwise.encoder.contents import MOST_BYTES_OF_YAML, contents
from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems, compose, entries, plain, shape
from kerfwise.rules.profile.machine_section import PROCESSES, PierceDwell, Process
from kerfwise.rules.profile.profile import Profile

ControlName = Literal["linuxcnc-qtplasmac", "linuxcnc"]
HOLES = {"feed": "mm_min", "dwell": "seconds", "comment": "text"}
LEAST = {"decimals": 2, "max_line": 80}
MOST = {"decimals": 6, "max_line": 252}
"""More decimals than a control keeps, and lines that LinuxCNC cuts off, are refused."""
MOST_COUNT = 1000


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
    control
        Which of the check's readers reads its programs back: it knows the words of the control by itself.
    processes
        The processes that it is for; others are refused (see `fit.py`).
    assumes
        What each program assumes of the machine, a comment each: by process, and of what marks under "marks".
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
    control: ControlName
    processes: tuple[Process, ...]
    assumes: Mapping[str, tuple[str, ...]]
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
    pierce_dwell: PierceDwell
    comment: str
    line_numbers: LineNumbers | None
    decimals: int
    max_line: int


def pierce_dwell_of(profile: Profile, dialect: Dialect | None = None) -> PierceDwell:
    """Who waits at a pierce: what the profile says, else the dialect of its machine."""
    return profile.machine.pierce_dwell or (dialect or load_dialect(profile.machine.dialect)).pierce_dwell


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
            text = contents(name, MOST_BYTES_OF_YAML).decode("utf-8")
        except OSError as error:
            raise InputError(f"cannot read the dialect: {error.strerror}", file=name) from None
        except UnicodeDecodeError:
            raise InputError("not a dialect: the file is not UTF-8 text", file=name) from None
        except ValueError as error:  # a NUL, or half a character
            raise InputError(f"cannot read the dialect: no file can have this name ({error})", file=name) from None
        return parse_dialect(text, name)
    if name not in dialect_names():
        raise InputError(f"{unknown('dialect', name, dialect_names())}; the file of a plant's own ends in .yaml")
    text = resources.files(__package__).joinpath(f"{name}.yaml").read_text(encoding="utf-8")
    return parse_dialect(text, f"{name}.yaml")


def parse_dialect(text: str, file: str) -> Dialect:
    """Read a dialect from YAML text; `file` is the name for messages (see `load_dialect`)."""
    root = compose(text, file)
    if not isinstance(root, yaml.MappingNode):
        raise InputError("not a dialect: expected keys such as torch_on and line", file=file)
    problems = Problems(file)
    hints = get_type_hints(Dialect)
    values: dict[str, Any] = {}
    for key, key_node, node in entries(root, problems, "dialect"):
        if key not in hints:
            problems.add(key_node, unknown("key", key, hints))
            continue
        try:
            values[key] = _value(key, plain(node), hints[key])
        except InputError as error:
            problems.add(node, f"{key}: {error.message}")
        except ValueError as error:
            problems.add(node, f"{key}: expected {error}, got {shape(node)}")
    problems.raise_any()
    if missing := [key for key in hints if key not in values]:
        raise InputError(f"the dialect lacks {', '.join(missing)}", file=file)
    return Dialect(**values)


def _value(key: str, value: object, hint: Any) -> Any:
    """`value` as the field's type; ValueError says what was expected."""
    if get_origin(hint) is Literal:
        if value not in get_args(hint):
            raise ValueError(" or ".join(get_args(hint)))
    elif key == "processes":
        if not isinstance(value, list) or not value or not all(v in PROCESSES for v in value):
            raise ValueError(f"a list of {', '.join(PROCESSES)}")
        return tuple(value)
    elif key == "assumes":
        if not isinstance(value, dict) or not set(value) <= {*PROCESSES, "marks"}:
            raise ValueError(f"lists of comments under {', '.join(PROCESSES)} or marks")
        return {of: _value(of, told, tuple[str, ...]) for of, told in value.items()}
    elif get_origin(hint) is tuple:
        if not isinstance(value, list) or not all(isinstance(v, str) and v.isprintable() for v in value):
            raise ValueError("a list of blocks, a line each")
        return tuple(value)
    elif hint is str:
        if not isinstance(value, str) or not value:
            raise ValueError("text")
        if not value.isprintable():
            raise ValueError("one line of text")
        if key in HOLES and _holes(value) != [(HOLES[key], "", None)]:
            raise ValueError(f"one {{{HOLES[key]}}}, and no other brace")
    elif hint is int:
        least = LEAST.get(key, 0)
        most = MOST[key]
        if type(value) is not int or not least <= value <= most:
            raise ValueError(f"a whole number from {least} to {most}")
    elif value is not None:
        names = {f.name for f in dataclasses.fields(LineNumbers)}
        if (
            not isinstance(value, dict)
            or set(value) != names
            or not all(type(v) is int and 0 < v <= MOST_COUNT for v in value.values())
        ):
            raise ValueError(f"{{start: 10, step: 10}} (each up to {MOST_COUNT}) or null")
        return LineNumbers(**value)
    return value


def _holes(text: str) -> list[tuple[str, str | None, str | None]]:
    """The `{name}`s of a text, each with its format and conversion; ("", …) where its braces do not match."""
    try:
        return [(name, spec, turn) for _, name, spec, turn in string.Formatter().parse(text) if name is not None]
    except ValueError:
        return [("", None, None)]
