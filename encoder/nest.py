"""The nest: a sheet, the parts placed on it and the bridges between them, frozen, in mm, y up."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, wraps
from typing import TYPE_CHECKING, Any, Concatenate, Literal, ParamSpec, TypeVar, cast, get_args

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.encoder.geometry.curve import Curve, flattened, lines_of
from kerfwise.encoder.geometry.segment import Point

from .bevels.bevel import Bevel, EdgeBevel
from .cut import Stretch, Tab
from .errors import InputError
from .escape import escape_text

if TYPE_CHECKING:
    from kerfwise.encoder.readers.reading import Reading


Kind = Literal["outer", "hole", "mark", "slit", "scrap", "stretch"]
Ids = tuple[str, str]
"""Two contours, by their ids; of orders, the one that is cut before first."""
KINDS: tuple[Kind, ...] = get_args(Kind)
CONTOUR_KINDS: tuple[Kind, ...] = tuple(kind for kind in KINDS if kind != "stretch")
"""Those of contours; a stretch is none."""
Severity = Literal["warning", "repaired"]
CHORD_MM = 0.01


@dataclass(frozen=True, slots=True)
class Source:
    """What a drawing says of a line: its layer, its colour, its line type, and the blocks that it lies in.

    `block` has their names, outermost first, as in `PANEL/HINGE`; `text` what the writing says that it is a stroke of.
    All are "" where the file does not say.
    """

    layer: str = ""
    colour: str = ""
    linetype: str = ""
    block: str = ""
    text: str = ""

    def told(self) -> str:
        """What is worth saying of it; "" for layer 0 and nothing else.

        Examples
        --------
        >>> Source("Gravur", "red", "", "HINGE", "A-1").told(), Source("0", "white").told()
        ("drawn on layer 'Gravur', red, in block 'HINGE', as a stroke of the text 'A-1'", '')
        """
        if self.layer in ("", "0") and not (self.block or self.text):
            return ""
        words = [f"drawn on layer '{self.layer}'" if self.layer else "drawn", self.colour, self.linetype]
        words.append(f"in block '{self.block}'" if self.block else "")
        words.append(f"as a stroke of the text '{self.text}'" if self.text else "")
        return ", ".join(filter(None, words))


NOWHERE = Source()


@dataclass(frozen=True, eq=False)
class Contour:
    """One curve that the torch follows once; `id` is `<part>.outer`, `<part>.hole1`…, `<part>.mark1`…, `<part>.slit1`…

    It is cut at `feed_share` of the machine's cut feed, which is less than 1 in small holes; slower corners take as
    long as `corner_mm` more of it would. Outer contours and holes enclose an area; a mark may be open and is not cut
    through; a slit is an open line that the torch's centre follows as it is drawn, from its start, along the middle of
    a slot of the contour `slot_of`. A scrap line, `scrap1`…, is an open line that is followed from either end, and
    belongs to no part: `part` is "". `source` is what its drawing says of it.

    A `stretch` is no contour of a drawing: it is a way of the torch's centre `along` stretches of contours, with links
    between them, that is cut before these contours are finished, as one item of the order. One that `holds` its part
    comes before the last stretch of every other that is held so in its zone.

    One with a `bevel`, or `edge_bevels` on some of its edges, is drawn at the part's largest section: see `bevels`.
    """

    id: str
    part: str
    kind: Kind
    curve: Curve
    feed_share: float = 1.0
    slot_of: str = ""
    corner_mm: float = 0.0
    source: Source = NOWHERE
    along: tuple[Stretch, ...] = ()
    holds: bool = False
    bevel: Bevel | None = None
    edge_bevels: tuple[EdgeBevel, ...] = ()

    @property
    def bevelled(self) -> bool:
        """Whether it has a bevel anywhere."""
        return self.bevel is not None or bool(self.edge_bevels)

    @property
    def with_one_bevel(self) -> Contour:
        """The same, where all its edges have one bevel with that bevel on the whole of it."""
        each = {*self.bevel_of_edge}
        if not self.edge_bevels or None in each or len(each) > 1:
            return self
        return replace(self, bevel=each.pop(), edge_bevels=())

    @cached_property
    def bevel_of_edge(self) -> tuple[Bevel | None, ...]:
        """The bevel of each line and arc of its curve, None where it is square."""
        if not self.edge_bevels:
            return (self.bevel,) * len(self.curve.segments)
        return tuple(
            next((one.bevel for one in self.edge_bevels if one.is_on(segment)), None) for segment in self.curve.segments
        )

    @property
    def encloses(self) -> bool:
        """Whether it goes round an area; the kerf is then beside it, else on it."""
        return self.kind in ("outer", "hole")

    @property
    def shapes_part(self) -> bool:
        """Whether the torch cuts through a part, or round it, here: neither marks nor scrap lines do.

        Nor does a stretch by itself: the contours that it begins are cut with their last.
        """
        return self.kind not in ("mark", "scrap", "stretch")

    @cached_property
    def polygon(self) -> shapely.Polygon:
        """The area inside a closed contour (chords within 0.01 mm)."""
        return self.curve.polygon(CHORD_MM)

    @cached_property
    def line(self) -> shapely.LineString:
        """The contour as a line (chords within 0.01 mm)."""
        return self.curve.line(CHORD_MM)


def lines_of_contours(contours: Sequence[Contour]) -> NDArray[np.object_]:
    """As `Contour.line` of each; those that were not asked for before are made together."""
    new = [contour for contour in contours if "line" not in contour.__dict__]
    flattened([contour.curve for contour in new], CHORD_MM)  # areas are made of the same points
    for contour, line in zip(new, lines_of([contour.curve for contour in new], CHORD_MM), strict=True):
        contour.__dict__["line"] = line
    lines: NDArray[np.object_] = np.empty(len(contours), dtype=object)
    lines[:] = [contour.line for contour in contours]
    return lines


PART_TYPE = "of"
"""The attribute of a part that names the part type of which it is a copy."""
QUANTITY_KEY = "quantity"
"""The attribute of a part that says how many of it are wanted."""


@dataclass(frozen=True, eq=False)
class Part:
    """One outer contour, its holes, marks and slits; `attributes` are free keys of the nest file (priority, order…).

    `tabs` are those that the nest draws on the outer contour, of width 0 where it does not say how wide they are.
    """

    id: str
    outer: Contour
    holes: tuple[Contour, ...] = ()
    marks: tuple[Contour, ...] = ()
    attributes: dict[str, object] = field(default_factory=dict)
    slits: tuple[Contour, ...] = ()
    tabs: tuple[Tab, ...] = ()

    @cached_property
    def polygon(self) -> shapely.Polygon:
        """The metal of the part: the outer contour less its holes."""
        return _metal(self.outer.curve, [hole.curve for hole in self.holes])

    def __iter__(self) -> Iterator[Contour]:
        """Marks, slits, holes, then the outer contour: the natural cutting order."""
        yield from (*self.marks, *self.slits, *self.holes, self.outer)


def _metal(outline: Curve, holes: Iterable[Curve]) -> shapely.Polygon:
    """The area inside an outline less that of holes; rings of fewer than three points count for nothing.

    No sound nest has such rings; a broken one is drawn, with all else that it holds.
    """
    points = outline.flatten()
    inner = [hole.flatten() for hole in holes]
    return shapely.Polygon(points, [ring for ring in inner if len(ring) > 2]) if len(points) > 2 else shapely.Polygon()


@dataclass(frozen=True, eq=False)
class Sheet:
    """The stock: its outline and, for a remnant, its own holes.

    `stated` says that the drawing, the nest file or the planner gave the outline and where it lies; False where it was
    laid around the parts because nobody said, so that its edges are nowhere in particular.
    """

    outline: Curve
    holes: tuple[Curve, ...] = ()
    stated: bool = True

    @cached_property
    def polygon(self) -> shapely.Polygon:
        """The metal of the sheet."""
        return _metal(self.outline, self.holes)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """xmin, ymin, xmax, ymax, mm; those of its line where a broken sheet encloses nothing."""
        x0, y0, x1, y1 = self.outline.line().bounds if self.polygon.is_empty else self.polygon.bounds
        return x0, y0, x1, y1

    @staticmethod
    def rectangle(width_mm: float, height_mm: float) -> Sheet:
        """A sheet with its lower left corner at the origin."""
        return Sheet(Curve.of([(0, 0), (width_mm, 0), (width_mm, height_mm), (0, height_mm)]))


@dataclass(frozen=True, slots=True)
class Note:
    """Something the reader wants said aloud: a warning, or what `--repair` mended.

    `common` says that the nest gives one line to two parts; `contours` are then what was dropped (an id, or words for a
    ring of a drawing) and the id that the line is cut as.
    """

    severity: Severity
    text: str
    contours: tuple[str, ...] = ()
    common: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "text", escape_text(self.text))


@dataclass(frozen=True, slots=True)
class Loss:
    """An outer contour with edges that touch others, and how much of its part is lost along these, mm."""

    contour: str
    others: tuple[str, ...]
    loss_mm: float

    def sentence(self) -> str:
        """What is lost, and who says so."""
        return (
            f"{self.contour} touches {', '.join(self.others)}: where they touch one cut makes both, and the part loses "
            f"{self.loss_mm:.3g} mm along the edge (cuts.common.accept_loss)"
        )


@dataclass(frozen=True, eq=False)
class Nest:
    """A sheet with its parts; made by a reader, which validates it once.

    `contours` lists every contour, part by part in file order, each part's marks, slits, holes, then outer, and after
    all parts the lines that cut up the skeleton, `scrap`. A nest as it is cut keeps the one that was read as `drawn`
    (see `small_holes.as_cut` and `slits.with_slits`). Last come the `stretches` that are cut before contours are
    finished, in a nest that is planned so, and in no other. One whose `bridges` have been made keeps the parts that
    they join, and all others, as they were drawn: `apart`. `refit_arcs_mm` is how near to flattened outlines its arcs
    were made; None where they are as drawn. `losses` are what parts that touch lose to the cuts between them. `reading`
    is how its file was understood; None for a nest that was read from none.
    """

    sheet: Sheet
    parts: tuple[Part, ...]
    file: str = ""
    sha256: str = ""
    notes: tuple[Note, ...] = ()
    drawn: Nest | None = None
    scrap: tuple[Contour, ...] = ()
    bridges: tuple[Bridge, ...] = ()
    apart: tuple[Part, ...] = ()
    refit_arcs_mm: float | None = None
    losses: tuple[Loss, ...] = ()
    reading: Reading | None = None
    stretches: tuple[Contour, ...] = ()

    def __getstate__(self) -> dict[str, Any]:
        """What another process or a copy is given: nothing of what was found out."""
        return {each.name: getattr(self, each.name) for each in fields(self)}

    @cached_property
    def kept(self) -> dict[Any, Any]:
        """What was found out about the nest before: see `kept.kept_with_nest`."""
        return {}

    @cached_property
    def contours(self) -> tuple[Contour, ...]:
        """Every contour to cut or mark."""
        return (*(c for p in self.parts for c in p), *self.scrap, *self.stretches)

    @cached_property
    def without_scrap(self) -> Nest:
        """The nest without its scrap lines; all other contours keep their numbers."""
        return replace(self, scrap=()) if self.scrap else self

    @cached_property
    def without_stretches(self) -> Nest:
        """The nest as everybody but the planning sees it; all other contours keep their numbers."""
        return replace(self, stretches=()) if self.stretches else self

    @cached_property
    def owners(self) -> tuple[int, ...]:
        """The number of each contour's part, from 0 on; scrap lines and stretches, which have none, have their own."""
        number = {part.id: k for k, part in enumerate(self.parts)}
        own = tuple(number[c.part] for part in self.parts for c in part)
        return (*own, *range(len(self.parts), len(self.parts) + len(self.scrap) + len(self.stretches)))

    @cached_property
    def index(self) -> dict[str, int]:
        """Contour id → its place in `contours`."""
        return {c.id: k for k, c in enumerate(self.contours)}

    @cached_property
    def part_of(self) -> dict[str, Part]:
        """Part id → part."""
        return {p.id: p for p in self.parts}

    @cached_property
    def not_cut(self) -> tuple[Contour, ...]:
        """Holes of the drawing that are not cut, as they are drawn."""
        drawn = () if self.drawn is None else (hole for part in self.drawn.parts for hole in part.holes)
        return tuple(hole for hole in drawn if hole.id not in self.index or self.contour(hole.id).kind == "mark")

    @property
    def spotted(self) -> tuple[str, ...]:
        """Those of them that are marked at their middle."""
        return tuple(hole.id for hole in self.not_cut if hole.id in self.index)

    @property
    def left_out(self) -> tuple[str, ...]:
        """Those of them that are not even marked."""
        return tuple(hole.id for hole in self.not_cut if hole.id not in self.index)

    def contour(self, contour_id: str) -> Contour:
        """The contour of that id (KeyError if there is none)."""
        return self.contours[self.index[contour_id]]


def as_scrap(curves: Iterable[Curve], sources: Sequence[Source] = ()) -> tuple[Contour, ...]:
    """Open curves as the lines that cut up a skeleton: `scrap1`, `scrap2`…"""
    contours = tuple(Contour(f"scrap{k}", "", "scrap", curve) for k, curve in enumerate(curves, 1))
    return (
        tuple(replace(line, source=source) for line, source in zip(contours, sources, strict=True))
        if sources
        else contours
    )


def with_parts(nest: Nest, parts: tuple[Part, ...]) -> Nest:
    """The nest with these parts in place of its own, each in its place; it keeps the nest as drawn.

    Where every part is the one that was there, it is the nest itself.
    """
    same = all(new is old for new, old in zip(parts, nest.parts, strict=True))
    return nest if same else replace(nest, parts=parts, drawn=nest.drawn or nest)


# A bridge as it is drawn: which parts it joins, from where to where, and how wide it is.


@dataclass(frozen=True, slots=True)
class Bridge:
    """A strip of metal, `width_mm` wide, around the line from `start` in one of two parts to `end` in the other.

    `number` counts from 1 in the order of the file; `line` is where it stands there, if that is known.
    """

    parts: tuple[str, str]
    start: Point
    end: Point
    width_mm: float
    number: int
    line: int | None = None

    @property
    def name(self) -> str:
        """What messages call it.

        Examples
        --------
        >>> Bridge(("A", "B"), (0, 0), (9, 0), 4, 1).name
        'bridge 1 (A to B)'
        """
        return f"bridge {self.number} ({self.parts[0]} to {self.parts[1]})"

    @property
    def length_mm(self) -> float:
        """How long it is as drawn, what lies in the parts included."""
        return math.dist(self.start, self.end)

    def side(self, left: bool, beyond_mm: float = 0.0) -> tuple[Point, Point]:
        """One long side, seen from `start` to `end`, and so much longer at both ends.

        Examples
        --------
        >>> Bridge(("A", "B"), (0, 0), (9, 0), 4, 1).side(left=True)
        ((0.0, 2.0), (9.0, 2.0))
        """
        (x0, y0), (x1, y1) = self.start, self.end
        ux, uy = (x1 - x0) / self.length_mm, (y1 - y0) / self.length_mm
        half_mm = self.width_mm / 2 if left else -self.width_mm / 2
        return (
            (x0 - uy * half_mm - ux * beyond_mm, y0 + ux * half_mm - uy * beyond_mm),
            (x1 - uy * half_mm + ux * beyond_mm, y1 + ux * half_mm + uy * beyond_mm),
        )

    @property
    def strip(self) -> shapely.Polygon:
        """The rectangle that it is."""
        return shapely.Polygon([*self.side(left=False), *self.side(left=True)[::-1]])

    def refused(self, why: str) -> InputError:
        """The error for a bridge that cannot be made, with its line."""
        return InputError(f"{self.name} {why}", line=self.line)


# Answers about a nest that are kept as long as the nest lives, and go with it.

Of = ParamSpec("Of")
AnswerT = TypeVar("AnswerT")


def cached_with_nest(
    most: int,
) -> Callable[[Callable[Concatenate[Nest, Of], AnswerT]], Callable[Concatenate[Nest, Of], AnswerT]]:
    """Has a function of a nest keep its last answers, `most` of them a nest, on the nest itself.

    The other arguments are given by position and are hashable.

    Examples
    --------
    >>> from kerfwise.rules.case import nest
    >>> @cached_with_nest(most=1)
    ... def size(plate, times):
    ...     print("asked")
    ...     return times * plate.sheet.polygon.area
    >>> plate = nest(30, 20)
    >>> size(plate, 1), size(plate, 1)
    asked
    (600.0, 600.0)
    """

    def keeping(function: Callable[Concatenate[Nest, Of], AnswerT]) -> Callable[Concatenate[Nest, Of], AnswerT]:
        @wraps(function)
        def answer(nest: Nest, /, *args: Of.args, **kwargs: Of.kwargs) -> AnswerT:
            assert not kwargs, "given by position, since answers are kept by position"
            answers = nest.kept.setdefault(function, OrderedDict())
            if args in answers:
                answers.move_to_end(args)
            else:
                answers[args] = function(nest, *args, **kwargs)
                if len(answers) > most:
                    answers.popitem(last=False)
            return cast(AnswerT, answers[args])

        return answer

    return keeping
