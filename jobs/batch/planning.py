"""One nest planned on one machine, as `kerfwise solve` does it; whatever goes wrong is an answer, too."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.faults import said
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.questions import Questions
from kerfwise.encoder.readers.read import BrokenNest
from kerfwise.encoder.shown import shown
from kerfwise.jobs.given import Given
from kerfwise.jobs.listening import Listener
from kerfwise.jobs.main_job import Finished, plan_nest
from kerfwise.jobs.no_plan import NoPlan
from kerfwise.jobs.page.page import page_bytes, page_data
from kerfwise.jobs.solve_options import options_for
from kerfwise.jobs.times import time_made
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.nc.remnant import remnant_files
from kerfwise.postproc.report import draw
from kerfwise.postproc.report.thumbnail import thumbnail

from .piece import Piece
from .reading import Changed, expect_same, given_of
from .row import PLAN, Figures, Row


@dataclass(frozen=True, slots=True)
class Made:
    """The row of a piece, and the content of its files by their names."""

    row: Row
    contents: Mapping[str, str | bytes]


class _Elsewhere(Listener):
    """Ctrl-C is answered where the pieces are handed out."""

    def __enter__(self) -> Self:
        return self


def plan_piece(piece: Piece, key: str) -> Made:
    """Plan one nest on one machine. That it is refused is in the row; what nobody foresaw is raised.

    `key` is what the piece was when it was handed out; where its files have changed since, that is a fault.
    """
    try:
        expect_same(piece, key)
        made = _planned(piece)
        expect_same(piece, key)
        return made
    except Changed as changed:
        return _without_plan(piece, "fault", str(changed))
    except Questions as error:
        asks = "\n".join(f"  - {shown(line)}" for question in error.questions for line in question.told().split("\n"))
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


def fault(piece: Piece, error: Exception) -> Made:
    """The row of a piece that has ended in a way that nobody foresaw."""
    return _without_plan(piece, "fault", f"a fault of kerfwise itself: {shown(said(error))}")


def _planned(piece: Piece) -> Made:
    options, notes = piece.options, list[str]()
    given = given_of(piece, notes.append)
    limits = options_for(
        given.nest, given.profile, work=options.work, time_s=options.time_s, gap=options.gap, seed=options.seed,
        memory_gb=options.memory_gb,
    )  # fmt: skip
    done = plan_nest(given, limits, relax=options.relax, listener=_Elsewhere())
    if not done.made.verdict.ok:
        broken = ", ".join(done.made.verdict.broken())
        return _without_plan(piece, "not safe", f"the check refuses the plan that was found: {broken}")
    seen = thumbnail(done.given.nest, done.made.plan)
    row = _row(piece, "planned", figures=_figures(done), notes=tuple(notes), thumbnail=seen)
    return Made(row, _contents(piece, given, done))


def _contents(piece: Piece, given: Given, done: Finished) -> Mapping[str, str | bytes]:
    """Program, plan, picture and page, and what of the sheet can be used again, by the names that they have."""
    stem, plan = Path(piece.name).name, done.made.plan
    files: dict[str, str | bytes] = {
        f"{stem}.nc": done.made.program,
        f"{stem}{PLAN}": plan.to_json(),
        f"{stem}.svg": draw(given.nest, plan, ".svg", given.profile.home_on(given.nest)),
    }
    if not done.given.profile.machine.torches.several:  # the page knows one
        page = page_data(done.given, plan, done.made.verdict, done.made.program, False, "none")
        files[f"{stem}.html"] = page_bytes(page)
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
    return "\n".join([str(head), *(f"  - {shown(text)}" for text in error.details)])


def _seen(nest: Nest, alert: tuple[str, ...]) -> str:
    """A thumbnail of a nest that was refused; none where it is too broken to be drawn."""
    try:
        return thumbnail(nest, alert=alert)
    except Exception:  # of a broken nest nothing is sure
        return ""


def _row(piece: Piece, ended: Any, told: str = "", **more: Any) -> Row:
    sheets: dict[str, Any] = {"quantity": piece.quantity, "order": piece.order, "due": piece.due}
    return Row(piece.name, str(piece.source), piece.machine.name, ended, told, **sheets, **more)


def _without_plan(piece: Piece, ended: Any, told: str, **more: Any) -> Made:
    return Made(_row(piece, ended, told, **more), {})
