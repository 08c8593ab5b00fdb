"""A comparison as a file: a picture of both routes, or a page or paper with all."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from kerfwise.encoder.errors import InputError

from .comparison import Comparison

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


def content_of(made: Comparison, suffix: str) -> str | bytes:
    """The content of a file whose name ends so; one of `KINDS`."""
    from kerfwise.jobs.page.page import compared_data, page_bytes

    from .paper import paper
    from .picture import picture

    if suffix == ".pdf":
        return paper(made)
    return page_bytes(compared_data(made)) if suffix == ".html" else picture(made, suffix)
