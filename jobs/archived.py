"""What became of a folder of old programs: a row each, and the table that is printed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal

from kerfwise.encoder.shown import shown

Ended = Literal["changed", "unchanged", "refused", "no order", "fault"]
_WIDEST = 48


@dataclass(frozen=True, slots=True)
class Row:
    """One program: how it ended, and its idle travel and time before and after, mm and s.

    `told` is why it was refused, or how the new order was found; `key` is the sha256 of all that the answer depends on,
    `sha256` that of the new program.
    """

    name: str
    ended: Ended
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


def _table(made: Archive) -> Iterator[str]:
    """What a plant manager wants: minutes saved a program, and in all."""
    read = [row for row in made.rows if row.read]
    width = min(max([7, *(len(shown(row.name)) for row in made.rows)]), _WIDEST)
    yield f"{'program':{width}}  {'idle m':>9} {'now':>9}  {'min':>8} {'now':>8}  {'saved':>8} {'%':>6}"
    for row in made.rows:
        name = shown(row.name)[-_WIDEST:]
        if row.read:
            yield f"{name:{width}}  {_figures(row.idle_mm, row.time_s)}"
        else:
            yield f"{name:{width}}  {row.ended}"
    idle = sum(row.idle_mm[0] for row in read), sum(row.idle_mm[1] for row in read)
    times = sum(row.time_s[0] for row in read), sum(row.time_s[1] for row in read)
    yield f"{'in all':{width}}  {_figures(idle, times)}"
    for row in made.rows:
        if not row.read:
            yield f"{row.ended}: {row.told}"
    counts = [f"{len(read)} of {len(made.rows)} programs read", f"{sum(r.ended == 'changed' for r in read)} changed"]
    if made.again:
        counts.append(f"{made.again} finished before")
    yield ", ".join(counts)
    if made.interrupted:
        yield "interrupted: the same command goes on from here"


def _figures(idle_mm: tuple[float, float], time_s: tuple[float, float]) -> str:
    saved_s = time_s[0] - time_s[1]
    share = f"{saved_s / time_s[0]:.1%}" if time_s[0] > 0 else "-"
    return (
        f"{idle_mm[0] / 1000:9.3f} {idle_mm[1] / 1000:9.3f}  {time_s[0] / 60:8.2f} {time_s[1] / 60:8.2f}  "
        f"{saved_s / 60:8.2f} {share:>6}"
    )
