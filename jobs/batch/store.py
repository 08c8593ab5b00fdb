"""The folder of a batch: programs and records, written whole, by one run at a time."""

from __future__ import annotations

import hashlib
import json
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import replace
from pathlib import Path

from kerfwise.encoder.contents import contents, is_folder, is_there
from kerfwise.encoder.errors import InputError
from kerfwise.jobs.content_key import UNREADABLE, holds
from kerfwise.postproc.files import make_folder, write_files

from .files import remove
from .row import PLAN, RECORD, Row, row_of

LOCK = ".batch.lock"
"""An empty file: that it is there says that the folder is a batch's, that it is locked that a run writes there."""


@contextmanager
def held(out: Path) -> Iterator[None]:
    """Have the folder of a batch to oneself, made where it is not there.

    The system frees the lock when the process ends, however it ends. A lock of SQLite's is one on every system.

    Raises
    ------
    InputError
        If another run has it, it holds what no batch has written, or cannot be written.
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
            said = "another batch is writing there: wait until it has ended, or give this one another folder"
        else:
            said = f"cannot be locked for this batch: {error}"
        raise InputError(said, file=out) from None


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
        return row if all(holds(folder / name, sha256) for name, sha256 in row.files.items()) else None

    def keep(self, row: Row, files: Mapping[str, str | bytes]) -> Row:
        """Write the files of a row with its record, all of them or none; files that it has no more are removed first.

        An old plan stays: the job file may call cuts by the numbers that they have in it.

        Raises
        ------
        InputError
            If they cannot be written.
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

        Raises
        ------
        InputError
            If a file cannot be removed.
        """
        row = self._rows.get((machine, nest))
        if row is not None:
            self._remove(row, row.files)

    def forget(self, row: Row) -> bool:
        """Remove all that was written of a row, and its record; whether a program was among it.

        A file that is not as it was written stays.

        Raises
        ------
        InputError
            If a file cannot be removed.
        """
        record = self._record(row)
        files = {record.parent / Path(name).name: sha256 for name, sha256 in row.files.items()}
        ours = [path for path, sha256 in files.items() if holds(path, sha256)]
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
        return row_of(json.loads(contents(path)))
    except (*UNREADABLE, RecursionError):
        return None


def _sha256(content: str | bytes) -> str:
    return hashlib.sha256(content if isinstance(content, bytes) else content.encode()).hexdigest()
