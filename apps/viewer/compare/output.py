"""A comparison as a file: both routes in one picture, a page, or sheets of A4."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kerfwise.apps.work_sheets.paper import Paper
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.jobs.display import Picture, PictureKind
from kerfwise.postproc.output_files import write_files
from kerfwise.postproc.report.plot import pdf_bytes
from kerfwise.postproc.report.scene import Scene
from kerfwise.postproc.report.simple_pictures import Panel, burns_scene, draw_burns

from .comparison import Compared, cut_row, figure_rows, proofs, rule_rows, rules_of, sides, summary_of, text
from .differences import cut_pairs, figures
from .sides import Side

# A comparison as a file: a picture of both routes, or a page or paper with all.

KINDS = (".svg", ".png", ".html", ".pdf")


def expect_kinds(names: Iterable[str | Path]) -> None:
    """Refuse a file that a comparison cannot be written as. Raises InputError naming the file."""
    for name in names:
        if Path(name).suffix.lower() not in KINDS:
            raise InputError(f"a comparison is written as {', '.join(KINDS)}: give a name that ends so", file=name)


def content_of(compared: Compared, suffix: str) -> str | bytes:
    """The content of a file whose name ends so; one of `KINDS`."""
    from kerfwise.apps.viewer.page.page_data import compared_data, page_bytes

    if suffix == ".pdf":
        return paper(compared)
    return page_bytes(compared_data(compared)) if suffix == ".html" else picture(compared, suffix)


@dataclass(frozen=True, eq=False, slots=True)
class Comparison(Compared):
    """Two sides, A and B; `print` says what `kerfwise compare` prints.

    Attributes
    ----------
    a, b
        Each with `plan` (None for a program), `verdict`, `times` and, where it was asked for, `heat`.
    figures
        Lengths, pierces, times, cost: `key`, `a`, `b` and `texts` of each.
    rules
        Id of each rule, and what it is on both sides: `strength`, `verdict`, `breaches`, `excuses`, `cost_mm`.
    cuts
        Every contour in both: its position in each, and what differs, in `told`.
    notes
        What is to be known of one side, such as that its plan was made with another profile.
    """

    def picture(self, kind: PictureKind = "svg") -> Picture:
        """Both routes, cuts that differ in red; "html" is the page with the tables."""
        content = content_of(self, f".{kind}")
        return Picture(content.encode("utf-8") if isinstance(content, str) else content, kind)

    def save(self, *paths: str | Path) -> tuple[Path, ...]:
        """Write it as .svg, .png, .html or .pdf, by the ends of the names: all files or none.

        Raises InputError if a name ends otherwise, or a file cannot be written.
        """
        expect_kinds(paths)
        write_files({Path(path): content_of(self, Path(path).suffix.lower()) for path in paths})
        return tuple(map(Path, paths))

    def __str__(self) -> str:
        return text(self)


def compare(a: Side, b: Side, *, notes: tuple[str, ...] = ()) -> Comparison:
    """Put two sides of one nest next to each other."""
    return Comparison(a, b, figures(a, b), rules_of(a, b), cut_pairs(a.cuts, b.cuts), notes)


# Both routes in one picture, the cuts that differ in red.

_SAME_S = 1e-3
"""Plans write times to milliseconds."""


def picture(compared: Compared, suffix: str) -> str | bytes:
    """The picture as SVG text or as PNG bytes."""
    return draw_burns(_panels(compared), suffix, title_of(compared))


def picture_scene(compared: Compared) -> Scene:
    """The picture, to be set on a page."""
    return burns_scene(_panels(compared), title_of(compared))


def title_of(compared: Compared) -> str:
    """What a picture or page of the comparison is called."""
    return f"{escape_text(Path(compared.a.given.nest.file or 'nest').name)} compared"


def _panels(compared: Compared) -> list[Panel]:
    changed = {pair.contour for pair in compared.changed}
    return [_panel(letter, side, changed) for letter, side in (("A", compared.a), ("B", compared.b))]


def _panel(letter: str, side: Side, changed: Collection[str]) -> Panel:
    job = side.times.timed.job
    text = f"idle {job.idle_mm / 1000:.3f} m, {job.pierces} pierces"
    begun_s = np.array(sorted(cut.start_s for cut in side.cuts.new if cut.contour in changed))
    starts_s = np.array([burn.start_s for burn in side.burns])
    loud = frozenset((np.searchsorted(starts_s, begun_s + _SAME_S) - 1).tolist())
    return Panel(f"{letter}: {side.name}", text, side.burns, side.home, side.end, loud, side.cuts.made + 1)


def paper(compared: Compared) -> bytes:
    """The comparison as a PDF; the same one gives the same bytes."""
    sheet = Paper(title_of(compared))
    sheet.heading(title_of(compared))
    sheet.lines(sides(compared))
    sheet.skip(6.0)
    sheet.table(("", "A", "B", "change"), figure_rows(compared))
    sheet.skip(6.0)
    sheet.lines(proofs(compared))
    sheet.skip(6.0)
    sheet.picture(picture_scene(compared))
    sheet.heading("Rules")
    sheet.table(("rule", "A", "B", ""), rule_rows(compared))
    sheet.heading("Cuts")
    sheet.lines([summary_of(compared.changed, len(compared.cuts))])
    if compared.changed:
        sheet.table(("contour", "A", "B", ""), [cut_row(pair) for pair in compared.changed])
    return pdf_bytes(sheet.scenes(), title_of(compared))
