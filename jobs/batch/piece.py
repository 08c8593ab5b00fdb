"""A piece of the batch: one nest on one machine, planned as `kerfwise solve` does it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Self

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers.read import BrokenNest
from kerfwise.encoder.shown import shown
from kerfwise.jobs.content_key import key_of
from kerfwise.jobs.given import Given, drawn_nest, plant_of, tabs_not_left
from kerfwise.jobs.listening import Listener
from kerfwise.jobs.main_job import Finished, plan_nest
from kerfwise.jobs.no_plan import NoPlan
from kerfwise.jobs.solve_options import options_for
from kerfwise.jobs.times import time_made
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.nc.remnant import remnant_files
from kerfwise.postproc.report import draw
from kerfwise.postproc.report.thumbnail import thumbnail
from kerfwise.rules.profile.placing import placing_notes
from kerfwise.rules.profile.profile import Profile

from .row import Figures, Row


@dataclass(frozen=True, slots=True)
class Machine:
    """A machine of the batch: its name there, its profile as the user names it, and the sha256 that this one has."""

    name: str
    profile: str
    sha256: str
    trust: bool = False


@dataclass(frozen=True, slots=True)
class Options:
    """The options of `kerfwise solve` that hold for every nest of a batch."""

    work: float = 30.0
    time_s: float | None = None
    gap: float | None = None
    seed: int = 1
    memory_gb: float = 2.0
    relax: bool = False
    repair: bool = False


@dataclass(frozen=True, slots=True)
class Piece:
    """One nest on one machine; `name` is the nest's in the folder of the batch."""

    name: str
    source: Path
    machine: Machine
    options: Options
    version: str

    def key(self) -> str:
        """The sha256 of all that the answer depends on: nest, profile with all that it is made of, options, version."""
        besides = {"version": self.version, "profile": self.machine.sha256, **asdict(self.options)}
        return key_of([self.source], besides)


@dataclass(frozen=True, slots=True)
class Made:
    """The row of a piece, and the content of its files by their names."""

    row: Row
    contents: Mapping[str, str | bytes]


class _Changed(Exception):
    """Something is not what it was when the piece was handed out."""


class _Elsewhere(Listener):
    """Ctrl-C is answered where the pieces are handed out."""

    def __enter__(self) -> Self:
        return self


def plan_piece(piece: Piece, key: str) -> Made:
    """Plan one nest on one machine. Whatever goes wrong is in the row: nothing is raised.

    `key` is what the piece was when it was handed out; where its files have changed since, that is a fault.
    """
    try:
        expect_same(piece, key)
        made = _planned(piece)
        expect_same(piece, key)
        return made
    except _Changed as changed:
        return _without_plan(piece, "fault", str(changed))
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
        return _without_plan(piece, "no plan", str(error), relax="--relax" in str(error))
    except Exception as error:
        return fault(piece, error)


def fault(piece: Piece, error: Exception) -> Made:
    """The row of a piece that has ended in a way that nobody foresaw."""
    said = shown(" ".join(str(error).split()))[:200]
    what = f"{type(error).__name__}: {said}" if said else type(error).__name__
    return _without_plan(piece, "fault", f"a fault of kerfwise itself: {what}")


def expect_same(piece: Piece, key: str) -> None:
    """Refuse to go on where the files of a piece are not those that its key was made of."""
    if piece.key() != key:
        raise _Changed("its file changed while it was planned, or is another one where it was planned")


def _planned(piece: Piece) -> Made:
    plant = _plant(piece.machine)
    options = piece.options
    drawn = drawn_nest(piece.source, plant, repair=options.repair)
    given = Given(plant.as_cut(drawn), plant)
    limits = options_for(
        given.nest, plant, work=options.work, time_s=options.time_s, gap=options.gap, seed=options.seed,
        memory_gb=options.memory_gb,
    )  # fmt: skip
    done = plan_nest(given, limits, relax=options.relax, listener=_Elsewhere())
    if not done.made.verdict.ok:
        broken = ", ".join(done.made.verdict.broken())
        return _without_plan(piece, "not safe", f"the check refuses the plan that was found: {broken}")
    figures, notes = _figures(done), tuple(_notes(drawn, given))
    row = _row(piece, "planned", figures=figures, notes=notes, thumbnail=thumbnail(done.given.nest, done.made.plan))
    return Made(row, _contents(piece, given, done))


@lru_cache(maxsize=16)
def _plant(machine: Machine) -> Profile:
    """The profile of a machine, read once a process."""
    plant = plant_of(machine.profile, machine.trust)
    if plant.sha256 != machine.sha256:
        raise _Changed(f"the profile {shown(machine.profile)} changed while the batch ran, or is another one there")
    return plant


def _contents(piece: Piece, given: Given, done: Finished) -> Mapping[str, str | bytes]:
    """Program, plan and picture, and what of the sheet can be used again, by the names that they have."""
    stem, plan = Path(piece.name).name, done.made.plan
    files: dict[str, str | bytes] = {
        f"{stem}.nc": done.made.program,
        f"{stem}.plan.json": plan.to_json(),
        f"{stem}.svg": draw(given.nest, plan, ".svg", given.profile.home_on(given.nest)),
    }
    saved = remnant_files(f"{stem}.nc", given.nest, given.profile)
    return files | {path.name: text for path, text in saved.items()}


def _figures(done: Finished) -> Figures:
    plan, times = done.made.plan, time_made(done.given, done.made.plan)
    gap = plan.solve.gap if plan.light_gap is None else plan.light_gap
    cost = times.cost
    return Figures(
        contours=len(plan.cuts),
        pierces=plan.totals.pierces,
        cut_mm=round(plan.totals.cut_mm, 3),
        idle_mm=round(plan.totals.idle_mm, 3),
        time_s=round(times.total_s, 3),
        gap=None if gap is None else round(gap, 6),
        excuses=tuple(_excuses(plan)),
        cost=None if cost is None else round(cost.total, 4),
        currency="" if cost is None else cost.currency,
    )


def _excuses(plan: Plan) -> Iterator[str]:
    """Where a hard rule does not hold, and why, a sentence each; relaxed ones are among them."""
    for rule in plan.rules:
        yield from (f"{rule.id}: {why}" for _, why in rule.exceptions)
    yield from (f"{dropped.rule}: {dropped.why}" for dropped in plan.dropped if dropped.relaxed)


def _notes(drawn: Nest, given: Given) -> Iterator[str]:
    """What a planner should know of the nest, as `solve` says it on standard error."""
    yield from (f"{note.severity}: {note.text}" for note in drawn.notes)
    if cut_all_the_same := tabs_not_left(drawn, given.profile):
        yield f"warning: {cut_all_the_same}"
    yield from (f"warning: {text}" for text in placing_notes(given.nest, given.profile))
    yield from (f"note: {text}" for text in given.profile.chart_notes())


def _is_of(error: InputError, source: Path) -> bool:
    """Whether it is the file of a nest that is wrong."""
    return error.file is not None and Path(str(error.file)).name == source.name


def _told(error: InputError, source: Path) -> str:
    """What is wrong with a nest, without the name of its file, which stands in the row."""
    if not _is_of(error, source):
        return str(error)
    place = ", ".join(f"{what} {at}" for what, at in (("line", error.line), ("column", error.column)) if at is not None)
    return str(InputError(f"{place}: {error.message}" if place else error.message, details=error.details))


def _seen(nest: Nest, alert: tuple[str, ...]) -> str:
    """A thumbnail of a nest that was refused; none where it is too broken to be drawn."""
    try:
        return thumbnail(nest, alert=alert)
    except Exception:  # of a broken nest nothing is sure
        return ""


def _row(piece: Piece, ended: Any, told: str = "", **more: Any) -> Row:
    return Row(piece.name, str(piece.source), piece.machine.name, ended, told, **more)


def _without_plan(piece: Piece, ended: Any, told: str, **more: Any) -> Made:
    return Made(_row(piece, ended, told, **more), {})
