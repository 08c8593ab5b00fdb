"""The work sheets of a batch: one PDF a machine, made again only where a plan on it has changed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from kerfwise.encoder.contents import contents
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.shown import shown
from kerfwise.jobs.content_key import UNREADABLE, holds, key_of
from kerfwise.jobs.given import silent
from kerfwise.jobs.sheets import WorkSheet, about_of_job, sheets_pdf, work_sheet
from kerfwise.models.plan.reader import read_plan
from kerfwise.postproc.files import write_files

from .files import file_of, remove
from .piece import Piece
from .reading import Changed, expect_same, given_of
from .row import PLAN, Row

FORMAT = "kerfwise-batch-sheets/1"
RECORD = ".sheets.json"
"""What the name of the record ends in that says what a PDF was made of."""


@dataclass(frozen=True, slots=True)
class Papers:
    """The PDF of each machine that has one, by its name in the folder of the batch; `told` is who has no sheet."""

    files: Mapping[str, str] = field(default_factory=dict)
    told: tuple[str, ...] = ()


def papers_of(rows: Mapping[Piece, Row], machines: Iterable[str], out: Path, *, make: bool) -> Papers:
    """The work sheets of all that is planned, machine by machine, in the order of the rows.

    A PDF that was made of the same plans is kept as it is. One of other plans is made again or, where `make` does not
    say so, removed: nobody should cut by an old sheet.

    Raises
    ------
    InputError
        If one cannot be written or removed.
    """
    files, told = dict[str, str](), list[str]()
    for machine in machines:
        planned = {piece: row for piece, row in rows.items() if row.machine == machine and row.planned}
        pdf, record = out / f"{machine}.pdf", out / f"{machine}{RECORD}"
        key = _key(planned)
        if planned and _is_finished(pdf, record, key):
            files[machine] = pdf.name
            continue
        leave_papers([machine], out)
        sheets = _sheets(planned, out, told) if make else ()
        if sheets:
            made = sheets_pdf(sheets)
            whole: dict[Path, str | bytes] = {pdf: made}
            if len(sheets) == len(planned):  # else it is tried again
                whole[record] = _record(key, made)
            write_files(whole)
            files[machine] = pdf.name
    return Papers(files, tuple(told))


def leave_papers(machines: Iterable[str], out: Path) -> None:
    """Remove the work sheets of machines, as before a program on them gives way to another.

    Raises
    ------
    InputError
        If one cannot be removed.
    """
    for machine in machines:
        for ending in (RECORD, ".pdf"):
            remove(out / f"{machine}{ending}", "older plans")


def _key(planned: Mapping[Piece, Row]) -> str:
    """The sha256 of all that stands on the sheets: what each plan was made of, its files, and their order."""
    return key_of([], {"sheets": [(row.nest, row.key, dict(row.files)) for row in planned.values()]})


def _is_finished(pdf: Path, record: Path, key: str) -> bool:
    try:
        said: Any = json.loads(contents(record))
        return said["format"] == FORMAT and said["key"] == key and holds(pdf, said["sha256"])
    except (*UNREADABLE, LookupError, TypeError, RecursionError):
        return False


def _record(key: str, made: bytes) -> str:
    return json.dumps({"format": FORMAT, "key": key, "sha256": hashlib.sha256(made).hexdigest()}, indent=1) + "\n"


def _sheets(planned: Mapping[Piece, Row], out: Path, told: list[str]) -> Sequence[WorkSheet]:
    sheets = []
    for piece, row in planned.items():
        try:
            sheets.append(_sheet(piece, row, out))
        except (InputError, RulesConflict, Changed) as error:
            told.append(f"no work sheet for {shown(row.nest)} on {row.machine}: {error}")
    return sheets


def _sheet(piece: Piece, row: Row, out: Path) -> WorkSheet:
    expect_same(piece, row.key)
    given = given_of(piece, silent)
    program, plan = (out / file_of(row, ending) for ending in (".nc", PLAN))
    return work_sheet(given, read_plan(plan), program, about=about_of_job(given.job))
