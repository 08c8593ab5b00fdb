"""The programs of an archive, one after the other or in processes of their own; a fault with one stops no other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.shown import shown
from kerfwise.rules.profile.profile import Profile

from .archived import Row
from .processes import Workers
from .resequence import resequence


@dataclass(frozen=True, eq=False, slots=True)
class Ended:
    """What became of one program: its row, its new text, and what nobody foresaw."""

    row: Row
    text: str = ""
    fault: Exception | None = None


def in_turn(
    folder: Path, names: Mapping[str, str], profile: Profile, options: Mapping[str, Any], jobs: int
) -> Iterator[tuple[str, Ended]]:
    """The programs, one after the other."""
    for name in names:
        yield name, _ended(name, partial(_one, folder, name, profile, options))


def side_by_side(
    folder: Path, names: Mapping[str, str], profile: Profile, options: Mapping[str, Any], jobs: int
) -> Iterator[tuple[str, Ended]]:
    """The programs in processes of their own, a few at a time; each as soon as it is finished."""
    with Workers(partial(_one_of, folder, profile, options), jobs) as workers:
        for name, made in workers.run(names):
            yield name, _ended(name, partial(_answer, made))


def _one_of(folder: Path, profile: Profile, options: Mapping[str, Any], name: str) -> Ended:
    return _one(folder, name, profile, options)


def _answer(made: Ended | Exception) -> Ended:
    if isinstance(made, Exception):
        raise made
    return made


def _ended(name: str, answer: Callable[[], Ended]) -> Ended:
    """The answer; what nobody foresaw ends here, with this program alone, and is handed on to be reported."""
    try:
        return answer()
    except Exception as error:
        said = shown(" ".join(str(error).split()))[:200]
        return Ended(Row(name, "fault", f"a fault of kerfwise itself: {type(error).__name__}: {said}"), fault=error)


def _one(folder: Path, name: str, profile: Profile, options: Mapping[str, Any]) -> Ended:
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
