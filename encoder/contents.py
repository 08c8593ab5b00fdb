"""What a file that a person names holds, read up to a size that no good one has."""

from __future__ import annotations

import os
from pathlib import Path

from .errors import InputError

MOST_BYTES = 256_000_000
"""Of nests, plans and programs: those of ten thousand contours have a tenth of it."""
MOST_BYTES_OF_YAML = 1_000_000
"""Of profiles and dialects: shipped ones have a hundredth of it; a megabyte takes seconds to read."""


def contents(path: str | Path, most_bytes: int = MOST_BYTES) -> bytes:
    """All bytes of a file. What never ends (a device, a pipe that is fed for ever) is not read to its end.

    Raises
    ------
    InputError
        If it holds more than `most_bytes`.
    OSError, ValueError
        If it cannot be read, or no file can have this name.
    """
    with open(path, "rb") as file:
        data = file.read(most_bytes + 1)
    if len(data) > most_bytes:
        raise InputError(f"holds over {most_bytes // 1_000_000} MB: too large to be what it should be", file=path)
    return data


def is_file(path: str | Path) -> bool:
    """Whether there is a file of that name. It answers for every name; `Path` raises for one that is too long."""
    return os.path.isfile(path)


def is_folder(path: str | Path) -> bool:
    """Whether there is a folder of that name, whatever the name."""
    return os.path.isdir(path)


def is_there(path: str | Path) -> bool:
    """Whether there is anything of that name, whatever the name."""
    return os.path.exists(path)
