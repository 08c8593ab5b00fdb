"""The folder of a batch: programs and records, written whole, by one run at a time, known again by content."""

from __future__ import annotations

import hashlib
import json
import sqlite3
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import is_file, is_folder, is_there, read_limited
from kerfwise.postproc.output_files import make_folder, write_files

from .result import PLAN, RECORD, Row, row_of

LOCK = ".batch.lock"
"""An empty file: that it is there says that the folder is a batch's, that it is locked that a run writes there."""


@contextmanager
def lock_folder(out: Path) -> Iterator[None]:
    """Have the folder of a batch to oneself, made where it is not there.

    The system frees the lock when the process ends, however it ends. A lock of SQLite's is one on every system. Raises
    InputError if another run has it, it holds what no batch has written, or cannot be written.
    """
    if is_folder(out) and not is_there(out / LOCK) and any(out.iterdir()):
        raise InputError("holds files that no batch wrote: give the batch a folder of its own with -o", file=out)
    if is_there(out) and not is_folder(out):
        raise InputError("this is a file: give the batch a folder with -o", file=out)
    make_folder(out, parents=True)
    try:
        with closing(sqlite3.connect(out / LOCK, timeout=0, isolation_level=None)) as lock:
            lock.execute("BEGIN EXCLUSIVE")
            yield
    except sqlite3.OperationalError as error:
        if "locked" in str(error):
            text = "another batch is writing there: wait until it has ended, or give this one another folder"
        else:
            text = f"cannot be locked for this batch: {error}"
        raise InputError(text, file=out) from None


class Store:
    """What is finished in the folder of a batch."""

    def __init__(self, out: Path) -> None:
        self.out = out
        self._rows: dict[tuple[str, str], Row] = {}
        for path in sorted(out.rglob(f"*{RECORD}")):
            row = _read(path)
            if row is not None and path == self._record(row):
                self._rows[row.machine, row.nest] = row

    def names(self) -> dict[str, Path]:
        """The name of every nest that has a record, and its file."""
        return {row.nest: Path(row.source) for row in self._rows.values()}

    def rows(self) -> tuple[Row, ...]:
        """Every record, by machine and nest."""
        return tuple(row for _, row in sorted(self._rows.items()))

    def known(self, machine: str, nest: str) -> Row | None:
        """The record of a nest on a machine, whether it is finished or not; None where there is none."""
        return self._rows.get((machine, nest))

    def finished(self, machine: str, nest: str, key: str) -> Row | None:
        """The row of what is finished with this key, if its files are there as they were written."""
        row = self._rows.get((machine, nest))
        if row is None or row.key != key or not row.for_good:
            return None
        folder = self._record(row).parent
        return row if all(has_content(folder / name, sha256) for name, sha256 in row.files.items()) else None

    def keep(self, row: Row, files: Mapping[str, str | bytes]) -> Row:
        """Write the files of a row with its record, all of them or none; files that it has no more are removed first.

        An old plan stays: the job file may call cuts by the numbers that they have in it. Raises InputError if they
        cannot be written.
        """
        row = replace(row, files={name: _sha256(content) for name, content in files.items()})
        record = self._record(row)
        make_folder(record.parent, parents=True)
        before = self._rows.get((row.machine, row.nest))
        if before is not None:
            self._remove(before, before.files.keys() - row.files.keys())
        write_files({**{record.parent / name: content for name, content in files.items()}, record: row.as_json()})
        self._rows[row.machine, row.nest] = row
        return row

    def leave(self, machine: str, nest: str) -> None:
        """Remove what was written of a nest that is not for a machine any more; its plan stays, as in `keep`.

        Raises InputError if a file cannot be removed.
        """
        row = self._rows.get((machine, nest))
        if row is not None:
            self._remove(row, row.files)

    def forget(self, row: Row) -> bool:
        """Remove all that was written of a row, and its record; whether a program was among it.

        A file that is not as it was written stays. Raises InputError if a file cannot be removed.
        """
        record = self._record(row)
        files = {record.parent / Path(name).name: sha256 for name, sha256 in row.files.items()}
        ours = [path for path, sha256 in files.items() if has_content(path, sha256)]
        for path in (*ours, record):
            remove(path, "a nest that is gone")
        del self._rows[row.machine, row.nest]
        return any(path.suffix == ".nc" for path in ours)

    def _remove(self, row: Row, names: Iterable[str]) -> None:
        """Remove files of a row but its plan. The record stays: with its files gone the nest is planned again."""
        for name in sorted(names):
            if not name.endswith(PLAN):
                remove(self._record(row).parent / Path(name).name, "an older nest")

    def _record(self, row: Row) -> Path:
        return self.out / row.machine / f"{row.nest}{RECORD}"


def _read(path: Path) -> Row | None:
    try:
        return row_of(json.loads(read_limited(path)))
    except (*UNREADABLE, RecursionError):
        return None


def _sha256(content: str | bytes) -> str:
    return hashlib.sha256(content if isinstance(content, bytes) else content.encode()).hexdigest()


# Where the files of a row lie, and how old ones go.


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

    Raises InputError if it cannot be removed.
    """
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"is of {what}, and cannot be removed: {error.strerror}", file=path) from None


# Programs in the folder of a batch that earlier runs wrote and that this one does not name.


@dataclass(frozen=True, slots=True)
class StaleOutput:
    """The program of a nest on a machine; `program` is its path from the index.

    `given` says whether the nest is in this batch, on other machines; `there` whether its file is still there.
    """

    nest: str
    source: str
    machine: str
    program: str
    given: bool
    there: bool

    @property
    def why(self) -> str:
        """Why it is in no row, in a few words."""
        if self.given:
            return "it is not planned on this machine here"
        return "its drawing is not among those that are given" if self.there else "its drawing is gone"


def stale_outputs(store: Store, pieces: Collection[tuple[str, str]]) -> tuple[StaleOutput, ...]:
    """What is left, machine by machine; `pieces` are the (machine, nest) of this batch."""
    return tuple(_left(store, pieces))


def _left(store: Store, pieces: Collection[tuple[str, str]]) -> Iterator[StaleOutput]:
    nests = {nest for _, nest in pieces}
    for row in store.rows():
        program = file_of(row, ".nc")
        if (row.machine, row.nest) not in pieces and program and is_file(store.out / program):
            there = is_file(Path(row.source))
            yield StaleOutput(row.nest, row.source, row.machine, program, row.nest in nests, there)


def tidy(store: Store, pieces: Collection[tuple[str, str]]) -> int:
    """Remove what earlier runs wrote of nests that are not in this batch; how many programs that were.

    A file that somebody has changed since stays, and so do programs of nests that are in it, for other machines. Raises
    InputError if a file cannot be removed.
    """
    nests = {nest for _, nest in pieces}
    return sum(store.forget(row) for row in store.rows() if row.nest not in nests)


# Work that was done before is known again by its content: the bytes that it was made of, and all else that counts.

UNREADABLE = (OSError, ValueError, InputError)
"""What `read_limited` raises."""


def key_of(files: Iterable[Path], besides: Mapping[str, Any]) -> str:
    """The sha256 of files, their names among it, and of all that an answer depends on besides them.

    A file that cannot be read counts by its name: it is another one as soon as it can.

    Examples
    --------
    >>> [key_of([], {"work": work}) == key_of([], {"work": 30.0}) for work in (30.0, 20.0)]
    [True, False]
    """
    total = hashlib.sha256(json.dumps(besides, sort_keys=True).encode())
    for file in files:
        try:
            digest = hashlib.sha256(read_limited(file)).hexdigest()
        except UNREADABLE:
            digest = "cannot be read"
        total.update(f"\0{file.name}\0{digest}".encode("utf-8", "surrogateescape"))
    return total.hexdigest()


def has_content(path: Path, sha256: str) -> bool:
    """Whether a file is there and has the content of that sha256."""
    try:
        return hashlib.sha256(read_limited(path)).hexdigest() == sha256
    except UNREADABLE:
        return False
