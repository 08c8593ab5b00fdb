"""A batch: every nest on every machine, what is finished skipped, here or on a Dask cluster."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import TracebackType
from typing import Any, Generic, Protocol, Self, TypeVar

from kerfwise.apps.viewer.page.page_data import page_bytes, page_data
from kerfwise.encoder.errors import InputError, RulesConflict, exception_text
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.questions import Questions
from kerfwise.encoder.readers.read import BrokenNest
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.programs import time_made
from kerfwise.jobs.progress import Listener
from kerfwise.jobs.request import NoPlan, options_for
from kerfwise.pipeline import FinishedPlan, Watchers, plan_nest
from kerfwise.postproc.output_files import remnant_files, write_files
from kerfwise.postproc.report import draw
from kerfwise.postproc.report.simple_pictures import thumbnail

from .reports import Papers, index_files, leave_papers, papers_of
from .result import PLAN, Figures, Row
from .store import StaleOutput, Store, stale_outputs, tidy
from .tasks import Changed, Machines, NestTask, Options, Source, expect_same, job_of, name_sources, task_inputs

# A batch: every nest on every machine, what is finished skipped, whatever goes wrong with one kept from the others.


@dataclass(frozen=True, slots=True)
class Task:
    """A piece that is to be planned, and its key."""

    piece: NestTask
    key: str


def plan_task(task: Task) -> TaskOutput:
    """What a process of the batch does with a task."""
    return plan_task_inputs(task.piece, task.key)


class Run(Protocol):
    """Does tasks somewhere, and gives each back as soon as it is finished."""

    def __call__(
        self, pieces: Iterable[Task], began: Callable[[Task], None]
    ) -> Iterator[tuple[Task, TaskOutput | Exception]]: ...


class Watcher:
    """Hears what a batch does; this one says nothing of it."""

    def planned(self, pieces: int, before: int) -> None:
        """So many pieces there are, and so many of them were finished before."""

    def began(self, piece: NestTask) -> None:
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
    left: tuple[StaleOutput, ...] = ()
    tidied: int = 0

    @property
    def exit_code(self) -> int:
        """0 where every nest was planned on every machine, 1 where one was refused, or its program was not written.

        70 after a fault of kerfwise.

        3 where some raise questions and all others were planned.
        """
        if self.interrupted:
            return 130
        ends = {row.ended for row in self.rows}
        if "fault" in ends:
            return 70
        return 0 if ends <= {"planned"} else 3 if ends <= {"planned", "asks"} else 1


@dataclass(frozen=True, slots=True)
class Beside:
    """What a batch does besides: retry what was refused, print work sheets, remove outputs of nests not given."""

    refused_again: bool = False
    sheets: bool = False
    tidy: bool = False


PLANS_ALONE = Beside()


def run_batch(
    sources: Iterable[Source],
    machines: Machines,
    store: Store,
    options: Options,
    version: str,
    run: Run,
    watcher: Watcher | None = None,
    beside: Beside = PLANS_ALONE,
) -> Batch:
    """Plan every nest on every machine, and write the index of all.

    What the store has finished is not planned again, and what was refused only where `beside` says so. Each
    program is written as soon as it is there: whoever kills this loses what is being planned, and nothing else. Where a
    job file names another machine than before, the program for the one that it means no more is removed.
    """
    watcher = watcher or Watcher()
    pieces = list(_pieces(name_sources(sources, store.names()), machines, store.out, options, version))
    _leave(pieces, machines, store)
    named_here = {(piece.machine.name, piece.name) for piece in pieces}
    removed = tidy(store, named_here) if beside.tidy else 0
    rows: dict[NestTask, Row] = {}
    tasks = []
    for piece in pieces:
        key = piece.key()
        row = store.finished(piece.machine.name, piece.name, key)
        if row is None or (beside.refused_again and not row.planned):
            tasks.append(Task(piece, key))
        else:
            rows[piece] = replace(row, source=str(piece.source))
    again, interrupted = len(rows), False
    watcher.planned(len(pieces), again)
    leave_papers({task.piece.machine.name for task in tasks if _is_other(task, store)}, store.out)
    faults: dict[str, Exception] = {}
    try:
        for task, output in run(tasks, lambda task: watcher.began(task.piece)):
            if isinstance(output, Exception):
                faults[f"{task.piece.name} on {task.piece.machine.name}"] = output
            rows[task.piece] = _kept(task, output, store)
            watcher.ended(rows[task.piece])
    except KeyboardInterrupt:
        interrupted = True
    ended = {piece: rows[piece] for piece in pieces if piece in rows}
    done = tuple(ended.values())
    names = tuple(dict.fromkeys([*(m.name for m in machines.named), *(piece.machine.name for piece in pieces)]))
    papers = papers_of(ended, names, store.out, make=beside.sheets and not interrupted)
    left = stale_outputs(store, named_here)
    write_files({store.out / name: text for name, text in index_files(done, names, papers.files, left).items()})
    return Batch(done, names, again, len(pieces) - len(done), interrupted, faults, papers, left, removed)


def _is_other(task: Task, store: Store) -> bool:
    """Whether there is a program for a task that is about to give way to another, so that its sheet is old."""
    before = store.known(task.piece.machine.name, task.piece.name)
    return before is not None and before.planned and before.key != task.key


def _pieces(
    sources: Mapping[str, Source], machines: Machines, out: Path, options: Options, version: str
) -> Iterator[NestTask]:
    """Each nest on the machines that it is for, with what its job file says of the sheets."""
    for name, source in sources.items():
        job = job_of(source.file)
        quantity, order, due = (1, "", None) if job is None else (job.quantity, job.order or "", job.due)
        for machine in machines.of(job):
            day = "" if due is None else due.isoformat()
            yield NestTask(name, source.file, machine, options, version, out, quantity, order, day)


def _leave(pieces: Iterable[NestTask], machines: Machines, store: Store) -> None:
    """Remove what is there of nests on machines of this batch that their job files do not mean any more."""
    where: dict[str, set[str]] = {}
    for piece in pieces:
        where.setdefault(piece.name, set()).add(piece.machine.name)
    for nest, meant in where.items():
        for machine in machines.named:
            if machine.name not in meant:
                store.leave(machine.name, nest)


def _kept(task: Task, output: TaskOutput | Exception, store: Store) -> Row:
    """The row of what was made, once its files are written; where they cannot be, it concerns this one alone."""
    output = fault(task.piece, output) if isinstance(output, Exception) else output
    row = replace(output.row, key=task.key)
    try:
        return store.keep(row, output.contents)
    except InputError as error:
        return replace(row, ended="not written", told=str(error), figures=None, files={})


# One nest planned on one machine, as `kerfwise solve` does it; whatever goes wrong is an answer, too.


@dataclass(frozen=True, slots=True)
class TaskOutput:
    """The row of a piece, and the content of its files by their names."""

    row: Row
    contents: Mapping[str, str | bytes]


class _Elsewhere(Listener):
    """Ctrl-C is answered where the pieces are handed out."""

    def __enter__(self) -> Self:
        return self


def plan_task_inputs(piece: NestTask, key: str) -> TaskOutput:
    """Plan one nest on one machine. That it is refused is in the row; what nobody foresaw is raised.

    `key` is what the piece was when it was handed out; where its files have changed since, that is a fault.
    """
    try:
        expect_same(piece, key)
        output = _planned(piece)
        expect_same(piece, key)
        return output
    except Changed as changed:
        return _without_plan(piece, "fault", str(changed))
    except Questions as error:
        asks = "\n".join(
            "  - " + "\n  ".join(map(escape_text, question.told().split("\n"))) for question in error.questions
        )
        return _without_plan(piece, "asks", f"{error.message}\n{asks}")
    except InputError as error:
        seen = _seen(error.nest, error.wrong) if isinstance(error, BrokenNest) else ""
        wrong = "refused" if _is_of(error, piece.source) else "no fit"
        return _without_plan(piece, wrong, _told(error, piece.source), thumbnail=seen)
    except NoPlan as error:
        conflict = error.conflict
        seen = _seen(error.facts.nest, conflict.contours if conflict is not None else ())
        relax = conflict is not None and conflict.relax is not None
        return _without_plan(piece, "no plan", str(error), relax=relax, thumbnail=seen)
    except RulesConflict as error:
        return _without_plan(piece, "no plan", str(error), relax="in Python relax=True, leaves" in str(error))


def fault(piece: NestTask, error: Exception) -> TaskOutput:
    """The row of a piece that has ended in a way that nobody foresaw."""
    return _without_plan(piece, "fault", f"a fault of kerfwise itself: {escape_text(exception_text(error))}")


def _planned(piece: NestTask) -> TaskOutput:
    options, notes = piece.options, list[str]()
    inputs = task_inputs(piece, notes.append)
    limits = options_for(
        inputs.nest, inputs.profile, work=options.work, time_s=options.time_s, gap=options.gap, seed=options.seed,
        memory_gb=options.memory_gb,
    )  # fmt: skip
    done = plan_nest(inputs, limits, watchers=Watchers(_Elsewhere()), relax=options.relax)
    if not done.made.verdict.ok:
        broken = ", ".join(done.made.verdict.broken())
        return _without_plan(piece, "not safe", f"the check refuses the plan that was found: {broken}")
    seen = thumbnail(done.given.nest, done.made.plan)
    row = _row(piece, "planned", figures=_figures(done), notes=tuple(notes), thumbnail=seen)
    return TaskOutput(row, _contents(piece, inputs, done))


def _contents(piece: NestTask, inputs: Inputs, done: FinishedPlan) -> Mapping[str, str | bytes]:
    """Program, plan, picture and page, and what of the sheet can be used again, by the names that they have."""
    stem, plan = Path(piece.name).name, done.made.plan
    files: dict[str, str | bytes] = {
        f"{stem}.nc": done.made.program,
        f"{stem}{PLAN}": plan.to_json(),
        f"{stem}.svg": draw(inputs.nest, plan, ".svg", inputs.profile.home_on(inputs.nest)),
    }
    if not done.given.profile.machine.torches.several:  # the page knows one
        page = page_data(done.given, plan, done.made.verdict, done.made.program, False, "none")
        files[f"{stem}.html"] = page_bytes(page)
    saved = remnant_files(f"{stem}.nc", inputs.nest, inputs.profile)
    return files | {path.name: text for path, text in saved.items()}


def _figures(done: FinishedPlan) -> Figures:
    plan, times = done.made.plan, time_made(done.given, done.made.plan)
    cost = times.cost
    return Figures(
        contours=len(plan.cuts),
        pierces=plan.totals.pierces,
        cut_mm=round(plan.totals.cut_mm, 3),
        idle_mm=round(plan.totals.idle_mm, 3),
        time_s=round(times.total_s, 3),
        gap=None if plan.told_gap is None else round(plan.told_gap, 6),
        excuses=tuple(f"{place.rule}: {place.why}" for place in plan.stated.places),
        cost=None if cost is None else round(cost.total, 4),
        currency="" if cost is None else cost.currency,
        state=plan.stated.short(),
    )


def _is_of(error: InputError, source: Path) -> bool:
    """Whether it is the file of a nest that is wrong."""
    return error.file is not None and Path(str(error.file)).name == source.name


def _told(error: InputError, source: Path) -> str:
    """All that is wrong with a nest, without the name of its file, which stands in the row."""
    message = error.message
    place = ", ".join(f"{what} {at}" for what, at in (("line", error.line), ("column", error.column)) if at is not None)
    if _is_of(error, source):
        head = InputError(f"{place}: {message}" if place else message)
    else:
        head = InputError(message, file=error.file, line=error.line, column=error.column)
    return "\n".join([str(head), *(f"  - {escape_text(text)}" for text in error.details)])


def _seen(nest: Nest, alert: tuple[str, ...]) -> str:
    """A thumbnail of a nest that was refused; none where it is too broken to be drawn."""
    try:
        return thumbnail(nest, alert=alert)
    except Exception:  # of a broken nest nothing is sure
        return ""


def _row(piece: NestTask, ended: Any, text: str = "", **more: Any) -> Row:
    sheets: dict[str, Any] = {"quantity": piece.quantity, "order": piece.order, "due": piece.due}
    return Row(piece.name, str(piece.source), piece.machine.name, ended, text, **sheets, **more)


def _without_plan(piece: NestTask, ended: Any, text: str, **more: Any) -> TaskOutput:
    return TaskOutput(_row(piece, ended, text, **more), {})


# The same batch on the machines of a Dask cluster, given by the address of its scheduler.

Piece = TypeVar("Piece")
Made = TypeVar("Made")

ANSWER_S = 10.0
"""How long a scheduler may take to answer."""
AHEAD = 4
"""Pieces handed out for each thread of the cluster: enough to keep it busy, few enough to be told what is done now."""


def dask() -> Any:
    """Dask's package for several machines, which is an extra. Raises InputError if it is not installed."""
    try:
        import distributed
    except ImportError:
        raise InputError("--scheduler needs Dask: pip install 'kerfwise[cluster]'") from None
    return distributed


class Cluster(Generic[Piece, Made]):
    """Pieces of work done by the workers of a Dask scheduler.

    Where a worker dies, Dask gives what it did to another; a piece that has killed several is an exception. Each piece
    comes back once. Files are named, not sent: the workers see nests and profiles under the same paths. Raises
    InputError if Dask is not installed, or no scheduler answers at the address.
    """

    def __init__(self, work: Callable[[Piece], Made], scheduler: str, tell: Callable[[str], None]) -> None:
        client = dask().Client
        for name in ("distributed", "distributed.client", "distributed.core", "distributed.comm", "tornado"):
            logging.getLogger(name).setLevel(logging.CRITICAL)  # what matters is said here, in words
        try:
            self._client: Any = client(scheduler, timeout=ANSWER_S, set_as_default=False)
        except (OSError, TimeoutError, ValueError) as error:
            text = f"no Dask scheduler answers ({error})"
            raise InputError(f"--scheduler {scheduler}: {text}; start one with `dask scheduler`") from None
        self._work, self._scheduler = work, scheduler
        workers = self._workers()
        if not workers:
            tell(f"the scheduler {scheduler} has no worker yet: start some with `dask worker {scheduler} --nthreads 1`")
        if any(worker["nthreads"] > 1 for worker in workers):
            tell(
                "workers with several threads plan several nests in one process, which is slow: --nthreads 1 is faster"
            )

    def run(self, pieces: Iterable[Piece], began: Callable[[Piece], None]) -> Iterator[tuple[Piece, Made | Exception]]:
        """Each piece with what was made of it, as soon as it is finished; with the exception, where one was raised.

        Raises InputError if the scheduler is lost.
        """
        left = iter(pieces)
        tasks: dict[Any, Piece] = {}
        answers = dask().as_completed(loop=self._client.loop)
        try:
            while True:
                room = AHEAD * max(1, sum(worker["nthreads"] for worker in self._workers())) - len(tasks)
                for _, piece in zip(range(room), left, strict=False):
                    future = self._client.submit(self._work, piece, pure=False)
                    tasks[future] = piece
                    answers.add(future)
                    began(piece)
                if not tasks:
                    return
                future = next(answers)
                yield tasks.pop(future), self._answer(future)
        finally:
            self._client.cancel(list(tasks), force=True)

    def _answer(self, future: Any) -> Made | Exception:
        if future.cancelled():
            raise InputError(f"--scheduler {self._scheduler}: was lost; the same command goes on from here")
        error = future.exception()
        if isinstance(error, Exception):
            return error
        answer: Made = future.result()
        future.release()
        return answer

    def _workers(self) -> list[dict[str, Any]]:
        with contextlib.suppress(OSError, TimeoutError):
            return list(self._client.scheduler_info(n_workers=-1)["workers"].values())
        return []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._client.close()
