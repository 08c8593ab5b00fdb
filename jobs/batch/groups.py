"""What was refused, and what to do about it: one group for all that have the same trouble."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from .row import Row

_PARTICULARS = re.compile(r"'[^']*'|\"[^\"]*\"|\(.*?\)|\S*\d\S*")
"""Of a message: names, numbers and coordinates, which differ from nest to nest."""

_COUNTED = re.compile(r"\b\d+ (\w+?)s?\b")
"""Such as `1 problem` and `3 problems`."""

HEADS = {
    "asks": "The drawing raises questions that nobody has answered",
    "refused": "The nest cannot be cut as it is drawn",
    "no fit": "The nest and what is asked for it do not fit",
    "no plan": "The rules leave no plan",
    "not safe": "The check refuses the plan",
    "fault": "Something went wrong that has nothing to do with the nest",
}
_REMEDIES = {
    "asks": "Write the answers in the job file beside the nest, or in the profile's drawing.answers, and run the same "
    "command again.",
    "refused": "Mend the drawing and run the same command again: what has changed is planned then.",
    "no fit": "Change what is named, in the nest, its job file or the profile, and run the same command again.",
    "no plan": "Change the lock, the rule or the nest that is named, and run the same command again.",
    "not safe": "Plan the nest alone with `kerfwise solve`, which prints the verdict of every rule.",
    "fault": "Run the same command again. If it stays so, send the report that it names.",
}
_RELAX = "With --relax (in Python: relax=True) the batch takes the way out that is named, and marks it in the plan. "


@dataclass(frozen=True, slots=True)
class Group:
    """Rows with the same trouble: what it is, what to do, and the rows."""

    head: str
    remedy: str
    rows: tuple[Row, ...]

    def said(self) -> Iterator[tuple[str, str, tuple[str, ...]]]:
        """A nest, what is said of it, and the machines for which it is said, in the order of the rows."""
        machines: dict[tuple[str, str], list[str]] = {}
        for row in self.rows:
            machines.setdefault((row.nest, row.told), []).append(row.machine)
        yield from ((nest, told, tuple(of)) for (nest, told), of in machines.items())


def groups_of(rows: Iterable[Row]) -> tuple[Group, ...]:
    """What was refused, the largest group first.

    Two have the same trouble where they ended alike and the first lines of what is said differ in names and numbers.
    """
    alike: dict[tuple[str, bool, str], list[Row]] = {}
    for row in rows:
        if not row.planned:
            first = row.told.split("\n", 1)[0]
            alike.setdefault((row.ended, row.relax, _PARTICULARS.sub("…", _COUNTED.sub(r"… \1", first))), []).append(
                row
            )
    ordered = sorted(alike.items(), key=lambda item: (-len(item[1]), item[0]))
    return tuple(
        Group(HEADS[ended], (_RELAX if relax else "") + _REMEDIES[ended], tuple(of))
        for (ended, relax, _), of in ordered
    )
