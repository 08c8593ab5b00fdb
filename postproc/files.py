"""Output files appear whole or not at all: written beside, then renamed."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path

from kerfwise.encoder.errors import InputError


def expect_folders(paths: Iterable[Path]) -> None:
    """Say at once, and not after the work is done, that a file has no folder to be in.

    Raises
    ------
    InputError
        Naming the file.
    """
    for path in paths:
        if not path.parent.is_dir():
            raise InputError(f"cannot write: there is no folder {str(path.parent)!r}", file=path)


def expect_outputs(outputs: Iterable[Path], inputs: Iterable[Path]) -> None:
    """Say at once that files cannot be written, or that one would take the place of another, or of what is read.

    Raises
    ------
    InputError
        Naming the file.
    """
    read = {path.resolve() for path in inputs}
    written: set[Path] = set()
    for path in outputs:
        expect_folders([path])
        place = path.resolve()
        if path.is_dir():
            raise InputError("cannot write: this is a folder; give the name of a file", file=path)
        if place in read:
            raise InputError("would be written over, and is read from: give the output another name", file=path)
        if place in written:
            raise InputError("two outputs have this name: give each its own", file=path)
        written.add(place)


def expect_place(folder: Path) -> None:
    """Say at once that a folder cannot be made.

    Raises
    ------
    InputError
        If there is no folder to make it in, or a file is in its place.
    """
    expect_folders([folder])
    if folder.exists() and not folder.is_dir():
        raise InputError("cannot make a folder there: it is a file", file=folder)


def make_folder(path: Path) -> None:
    """Make a folder, unless it is there.

    Raises
    ------
    InputError
        If it cannot be made.
    """
    try:
        path.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot make a folder there: {error.strerror}", file=path) from None


def write_files(contents: Mapping[Path, str | bytes]) -> None:
    """Write all files, or none: each is written beside its place and renamed once all are on disk.

    Raises
    ------
    InputError
        If a folder does not exist or may not be written.
    """
    beside: dict[Path, Path] = {}
    try:
        for path, content in contents.items():
            handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
            beside[path] = Path(name)
            with os.fdopen(handle, "wb") as file:
                file.write(content if isinstance(content, bytes) else content.encode("utf-8"))
            os.chmod(name, 0o666 & ~_umask())
        for path, temporary in beside.items():
            temporary.replace(path)
    except OSError as error:
        raise InputError(f"cannot write: {error.strerror}", file=path) from None
    finally:
        for temporary in beside.values():
            temporary.unlink(missing_ok=True)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
