"""Where the files of a row lie, and how old ones go."""

from __future__ import annotations

from pathlib import Path

from kerfwise.encoder.errors import InputError

from .row import Row


def file_of(row: Row, ending: str) -> str:
    """The path of a row's file with that ending, from the index, with `/` between folders; "" where it has none.

    Examples
    --------
    >>> file_of(Row("6 mm/a", "a.dxf", "plasma", "planned", files={"a.nc": "", "a.svg": ""}), ".nc")
    'plasma/6 mm/a.nc'
    """
    folder, _, stem = row.nest.rpartition("/")
    name = f"{stem}{ending}"
    return "/".join(part for part in (row.machine, folder, name) if part) if name in row.files else ""


def remove(path: Path, what: str) -> None:
    """Remove a file that is of something older, so that nobody cuts by it; it may be gone already.

    Raises
    ------
    InputError
        If it cannot be removed.
    """
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"is of {what}, and cannot be removed: {error.strerror}", file=path) from None
