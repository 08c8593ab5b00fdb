"""A folder of old programs, each put into a better order: in parallel, and gone on with where it was stopped."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import pickle
from collections.abc import Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import asdict, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from kerfwise.encoder.contents import contents
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.shown import shown
from kerfwise.postproc.files import make_folder, write_files
from kerfwise.rules.profile.made_of import files_of
from kerfwise.rules.profile.profile import Profile

from .archived import Archive, Row
from .given import Tell, silent
from .old_program import Asked
from .resequence import resequence
from .resequenced import Paths

RECORD = "resequence.json"
"""What is kept in the folder of the new programs, of what is finished there."""
_FORMAT = "kerfwise-resequence/1"
PROGRAMS = (".nc", ".ngc", ".cnc", ".tap", ".gcode", ".gc", ".eia", ".iso", ".mpf", ".min")
"""Endings of the files that are taken for programs."""
_UNREADABLE = (OSError, ValueError, InputError)
"""What `contents` raises."""


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

    A program that is refused stops no other. What is finished is written at once, and known again by its content: the
    same program, profile, options and `version` of kerfwise are not planned a second time.

    Raises
    ------
    InputError
        If the folder holds no program, or the other cannot be written.
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
    record, besides = _recorded(out), _besides(profile, options, version)
    rows: dict[str, Row] = {}
    waiting: dict[str, str] = {}
    for name in names:
        key = _key(folder / name, besides)
        done = record.get(name)
        if done is not None and done.key == key and _is_there(out / name, done.sha256):
            rows[name] = done
        else:
            waiting[name] = key
    again, interrupted = len(rows), False
    side_by_side = jobs > 1 and _travels(profile)
    if jobs > 1 and not side_by_side:
        tell("the profile's rules in Python cannot be handed to other processes: one program after the other")
    work_of = _side_by_side if side_by_side else _in_turn
    try:
        for name, (row, text) in work_of(folder, waiting, profile, options, jobs):
            row = rows[name] = replace(row, key=waiting[name])
            if row.read:
                make_folder(out / Path(name).parent, parents=True)
                record[name] = rows[name] = replace(row, sha256=hashlib.sha256(text.encode()).hexdigest())
                write_files({out / name: text, out / RECORD: _as_json(record)})
            tell(f"{len(rows)} of {len(names)}: {name}: {row.ended}")
    except KeyboardInterrupt:
        interrupted = True
    return Archive(tuple(rows[name] for name in names if name in rows), again, interrupted)


def _travels(profile: Profile) -> bool:
    """Whether a profile can be handed to another process."""
    try:
        pickle.dumps(profile)
    except Exception:  # what its rules hold is theirs
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


def _besides(profile: Profile, options: Mapping[str, Any], version: str) -> bytes:
    """All that answers depend on besides the program."""
    said = json.dumps({**options, "asked": asdict(options["asked"])}, sort_keys=True)
    parts = [part.encode() for part in (version, profile.sha256, repr(profile.machine), said)]
    for file in files_of(profile):  # a dialect's, above all
        with contextlib.suppress(*_UNREADABLE):
            parts.append(contents(file))
    return b"\0".join(parts)


def _key(path: Path, besides: bytes) -> str:
    """The sha256 of a program and of all else that its answer depends on; of its name where it cannot be read."""
    try:
        data = contents(path)
    except _UNREADABLE:
        data = str(path).encode("utf-8", "surrogateescape")
    return hashlib.sha256(b"\0".join([data, besides])).hexdigest()


def _is_there(path: Path, sha256: str) -> bool:
    try:
        return hashlib.sha256(contents(path)).hexdigest() == sha256
    except _UNREADABLE:
        return False


def _in_turn(
    folder: Path, waiting: Mapping[str, str], profile: Profile, options: Mapping[str, Any], jobs: int
) -> Iterator[tuple[str, tuple[Row, str]]]:
    for name in waiting:
        yield name, _one(folder, name, profile, options)


def _side_by_side(
    folder: Path, waiting: Mapping[str, str], profile: Profile, options: Mapping[str, Any], jobs: int
) -> Iterator[tuple[str, tuple[Row, str]]]:
    """The programs in processes of their own, a few at a time; each as soon as it is finished."""
    left = iter(waiting)
    running: dict[Future[tuple[Row, str]], str] = {}
    with ProcessPoolExecutor(max_workers=min(jobs, max(len(waiting), 1)), mp_context=get_context("spawn")) as pool:
        try:
            while True:
                while len(running) < jobs and (name := next(left, None)) is not None:
                    running[pool.submit(_one, folder, name, profile, options)] = name
                if not running:
                    return
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    name = running.pop(future)
                    error = future.exception()
                    yield name, (_fault(name, error), "") if isinstance(error, Exception) else future.result()
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _one(folder: Path, name: str, profile: Profile, options: Mapping[str, Any]) -> tuple[Row, str]:
    """One program: its row and its new text. Whatever goes wrong with it is in the row."""
    try:
        made = resequence(folder / name, profile, **options)
    except InputError as error:
        return Row(name, "refused", str(error)), ""
    except RulesConflict as error:
        return Row(name, "no order", str(error)), ""
    except Exception as error:
        return _fault(name, error), ""
    if made.interrupted:
        raise KeyboardInterrupt
    row = Row(
        name,
        "changed" if made.changed else "unchanged",
        made.ends,
        (made.before.idle_mm, made.after.idle_mm),
        (made.before.time_s, made.after.time_s),
    )
    return row, made.program


def _fault(name: str, error: Exception) -> Row:
    said = shown(" ".join(str(error).split()))[:200]
    text = f"a fault of kerfwise itself: {type(error).__name__}: {said}; resequence it alone for a report"
    return Row(name, "fault", text)


def _recorded(out: Path) -> dict[str, Row]:
    """What was finished before; nothing where the record is gone, or is none."""
    try:
        data = json.loads(contents(out / RECORD))
        if data["format"] != _FORMAT:
            return {}
        return {
            row["name"]: Row(**{**row, "idle_mm": tuple(row["idle_mm"]), "time_s": tuple(row["time_s"])})
            for row in data["programs"]
        }
    except (*_UNREADABLE, LookupError, TypeError, RecursionError):
        return {}


def _as_json(record: Mapping[str, Row]) -> str:
    rows = [asdict(record[name]) for name in sorted(record)]
    return json.dumps({"format": _FORMAT, "programs": rows}, indent=1) + "\n"
