"""Work sheets as pages of A4: head, facts, picture, boxes to tick, what is not kept, locks, and the table of cuts."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from kerfwise.encoder.shown import shown
from kerfwise.jobs.resequence_table import clock_text
from kerfwise.models.plan.plan import PlannedCut
from kerfwise.postproc.report.colours import FAINT, INK
from kerfwise.postproc.report.legend import counted
from kerfwise.postproc.report.paper import BOX, MARGIN, ROOM, WIDTH, Paper, shortened
from kerfwise.postproc.report.pdf import pdf_bytes
from kerfwise.postproc.report.picture import bare_picture
from kerfwise.postproc.report.qr import qr_items
from kerfwise.postproc.report.scene import Scene, TextLine
from kerfwise.rules.profile.lock_text import lines_of

from .facts import facts_of_sheet, to_tick
from .work_sheet import WorkSheet

_QR = 78.0
_MANY = 60
"""Cuts from which on the picture gets more of the first page, so that its numbers can be read."""
_HIGH = {False: 290.0, True: 470.0}
_KEY = "bold numbers: outer contours, in cutting order; grey: parts; red dots: pierces; dashed: idle travel"
_HEAD = ("", "#", "contour", "way", "mm", "begins", "note")
_WIDTHS = (11, 19, 78, 22, 30, 36, 58)


def sheets_pdf(sheets: Sequence[WorkSheet], date: str = "") -> bytes:
    """The work sheets of several nests in one PDF, each from a page of its own on.

    The same sheets give the same bytes: a date stands on them only where one is given.
    """
    pages = [page for sheet in sheets for page in pages_of(sheet, date)]
    return pdf_bytes(pages, " · ".join(_title(sheet) for sheet in sheets[:3]) + (" …" if len(sheets) > 3 else ""))


def pages_of(sheet: WorkSheet, date: str = "") -> tuple[Scene, ...]:
    """The pages of one work sheet."""
    paper = Paper(f"{_title(sheet)} · {sheet.program_name} · sha256 {sheet.program_sha256[:16]}…")
    _head(paper, sheet, date)
    home = sheet.profile.at_origin(sheet.plan.origin).home_on(sheet.nest)
    most_high = _HIGH[len(sheet.plan.cuts) > _MANY]
    paper.picture(bare_picture(sheet.nest, sheet.plan, home, ROOM, most_high))
    paper.skip(10.0)
    paper.lines([_KEY], 6.5)
    paper.heading("Before and after")
    paper.lines(to_tick(sheet), 8.0, BOX)
    _signed(paper)
    for heading, texts in (
        ("Not as it was when the plan was made", [shown(text) for text in sheet.changed]),
        ("What this plan does not keep", sheet.not_kept),
        ("Locks", [shown(line) for lock in sheet.profile.locks for line in lines_of(lock)]),
        ("Metal lost", [shown(loss.sentence()) for loss in sheet.plan.losses]),
        ("Not cut", [f"{shown(left.contour)}: {left.why}" for left in sheet.plan.left_out]),
    ):
        if texts:
            paper.heading(heading)
            paper.lines(texts, 7.5, "–")
    paper.heading(f"{counted(len(sheet.plan.cuts), 'cut')}, in order")
    rows = [_row(k, planned) for k, planned in enumerate(sheet.plan.cuts, sheet.plan.resumed_after + 1)]
    paper.table(_HEAD, rows, _WIDTHS, blocks=2)
    return paper.scenes()


def _title(sheet: WorkSheet) -> str:
    return shown(Path(sheet.nest.file or "nest").name)


def _head(paper: Paper, sheet: WorkSheet, date: str) -> None:
    """Title and facts, and beside them the QR code of the program's hash."""
    right, sha256 = WIDTH - MARGIN, sheet.program_sha256
    paper.put(qr_items(f"SHA256 {sha256}".upper(), right - _QR, MARGIN, _QR))
    for k in range(4):
        text = sha256[16 * k : 16 * k + 16]
        paper.put([TextLine(right - _QR / 2, MARGIN + _QR + 8 + 7.5 * k, text, 6.0, FAINT)])
    room = ROOM - _QR - 14
    title = shortened(_title(sheet), 15.0, 0.85 * room)
    paper.put([TextLine(MARGIN, paper.y + 8, title, 15.0, INK, "start", bold=True)])
    paper.skip(25.0)
    line = " · ".join(text for text in (f"program {sheet.program_name}", f"profile {sheet.profile.name}", date) if text)
    paper.put([TextLine(MARGIN, paper.y, shortened(shown(line), 9.0, room), 9.0, INK, "start")])
    paper.skip(12.0)
    paper.pairs([*((shown(name), shown(text)) for name, text in sheet.about.items()), *facts_of_sheet(sheet)], room)
    paper.y = max(paper.y, MARGIN + _QR + 40) + 4


def _signed(paper: Paper) -> None:
    """Lines to write on."""
    paper.room_for(18.0)
    paper.skip(6.0)
    for k, name in enumerate(("operator", "machine", "date, time")):
        paper.put([TextLine(MARGIN + 180 * k, paper.y + 4, f"{name} ____________________", 8.0, INK, "start")])
    paper.skip(12.0)


def _row(order: int, planned: PlannedCut) -> tuple[str, ...]:
    cut = planned.cut
    notes = [
        *([planned.kind] if planned.kind not in ("outer", "hole") else []),
        *(["linked"] if cut.linked else []),
        *([f"waits {planned.dwell_s:.1f} s"] if planned.dwell_s else []),
        *([counted(len(cut.tabs), "tab")] if cut.tabs else []),
        *(["excused"] if cut.excused else []),
    ]
    begins = clock_text(cut.start_s)
    return BOX, str(order), shown(cut.contour), cut.direction, f"{planned.length_mm:.0f}", begins, ", ".join(notes)
