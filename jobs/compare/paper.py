"""A comparison on sheets of A4."""

from __future__ import annotations

from kerfwise.postproc.report.paper import Paper
from kerfwise.postproc.report.pdf import pdf_bytes

from .comparison import Compared
from .picture import picture_scene, title_of
from .text import cut_row, figure_rows, proofs, rule_rows, sides, summary_of


def paper(made: Compared) -> bytes:
    """The comparison as a PDF; the same one gives the same bytes."""
    sheet = Paper(title_of(made))
    sheet.heading(title_of(made))
    sheet.lines(sides(made))
    sheet.skip(6.0)
    sheet.table(("", "A", "B", "change"), figure_rows(made), (3, 3, 3, 2))
    sheet.skip(6.0)
    sheet.lines(proofs(made))
    sheet.skip(6.0)
    sheet.picture(picture_scene(made))
    sheet.heading("Rules")
    sheet.table(("rule", "A", "B", ""), rule_rows(made), (3, 4, 4, 1.5))
    sheet.heading("Cuts")
    sheet.lines([summary_of(made.changed, len(made.cuts))])
    if made.changed:
        sheet.table(("contour", "A", "B", ""), [cut_row(pair) for pair in made.changed], (4, 1, 1, 6))
    return pdf_bytes(sheet.scenes(), title_of(made))
