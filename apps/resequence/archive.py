"""A folder of old programs, each put into a better order: in parallel, and gone on with where it was stopped."""

from __future__ import annotations

import hashlib
import json
import os
import pickle
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal, Unpack

from kerfwise.apps.batch.store import UNREADABLE, has_content, key_of, remove
from kerfwise.encoder.errors import InputError, RulesConflict, exception_text
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.files import read_limited
from kerfwise.jobs.inputs import Tell, silent
from kerfwise.jobs.process_pool import Workers, run_in_process
from kerfwise.jobs.programs import ProgramRequest
from kerfwise.models.engines.tuning import REQUEST_WORK as WORK
from kerfwise.postproc.output_files import make_folder, write_files
from kerfwise.rules.profile.load import files_of
from kerfwise.rules.profile.profile import Profile

from .resequence import Reordering, resequence

PROGRAMS = (".nc", ".ngc", ".cnc", ".tap", ".gcode", ".gc", ".eia", ".iso", ".mpf", ".min")
"""Endings of the files that are taken for programs."""


def resequence_folder(
    folder: Path,
    out: Path,
    profile: Profile,
    *,
    jobs: int = 1,
    version: str = "",
    tell: Tell = silent,
    **how: Unpack[Reordering],
) -> Archive:
    """Put every program of a folder, and of the folders in it, into a better order, under the same name in `out`.

    A program that is refused stops no other; what an earlier run wrote for it is removed, so that nobody cuts by it.
    Files in `out` that no earlier run wrote stay: a program in whose place one stands is refused. What is finished is
    written at once, and known again by its content: the same program, profile, options and `version` of kerfwise are
    not planned a second time. Raises InputError if the folder holds no program, or in the other a file cannot be
    written or removed.
    """
    names = _programs(folder, out)
    if not names:
        raise InputError(f"holds no program: no file ends in {', '.join(PROGRAMS)}", file=folder)
    if out.resolve() == folder.resolve():
        raise InputError("would be written over, and is read from: give the output another folder", file=out)
    make_folder(out, parents=True)
    options: Reordering = {
        "paths": "keep", "request": ProgramRequest(), "without_rules": False, "work": WORK, "time_s": None, "seed": 1,
    }  # fmt: skip
    options |= how
    record, besides = recorded(out), besides_of(profile, options, version)
    of_profile = files_of(profile)  # a dialect's, above all
    foreign = _foreign(out, names, record)
    rows: dict[str, Row] = {}
    waiting: dict[str, str] = {}
    for name in names:
        key = key_of([folder / name, *of_profile], besides)
        done = record.get(name)
        if done is not None and done.key == key and has_content(out / name, done.sha256):
            rows[name] = done
        else:
            waiting[name] = key
    again, interrupted = len(rows), False
    faults: dict[str, Exception] = {}
    together = jobs > 1 and _travels(profile)
    if jobs > 1 and not together:
        tell("the profile's rules in Python cannot be handed to other processes: one program after the other")
    try:
        for name, ended in ended_of(folder, waiting, profile, options, jobs if together else 1):
            if ended.fault is not None:
                faults[name] = ended.fault
            row = replace(ended.row, key=waiting[name])
            if row.read and name in foreign:
                why = "is in the place of the new program, and no earlier run wrote it: give the output another folder"
                row = Row(name, "refused", f"{out / name}: {why}")
            rows[name] = _kept(row, ended.text, record, out)
            tell(f"{len(rows)} of {len(names)}: {name}: {row.ended}")
    except KeyboardInterrupt:
        interrupted = True
    return Archive(tuple(rows[name] for name in names if name in rows), again, interrupted, faults)


def _foreign(out: Path, names: Sequence[str], record: Mapping[str, Row]) -> frozenset[str]:
    """The names in `out` of files that no earlier run wrote; of a record that cannot be read, none is sure."""
    if not record and (out / RECORD).exists():
        return frozenset()
    places = ((name, out / name) for name in names if name not in record)
    return frozenset(name for name, place in places if place.is_symlink() or place.exists())


def _kept(row: Row, text: str, record: dict[str, Row], out: Path) -> Row:
    """The row, once its program is written; where there is none, one that was written before is removed."""
    if row.read:
        make_folder(out / Path(row.name).parent, parents=True)
        row = record[row.name] = replace(row, sha256=hashlib.sha256(text.encode()).hexdigest())
        write_files({out / row.name: text, out / RECORD: record_of(record)})
    elif row.name in record:
        remove(out / row.name, "an older program")
        del record[row.name]
        write_files({out / RECORD: record_of(record)})
    return row


def _travels(profile: Profile) -> bool:
    """Whether a profile can be handed to another process."""
    try:
        pickle.dumps(profile)
    except (pickle.PicklingError, TypeError, AttributeError):  # what pickle says of what its rules hold
        return False
    return True


def _programs(folder: Path, out: Path) -> list[str]:
    """The programs under a folder, by their paths in it; those under `out` are not among them."""
    found = []
    beside = out.resolve()
    for place, folders, files in os.walk(folder):
        here = Path(place)
        folders[:] = sorted(name for name in folders if (here / name).resolve() != beside)
        found += [str((here / name).relative_to(folder)) for name in files if Path(name).suffix.lower() in PROGRAMS]
    return sorted(found)


# What is finished of an archive: known again by its content, so that it is not planned a second time.

RECORD = "resequence.json"
"""What is kept in the folder of the new programs, of what is finished there."""
_FORMAT = "kerfwise-resequence/1"


def besides_of(profile: Profile, options: Reordering, version: str) -> dict[str, Any]:
    """All that answers depend on besides the program and the files of the profile."""
    of_profile = {"profile": profile.sha256, "machine": repr(profile.machine)}
    return {"version": version, **of_profile, **options, "request": asdict(options["request"])}


def recorded(out: Path) -> dict[str, Row]:
    """What was finished before; nothing where the record is gone, or is none."""
    try:
        data = json.loads(read_limited(out / RECORD))
        if data["format"] != _FORMAT:
            return {}
        return {
            row["name"]: Row(**{**row, "idle_mm": tuple(row["idle_mm"]), "time_s": tuple(row["time_s"])})
            for row in data["programs"]
        }
    except (*UNREADABLE, LookupError, TypeError, RecursionError):
        return {}


def record_of(record: Mapping[str, Row]) -> str:
    """The record as its file holds it."""
    rows = [asdict(record[name]) for name in sorted(record)]
    return json.dumps({"format": _FORMAT, "programs": rows}, indent=1) + "\n"


# The programs of an archive, one after the other or in processes of their own; a fault with one stops no other.


@dataclass(frozen=True, eq=False, slots=True)
class FinishedProgram:
    """What became of one program: its row, its new text, and what nobody foresaw."""

    row: Row
    text: str = ""
    fault: Exception | None = None


def ended_of(
    folder: Path, names: Iterable[str], profile: Profile, options: Reordering, jobs: int
) -> Iterator[tuple[str, FinishedProgram]]:
    """Each program as soon as it is finished: one after the other, or, with more jobs, in processes of their own."""
    work = partial(_one, folder, profile, options)
    with Workers(work, jobs) as workers:
        run = workers.run if jobs > 1 else run_in_process(work)
        for name, finished in run(names, lambda name: None):
            yield name, finished if isinstance(finished, FinishedProgram) else _fault(name, finished)


def _fault(name: str, error: Exception) -> FinishedProgram:
    """What nobody foresaw ends with this program alone, and is handed on to be reported."""
    return FinishedProgram(
        Row(name, "fault", f"a fault of kerfwise itself: {escape_text(exception_text(error))}"), fault=error
    )


def _one(folder: Path, profile: Profile, options: Reordering, name: str) -> FinishedProgram:
    """One program; that it is refused, or that no order keeps the rules, is in its row."""
    try:
        resequenced = resequence(folder / name, profile, **options)
    except InputError as error:
        return FinishedProgram(Row(name, "refused", str(error)))
    except RulesConflict as error:
        return FinishedProgram(Row(name, "no order", str(error)))
    if resequenced.interrupted:
        raise KeyboardInterrupt
    row = Row(
        name,
        "changed" if resequenced.changed else "unchanged",
        resequenced.ends,
        (resequenced.before.idle_mm, resequenced.after.idle_mm),
        (resequenced.before.time_s, resequenced.after.time_s),
    )
    return FinishedProgram(row, resequenced.program)


# What became of a folder of old programs: a row each, and the table that is printed.

Outcome = Literal["changed", "unchanged", "refused", "no order", "fault"]
_WIDEST = 48


@dataclass(frozen=True, slots=True)
class Row:
    """One program: how it ended, and its idle travel and time before and after, mm and s.

    `told` is why it was refused, or how the new order was found; `key` is the sha256 of all that the answer depends on,
    `sha256` that of the new program.
    """

    name: str
    ended: Outcome
    told: str = ""
    idle_mm: tuple[float, float] = (0.0, 0.0)
    time_s: tuple[float, float] = (0.0, 0.0)
    key: str = ""
    sha256: str = ""

    @property
    def read(self) -> bool:
        """Whether the program could be read and planned."""
        return self.ended in ("changed", "unchanged")


@dataclass(frozen=True, slots=True)
class Archive:
    """What became of a folder: a row a program, in the order of their names; `again` were finished before.

    `faults` are what nobody foresaw, by the names of the programs that it came up with.
    """

    rows: tuple[Row, ...]
    again: int = 0
    interrupted: bool = False
    faults: Mapping[str, Exception] = field(default_factory=dict)

    @property
    def exit_code(self) -> int:
        """0 where every program was read and planned, else what the worst of them ends with."""
        if self.interrupted:
            return 130
        ends = {row.ended for row in self.rows}
        return 70 if "fault" in ends else 2 if "refused" in ends else 1 if "no order" in ends else 0

    def __str__(self) -> str:
        return "\n".join(_table(self))


def _table(archive: Archive) -> Iterator[str]:
    """What a plant manager wants: minutes saved a program, and in all."""
    read = [row for row in archive.rows if row.read]
    width = min(max([7, *(len(escape_text(row.name)) for row in archive.rows)]), _WIDEST)
    yield f"{'program':{width}}  {'idle m':>9} {'now':>9}  {'min':>8} {'now':>8}  {'saved':>8} {'%':>6}"
    for row in archive.rows:
        name = escape_text(row.name)[-_WIDEST:]
        if row.read:
            yield f"{name:{width}}  {_figures(row.idle_mm, row.time_s)}"
        else:
            yield f"{name:{width}}  {row.ended}"
    idle = sum(row.idle_mm[0] for row in read), sum(row.idle_mm[1] for row in read)
    times = sum(row.time_s[0] for row in read), sum(row.time_s[1] for row in read)
    yield f"{'in all':{width}}  {_figures(idle, times)}"
    for row in archive.rows:
        if not row.read:
            yield f"{row.ended}: {row.told}"
    counts = [f"{len(read)} of {len(archive.rows)} programs read", f"{sum(r.ended == 'changed' for r in read)} changed"]
    if archive.again:
        counts.append(f"{archive.again} finished before")
    yield ", ".join(counts)
    if archive.interrupted:
        yield "interrupted: the same command goes on from here"


def _figures(idle_mm: tuple[float, float], time_s: tuple[float, float]) -> str:
    saved_s = time_s[0] - time_s[1]
    share = f"{saved_s / time_s[0]:.1%}" if time_s[0] > 0 else "-"
    return (
        f"{idle_mm[0] / 1000:9.3f} {idle_mm[1] / 1000:9.3f}  {time_s[0] / 60:8.2f} {time_s[1] / 60:8.2f}  "
        f"{saved_s / 60:8.2f} {share:>6}"
    )
