"""The programs of an archive, one after the other or in processes of their own; a fault with one stops no other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.shown import shown
from kerfwise.rules.profile.profile import Profile

from .archived import Row
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
    left = iter(names)
    running: dict[Future[Ended], str] = {}
    with ProcessPoolExecutor(max_workers=min(jobs, max(len(names), 1)), mp_context=get_context("spawn")) as pool:
        try:
            while True:
                while len(running) < jobs and (name := next(left, None)) is not None:
                    running[pool.submit(_one, folder, name, profile, options)] = name
                if not running:
                    return
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    name = running.pop(future)
                    yield name, _ended(name, future.result)
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


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
