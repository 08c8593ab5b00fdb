"""Files that are named after the nest because nobody named them: they take no place of what is made of another."""

from __future__ import annotations

import html
import json
import re
from pathlib import Path

from kerfwise.encoder.contents import is_file
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.readers.read import SUFFIXES
from kerfwise.encoder.shown import shown

_OF = re.compile(rb"\(NEST (.*) SHA256 ", re.IGNORECASE)
_HEAD_BYTES = 2000


def named_after(nest: Path) -> tuple[str, str, str]:
    """Names of the program, the plan and the picture of a nest.

    Examples
    --------
    >>> named_after(Path("nests/plate.dxf")), named_after(Path("plate.svg"))[2]
    (('plate.nc', 'plate.plan.json', 'plate.svg'), 'plate.plan.svg')
    """
    beside = f"{nest.stem}.plan.svg" if nest.suffix.lower() == ".svg" else f"{nest.stem}.svg"
    return f"{nest.stem}.nc", f"{nest.stem}.plan.json", beside


def expect_own(nest: Path, program: Path, plan: Path, picture: Path) -> None:
    """Refuse to write over the program, plan or picture of another nest: NEST.dxf and NEST.json give the same names.

    Raises
    ------
    InputError
        Naming the file that is there, and the nest it is of.
    """
    for path, made_of, alike in (
        (plan, _plan_of(plan), lambda name: name),
        (program, _program_of(program), lambda name: Path(name).suffix),
    ):
        if made_of is not None and alike(made_of).lower() != alike(shown(nest.name)).lower():
            raise InputError(f"is of {made_of}, and {nest.name} would take its place: {_HOW}", file=path)
    if is_file(picture) and not _is_picture_of(nest, picture):
        raise InputError(f"is no picture of {nest.name}, and one would take its place: {_HOW}", file=picture)


_HOW = "name the outputs (-o, --plan, --picture), or move it away"


def _plan_of(path: Path) -> str | None:
    """The file name of the nest that a plan is of; None where there is no plan that says so."""
    try:
        name = json.loads(path.read_bytes())["nest"]["file"]
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return None
    return name if isinstance(name, str) and name else None


def _program_of(path: Path) -> str | None:
    """The same of a program, where its head names a file of another kind: its characters may be fewer than names have.

    Where the kinds are the same so are the names, for the program is named after the nest.
    """
    found = _OF.search(_head(path))
    if found is None:
        return None
    name = found.group(1).decode("ascii", "replace")
    return name if Path(name).suffix.lower() in SUFFIXES else None


def _is_picture_of(nest: Path, path: Path) -> bool:
    head = _head(path).decode("utf-8", "replace")
    title = re.search("<title>(.*?)</title>", head)
    return '<g id="sheet">' in head and title is not None and shown(nest.name) in html.unescape(title.group(1))


def _head(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(_HEAD_BYTES)
    except OSError:
        return b""
