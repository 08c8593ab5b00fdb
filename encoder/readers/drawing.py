"""What a drawing holds before anyone knows which line is a part's, the limits of every reader, and the sheet."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.contour_checks import enclosed
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Nest, Note, Part, Sheet, Source


@dataclass(frozen=True, eq=False)
class DrawnCurve:
    """One drawn curve in mm, open or closed, on its layer; `order` counts in the order of the file.

    `within` are the names it can be known by, outermost first, where those are more than its layer's: groups of groups.
    `colour` and `linetype` are how it is drawn, "" where the file does not say; `filled` that it is an area without a
    line round it, `width_mm` how wide that line is. `blocks` are the names of those that it lies in, outermost first,
    and `attributes` what these say.
    """

    curve: Curve
    layer: str
    order: int
    within: tuple[str, ...] | None = None
    colour: str = ""
    linetype: str = ""
    filled: bool = False
    blocks: tuple[str, ...] = ()
    attributes: tuple[tuple[str, str], ...] = ()
    width_mm: float = 0.0

    @property
    def source(self) -> Source:
        """What a contour of it remembers."""
        return Source(self.layer, self.colour, self.linetype, "/".join(self.blocks))

    @property
    def names(self) -> tuple[str, ...]:
        """The names that say what it is for, outermost first."""
        return (self.layer,) if self.within is None else self.within

    @cached_property
    def area(self) -> shapely.Geometry:
        """The area inside a closed piece, made valid where the ring crosses itself."""
        return enclosed(self.curve)

    @property
    def place(self) -> str:
        """Where it is, for messages: its first vertex and its layer."""
        x, y = self.curve.start
        return f"at ({x:.3f}, {y:.3f}) on layer '{self.layer}'"


@dataclass(frozen=True, eq=False)
class DrawnText:
    """Writing, or a point where `text` is "", on its layer: what it says, where, and how tall its capitals are, mm.

    `strokes` engrave it; each is a curve of the layer. `trouble` says why it cannot be engraved, "" where it can.
    `look` stands for it where its layer, its names, its colour or its place are asked for.
    """

    text: str
    look: DrawnCurve
    height_mm: float
    strokes: tuple[DrawnCurve, ...] = ()
    trouble: str = ""

    @property
    def place(self) -> str:
        """What it is and where, for messages."""
        short = " ".join(self.text.split())
        short = short if len(short) <= LONGEST_SHOWN else f"{short[: LONGEST_SHOWN - 1]}…"
        what = f"text '{short}'" if self.text else "point"
        return f"{what} {self.look.place}"


LONGEST_SHOWN = 24
"""So many letters of a text are shown in a message."""


@dataclass(frozen=True, eq=False)
class Drawing:
    """The pieces of a drawing in mm, y up, with what its reader wants said.

    `units` is what it was read in, `because` why; `page` the drawing area, for a format that has one; `texts` what it
    writes, and its points.
    """

    pieces: tuple[DrawnCurve, ...]
    units: str
    notes: tuple[Note, ...] = ()
    page: Sheet | None = None
    because: str = ""
    texts: tuple[DrawnText, ...] = ()


# The error of lines that do not close, with the drawing, so that it can be shown.


class OpenLines(InputError):
    """Lines that do not close: with them, and with the parts and the sheet's rings beside them, to be drawn."""

    def __init__(
        self,
        message: str,
        lines: Sequence[DrawnCurve],
        details: tuple[str, ...],
        parts: Sequence[Part] = (),
        sheet: Sequence[DrawnCurve] = (),
    ) -> None:
        super().__init__(message, details=details)
        self.lines, self.parts, self.sheet = tuple(lines), tuple(parts), tuple(sheet)

    def nest(self) -> Nest:
        """The parts and the open lines, `open1`, `open2`…; without a sheet on one that is no larger than they are."""
        lines = tuple(Contour(f"open{k}", "", "scrap", line.curve) for k, line in enumerate(self.lines, 1))
        if self.sheet:
            outline, *holes = sorted((ring.curve for ring in self.sheet), key=lambda c: -abs(c.signed_area_mm2))
            return Nest(Sheet(outline, tuple(holes)), self.parts, scrap=lines)
        everything = [*(part.outer.line for part in self.parts), *(line.line for line in lines)]
        x0, y0, x1, y1 = shapely.GeometryCollection(everything).bounds
        corners = [(x0, y0), (max(x1, x0 + 1), y0), (max(x1, x0 + 1), max(y1, y0 + 1)), (x0, max(y1, y0 + 1))]
        return Nest(Sheet(Curve.of(corners), ()), self.parts, scrap=lines)


# What a library may raise when it is fed a broken file.

FOREIGN_ERRORS: tuple[type[Exception], ...] = (
    ValueError,  # includes UnicodeError and json.JSONDecodeError
    LookupError,
    TypeError,
    AttributeError,
    ArithmeticError,
    AssertionError,
    RuntimeError,  # includes RecursionError and NotImplementedError
    EOFError,
    StopIteration,
    OSError,
    SyntaxError,  # includes xml.etree.ElementTree.ParseError
    struct.error,
    zlib.error,
)
"""Parsers of foreign formats trip over damaged input in their own code, with whatever error lies at hand.

Catch these only where such a library is called or its objects are taken apart.
"""


# Blocks of blocks and clones of clones: what they unfold to is counted before any of it is drawn.

DEEPEST = 32
MOST_COPIES = 500_000
"""Ten thousand contours of fifty lines each; as many copies take a minute or two to draw."""

K = TypeVar("K")
MadeOf = Callable[[K], tuple[int, Iterable[tuple[K, int]]]]
"""Key of a drawing or a block → how many entities it holds beside blocks, and which blocks how many times over."""


def check_copies(whole: K, made_of: MadeOf[K], word: str) -> None:
    """Refuse a drawing whose copies nobody could wait for: two dozen blocks of two blocks each are 16 million.

    Every block is looked into once. `whole`: key of the drawing itself; its own entities are no copies. `word`: what
    the format calls a block, for the message. Raises InputError for over `MOST_COPIES` copies, or blocks in blocks over
    `DEEPEST` deep, as those that contain themselves are.

    Examples
    --------
    >>> nested = {"sheet": (1, [("row", 10)]), "row": (0, [("part", 10)]), "part": (4, [])}
    >>> check_copies("sheet", nested.__getitem__, "block")
    >>> check_copies("sheet", (nested | {"part": (9000, [])}).__getitem__, "block")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    kerfwise.encoder.errors.InputError: the drawing unfolds to 900,110 copies of what its blocks hold, ...
    """
    counted: dict[K, int] = {}

    def unfolded(key: K, depth: int) -> int:
        if depth > DEEPEST:
            raise InputError(f"{word}s are nested over {DEEPEST} deep: a {word} seems to contain itself")
        if key not in counted:
            own, inner = made_of(key)
            counted[key] = own + sum(times * (1 + unfolded(block, depth + 1)) for block, times in inner)
        return counted[key]

    copies = unfolded(whole, 0) - made_of(whole)[0]
    if copies > MOST_COPIES:
        raise InputError(
            f"the drawing unfolds to {copies:,} copies of what its {word}s hold, {MOST_COPIES:,} at the most can be "
            f"read; take out {word}s that are no part of the nest"
        )


# Coordinates that cannot be of a sheet are refused before any geometry is done with them.

LIMIT_MM = 1e6
"""No drawing, and no arc, is larger than a kilometre."""

FAREST_MM = 1e10
"""A drawing may lie so far from the origin, as surveyors' coordinates do: it is moved near it."""

FAR_MM = 50_000.0
"""No machine is so large: a drawing that begins further from the origin is moved to it."""

SNAP_MM = 1e-3
"""Points this close are one: CAD rounds. Wider gaps are closed pair by pair, so that short chords never melt."""

FLAT_MM = 1e-4
"""An arc that leaves its chord by less is a line: its centre would lie further off than numbers reach."""


WRONG_UNITS = "if the units are wrong, pass --units (in Python: units=)"


def brought_near(
    pieces: Sequence[DrawnCurve], texts: Sequence[DrawnText] = ()
) -> tuple[tuple[DrawnCurve, ...], tuple[DrawnText, ...], list[Note]]:
    """The pieces and texts, moved to the origin where the pieces begin further from it than any machine reaches.

    Raises InputError if they reach further than a kilometre, with the piece that lies farthest from the others.

    Examples
    --------
    >>> square = Curve.of([(5e6, 3e6), (5e6 + 9, 3e6), (5e6 + 9, 3e6 + 9)])
    >>> [moved], _, [note] = brought_near([DrawnCurve(square, "0", 0)])
    >>> moved.curve.as_rows(), note.text
    ([[0.0, 0.0], [9.0, 0.0], [9.0, 9.0]], 'the drawing begins at (5e+06, 3e+06) mm: moved to (0, 0)')
    """
    if not pieces:
        return (), tuple(texts), []
    boxes = shapely.bounds(np.array([piece.curve.line(1.0) for piece in pieces], dtype=object))
    low, high = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
    if (high - low).max() > LIMIT_MM:
        middles = (boxes[:, :2] + boxes[:, 2:]) / 2
        farthest = pieces[int(np.abs(middles - np.median(middles, axis=0)).max(axis=1).argmax())]
        raise InputError(
            f"the drawing reaches over more than a kilometre; the line farthest from the others lies {farthest.place}: "
            f"take it out if it is a stray one; {WRONG_UNITS}"
        )
    if max(*low, *-high) <= FAR_MM:
        return tuple(pieces), tuple(texts), []

    def moved(piece: DrawnCurve) -> DrawnCurve:
        return replace(piece, curve=piece.curve.moved(float(-low[0]), float(-low[1])))

    written = tuple(replace(t, look=moved(t.look), strokes=tuple(map(moved, t.strokes))) for t in texts)
    text = f"the drawing begins at ({low[0]:g}, {low[1]:g}) mm: moved to (0, 0)"
    return tuple(map(moved, pieces)), written, [Note("repaired", text)]


def checked_curve(rows: Iterable[Sequence[float]] | Floats, closed: bool, scale: float = 1.0) -> Curve:
    """A curve of x, y (times `scale`) and bulge, without repeated vertices and arcs as flat as a line.

    Raises InputError when a number is not finite or lies beyond `FAREST_MM`, or the curve is larger than `LIMIT_MM`.

    Examples
    --------
    >>> checked_curve([(0, 0), (0, 0), (1, 0), (1, 1), (0, 0)], closed=True, scale=10).as_rows()
    [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]]
    """
    drawn = rows if isinstance(rows, np.ndarray) else Curve.of(rows).vertices
    if not np.isfinite(drawn).all():
        drawn = _drop_lost_bulges(drawn, scale)
    if not np.isfinite(drawn).all():
        raise InputError("a coordinate is not a finite number")
    with np.errstate(over="ignore", invalid="ignore"):
        points, bulge = np.round(drawn[:, :2] * scale, 9) + 0.0, np.abs(drawn[:, 2])
        far = np.abs(points - np.clip(points[:1], -FAREST_MM, FAREST_MM)).max(axis=1, initial=0.0)
        steps = np.diff(points, axis=0, append=points[:1])
        chord = np.hypot(steps[:, 0], steps[:, 1])
        wide = (bulge > 1) & (chord * (1 + bulge * bulge) > 4 * bulge * LIMIT_MM)
    if (far > LIMIT_MM).any():
        x, y = points[far.argmax()].tolist()
        raise InputError(f"({x:g}, {y:g}) mm lies more than a kilometre from where its line begins: {WRONG_UNITS}")
    if wide.any():
        raise InputError(f"an arc of bulge {drawn[wide.argmax(), 2]:g} is wider than a kilometre")
    keep = chord > 1e-9
    keep[-1] |= not closed or not keep.any()
    arc = bulge * chord / 2 > FLAT_MM
    return Curve(np.column_stack([points, np.where(arc, drawn[:, 2], 0.0)])[keep], closed)


def checked_stroke(points: Floats, scale: float = 1.0) -> Curve | None:
    """A stroke of a letter, closed where it ends where it begins; None for one without length."""
    closed = len(points) > 3 and bool((points[0] == points[-1]).all())
    curve = checked_curve(np.column_stack([points, np.zeros(len(points))]), closed, scale)
    return curve if len(curve.vertices) > 1 else None


def _drop_lost_bulges(drawn: Floats, scale: float) -> Floats:
    """The rows with a bulge of 0 where it is no number between points that are one: CAD divides by their distance."""
    with np.errstate(over="ignore", invalid="ignore"):
        steps = np.diff(drawn[:, :2], axis=0, append=drawn[:1, :2])
        near = np.hypot(steps[:, 0], steps[:, 1]) * scale <= SNAP_MM
    return np.column_stack([drawn[:, :2], np.where(near & ~np.isfinite(drawn[:, 2]), 0.0, drawn[:, 2])])
