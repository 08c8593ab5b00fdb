"""Work sheets: what the operator has on paper beside the machine."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from kerfwise.apps.work_sheets.paper import BOX, MARGIN, ROOM, WIDTH, Paper, qr_items, shortened
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.inputs import Inputs, Tell, dates_ignored, differences, program_text, silent
from kerfwise.jobs.nest_job.job import Job
from kerfwise.jobs.programs import Times, time_made
from kerfwise.languages import ENGLISH, ENGLISH_TEXTS, Texts, texts
from kerfwise.models.plan.plan import Plan, PlannedCut
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.report.legend import clock_text, duration
from kerfwise.postproc.report.picture import bare_picture
from kerfwise.postproc.report.plot import pdf_bytes
from kerfwise.postproc.report.scene import FAINT, INK, Scene, TextLine
from kerfwise.postproc.verdict.check_plan import check_plan, check_program, held_to_plan
from kerfwise.postproc.verdict.dialect_read_back import trusted_dialect
from kerfwise.rules.plan_state import PlanState
from kerfwise.rules.profile.overrides import lines_of
from kerfwise.rules.profile.profile import Profile

from .sheet_parts import PartKind, left_of, part_kinds, zero_sketch, zero_words


@dataclass(frozen=True, eq=False, slots=True)
class WorkSheet:
    """One nest with its plan, as the operator has it on paper.

    Attributes
    ----------
    nest, profile
        The nest as the profile has it cut, and the profile.
    plan
        Of the nest; it passed the check.
    times
        What it takes, and costs.
    program, program_name
        The text of the NC program, and the name of its file.
    state
        Whether every hard rule holds, as the check finds now.
    about
        More to say at the top, such as an order and when it is due: names and values.
    changed
        What is not as it was when the plan was made, a sentence each: the settings above may be others than its own.
    language
        That the sheet speaks, the sentences of shipped rules included; what is said of single places stays English.
    """

    nest: Nest
    profile: Profile
    plan: Plan
    times: Times
    program: str
    program_name: str
    state: PlanState
    about: Mapping[str, str] = field(default_factory=dict)
    changed: tuple[str, ...] = ()
    language: str = ENGLISH

    @property
    def say(self) -> Texts:
        """How the sheet says things."""
        return texts(self.language)

    @property
    def program_sha256(self) -> str:
        """The hash of the program's file, as `sha256sum` says it."""
        return hashlib.sha256(self.program.encode("utf-8")).hexdigest()

    @property
    def not_kept(self) -> tuple[str, ...]:
        """Where to stand by: what is excused or relaxed, a line for each reason, with the sentence of its rule."""
        return tuple(_not_kept(self))


def work_sheet(
    inputs: Inputs,
    plan: Plan,
    program: str | Path | None = None,
    *,
    name: str = "",
    about: Mapping[str, str] | None = None,
    tell: Tell = silent,
    language: str = ENGLISH,
) -> WorkSheet:
    """The work sheet of a plan.

    `inputs`: nest and profile. `plan`: the plan of the nest. `program`: the file of its NC program; where none is
    given, the program is written anew from the plan, as `solve` does. `name`: what the program's file is called, where
    no file is given; else it is named after the nest. `about`: more to say at the top. `tell`: told what is not as it
    was when the plan was made; it stands on the sheet, too. `language`: that it speaks: one of `LANGUAGES`. Raises
    InputError if the plan or the program is of another nest, or the program cannot be read; RulesConflict if the check
    refuses the plan, or the program does not follow it: nobody should cut by such a sheet.
    """
    trusted_dialect(inputs.profile)
    changed = tuple(differences(plan, inputs, judged=True))
    for text in changed:
        tell(text)
    times = time_made(inputs, plan)  # refuses the plan of another nest
    verdict = check_plan(inputs.nest, plan, inputs.profile)
    if not verdict.ok:
        raise RulesConflict(f"the check refuses the plan: {', '.join(verdict.broken())}; no work sheet is made")
    if program is None:
        text = write_program(plan, inputs.nest, inputs.profile)
        file = name or f"{Path(inputs.nest.file or 'nest').stem}.nc"
    else:
        text, file = program_text(program), Path(program).name
        followed = check_program(inputs.nest, text, inputs.profile, str(program), plan)
        followed = held_to_plan(followed, inputs.nest, text, plan, inputs.profile)
        if not followed.ok:
            wrong = ", ".join(followed.broken())
            raise RulesConflict(f"{program}: the program does not follow the plan, or breaks rules: {wrong}")
    shown = escape_text(file)
    return WorkSheet(
        inputs.nest, inputs.profile, plan, times, text, shown, verdict.state, about or {}, changed, language
    )


def _not_kept(sheet: WorkSheet) -> Iterator[str]:
    tr, book = sheet.say.tr, sheet.profile.rulebook()
    before, not_kept = tr(" before "), tr("not kept")

    def asked(rule: str) -> str:
        return f" – {escape_text(tr(book[rule].sentence))}" if rule in book else ""

    found: dict[tuple[str, str], list[str]] = {}
    for rule in sheet.plan.rules:
        for contours, why in rule.exceptions:
            found.setdefault((rule.id, why), []).append(", ".join(contours))
    for dropped in sheet.plan.dropped:
        if dropped.relaxed:
            reason = (dropped.rule, f"{not_kept}: {dropped.why}")
            found.setdefault(reason, []).append(before.join(dropped.contours))
    for (rule_id, why), names in found.items():
        named = f"{'; '.join(names)}: " if any(names) else ""
        yield f"{named}{why}{asked(rule_id)}"


# The facts at the top of a work sheet, and what the operator ticks.

_MOST_PLACES = 12


def facts_of_sheet(sheet: WorkSheet) -> Iterator[tuple[str, str]]:
    """Names and values: stock, machine, feeds, settings, gas, time, lengths, cost."""
    plan, totals, report = sheet.plan, sheet.plan.totals, sheet.times.report
    machine, material = sheet.profile.machine, sheet.profile.material
    tr, trn = sheet.say
    feeds = (
        (tr("cut"), machine.cut_feed_mm_s), (tr("mark"), machine.mark_feed_mm_s), (tr("travel"), machine.travel_mm_s)
    )  # fmt: skip
    feeds_text = ", ".join(f"{name} {mm_s * 60:g}" for name, mm_s in feeds)
    spent = (
        (tr("cutting"), report.cut_s),
        (tr("travelling"), report.idle_s),
        (tr("piercing"), report.pierce_s),
        *([(tr("waiting"), report.dwell_s)] if report.dwell_s else []),
    )
    shares = ", ".join(f"{name} {clock_text(seconds)}" for name, seconds in spent)
    yield tr("state"), escape_text(_state(sheet))
    yield tr("sheet"), f"{_stock(sheet)}, {_parts(sheet)}"
    if sheet.nest.reading is not None and sheet.nest.reading.taken:
        yield tr("drawing"), sheet.nest.reading.short()
    if across := [(c.cut.contour, at) for c in plan.cuts for at in c.across]:
        places = "; ".join(
            tr("{name} at ({x}, {y})").format(name=name, x=f"{x:.1f}", y=f"{y:.1f}")
            for name, (x, y) in across[:_MOST_PLACES]
        )
        further = tr("and {n} more").format(n=len(across) - _MOST_PLACES)
        more = f"; {further}" if len(across) > _MOST_PLACES else ""
        slots = trn(
            "{n} slot narrower than the kerf (crosses)", "{n} slots narrower than the kerf (crosses)", len(across)
        )
        yield tr("not cut"), f"{slots.format(n=len(across))}: {places}{more}"
    left = left_of(sheet.nest, sheet.profile.material.kerf_mm)
    if min(left) > 0:
        yield (
            tr("left over"),
            tr("at most {size} mm in one piece, beside the parts").format(size=f"{left[0]:.0f} × {left[1]:.0f}"),
        )
    dues = sorted({row.due for row in part_kinds(sheet.nest, sheet.profile) if row.due})
    loose = tr("the order of the cuts does not follow it") if dates_ignored(sheet.nest, sheet.profile) else ""
    if dues and "due" not in sheet.about:
        yield tr("due"), "; ".join(filter(None, (dues[0], loose)))
    yield tr("machine"), f"{machine.process}, {machine.dialect}; {_zero(sheet)}"
    widths = {"kerf": f"{material.kerf_mm:g}", "s": f"{machine.pierce_time_s:g}"}
    line = tr("{feeds} mm/min; kerf {kerf} mm, pierce {s} s").format(feeds=feeds_text, **widths)
    yield tr("feeds"), re.sub(r"(?<=\d) (?=\D)", "\u00a0", line)  # no unit stands in a line of its own
    yield tr("settings"), _settings(sheet)
    yield tr("gas"), material.gas or _unknown(sheet.say)
    yield tr("time"), f"{duration(report.total_s, sheet.say)} ({shares})"
    lengths = tr("torch on {on} m, idle {idle} m")
    lengths = lengths.format(on=f"{totals.cut_mm / 1000:.2f}", idle=f"{totals.idle_mm / 1000:.2f}")
    at_once = tr("all of a zone or of the sheet first")
    passes = f", {at_once}" if plan.pierces else ""
    pierces = trn("{n} pierce", "{n} pierces", totals.pierces).format(n=totals.pierces)
    yield tr("path"), f"{lengths}, {pierces}{passes}"
    if sheet.times.cost is not None:
        yield tr("cost"), str(sheet.times.cost)
    if plan.already:
        repeated, after = tr("the last is cut again"), tr("after cut {number}").format(number=plan.resumed_after)
        yield tr("goes on"), f"{after}; {repeated}" if plan.broken_off is not None else after


def checklist(sheet: WorkSheet) -> Iterator[str]:
    """What is looked at before the program starts, and after it ends."""
    tr = sheet.say.tr
    yield tr("sheet on the table: {stock}").format(stock=_stock(sheet))
    yield tr("zero set: {zero}").format(zero=_zero(sheet))
    yield tr("program loaded: {name}; its SHA-256 is that of the code above").format(name=sheet.program_name)
    gas = sheet.profile.material.gas or _unknown(sheet.say)
    yield tr("settings: {settings}; gas: {gas}").format(settings=_settings(sheet), gas=gas)
    yield tr("{parts} counted and good; scrap: ______").format(parts=_parts(sheet))


def _unknown(say: Texts) -> str:
    return say.tr("as the machine has it")


def _state(sheet: WorkSheet) -> str:
    """What the state means to whoever stands at the machine."""
    state, (tr, trn) = sheet.state, sheet.say
    if state.kind == "kept":
        return tr("kept: cut it as the program says")
    if state.kind == "broken":
        return tr("broken: do not cut this sheet")
    text = trn(
        "kept but for {n} place: metal may move or tip there, stand by when these are cut: {places}",
        "kept but for {n} places: metal may move or tip there, stand by when these are cut: {places}",
        state.count,
    )
    return text.format(n=state.count, places=state.named())


def _settings(sheet: WorkSheet) -> str:
    material, tr = sheet.profile.material, sheet.say.tr
    known = (
        ("{value} A", material.amps),
        ("{value} V", material.volts),
        (tr("power {value} %"), material.power),
        (tr("pierce power {value} %"), material.pierce_power),
        (tr("mark power {value} %"), material.mark_power),
        (tr("pierce height {value} mm"), material.pierce_height_mm),
        (tr("cut height {value} mm"), material.cut_height_mm),
    )
    texts = (text.format(value=f"{value:g}") for text, value in known if value is not None)
    return ", ".join(texts) or _unknown(sheet.say)


def _stock(sheet: WorkSheet) -> str:
    material, (left, bottom, right, top) = sheet.profile.material, sheet.nest.sheet.bounds
    assumed = f" {sheet.say.tr('(assumed)')}" if sheet.nest.reading is not None and sheet.nest.reading.assumed else ""
    return f"{material.name}, {material.thickness_mm:g} mm, {right - left:g} × {top - bottom:g} mm{assumed}"


def _parts(sheet: WorkSheet) -> str:
    count = len({planned.part for planned in sheet.plan.cuts if planned.kind == "outer"})
    return sheet.say.trn("{n} part", "{n} parts", count).format(n=count)


def _zero(sheet: WorkSheet) -> str:
    corner = zero_words(sheet.nest, sheet.plan.zero, sheet.say)
    return sheet.say.tr("the machine's zero is the {corner}").format(corner=corner)


# Work sheets as pages of A4: head, facts, picture, boxes to tick, what is not kept, locks, and the table of cuts.

_QR = 78.0
_MANY = 60
"""Cuts from which on the picture gets more of the first page, so that its numbers can be read."""
_HIGH = {False: 290.0, True: 470.0}


def sheets_pdf(sheets: Sequence[WorkSheet], date: str = "") -> bytes:
    """The work sheets of several nests in one PDF, each from a page of its own on.

    The same sheets give the same bytes: a date stands on them only where one is given.
    """
    pages = [page for sheet in sheets for page in pages_of(sheet, date)]
    return pdf_bytes(pages, " · ".join(_title(sheet) for sheet in sheets[:3]) + (" …" if len(sheets) > 3 else ""))


def pages_of(sheet: WorkSheet, date: str = "") -> tuple[Scene, ...]:
    """The pages of one work sheet."""
    tr = sheet.say.tr
    paper = Paper(f"{_title(sheet)} · {sheet.program_name} · sha256 {sheet.program_sha256[:16]}…", sheet.say)
    _head(paper, sheet, date)
    home = sheet.profile.at_origin(sheet.plan.origin).home_on(sheet.nest)
    most_high = _HIGH[len(sheet.plan.cuts) > _MANY]
    paper.picture(bare_picture(sheet.nest, sheet.plan, home, ROOM, most_high))
    paper.skip(10.0)
    key = tr("bold numbers: outer contours, in cutting order; grey: parts; red dots: pierces; dashed: idle travel")
    paper.lines([key], 6.5)
    paper.heading(tr("Before and after"))
    paper.lines(checklist(sheet), 8.0, BOX)
    _signed(paper, sheet.say)
    paper.heading(tr("Parts"))
    kinds = part_kinds(sheet.nest, sheet.profile)
    if any(row.order or row.due or row.count > 1 for row in kinds):
        head = ("", tr("part"), tr("count"), tr("order"), tr("due"), tr("size, mm"), tr("kg each"), tr("kg"))
        paper.table(head, [_part_row(row) for row in kinds])
    else:
        bare = [(BOX, escape_text(row.name), *_part_row(row)[-3:-1]) for row in kinds]
        paper.table(("", tr("part"), tr("size, mm"), tr("kg")), bare, blocks=3)
    paper.skip(6.0)
    for heading, lines in (
        (tr("Not as it was when the plan was made"), [escape_text(text) for text in sheet.changed]),
        (tr("Take care"), sheet.not_kept),
        (tr("Locks"), [escape_text(line) for lock in sheet.profile.locks for line in lines_of(lock)]),
        (tr("Metal lost"), [escape_text(loss.sentence()) for loss in sheet.plan.losses]),
        (tr("Not cut"), [f"{escape_text(left.contour)}: {left.why}" for left in sheet.plan.left_out]),
    ):
        if lines:
            paper.heading(heading)
            paper.lines(lines, 7.5, "–")
    cuts = len(sheet.plan.cuts)
    paper.heading(sheet.say.trn("{n} cut, in order", "{n} cuts, in order", cuts).format(n=cuts))
    rows = [_row(k, planned, sheet.say) for k, planned in enumerate(sheet.plan.cuts, sheet.plan.resumed_after + 1)]
    cut_head = ("", "#", tr("contour"), tr("way"), "mm", tr("begins"), tr("note"))
    paper.table(cut_head, rows, blocks=2)
    return paper.scenes()


def _part_row(row: PartKind) -> tuple[str, ...]:
    size, weight = f"{row.width_mm:.0f} × {row.height_mm:.0f}", f"{row.weight_kg:.3g}"
    named = (escape_text(text) for text in (row.order, row.due))
    return (BOX, escape_text(row.name), str(row.count), *named, size, weight, f"{row.count * row.weight_kg:.3g}")


def _title(sheet: WorkSheet) -> str:
    return escape_text(Path(sheet.nest.file or "nest").name)


def _head(paper: Paper, sheet: WorkSheet, date: str) -> None:
    """Title and facts, and beside them the QR code of the program's hash."""
    right, sha256 = WIDTH - MARGIN, sheet.program_sha256
    paper.put(qr_items(f"SHA256 {sha256}".upper(), right - _QR, MARGIN, _QR))
    paper.put(zero_sketch(sheet.nest, sheet.plan.zero, right - _QR - 62, MARGIN + 4, 46.0))
    paper.put([TextLine(right - _QR - 39, MARGIN + 58, sheet.say.tr("zero"), 6.0, FAINT)])
    for k in range(4):
        text = sha256[16 * k : 16 * k + 16]
        paper.put([TextLine(right - _QR / 2, MARGIN + _QR + 8 + 7.5 * k, text, 6.0, FAINT)])
    room = ROOM - _QR - 76
    title = shortened(_title(sheet), 15.0, 0.85 * room)
    paper.put([TextLine(MARGIN, paper.y + 8, title, 15.0, INK, "start", bold=True)])
    paper.skip(25.0)
    tr = sheet.say.tr
    program = tr("program {name}").format(name=sheet.program_name)
    line = " · ".join(filter(None, (program, tr("profile {name}").format(name=sheet.profile.name), date)))
    paper.put([TextLine(MARGIN, paper.y, shortened(escape_text(line), 9.0, room), 9.0, INK, "start")])
    paper.skip(12.0)
    paper.pairs([*_about(sheet), *facts_of_sheet(sheet)], room)
    paper.y = max(paper.y, MARGIN + _QR + 40) + 4


def _about(sheet: WorkSheet) -> Iterator[tuple[str, str]]:
    """What more is said at the top; names that kerfwise gives are said in the sheet's language."""
    tr = sheet.say.tr
    known = {"order": tr("order"), "due": tr("due"), "sheets": tr("sheets"), "number": tr("number")}
    for name, text in sheet.about.items():
        yield known.get(name, escape_text(name)), escape_text(text)


def _signed(paper: Paper, say: Texts) -> None:
    """Lines to write on."""
    paper.room_for(18.0)
    paper.skip(6.0)
    for k, name in enumerate((say.tr("operator"), say.tr("machine"), say.tr("date, time"))):
        paper.put([TextLine(MARGIN + 180 * k, paper.y + 4, f"{name} ____________________", 8.0, INK, "start")])
    paper.skip(12.0)


def _row(order: int, planned: PlannedCut, say: Texts) -> tuple[str, ...]:
    cut, (tr, trn) = planned.cut, say
    kinds = {"mark": tr("mark"), "slit": tr("slit"), "scrap": tr("scrap line")}
    notes = [
        *([kinds[planned.kind]] if planned.kind in kinds else []),
        *([tr("linked")] if cut.linked else []),
        *([tr("waits {s} s").format(s=f"{planned.dwell_s:.1f}")] if planned.dwell_s else []),
        *([trn("{n} tab", "{n} tabs", len(cut.tabs)).format(n=len(cut.tabs))] if cut.tabs else []),
        *([" / ".join(f"{one.tilt_deg:g}°" for one in planned.passes)] if planned.passes else []),
        *([tr("take care")] if cut.excused else []),
    ]
    begins = clock_text(cut.start_s)
    return (
        BOX,
        str(order),
        escape_text(cut.contour),
        cut.direction,
        f"{planned.length_mm:.0f}",
        begins,
        ", ".join(notes),
    )


# What a work sheet says of the job that a nest belongs to.


def about_of_job(job: Job | None, say: Texts = ENGLISH_TEXTS) -> dict[str, str]:
    """Names and values for the top of the sheet: order, due date, how many sheets; nothing where there is no job.

    Examples
    --------
    >>> about_of_job(Job(order="4711", quantity=3))
    {'order': '4711', 'sheets': '3 of the same'}
    """
    if job is None:
        return {}
    about = {"order": job.order or "", "due": "" if job.due is None else job.due.isoformat()}
    about["sheets"] = say.tr("{n} of the same").format(n=job.quantity) if job.quantity > 1 else ""
    return {name: text for name, text in about.items() if text}
