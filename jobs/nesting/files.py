"""The files of a set of nests in their folder, and what an earlier run left there."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from kerfwise.encoder.contents import contents, is_file, is_folder
from kerfwise.encoder.errors import InputError
from kerfwise.nesting.written import nest_dxf
from kerfwise.postproc.files import expect_place, make_folder, write_files
from kerfwise.postproc.report import draw

from .run import Nested
from .table import FORMAT, as_csv, as_json

TABLE, ROWS = "nests.json", "nests.csv"
_FILES = "files"


def expect_folder(out: Path) -> None:
    """Say before the work that a folder cannot be that of nests: it is a file, or holds files of others.

    Raises
    ------
    InputError
        With what to do.
    """
    expect_place(out)
    if not is_folder(out):
        return
    own = {TABLE, *_before(out)}
    others = sorted(path.name for path in out.iterdir() if path.name[0] != "." and path.name not in own)
    if others:
        raise InputError(
            f"holds files that kerfwise nest did not write, such as {others[0]}: give an empty folder with -o", file=out
        )


def nest_files(nested: Nested, picture: str, dxf: bool) -> dict[str, str | bytes]:
    """The nests and their pictures by the names that they have: `picture` is how the names of these end."""
    made: dict[str, str | bytes] = {}
    for name, nest, text in zip(nested.names, nested.nests, nested.texts, strict=True):
        made[f"{name}.json"] = text
        made[f"{name}{picture}"] = draw(replace(nest, file=f"{name}.json"), None, Path(picture).suffix or picture)
        if dxf:
            made[f"{name}.dxf"] = nest_dxf(nest)
    return made


def write_nests(out: Path, nested: Nested, files: Mapping[str, str | bytes], **about: Any) -> list[Path]:
    """Write these files and the table, or none; those of an earlier run that are not made again are removed.

    Returns
    -------
    The files, the table last.
    """
    made = {**files, ROWS: as_csv(nested)}
    made[TABLE] = as_json(nested, **about, **{_FILES: list(made)})
    make_folder(out)
    before = _before(out)
    write_files({out / name: content for name, content in made.items()})
    for name in sorted(before - made.keys()):
        (out / name).unlink(missing_ok=True)
    return [out / name for name in made]


def _before(out: Path) -> set[str]:
    """Names of the files that an earlier run wrote."""
    table = out / TABLE
    if not is_file(table):
        return set()
    try:
        data: Mapping[str, Any] = json.loads(contents(table))
        names = data[_FILES] if data.get("format") == FORMAT else []
        return {name for name in names if isinstance(name, str) and Path(name).name == name}
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return set()
