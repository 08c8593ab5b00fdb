"""Changes of a nest, each a thing that a planner says in a line, and what of files belongs to them."""

from __future__ import annotations

import json
import os
import re
import shlex
from dataclasses import dataclass
from pathlib import Path

from kerfwise.apps.nesting.placement.demand import PartType
from kerfwise.apps.nesting.request import part_types
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import is_file, read_limited
from kerfwise.encoder.nest import Nest, Sheet
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.jobs.inputs import Tell, silent
from kerfwise.jobs.nest_job import Job
from kerfwise.jobs.nest_job.request import Names
from kerfwise.rules.options.yaml_positions import without_item
from kerfwise.rules.profile.load import shipped_profiles

_FARTHEST = 1e6


def _expect_amounts(line: str, *amounts: float) -> None:
    """Refuse what is no length and no angle, or beyond every sheet."""
    if not all(abs(amount) <= _FARTHEST for amount in amounts):
        raise InputError(f"{line}: expected numbers from {-_FARTHEST:g} to {_FARTHEST:g}")


@dataclass(frozen=True, slots=True)
class Drop:
    """Parts are left out."""

    parts: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Keep:
    """All other parts are left out; where they are cut already, their metal is out, and the sheet has holes there."""

    parts: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Move:
    """A part is moved, mm."""

    part: str
    dx_mm: float
    dy_mm: float

    def __post_init__(self) -> None:
        _expect_amounts(f"move {self.part} {self.dx_mm:g} {self.dy_mm:g}", self.dx_mm, self.dy_mm)


@dataclass(frozen=True, slots=True)
class Turn:
    """A part is turned counter-clockwise about its middle, degrees."""

    part: str
    turn_deg: float

    def __post_init__(self) -> None:
        _expect_amounts(f"turn {self.part} {self.turn_deg:g}", self.turn_deg)


@dataclass(frozen=True, slots=True)
class Mirror:
    """A part is turned over, left to right, about its middle."""

    part: str


@dataclass(frozen=True, eq=False, slots=True)
class OtherSheet:
    """Another sheet lies under the nest, its lower left corner where that of the old one is."""

    sheet: Sheet


@dataclass(frozen=True, eq=False, slots=True)
class Add:
    """Parts are laid into free room, as many of each as its type says."""

    types: tuple[PartType, ...]


@dataclass(frozen=True, slots=True)
class NestAnew:
    """All parts but those that are fixed are laid anew around these."""

    fixed: tuple[str, ...] = ()


Edit = Drop | Keep | Move | Turn | Mirror | OtherSheet | Add | NestAnew


def edit_of(line: str, reading: ReadOptions = ReadOptions()) -> Edit:  # noqa: B008 - frozen
    """The change that a line says: `drop P1 P2`, `keep P1`, `move P1 10 -5`, `turn P1 90`, `mirror P1`, `nest-anew P1`.

    Names with blanks stand in quotes. A sheet is given as `sheet 400x300`; `add FILE=N` adds parts of a file, which is
    read as `reading` says.

    Raises InputError with what was expected.

    Examples
    --------
    >>> edit_of("move P1 10 -5.5"), edit_of('drop "a part" P2')
    (Move(part='P1', dx_mm=10.0, dy_mm=-5.5), Drop(parts=('a part', 'P2')))
    """
    try:
        verb, *words = shlex.split(line)
        match verb, words:
            case "drop", [_, *_]:
                return Drop(tuple(words))
            case "keep", [_, *_]:
                return Keep(tuple(words))
            case "move", [part, dx, dy]:
                return Move(part, float(dx), float(dy))
            case "turn", [part, turn]:
                return Turn(part, float(turn))
            case "mirror", [part]:
                return Mirror(part)
            case "add", [file]:
                return added(file, reading)
            case "nest-anew", _:
                return NestAnew(tuple(words))
            case "sheet", [size]:
                width, _, height = size.lower().partition("x")
                wide, high = float(width), float(height)
                if 0 < wide <= _FARTHEST and 0 < high <= _FARTHEST:
                    return OtherSheet(Sheet.rectangle(wide, high))
    except ValueError:
        pass
    known = (
        "drop PART…, keep PART…, move PART DX DY, turn PART DEG, mirror PART, nest-anew [PART…], sheet WxH, add FILE=N"
    )
    raise InputError(f"{line!r} is no change of a nest: expected {known}")


def added(text: str, reading: ReadOptions, tell: Tell = silent) -> Add:
    """Parts to be added, from a file with its quantity behind it: `bracket.dxf=2`."""
    return Add(part_types([text], reading, tell))


def job_text_for(job: Job, nest: Nest, beside: Path) -> tuple[str, tuple[str, ...]]:
    """The text of a job file for an edited nest in its own file; profile and chart are named as seen from there.

    Locks that name what the nest does not have any more are left out of it: why, a sentence each, stands beside it.
    Raises InputError if such a lock is no entry of a list in the file, or a file cannot be named from there.
    """
    old = Path(job.file)
    names = Names(nest, lambda number: number)
    text, lost = read_limited(old).decode("utf-8-sig"), []
    for lock in reversed(job.locks):
        try:
            for _ in names.on_nest(lock):
                pass
        except InputError as error:
            if lock.place is None or (without := without_item(text, lock.place)) is None:
                raise
            text = without
            lost.append(error.message)
    left_out = tuple(reversed(lost))
    if old.resolve().parent == beside.resolve().parent:
        return text, left_out
    files = {one.key: one.text for one in job.settings if one.key in ("material.chart", "machine.dialect")}
    if job.profile is not None and job.profile not in shipped_profiles():
        files["profile"] = job.profile
    for key, named in files.items():
        if is_file(file := old.parent / named):
            text = _renamed(text, key, named, os.path.relpath(file.resolve(), beside.resolve().parent))
    return text, left_out


def _renamed(text: str, key: str, named: str, other: str) -> str:
    """A job file's text that names a file otherwise."""
    line = re.compile(rf"^(\s*{re.escape(key)}\s*:\s*)(['\"]?){re.escape(named)}\2(?=\s|$)", re.MULTILINE)
    text, count = line.subn(lambda found: found[1] + json.dumps(Path(other).as_posix(), ensure_ascii=False), text)
    if count != 1:
        raise InputError(f"it names {key} {named} from its own folder")
    return text
