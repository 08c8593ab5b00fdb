"""Scenes as the pages of a PDF, drawn by matplotlib: lines stay lines, and texts can be searched and copied."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from .png import as_collections
from .scene import CAP_HEIGHT, Scene, TextLine

if TYPE_CHECKING:
    from matplotlib.figure import Figure

A4 = (595.28, 841.89)
"""Width and height of the paper upright, points of 1/72 inch."""
_MARGIN = 24.0
_INCH = 72.0
_NO_DATE: dict[str, None] = {"CreationDate": None, "Creator": None, "Producer": None}


def pdf_bytes(pages: Sequence[Scene], title: str) -> bytes:
    """A PDF of so many pages; a page unit is a point. The same scenes give the same bytes, without any date."""
    return _pdf(map(_figure, pages), title)


def on_paper(scene: Scene) -> bytes:
    """One scene on a sheet of A4, as large as it can be, upright or across."""
    wide, high = A4 if scene.height > scene.width else A4[::-1]
    scale = min((wide - 2 * _MARGIN) / scene.width, (high - 2 * _MARGIN) / scene.height)
    return _pdf([_figure(scene, (wide, high), scale)], scene.title)


def _pdf(figures: Iterable[Figure], title: str) -> bytes:
    # Loading matplotlib takes longer than making the scenes, so only those who want a PDF pay for it.
    from matplotlib import rc_context
    from matplotlib.backends.backend_pdf import PdfPages

    file = io.BytesIO()
    with (
        rc_context({"pdf.fonttype": 42, "pdf.compression": 6}),
        PdfPages(file, metadata={"Title": title, **_NO_DATE}) as pdf,
    ):
        for figure in figures:
            pdf.savefig(figure)
    return file.getvalue()


def _figure(scene: Scene, paper: tuple[float, float] | None = None, scale: float = 1.0) -> Figure:
    from matplotlib.figure import Figure

    wide, high = paper or (scene.width, scene.height)
    figure = Figure(figsize=(wide / _INCH, high / _INCH), facecolor="white")
    box = (scene.width * scale / wide, scene.height * scale / high)
    axes = figure.add_axes(((1 - box[0]) / 2, (1 - box[1]) / 2, *box))
    axes.set_axis_off()
    axes.set_xlim(0, scene.width)
    axes.set_ylim(scene.height, 0)
    for collection in as_collections(scene, scale, without=_plain):
        axes.add_collection(collection, autolim=False)
    for text in _texts(scene):
        _write(axes, text, scale)
    return figure


def _plain(item: TextLine) -> bool:
    """Whether a text is written as letters; one with a rim around it is drawn."""
    return item.halo is None and not item.turned


def _texts(scene: Scene) -> Iterator[TextLine]:
    yield from (item for layer in scene for item in layer.items if isinstance(item, TextLine) and _plain(item))


def _write(axes: Any, text: TextLine, scale: float) -> None:
    align = {"start": "left", "middle": "center", "end": "right"}[text.anchor]
    axes.text(
        text.x, text.y + text.size * CAP_HEIGHT / 2, text.text, fontsize=text.size * scale, color=text.colour, ha=align,
        va="baseline", weight="bold" if text.bold else "normal", family="DejaVu Sans", parse_math=False, zorder=1000,
    )  # fmt: skip
