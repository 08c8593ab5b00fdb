"""The programs of an archive, one after the other or in processes of their own; a fault with one stops no other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.faults import said
from kerfwise.encoder.shown import shown
from kerfwise.rules.profile.profile import Profile

from .archived import Row
from .processes import Workers, in_turn
from .resequence import resequence


@dataclass(frozen=True, eq=False, slots=True)
class Ended:
    """What became of one program: its row, its new text, and what nobody foresaw."""

    row: Row
    text: str = ""
    fault: Exception | None = None


def ended_of(
    folder: Path, names: Iterable[str], profile: Profile, options: Mapping[str, Any], jobs: int
) -> Iterator[tuple[str, Ended]]:
    """Each program as soon as it is finished: one after the other, or, with more jobs, in processes of their own."""
    work = partial(_one, folder, profile, options)
    with Workers(work, jobs) as workers:
        run = workers.run if jobs > 1 else in_turn(work)
        for name, made in run(names, lambda name: None):
            yield name, made if isinstance(made, Ended) else _fault(name, made)


def _fault(name: str, error: Exception) -> Ended:
    """What nobody foresaw ends with this program alone, and is handed on to be reported."""
    return Ended(Row(name, "fault", f"a fault of kerfwise itself: {shown(said(error))}"), fault=error)


def _one(folder: Path, profile: Profile, options: Mapping[str, Any], name: str) -> Ended:
    """One program; that it is refused, or that no order keeps the rules, is in its row."""
    try:
        made = resequence(folder / name, profile, **options)
    except InputError as error:
        return Ended(Row(name, "refused", str(error)))
    except RulesConflict as error:
        return Ended(Row(name, "no order", str(error)))
    if made.interrupted:
        raise KeyboardInterrupt
    row = Row(
        name,
        "changed" if made.changed else "unchanged",
        made.ends,
        (made.before.idle_mm, made.after.idle_mm),
        (made.before.time_s, made.after.time_s),
    )
    return Ended(row, made.program)
