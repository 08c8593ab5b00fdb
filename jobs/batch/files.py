"""Where the files of a row lie."""

from __future__ import annotations

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
