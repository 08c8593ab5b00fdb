"""What a batch shows while it runs, on a terminal, and what it prints at its end."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from kerfwise.encoder.text import clock, escape_text, money
from kerfwise.jobs.batch.result import groups_of, totals, truncate
from kerfwise.jobs.batch.run import Batch, Watcher
from kerfwise.postproc.report.legend import counted

if TYPE_CHECKING:
    from kerfwise.jobs.batch.result import Row
    from kerfwise.jobs.batch.tasks import NestTask


class BatchProgress(Watcher):
    """A bar for all, and a line for each nest that is being planned; in a pipe nothing."""

    def __init__(self) -> None:
        self._bars: Any = None
        self._all: Any = None
        self._refused = 0
        self._lines: dict[tuple[str, str], Any] = {}
        if sys.stderr.isatty():
            from rich.console import Console
            from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

            from .terminal import bare

            columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn())
            console = Console(file=bare(sys.stderr))
            self._bars = Progress(*columns, TimeElapsedColumn(), console=console, transient=True)

    def planned(self, pieces: int, before: int) -> None:
        """Begin with what is finished already."""
        if self._bars is not None:
            self._all = self._bars.add_task("all", total=pieces, completed=before)

    def began(self, piece: NestTask) -> None:
        """A line for it."""
        if self._bars is not None:
            text = f"{escape_text(piece.name)} on {piece.machine.name}"
            self._lines[piece.name, piece.machine.name] = self._bars.add_task(text, total=None)

    def ended(self, row: Row) -> None:
        """Its line goes, the bar of all grows."""
        if self._bars is not None:
            if (line := self._lines.pop((row.nest, row.machine), None)) is not None:
                self._bars.remove_task(line)
            self._refused += not row.planned
            self._bars.update(self._all, advance=1, description=f"{self._refused} refused" if self._refused else "all")

    def __enter__(self) -> Self:
        if self._bars is not None:
            self._bars.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bars is not None:
            self._bars.stop()


def printed(batch: Batch, out: Path) -> str:
    """Sums a machine, what was refused and what to do, and where the index is."""
    return "\n".join(_lines(batch, out))


def _lines(batch: Batch, out: Path) -> Iterator[str]:
    width = max(map(len, ["machine", *batch.machines]))
    yield f"{'machine':{width}}  {'planned':>7} {'refused':>7}  {'time':>9} {'cost':>12}  {'idle m':>9} {'excuses':>7}"
    for total in totals(batch.rows, batch.machines):
        yield (
            f"{total.machine:{width}}  {total.planned:7} {total.refused:7}  {clock(total.time_s):>9} "
            f"{money(total.cost, total.currency):>12}  {total.idle_mm / 1000:9.3f} {total.excuses:7}"
        )
    for row in batch.rows:
        if row.figures is not None and row.figures.excuses:
            yield f"{escape_text(row.nest)} on {row.machine}: {row.figures.state}"
    for group in groups_of(batch.rows):
        yield f"{group.head}. {group.remedy}"
        for nest, told, machines in group.said():
            short = truncate(told)
            text = f"{short.told}\n  {short.more}, all of them in the index" if short.more else told
            yield f"  {escape_text(nest)} on {', '.join(machines)}: {text}".replace("\n", "\n    ")
    if gone := sum(not one.given for one in batch.left):
        of = f"{counted(gone, 'program')} {'is' if gone == 1 else 'are'} left from earlier runs"
        yield f"{of}, of nests that are not given now: the index lists them, --tidy removes them"
    if batch.tidied:
        yield f"{counted(batch.tidied, 'program')} removed, of nests that are not given any more"
    planned = sum(row.planned for row in batch.rows)
    counts = [f"{planned} of {len(batch.rows) + batch.waiting} planned"]
    if batch.again:
        counts.append(f"{batch.again} finished before")
    yield ", ".join(counts)
    yield f"index: {escape_text(str(out / 'index.html'))}"
    for name in batch.papers.files.values():
        yield f"work sheets: {escape_text(str(out / name))}"
    if batch.interrupted:
        yield "interrupted: the same command goes on from here"
