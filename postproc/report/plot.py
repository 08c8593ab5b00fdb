"""Pictures of a nest and its plan: their bytes, or files of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.files import write_files

from .known import expect_known
from .page import page_html
from .page_data import plain_page
from .pdf import on_paper
from .picture import Spot, make_scene
from .png import png_bytes
from .scene import Scene
from .svg import svg_text

_DRAWN: dict[str, Callable[[Scene], bytes]] = {
    ".svg": lambda scene: svg_text(scene).encode(),
    ".png": png_bytes,
    ".pdf": on_paper,
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

    Raises
    ------
    InputError
        If the suffix is another, or the plan or the spot is not of this nest.
    """
    expect_picture(suffix)
    if suffix.lower() == PAGE:
        named, caption = (spot.contours, spot.caption) if spot else ((), "")
        expect_known(nest, plan, named)
        return page_html(plain_page(nest, plan, home, sorted(named), caption)).encode()
    return drawn(make_scene(nest, plan, home, spot), suffix)


def drawn(scene: Scene, suffix: str) -> bytes:
    """A picture as the content of a file: ".svg", ".png" or ".pdf"."""
    return _DRAWN[suffix.lower()](scene)


def expect_picture(suffix: str, file: str | Path | None = None) -> None:
    """Say at once that no picture can be drawn to a file of such a suffix.

    Raises
    ------
    InputError
        With those that can be.
    """
    if suffix.lower() not in (*_DRAWN, PAGE):
        known = ", ".join((*_DRAWN, PAGE))
        raise InputError(
            f"cannot draw a picture of type {suffix!r}: the file name must end in one of {known}", file=file
        )


def plot(nest: Nest, plan: Plan | None, path: str | Path, home: Point = (0.0, 0.0)) -> None:
    """Draw a nest, with its plan if there is one, to a file of the type that its suffix says; see `draw`.

    The file is written whole or not at all.

    Raises
    ------
    InputError
        As for `draw`, and if the file cannot be written.
    """
    write_files({Path(path): draw(nest, plan, Path(path).suffix, home)})


def plot_spot(
    nest: Nest,
    contours: Iterable[str],
    path: str | Path,
    plan: Plan | None = None,
    caption: str = "",
    home: Point = (0.0, 0.0),
) -> None:
    """Draw the surroundings of the named contours, large, with these in red: where rules are in conflict, say.

    Parameters
    ----------
    nest, plan, path, home
        As for `plot`.
    contours
        Contour ids, at least one.
    caption
        A sentence for the title line.

    Raises
    ------
    InputError
        As for `plot`, and if no contour is named or the nest has none of that name.
    """
    named = frozenset(contours)
    if not named:
        raise InputError("no contours to show: name at least one contour id")
    write_files({Path(path): draw(nest, plan, Path(path).suffix, home, Spot(named, caption))})
