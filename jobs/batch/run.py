"""A batch: every nest on every machine, what is finished skipped, whatever goes wrong with one kept from the others."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Protocol

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.files import write_files

from .index import index_files
from .left import Left, left_in, tidy
from .machines import Machines, job_of
from .papers import Papers, leave_papers, papers_of
from .piece import Options, Piece
from .planning import Made, fault, plan_piece
from .row import Row
from .sources import Source, named
from .store import Store


@dataclass(frozen=True, slots=True)
class Task:
    """A piece that is to be planned, and its key."""

    piece: Piece
    key: str


def plan_task(task: Task) -> Made:
    """What a process of the batch does with a task."""
    return plan_piece(task.piece, task.key)


class Run(Protocol):
    """Does tasks somewhere, and gives each back as soon as it is finished."""

    def __call__(
        self, pieces: Iterable[Task], began: Callable[[Task], None]
    ) -> Iterator[tuple[Task, Made | Exception]]: ...


class Watcher:
    """Hears what a batch does; this one says nothing of it."""

    def planned(self, pieces: int, before: int) -> None:
        """So many pieces there are, and so many of them were finished before."""

    def began(self, piece: Piece) -> None:
        """A piece is being planned now."""

    def ended(self, row: Row) -> None:
        """A piece is finished."""


@dataclass(frozen=True, slots=True)
class Batch:
    """What became of a batch: a row for each nest and machine that is finished, in the order of the nests.

    `again` were finished before. `waiting` are still to be planned, where it was interrupted.
    `left` are programs of earlier runs that no row is about; `tidied` is how many of these were removed.
    `faults` are what nobody foresaw, by nest and machine. `papers` are the work sheets of each machine.
    """

    rows: tuple[Row, ...]
    machines: tuple[str, ...]
    again: int = 0
    waiting: int = 0
    interrupted: bool = False
    faults: Mapping[str, Exception] = field(default_factory=dict)
    papers: Papers = field(default_factory=Papers)
    left: tuple[Left, ...] = ()
    tidied: int = 0

    @property
    def exit_code(self) -> int:
        """0 where every nest was planned on every machine, 1 where one was refused, 70 after a fault of kerfwise.

        3 where some raise questions and all others were planned.
        """
        if self.interrupted:
            return 130
        ends = {row.ended for row in self.rows}
        if "fault" in ends:
            return 70
        return 0 if ends <= {"planned"} else 3 if ends <= {"planned", "asks"} else 1


def run_batch(
    sources: Iterable[Source],
    machines: Machines,
    store: Store,
    options: Options,
    version: str,
    run: Run,
    watcher: Watcher | None = None,
    *,
    refused_again: bool = False,
    sheets: bool = False,
    tidied: bool = False,
) -> Batch:
    """Plan every nest on every machine, and write the index of all.

    What the store has finished is not planned again, and what was refused only where `refused_again` says so. Each
    program is written as soon as it is there: whoever kills this loses what is being planned, and nothing else. Where a
    job file names another machine than before, the program for the one that it means no more is removed.
    `sheets` says that the work sheets of each machine are printed, too, `tidied` that what earlier runs wrote of nests
    that are not among the sources is removed.
    """
    watcher = watcher or Watcher()
    pieces = list(_pieces(named(sources, store.names()), machines, store.out, options, version))
    _leave(pieces, machines, store)
    named_here = {(piece.machine.name, piece.name) for piece in pieces}
    removed = tidy(store, named_here) if tidied else 0
    rows: dict[Piece, Row] = {}
    tasks = []
    for piece in pieces:
        key = piece.key()
        row = store.finished(piece.machine.name, piece.name, key)
        if row is None or (refused_again and not row.planned):
            tasks.append(Task(piece, key))
        else:
            rows[piece] = replace(row, source=str(piece.source))
    again, interrupted = len(rows), False
    watcher.planned(len(pieces), again)
    leave_papers({task.piece.machine.name for task in tasks if _is_other(task, store)}, store.out)
    faults: dict[str, Exception] = {}
    try:
        for task, made in run(tasks, lambda task: watcher.began(task.piece)):
            if isinstance(made, Exception):
                faults[f"{task.piece.name} on {task.piece.machine.name}"] = made
            rows[task.piece] = _kept(task, made, store)
            watcher.ended(rows[task.piece])
    except KeyboardInterrupt:
        interrupted = True
    ended = {piece: rows[piece] for piece in pieces if piece in rows}
    done = tuple(ended.values())
    names = tuple(dict.fromkeys([*(m.name for m in machines.named), *(piece.machine.name for piece in pieces)]))
    papers = papers_of(ended, names, store.out, make=sheets and not interrupted)
    left = left_in(store, named_here)
    write_files({store.out / name: text for name, text in index_files(done, names, papers.files, left).items()})
    return Batch(done, names, again, len(pieces) - len(done), interrupted, faults, papers, left, removed)


def _is_other(task: Task, store: Store) -> bool:
    """Whether there is a program for a task that is about to give way to another, so that its sheet is old."""
    before = store.known(task.piece.machine.name, task.piece.name)
    return before is not None and before.planned and before.key != task.key


def _pieces(
    sources: Mapping[str, Source], machines: Machines, out: Path, options: Options, version: str
) -> Iterator[Piece]:
    """Each nest on the machines that it is for, with what its job file says of the sheets."""
    for name, source in sources.items():
        job = job_of(source.file)
        quantity, order, due = (1, "", None) if job is None else (job.quantity, job.order or "", job.due)
        for machine in machines.of(job):
            day = "" if due is None else due.isoformat()
            yield Piece(name, source.file, machine, options, version, out, quantity, order, day)


def _leave(pieces: Iterable[Piece], machines: Machines, store: Store) -> None:
    """Remove what is there of nests on machines of this batch that their job files do not mean any more."""
    where: dict[str, set[str]] = {}
    for piece in pieces:
        where.setdefault(piece.name, set()).add(piece.machine.name)
    for nest, meant in where.items():
        for machine in machines.named:
            if machine.name not in meant:
                store.leave(machine.name, nest)


def _kept(task: Task, made: Made | Exception, store: Store) -> Row:
    """The row of what was made, once its files are written; that they cannot be is the fault of this one alone."""
    made = fault(task.piece, made) if isinstance(made, Exception) else made
    row = replace(made.row, key=task.key)
    try:
        return store.keep(row, made.contents)
    except InputError as error:
        return replace(row, ended="fault", told=str(error), figures=None, files={})
