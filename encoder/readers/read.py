"""One door for every nest file."""

from __future__ import annotations

import hashlib
import os
import re
from dataclasses import replace
from pathlib import Path

from kerfwise.encoder.bridges.join import with_bridges
from kerfwise.encoder.contents import contents
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.shown import shown
from kerfwise.encoder.still_going import told_if_long
from kerfwise.encoder.validate import validated

from .mend import mended
from .not_closed import OpenLines
from .options import ReadOptions
from .refit import with_arcs

SUFFIXES = (".dxf", ".json", ".svg")


class BrokenNest(InputError):
    """A nest that can be read, but not cut as it is drawn: with the nest, so that it can be shown.

    `wrong` are the ids of the contours that the problems name, and of lines that do not close; such are scrap lines of
    the nest here.
    """

    def __init__(self, nest: Nest, error: InputError, file: Path) -> None:
        super().__init__(error.message, file=file, line=error.line, column=error.column, details=error.details)
        words = {word for text in (error.message, *error.details) for word in re.split(r"[\s,:]+", text)}
        self.nest = nest
        is_open = isinstance(error, OpenLines)
        self.wrong = tuple(c.id for c in nest.contours if c.id in words or (is_open and c.kind == "scrap"))


def read_nest(path: str | Path, options: ReadOptions = ReadOptions()) -> Nest:  # noqa: B008 - frozen
    """Read and check a nest: a sheet with the parts placed on it.

    Parameters
    ----------
    path
        A `.json` (kerfwise-nest/1), `.dxf` or `.svg` file; the suffix decides.
    options
        Units, layers, tolerances, and whether to repair.

    Returns
    -------
    A nest in mm, y up, every contour of it sound; its notes say what was doubtful and what was mended.

    Raises
    ------
    InputError
        When the file cannot be read, or what it holds cannot be cut; the one error lists all that is wrong.

    Examples
    --------
    >>> import tempfile
    >>> text = '{"format": "kerfwise-nest/1", "sheet": {"width": 100, "height": 50}, "parts": ['
    >>> text += '{"id": "A", "outer": [[5, 5], [45, 5], [45, 45], [5, 45]]}]}'
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "small.json")
    ...     _ = file.write_text(text)
    ...     nest = read_nest(file)
    >>> nest.file, [c.id for c in nest.contours], nest.contour("A.outer").polygon.area
    ('small.json', ['A.outer'], 1600.0)
    """
    file = Path(path)
    if os.path.isdir(file):  # unlike the method of a path it answers for any name
        raise InputError("this is a folder; expected a nest file", file=file)
    suffix = file.suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(f"cannot tell the format of '{file.name}': expected {', '.join(SUFFIXES)}", file=file)
    with told_if_long(f"reading {file.name}"):
        return _read(file, suffix, options)


def _read(file: Path, suffix: str, options: ReadOptions) -> Nest:
    data = file_bytes(file)
    try:
        nest = _nest(file, suffix, data, options)
        drawn = mended(nest) if options.repair else nest
        drawn = with_arcs(drawn, options.refit_arcs_mm) if options.refit_arcs_mm else drawn
    except OpenLines as error:
        raise BrokenNest(replace(error.nest(), file=shown(file.name)), error, file) from error.__cause__
    except InputError as error:
        raise InputError(
            error.message, file=file, line=error.line, column=error.column, details=error.details
        ) from error.__cause__
    try:
        checked = validated(drawn)
        if checked.bridges:
            joined = with_bridges(checked)
            checked = replace(validated(joined), notes=joined.notes)
    except InputError as error:
        raise BrokenNest(replace(drawn, file=shown(file.name)), error, file) from error.__cause__
    sha256 = hashlib.sha256(data).hexdigest()
    return replace(checked, file=shown(file.name), sha256=sha256, refit_arcs_mm=options.refit_arcs_mm)


def file_bytes(file: Path) -> bytes:
    """All bytes of a nest file; InputError if it cannot be opened or is empty."""
    try:
        data = contents(file)
    except FileNotFoundError:
        raise InputError("there is no such file", file=file) from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        raise InputError(f"the file cannot be opened: {error}", file=file) from None
    if not data.strip():
        raise InputError("the file is empty", file=file)
    return data


def _nest(file: Path, suffix: str, data: bytes, options: ReadOptions) -> Nest:
    """Each format's libraries are imported only when such a file is read."""
    if suffix == ".json":
        from .json_nest import read_json

        return read_json(data, options)
    from .drawing_nest import nest_of

    if suffix == ".dxf":
        from .dxf import read_dxf

        return nest_of(read_dxf(file, data, options), options)
    from .svg import read_svg

    return nest_of(read_svg(data, options), options)
