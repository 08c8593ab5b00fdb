"""Pictures of a nest and its plan, and any scene, as SVG, PNG, PDF or HTML: their bytes, or files of them."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Iterator, Sequence
from html import escape
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from kerfwise.app_modules import app_module, expect_app
from kerfwise.arrays import Floats
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.output_files import write_files

from .picture import Spot, expect_known, make_scene
from .scene import CAP_HEIGHT, HALO, Dot, Item, Scene, Shape, Style, TextLine

if TYPE_CHECKING:
    from matplotlib.collections import PathCollection
    from matplotlib.figure import Figure
    from matplotlib.path import Path as MatplotlibPath


FONT = "DejaVu Sans, Verdana, Arial, sans-serif"


def svg_text(scene: Scene) -> str:
    """The scene as a complete SVG document.

    Every layer is a group with the layer's name as its id; what belongs to a cut has `data-cut`, its place in the
    cutting order.
    """
    width, height = _number(scene.width), _number(scene.height)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}"'
        f' font-family="{FONT}">',
        f"<title>{_clean(scene.title)}</title>",
        '<rect width="100%" height="100%" fill="#ffffff"/>',
    ]
    for layer in scene:
        lines.append(f'<g id="{layer.name}">')
        for attributes, items in groupby(layer.items, key=_shared):
            lines.append(f"<g{attributes}>")
            lines.extend(_element(item) for item in items)
            lines.append("</g>")
        lines.append("</g>")
    lines.append("</svg>")
    return "\n".join(lines) + "\n"


def _number(value: float) -> str:
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def _clean(text: str) -> str:
    """Text safe inside an element: XML forbids most control characters."""
    return escape("".join(c if c.isprintable() else " " for c in text), quote=False)


def _shared(item: Item) -> str:
    """The attributes that neighbouring items of one look can share by standing on their group."""
    if isinstance(item, TextLine):
        halo = f' stroke="{item.halo}" stroke-linejoin="round" paint-order="stroke"' if item.halo else ""
        weight = ' font-weight="bold"' if item.bold else ""
        return f' class="text" fill="{item.colour}" text-anchor="{item.anchor}"{weight}{halo}'
    return "".join(_painted(item.style))


def _painted(style: Style) -> Iterator[str]:
    yield f' fill="{style.fill or "none"}"'
    if style.stroke:
        yield f' stroke="{style.stroke}" stroke-width="{_number(style.width)}"'
        yield ' stroke-linejoin="round" stroke-linecap="round"'
    if style.dash:
        yield f' stroke-dasharray="{" ".join(map(_number, style.dash))}"'


def _element(item: Item) -> str:
    cut = f' data-cut="{item.cut}"' if item.cut else ""
    if isinstance(item, Dot):
        return f'<circle cx="{_number(item.x)}" cy="{_number(item.y)}" r="{_number(item.radius)}"{cut}/>'
    if isinstance(item, Shape):
        path = "".join(_path(line, item.closed) for line in item.lines)
        return f'<path d="{path}"{cut}>{_title(item.title)}</path>' if item.title else f'<path d="{path}"{cut}/>'
    x, y = _number(item.x), _number(item.y)
    turn = f' transform="rotate(-90 {x} {y})"' if item.turned else ""
    rim = f' stroke-width="{_number(HALO * item.size)}"' if item.halo else ""
    baseline = _number(item.y + item.size * CAP_HEIGHT / 2)
    size = _number(item.size)
    return f'<text x="{x}" y="{baseline}" font-size="{size}"{rim}{turn}{cut}>{_clean(item.text)}</text>'


def _title(text: str) -> str:
    return f"<title>{_clean(text)}</title>"


def _path(line: Floats, closed: bool) -> str:
    points = " ".join(f"{_number(x)},{_number(y)}" for x, y in line.tolist())
    return f"M{points}{'Z' if closed else ''}"


# A scene as PNG, drawn by matplotlib without a display.


def png_bytes(scene: Scene) -> bytes:
    """The scene as a PNG file, `scene.enlarge` pixels a page unit; the same scene gives the same bytes."""
    # Loading matplotlib takes longer than drawing an SVG, so only those who want a PNG pay for it.
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    # At 72 dots per inch a point, the unit of line widths, is one page unit.
    figure = Figure(figsize=(scene.width / 72, scene.height / 72), dpi=72 * scene.enlarge, facecolor="white")
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(0, scene.width)
    axes.set_ylim(scene.height, 0)
    for collection in as_collections(scene):
        axes.add_collection(collection, autolim=False)
    file = io.BytesIO()
    figure.savefig(file, format="png", metadata={"Software": None})
    return file.getvalue()


def as_collections(
    scene: Scene, scale: float = 1.0, without: Callable[[TextLine], bool] = lambda text: False
) -> Iterator[PathCollection]:
    """Everything as collections of paths, from the bottom up; lines are `scale` times as wide.

    Texts that are `without` are left to whoever writes them in another way.
    """
    from matplotlib.collections import PathCollection

    for depth, (_, group) in enumerate(groupby(_stroked(scene, without), key=_dash)):
        painted = list(group)
        yield PathCollection(
            [p.path for p in painted],
            facecolors=[p.style.fill or "none" for p in painted],
            edgecolors=[p.style.stroke or "none" for p in painted],
            linewidths=[scale * p.style.width if p.style.stroke else 0.0 for p in painted],
            linestyles=[_dash(painted[0])],
            capstyle="round",
            joinstyle="round",
            zorder=depth,
        )


class _Stroked(NamedTuple):
    path: MatplotlibPath
    style: Style


def _dash(painted: _Stroked) -> str | tuple[float, tuple[float, ...]]:
    """The dash as matplotlib has it, in line widths."""
    style = painted.style
    return (0.0, tuple(d / style.width for d in style.dash)) if style.dash else "solid"


def _stroked(scene: Scene, without: Callable[[TextLine], bool]) -> Iterator[_Stroked]:
    """Everything as paths from the bottom up; in a layer the rims of all texts lie below all texts."""
    for layer in scene:
        texts = [item for item in layer.items if isinstance(item, TextLine) and not without(item)]
        for item in layer.items:
            if not isinstance(item, TextLine):
                yield _Stroked(_png_path(item), item.style)
        paths = [_text_path(text) for text in texts]
        for text, path in zip(texts, paths, strict=True):
            if text.halo:
                yield _Stroked(path, Style(stroke=text.halo, width=HALO * text.size))
        for text, path in zip(texts, paths, strict=True):
            yield _Stroked(path, Style(fill=text.colour))


def _png_path(item: Item) -> MatplotlibPath:
    from matplotlib.path import Path

    if isinstance(item, Dot):
        return Path.circle((item.x, item.y), item.radius)
    assert isinstance(item, Shape)
    if not item.closed:
        return Path.make_compound_path(*(Path(line) for line in item.lines))
    rings = (np.concatenate([line, line[:1]]) for line in item.lines)
    return Path.make_compound_path(*(Path(ring, closed=True) for ring in rings))


def _text_path(text: TextLine) -> MatplotlibPath:
    """The outlines of the letters: far quicker than matplotlib's own texts where there are a thousand numbers."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.path import Path
    from matplotlib.textpath import TextToPath, text_to_path

    font = FontProperties(family="DejaVu Sans", weight="bold" if text.bold else "normal")
    points, codes = text_to_path.get_text_path(font, text.text)
    if len(points) == 0:
        return Path(np.zeros((0, 2)))
    points = np.asarray(points) * (text.size / TextToPath.FONT_SCALE)
    width = float(points[:, 0].max())
    x = points[:, 0] - {"start": 0.0, "middle": 0.5, "end": 1.0}[text.anchor] * width
    y = text.size * CAP_HEIGHT / 2 - points[:, 1]
    x, y = (y, -x) if text.turned else (x, y)
    return Path(np.column_stack([x + text.x, y + text.y]), codes)


# Scenes as the pages of a PDF, drawn by matplotlib: lines stay lines, and texts can be searched and copied.

A4 = (595.28, 841.89)
"""Width and height of the paper upright, points of 1/72 inch."""
_MARGIN = 24.0
_INCH = 72.0
_NO_DATE: dict[str, None] = {"CreationDate": None, "Creator": None, "Producer": None}


def pdf_bytes(pages: Sequence[Scene], title: str) -> bytes:
    """A PDF of so many pages; a page unit is a point. The same scenes give the same bytes, without any date."""
    return _pdf(map(_figure, pages), title)


def fit_to_a4(scene: Scene) -> bytes:
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


_DRAWN: dict[str, Callable[[Scene], bytes]] = {
    ".svg": lambda scene: svg_text(scene).encode(),
    ".png": png_bytes,
    ".pdf": fit_to_a4,
}
PAGE = ".html"


def draw(nest: Nest, plan: Plan | None, suffix: str, home: Point = (0.0, 0.0), spot: Spot | None = None) -> bytes:
    """The picture of a nest, with its plan if there is one, as the content of a file.

    Parameters
    ----------
    nest
        What is drawn.
    plan
        Its plan: order numbers, zones, pierces, leads, directions and idle travel. Without one the parts have their
        names.
    suffix
        ".svg", ".png", ".pdf" for a sheet of A4, or ".html" for a page that plays the cuts in order; the page of
        `jobs.page` knows more: verdict, reasons, heat and program.
    home
        Where the torch starts and ends, mm.
    spot
        Contours to draw large, in red, with what is around them; the whole sheet is drawn without.

    Raises InputError if the suffix is another, or the plan or the spot is not of this nest.
    """
    expect_picture(suffix)
    if suffix.lower() == PAGE:
        named, caption = (spot.contours, spot.caption) if spot else ((), "")
        expect_known(nest, plan, named)
        page = app_module("viewer.page.page_html")
        content: bytes = page.page_html(page.plain_page(nest, plan, home, sorted(named), caption)).encode()
        return content
    return render_picture(make_scene(nest, plan, home, spot), suffix)


def render_picture(scene: Scene, suffix: str) -> bytes:
    """A picture as the content of a file: ".svg", ".png" or ".pdf"."""
    return _DRAWN[suffix.lower()](scene)


def expect_picture(suffix: str, file: str | Path | None = None) -> None:
    """Say at once that no picture can be drawn to a file of such a suffix. Raises InputError with those that can be."""
    if suffix.lower() not in (*_DRAWN, PAGE):
        known = ", ".join((*_DRAWN, PAGE))
        raise InputError(
            f"cannot draw a picture of type {suffix!r}: the file name must end in one of {known}", file=file
        )
    if suffix.lower() == PAGE:
        expect_app("viewer")


def plot(nest: Nest, plan: Plan | None, path: str | Path, home: Point = (0.0, 0.0)) -> None:
    """Draw a nest, with its plan if there is one, to a file of the type that its suffix says; see `draw`.

    The file is written whole or not at all. Raises InputError as for `draw`, and if the file cannot be written.
    """
    write_files({Path(path): draw(nest, plan, Path(path).suffix, home)})


def plot_spot(
    nest: Nest, contours: Iterable[str], path: str | Path, caption: str = "", home: Point = (0.0, 0.0)
) -> None:
    """Draw the surroundings of the named contours, large, with these in red: where rules are in conflict, say.

    `nest` and `path` and `home`: as for `plot`. `contours`: contour ids, at least one. `caption`: a sentence
    for the title line. Raises InputError as for `plot`, and if no contour is named or the nest has none of that name.
    """
    named = frozenset(contours)
    if not named:
        raise InputError("no contours to show: name at least one contour id")
    write_files({Path(path): draw(nest, None, Path(path).suffix, home, Spot(named, caption))})
