"""The folder that the server was started in: nests are read and files written there and below, and nowhere else."""

from __future__ import annotations

import math
import os
import re
import threading
import time
import unicodedata
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.readers.read import SUFFIXES
from kerfwise.postproc.output_files import write_files

FRESH_S, FRESH_SHARE = 0.2, 2.0
"""A list of the nests is not made anew sooner after the last one, nor before so many times as long as that took."""
_NAME = re.compile(r"[^\x00-\x1f/\\:*?\"<>|]{1,150}")
_NOT_NESTS = (".plan.json", ".schema.json", ".settings.json")


@dataclass(frozen=True, slots=True)
class Folder:
    """A folder, by its real path."""

    path: Path

    def nest(self, name: str) -> Path:
        """The path of a nest by its name in this folder.

        Raises InputError if there is none, or it is not in this folder: a link that leads out of it counts as not
        there.
        """
        wanted = PurePosixPath(name)
        if wanted.is_absolute() or ".." in wanted.parts or "\\" in name or "\x00" in name or not wanted.parts:
            raise InputError(f"no nest of this folder has the name {escape_text(name)!r}")
        if not is_readable(name):
            raise InputError(f"{escape_text(name)!r} is no name in UTF-8: give the file, or its folder, another name")
        path = self.path.joinpath(*wanted.parts)
        try:
            inside = path.resolve().is_relative_to(self.path)
        except (OSError, ValueError, RuntimeError):
            inside = False
        if not inside or path.suffix.lower() not in SUFFIXES or not path.is_file():
            raise InputError(f"no nest of this folder has the name {escape_text(name)!r}")
        return path

    def keep(self, name: str, drawing: bytes, beside: Path | None = None) -> Path:
        """Write a drawing that was dropped on the page, or a nest beside another, unless it is there already; its path.

        Raises InputError as `expect_free` does.
        """
        folder = self.path if beside is None else beside.parent
        self.expect_free(name, drawing, folder)
        self.expect_inside([folder])
        path = folder / name
        if not path.exists():
            write_files({path: drawing})
        return path

    def expect_free(self, name: str, drawing: bytes, folder: Path | None = None) -> None:
        """Make sure that a drawing can be written under a name, in this folder or one in it.

        Raises InputError if the name is no plain name of a nest, or another drawing has it.
        """
        if not _NAME.fullmatch(name) or name.startswith(".") or Path(name).suffix.lower() not in SUFFIXES:
            raise InputError(f"{escape_text(name)!r}: expected the name of a drawing, ending in {', '.join(SUFFIXES)}")
        if name.lower().endswith(_NOT_NESTS):
            raise InputError(f"{escape_text(name)!r} is the name of a plan, or of settings, not of a drawing")
        path = (folder or self.path) / name
        if path.is_symlink() or path.exists():
            if path.is_file() and not path.is_symlink() and path.read_bytes() == drawing:
                return
            raise InputError(
                f"another file {escape_text(name)!r} is in the folder already: give the drawing another name"
            )

    def expect_inside(self, paths: Iterable[Path]) -> None:
        """Make sure that files are read and written in this folder, wherever links lead to.

        Raises InputError naming the file that is elsewhere.
        """
        for path in paths:
            try:
                inside = path.resolve().is_relative_to(self.path)
            except (OSError, RuntimeError):
                inside = False
            if not inside:
                raise InputError(
                    "is a link that leads out of the folder: nothing is read or written there", file=path.name
                )


def is_readable(name: str) -> bool:
    """Whether a name is text; on Linux the name of a file may be any bytes.

    Examples
    --------
    >>> is_readable("Träger.dxf"), is_readable(b"Tr\\xe4ger.dxf".decode("utf-8", "surrogateescape"))
    (True, False)
    """
    return not any("\ud800" <= sign <= "\udfff" for sign in name)


# The nests of the folder, looked for in a thread: however many files there are, nobody waits for the last one.


class NestFile(NamedTuple):
    """A nest of the folder: its name, `/` between folders, its bytes, and when it was changed (seconds since 1970)."""

    name: str
    size: int
    changed: float


class NestList:
    """What nests there are; each look at the folder is a walk of its own, and what is known meanwhile is told."""

    def __init__(self, folder: Folder) -> None:
        self._folder = folder
        self._found: list[NestFile] = []
        self._stale_s, self._walk = -math.inf, threading.Thread()
        self._heads: dict[tuple[str, int, float], bool] = {}
        self._lock = threading.Lock()

    def known(self, within_s: float = 0.0) -> tuple[list[NestFile], bool]:
        """The nests in the order in which people count, and whether they are all; waits so long for the last ones."""
        with self._lock:
            if not self._walk.is_alive() and time.monotonic() > self._stale_s:
                self._walk = threading.Thread(target=self._look, daemon=True)
                self._walk.start()
        if self._walk.is_alive():
            self._walk.join(within_s)
        complete = not self._walk.is_alive()
        return sorted(self._found, key=lambda one: natural(one.name)), complete

    def _look(self) -> None:
        found: list[NestFile] = []
        began_s = time.monotonic()
        if not self._found:  # at first what is found is told as it is; later the whole list takes the place of the last
            self._found = found
        heads: dict[tuple[str, int, float], bool] = {}
        for path, told in _files_below(str(self._folder.path)):
            key = (path, told.st_size, told.st_mtime)
            nest = self._heads.get(key)
            heads[key] = nest = _is_nest(path, self._folder.path) if nest is None else nest
            if nest:
                name = Path(path).relative_to(self._folder.path).as_posix()
                found.append(NestFile(name, told.st_size, told.st_mtime))
        took_s = time.monotonic() - began_s
        self._found, self._heads, self._stale_s = found, heads, began_s + took_s + max(FRESH_S, FRESH_SHARE * took_s)


def natural(name: str) -> list[tuple[int, int, str]]:
    """A key by which plate 9 comes before plate 10.

    Examples
    --------
    >>> sorted(["plate10.dxf", "Träger.dxf", "Plate9.dxf", "a/1.dxf", "Traverse.dxf"], key=natural)
    ['a/1.dxf', 'Plate9.dxf', 'plate10.dxf', 'Träger.dxf', 'Traverse.dxf']
    """
    bare = re.sub(r"[\u0300-\u036f]", "", unicodedata.normalize("NFKD", name.casefold()))
    parts = re.split(r"([0-9]+)", bare)
    return [(0, int(part), "") if part.isdecimal() else (1, 0, part) for part in parts if part]


def _files_below(folder: str) -> Iterator[tuple[str, os.stat_result]]:
    """Files with the suffix of a nest in a folder and those below, hidden ones left out; links to folders as well."""
    waiting = [folder]
    while waiting:
        try:
            with os.scandir(waiting.pop()) as entries:
                for entry in entries:
                    if entry.name.startswith("."):
                        continue
                    try:
                        if entry.is_dir(follow_symlinks=False):
                            waiting.append(entry.path)
                        elif Path(entry.name).suffix.lower() in SUFFIXES and entry.is_file():
                            yield entry.path, entry.stat()
                    except OSError:
                        continue
        except OSError:
            continue


def _is_nest(path: str, folder: Path) -> bool:
    """Whether a file may be a nest: pictures that kerfwise drew are none, nor is any other JSON."""
    if path.lower().endswith(_NOT_NESTS):
        return False
    try:
        if Path(path).is_symlink() and not Path(path).resolve().is_relative_to(folder):
            return False
        suffix = Path(path).suffix.lower()
        if suffix == ".dxf":
            return True
        with open(path, "rb") as file:
            head = file.read(4000)
    except (OSError, RuntimeError):
        return False
    return b"kerfwise-nest/" in head if suffix == ".json" else b'id="sheet"' not in head
