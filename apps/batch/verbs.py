"""kerfwise batch: a folder of nests on every machine, side by side, gone on with where it was stopped."""

from __future__ import annotations

import contextlib
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import click

from kerfwise import __version__
from kerfwise.app_modules import library
from kerfwise.commands.option_groups import GAP, RELAX, limit_options, together
from kerfwise.commands.shared_options import AMOUNT_OVER_ZERO, TRUST, print_note
from kerfwise.encoder.display import clock, money
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.postproc.report.legend import counted
from kerfwise.rules.profile.load import DEFAULT

from .result import groups_of, totals, truncate
from .run import Batch, Beside, Watcher

if TYPE_CHECKING:
    from kerfwise.models.engines.solution import Limits

    from .result import Row
    from .run import Run
    from .tasks import Machines, NestTask, Source


# What a batch shows while it runs, on a terminal, and what it prints at its end.


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

            from kerfwise.commands.terminal import bare

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
        for nest, notes, machines in group.said():
            short = truncate(notes)
            text = f"{short.told}\n  {short.more}, all of them in the index" if short.more else notes
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


_NAME = re.compile(r"\w[\w-]*")


@click.command()
@click.option("-p", "--profile", "profiles", metavar="[NAME=]PROFILE", multiple=True,
              help=f"A machine; repeatable. Default: the profile of the job file, or {DEFAULT}.")  # fmt: skip
@TRUST
@click.option("-o", "--output", metavar="OUT", required=True, help="Output folder of the programs and the index.")
@together(
    "workers",
    dict,
    click.option("--jobs", type=click.IntRange(min=1), metavar="N",
                 help="Number of nests to plan at once. Default: half the cores."),
    click.option("--scheduler", metavar="tcp://…",
                 help="Plan on the workers of this Dask scheduler: kerfwise[cluster]."),
)  # fmt: skip
@click.option("--watch", is_flag=True, help="Keep planning as files arrive or change, until Ctrl-C.")
@limit_options(
    GAP,
    click.option("--memory", "memory_gb", type=AMOUNT_OVER_ZERO, default=2.0, show_default=True, metavar="GB",
                 help="Memory limit in GB for each nest, as for solve."),
)  # fmt: skip
@RELAX
@click.option("--repair", is_flag=True, help="Repair the drawings where possible.")
@together(
    "beside",
    Beside,
    click.option("--sheets", is_flag=True, help="Print the work sheets of each machine: OUT/MACHINE.pdf."),
    click.option("--refused-again", is_flag=True, help="Retry nests that were refused before."),
    click.option("--tidy", is_flag=True, help="Remove outputs of nests that are no longer among IN…."),
)
@click.argument("nests", metavar="IN…", nargs=-1, required=True)
def command(
    nests: tuple[str, ...],
    profiles: tuple[str, ...],
    trust: bool,
    output: str,
    workers: dict[str, Any],
    watch: bool,
    beside: Beside,
    limits: Limits,
    **options: Any,
) -> int:
    """Plan every nest of files and folders on every machine; skip what is already finished."""
    from kerfwise.commands.crash_report import arguments, crash_message

    from .run import run_batch
    from .store import Store, lock_folder
    from .tasks import Options, keep_on, sources_in

    if None not in workers.values():
        raise click.UsageError("--jobs is for this machine: with --scheduler the number of its workers counts")
    if beside.tidy and watch:
        raise click.UsageError("--tidy is for one run: with --watch a folder may be away for a while")
    if beside.sheets:
        library("segno", "a work sheet", "sheets")
    options |= limits
    paths, out, of_nests = [Path(name) for name in nests], Path(output), Options(**options)
    machines = _machines(profiles, trust)
    sources = sources_in(paths, out)
    _expect_apart(paths, out)
    if not sources and not watch:
        raise InputError("holds no nest", file=nests[0])
    with lock_folder(out), _runner(**workers) as run:
        store = Store(out)

        def one_round(found: Sequence[Source], now: Machines) -> Batch:
            with BatchProgress() as progress:
                batch = run_batch(found, now, store, of_nests, __version__, run, progress, beside)
            click.echo(printed(batch, out))
            for text in batch.papers.told:
                print_note(text)
            for name, error in batch.faults.items():
                click.echo(f"{escape_text(name)}: {crash_message(error, arguments(None))}", err=True)
            if watch and batch.interrupted:
                raise KeyboardInterrupt
            return batch

        if watch:
            keep_on(paths, out, machines, one_round, print_note)
        return one_round(sources, machines).exit_code


@contextlib.contextmanager
def _runner(scheduler: str | None, jobs: int | None) -> Iterator[Run]:
    """Who does the work: processes here, or the workers of a scheduler."""
    from .run import plan_task

    if scheduler is not None:
        from .run import Cluster

        with Cluster(plan_task, scheduler, print_note) as cluster:
            yield cluster.run
        return
    from kerfwise.jobs.process_pool import Workers
    from kerfwise.models.jit import machine_cores

    cores = len(machine_cores())
    with Workers(plan_task, jobs or max(1, cores // 2)) as workers:
        if jobs is not None and workers.jobs < jobs:
            print_note(f"--jobs {jobs}: there are {cores} cores, so that {workers.jobs} nests are planned at a time")
        yield workers.run


def _machines(profiles: Sequence[str], trust: bool) -> Machines:
    """The machines by their names; one without is named after its profile."""
    from .tasks import Machine, Machines, machine_of, name_of

    found: dict[str, Machine] = {}
    for text in profiles:
        name, equals, profile = text.partition("=")
        if not equals:
            name, profile = name_of(text), text
        if not _NAME.fullmatch(name):
            problem = f"{name!r} is no name for a machine: write NAME=PROFILE, the name in letters, digits, - and _"
            raise InputError(f"-p {text}: {problem}")
        if name.casefold() in found:
            raise InputError(f"-p {text}: two machines have the name {name!r}: write NAME=PROFILE, with another name")
        found[name.casefold()] = machine_of(name, profile, trust)
    return Machines(tuple(found.values()), trust)


def _expect_apart(paths: Sequence[Path], out: Path) -> None:
    """Refuse to write where nests are looked for."""
    for place in paths:
        if place.resolve() == out.resolve():
            raise InputError("is read from, and cannot be the folder of the programs: give another with -o", file=out)
