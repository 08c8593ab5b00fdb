"""A comparison as a file: a picture of both routes, or a page or paper with all."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.picture import Picture, PictureKind
from kerfwise.postproc.files import write_files

from .comparison import Compared, rules_of
from .figures import figures
from .moved import cut_pairs
from .side import Side
from .text import text

KINDS = (".svg", ".png", ".html", ".pdf")


def expect_kinds(names: Iterable[str | Path]) -> None:
    """Refuse a file that a comparison cannot be written as.

    Raises
    ------
    InputError
        Naming the file.
    """
    for name in names:
        if Path(name).suffix.lower() not in KINDS:
            raise InputError(f"a comparison is written as {', '.join(KINDS)}: give a name that ends so", file=name)


def content_of(made: Compared, suffix: str) -> str | bytes:
    """The content of a file whose name ends so; one of `KINDS`."""
    from kerfwise.jobs.page.page import compared_data, page_bytes

    from .paper import paper
    from .picture import picture

    if suffix == ".pdf":
        return paper(made)
    return page_bytes(compared_data(made)) if suffix == ".html" else picture(made, suffix)


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
        made = content_of(self, f".{kind}")
        return Picture(made.encode("utf-8") if isinstance(made, str) else made, kind)

    def save(self, *paths: str | Path) -> tuple[Path, ...]:
        """Write it as .svg, .png, .html or .pdf, by the ends of the names: all files or none.

        Raises
        ------
        InputError
            If a name ends otherwise, or a file cannot be written.
        """
        expect_kinds(paths)
        write_files({Path(path): content_of(self, Path(path).suffix.lower()) for path in paths})
        return tuple(map(Path, paths))

    def __str__(self) -> str:
        return text(self)


def compare(a: Side, b: Side, *, notes: tuple[str, ...] = ()) -> Comparison:
    """Put two sides of one nest next to each other."""
    return Comparison(a, b, figures(a, b), rules_of(a, b), cut_pairs(a.cuts, b.cuts), notes)
