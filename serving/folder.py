"""The folder that the server was started in: nests are read and files written there, and nowhere else."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.readers.read import SUFFIXES
from kerfwise.encoder.shown import shown
from kerfwise.postproc.files import write_files

MOST_NESTS = 2000
_NAME = re.compile(r"[^\x00-\x1f/\\:*?\"<>|]{1,150}")
_NOT_NESTS = (".plan.json", ".schema.json", ".settings.json")


@dataclass(frozen=True, slots=True)
class Folder:
    """A folder, by its real path."""

    path: Path

    def nests(self) -> Iterator[str]:
        """Names of the nests in it and in the folders below, `/` between; hidden ones are left out.

        A name that is no UTF-8 holds halves of characters that stand alone: no nest is opened by it (`is_readable`).
        """
        found = 0
        for path in sorted(self.path.rglob("*")):
            name = path.relative_to(self.path)
            if any(part.startswith(".") for part in name.parts) or not self._is_nest(path):
                continue
            found += 1
            if found > MOST_NESTS:
                return
            yield name.as_posix()

    def nest(self, name: str) -> Path:
        """The path of a nest by its name in this folder.

        Raises
        ------
        InputError
            If there is none, or it is not in this folder: a link that leads out of it counts as not there.
        """
        wanted = PurePosixPath(name)
        if wanted.is_absolute() or ".." in wanted.parts or "\\" in name or "\x00" in name or not wanted.parts:
            raise InputError(f"no nest of this folder has the name {shown(name)!r}")
        if not is_readable(name):
            raise InputError(f"{shown(name)!r} is no name in UTF-8: give the file, or its folder, another name")
        path = self.path.joinpath(*wanted.parts)
        try:
            inside = path.resolve().is_relative_to(self.path)
        except (OSError, ValueError, RuntimeError):
            inside = False
        if not inside or path.suffix.lower() not in SUFFIXES or not path.is_file():
            raise InputError(f"no nest of this folder has the name {shown(name)!r}")
        return path

    def keep(self, name: str, drawing: bytes) -> Path:
        """Write a drawing that was dropped on the page, unless it is there already; its path.

        Raises
        ------
        InputError
            As `expect_free` does.
        """
        self.expect_free(name, drawing)
        path = self.path / name
        if not path.exists():
            write_files({path: drawing})
        return path

    def expect_free(self, name: str, drawing: bytes) -> None:
        """Make sure that a drawing can be written under a name.

        Raises
        ------
        InputError
            If the name is no plain name of a nest, or another drawing has it.
        """
        if not _NAME.fullmatch(name) or name.startswith(".") or Path(name).suffix.lower() not in SUFFIXES:
            raise InputError(f"{shown(name)!r}: expected the name of a drawing, ending in {', '.join(SUFFIXES)}")
        if name.lower().endswith(_NOT_NESTS):
            raise InputError(f"{shown(name)!r} is the name of a plan, or of settings, not of a drawing")
        path = self.path / name
        if path.is_symlink() or path.exists():
            if path.is_file() and not path.is_symlink() and path.read_bytes() == drawing:
                return
            raise InputError(f"another file {shown(name)!r} is in the folder already: give the drawing another name")

    def expect_inside(self, paths: Iterable[Path]) -> None:
        """Make sure that files are written in this folder, wherever links lead to.

        Raises
        ------
        InputError
            Naming the file that would be written elsewhere.
        """
        for path in paths:
            try:
                inside = path.resolve().is_relative_to(self.path)
            except (OSError, RuntimeError):
                inside = False
            if not inside:
                raise InputError("is a link that leads out of the folder: nothing is written there", file=path.name)

    def _is_nest(self, path: Path) -> bool:
        try:
            return (
                path.suffix.lower() in SUFFIXES
                and not path.name.lower().endswith(_NOT_NESTS)
                and path.is_file()
                and path.resolve().is_relative_to(self.path)
                and (path.suffix.lower() == ".dxf" or _begins_as_nest(path))
            )
        except (OSError, RuntimeError):
            return False


def is_readable(name: str) -> bool:
    """Whether a name is text; on Linux the name of a file may be any bytes.

    Examples
    --------
    >>> is_readable("Träger.dxf"), is_readable(b"Tr\\xe4ger.dxf".decode("utf-8", "surrogateescape"))
    (True, False)
    """
    return not any("\ud800" <= sign <= "\udfff" for sign in name)


def _begins_as_nest(path: Path) -> bool:
    """Whether an SVG or JSON file may be a nest: pictures that kerfwise drew are none, nor is any other JSON."""
    with path.open("rb") as file:
        head = file.read(4000)
    return b"kerfwise-nest/" in head if path.suffix.lower() == ".json" else b'id="sheet"' not in head
