"""A folder of old programs, each put into a better order: in parallel, and gone on with where it was stopped."""

from __future__ import annotations

import hashlib
import os
import pickle
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.files import make_folder, write_files
from kerfwise.rules.profile.made_of import files_of
from kerfwise.rules.profile.profile import Profile

from .archive_record import RECORD, besides_of, record_of, recorded
from .archive_runs import ended_of
from .archived import Archive, Row
from .batch.files import remove
from .content_key import holds, key_of
from .given import Tell, silent
from .old_program import Asked
from .resequenced import Paths

PROGRAMS = (".nc", ".ngc", ".cnc", ".tap", ".gcode", ".gc", ".eia", ".iso", ".mpf", ".min")
"""Endings of the files that are taken for programs."""


def resequence_folder(
    folder: Path,
    out: Path,
    profile: Profile,
    *,
    paths: Paths = "keep",
    asked: Asked | None = None,
    without_rules: bool = False,
    work: float = 30.0,
    time_s: float | None = None,
    seed: int = 1,
    jobs: int = 1,
    version: str = "",
    tell: Tell = silent,
) -> Archive:
    """Put every program of a folder, and of the folders in it, into a better order, under the same name in `out`.

    A program that is refused stops no other; what an earlier run wrote for it is removed, so that nobody cuts by it.
    Files in `out` that no earlier run wrote stay: a program in whose place one stands is refused.
    What is finished is written at once, and known again by its content: the same program, profile, options and
    `version` of kerfwise are not planned a second time.

    Raises
    ------
    InputError
        If the folder holds no program, or in the other a file cannot be written or removed.
    """
    names = _programs(folder, out)
    if not names:
        raise InputError(f"holds no program: no file ends in {', '.join(PROGRAMS)}", file=folder)
    if out.resolve() == folder.resolve():
        raise InputError("would be written over, and is read from: give the output another folder", file=out)
    make_folder(out, parents=True)
    options = {
        "paths": paths,
        "asked": asked or Asked(),
        "without_rules": without_rules,
        "work": work,
        "time_s": time_s,
        "seed": seed,
    }
    record, besides = recorded(out), besides_of(profile, options, version)
    of_profile = files_of(profile)  # a dialect's, above all
    foreign = _foreign(out, names, record)
    rows: dict[str, Row] = {}
    waiting: dict[str, str] = {}
    for name in names:
        key = key_of([folder / name, *of_profile], besides)
        done = record.get(name)
        if done is not None and done.key == key and holds(out / name, done.sha256):
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
