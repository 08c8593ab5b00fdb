"""The facts that own rules may name, known of a nest by what it is planned with, or as the check measures it."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.nest import CONTOUR_KINDS, Nest
from kerfwise.rules.judging.metal import host_holes, places
from kerfwise.rules.rule import USUAL, Plate

from .criteria import AREAS, COUNTED, FLAGS, FREE, KILOGRAMS, LENGTHS, ROUNDING_MM, SECONDS, TEXTS, ValueKind, word_kind

if TYPE_CHECKING:
    from kerfwise.encoder.candidates.candidate import Candidate
    from kerfwise.encoder.facts.facts import Facts

Values = Sequence[Any]
SIDES = ("left", "right", "bottom", "top")
NC_ROUNDING_MM = 0.05
"""A point this near to a limit is on either side of it: programs round their coordinates."""


class KnownNest(ABC):
    """The named facts of one nest, computed when first asked for, and the ways to cut its contours.

    `ways` are the candidates, or the cuts that are judged, each with the number of its contour. Points of theirs are
    known to `slack_mm`. A program that is `resumed` goes on after a stop. What the methods give is in the order of
    contours; a contour's own measures, such as its size, are the same geometry for both kinds of nest.
    """

    def __init__(
        self, nest: Nest, plate: Plate, ways: Sequence[tuple[int, Cut | Candidate]], slack_mm: float, resumed: bool
    ) -> None:
        self.nest, self.plate, self.ways, self.slack_mm, self.resumed = nest, plate, ways, slack_mm, resumed
        self._found: dict[str, Values] = {}

    def values(self, name: str) -> Values:
        """The fact of that name, contour by contour."""
        if name not in self._found:
            fact = named_fact(name)
            assert fact is not None, name
            self._found[name] = fact.of(self)
        return self._found[name]

    @abstractmethod
    def long(self) -> list[bool]:
        """Outer contours whose smallest rectangle has one side at least `long_ratio` times the other (Petunin 2009)."""

    @abstractmethod
    def edge_gaps_mm(self, side: str) -> list[float]:
        """Distance from a side of the sheet; from the nearest where side is `edge`."""

    @abstractmethod
    def hosts(self) -> list[str]:
        """Id of the part in whose hole a contour's part lies, "" for none."""

    @abstractmethod
    def depths(self) -> list[int]:
        """How many contours lie around every contour."""

    @abstractmethod
    def neighbour_counts(self) -> list[int]:
        """How many other parts in the same place come as near as `web_mm` to each outer contour; else 0."""

    @abstractmethod
    def zones(self) -> list[int | None]:
        """The zone in which every contour is cut, None where nobody states one."""


class PlannedNest(KnownNest):
    """As plans are made with."""

    def __init__(self, facts: Facts, plate: Plate = USUAL) -> None:
        super().__init__(facts.nest, plate, [(c.contour, c) for c in facts.candidates], 0.0, bool(facts.already_cut))
        self._facts = facts

    def long(self) -> list[bool]:
        return [bool(v) for v in self._facts.long]

    def edge_gaps_mm(self, side: str) -> list[float]:
        gaps = self._facts.edge_gap_mm
        return [float(v) for v in (gaps.min(axis=1) if side == "edge" else gaps[:, SIDES.index(side)])]

    def hosts(self) -> list[str]:
        contours, hole = self.nest.contours, self._hole_of_part()
        return [contours[hole[c.part]].part if hole.get(c.part, -1) >= 0 else "" for c in contours]

    def depths(self) -> list[int]:
        depth = [0] * self._facts.n
        for inner in self._facts.contains[:, 1].tolist():
            depth[inner] += 1
        return depth

    def neighbour_counts(self) -> list[int]:
        return count_near(self.nest, list(self._hole_of_part().values()), self._facts.options.web_mm)

    def zones(self) -> list[int | None]:
        return list(self._facts.zone.tolist())

    def _hole_of_part(self) -> dict[str, int]:
        """The hole that each part lies in, -1 for none."""
        return {part.id: int(self._facts.parent[self.nest.index[part.outer.id]]) for part in self.nest.parts}


class MeasuredNest(KnownNest):
    """As the check measures it with plain shapely: the facts that models are built on are not looked at here.

    Without cuts no zone is known.
    """

    def __init__(
        self, nest: Nest, cuts: CutSequence | None, long_ratio: float, web_mm: float, plate: Plate = USUAL
    ) -> None:
        cuts = cuts or CutSequence(())
        ways = [(nest.index.get(cut.contour, -1), cut) for cut in cuts]
        super().__init__(nest, plate, ways, NC_ROUNDING_MM, cuts.made > 0)
        self._long_ratio, self._web_mm = long_ratio, web_mm
        self.stated_zones = {cut.contour: cut.zone for cut in cuts if cut.zone}

    def long(self) -> list[bool]:
        sides = rectangles_mm(self.nest)
        slim = sides.max(axis=1) >= self._long_ratio * sides.min(axis=1) * (1 - 1e-9)
        return [bool(s) and c.kind == "outer" for s, c in zip(slim, self.nest.contours, strict=True)]

    def edge_gaps_mm(self, side: str) -> list[float]:
        return edge_gaps_mm(self.nest, side)

    def hosts(self) -> list[str]:
        of_part = host_holes(self.nest)
        return [of_part[c.part].part if c.part in of_part else "" for c in self.nest.contours]

    def depths(self) -> list[int]:
        host = host_holes(self.nest)

        def of_part(part: str) -> int:
            return 2 + of_part(host[part].part) if part in host else 0

        return [of_part(c.part) + (c.kind not in ("outer", "scrap")) for c in self.nest.contours]

    def neighbour_counts(self) -> list[int]:
        at = places(self.nest, host_holes(self.nest))
        return count_near(self.nest, [at[part.id] for part in self.nest.parts], self._web_mm)

    def zones(self) -> list[int | None]:
        return [self.stated_zones.get(c.id) for c in self.nest.contours]


def count_near(nest: Nest, place: Sequence[object], web_mm: float) -> list[int]:
    """For every contour the number of other parts of the same place within `web_mm`; `place` is given part by part."""
    lines = [part.outer.line for part in nest.parts]
    a, b = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=web_mm + ROUNDING_MM)
    count = [0] * len(nest.contours)
    for first, second in zip(a.tolist(), b.tolist(), strict=True):
        if first != second and place[first] == place[second]:
            count[nest.index[nest.parts[first].outer.id]] += 1
    return count


def attributes(nest: Nest, name: str) -> list[Any]:
    """What the nest's file says of every contour's part under that name, None where it says nothing.

    Where no part says anything under the very name, CAPITALS and small letters are the same: blocks write NO and Order.
    """
    key = name
    if not any(name in part.attributes for part in nest.parts):
        alike = (other for part in nest.parts for other in part.attributes if other.lower() == name.lower())
        key = next(alike, name)
    return [nest.part_of[c.part].attributes.get(key) if c.part else None for c in nest.contours]


ATTRIBUTE = "attribute."
"""`attribute.priority` is what the nest's file says of a part under `priority`."""


@dataclass(frozen=True, slots=True)
class NamedFact:
    """A fact by name: its kind, one line of help, and its values for every contour of a nest."""

    name: str
    kind: ValueKind
    help: str
    of: Callable[[KnownNest], Values]


def _each(value: Callable[[KnownNest], object]) -> Callable[[KnownNest], Values]:
    """A fact of the sheet, the same for every contour."""
    return lambda k: [value(k)] * len(k.nest.contours)


def _drawn(key: str) -> Callable[[KnownNest], Values]:
    return lambda k: [getattr(c.source, key) for c in k.nest.contours]


_ID = "its own id, `<part>.outer`, `<part>.hole1` …, `scrap1` …"
_BLOCK = "the blocks that it lies in there, outermost first, as in `PANEL/HINGE`"
_WANTED = "how many of its part are wanted, by the name of its block, its layer or the file"
_SHORT = "shorter side of the smallest rectangle around it, at any angle"
_LONG = "an outer contour whose longer side is at least `long_ratio` (rule start-side) times the shorter"
_NEAR = "of an outer contour: other parts in the same place no further off than 25 mm"
_TABLE: tuple[tuple[str, ValueKind, str, Callable[[KnownNest], Values]], ...] = (
    ("kind", word_kind(CONTOUR_KINDS), "what the contour is", lambda k: [c.kind for c in k.nest.contours]),
    ("part", TEXTS, "id of its part, empty for a scrap line", lambda k: [c.part for c in k.nest.contours]),
    (
        "id",
        TEXTS,
        "its own id, `<part>.outer`, `<part>.hole1` …, `scrap1` …",
        lambda k: [c.id for c in k.nest.contours],
    ),
    ("layer", TEXTS, "its layer in the drawing", _drawn("layer")),
    ("colour", TEXTS, "its colour there, a name or #rrggbb", _drawn("colour")),
    ("block", TEXTS, _BLOCK, _drawn("block")),
    ("text", TEXTS, "the writing that a mark is a stroke of", _drawn("text")),
    ("quantity", COUNTED, _WANTED, lambda k: attributes(k.nest, "quantity")),
    ("area_mm2", AREAS, "area inside it, 0 for an open line", lambda k: areas_mm2(k.nest)),
    ("length_mm", LENGTHS, "its length", lambda k: lengths_mm(k.nest)),
    ("width_mm", LENGTHS, "its extent along x", lambda k: sizes_mm(k.nest, 0)),
    ("height_mm", LENGTHS, "its extent along y", lambda k: sizes_mm(k.nest, 1)),
    ("short_side_mm", LENGTHS, _SHORT, lambda k: rectangle_sides_mm(k.nest, longer=False)),
    ("long_side_mm", LENGTHS, "longer side of that rectangle", lambda k: rectangle_sides_mm(k.nest, longer=True)),
    ("long", FLAGS, _LONG, lambda k: k.long()),
    ("left_gap_mm", LENGTHS, "distance from the left side of the sheet", lambda k: k.edge_gaps_mm("left")),
    ("right_gap_mm", LENGTHS, "distance from the right side of the sheet", lambda k: k.edge_gaps_mm("right")),
    ("bottom_gap_mm", LENGTHS, "distance from the bottom side of the sheet", lambda k: k.edge_gaps_mm("bottom")),
    ("top_gap_mm", LENGTHS, "distance from the top side of the sheet", lambda k: k.edge_gaps_mm("top")),
    ("edge_gap_mm", LENGTHS, "distance from the nearest side of the sheet", lambda k: k.edge_gaps_mm("edge")),
    ("x_mm", LENGTHS, "x of its middle, as it is drawn", lambda k: middles_mm(k.nest, 0)),
    ("y_mm", LENGTHS, "y of its middle, as it is drawn", lambda k: middles_mm(k.nest, 1)),
    (
        *("corner_distance_mm", LENGTHS, "from the sheet's lower left corner to its middle"),
        lambda k: corner_distances_mm(k.nest),
    ),
    (
        *("cut_s", SECONDS, "what it takes to pierce and cut it, without leads and travel"),
        lambda k: cut_seconds(k.nest, k.plate),
    ),
    ("weight_kg", KILOGRAMS, "weight of its part: area, thickness, density", lambda k: weights_kg(k.nest, k.plate)),
    ("thickness_mm", LENGTHS, "thickness of the sheet", _each(lambda k: k.plate.thickness_mm)),
    ("material", TEXTS, "grade of the sheet", _each(lambda k: k.plate.material)),
    ("process", TEXTS, "what cuts: plasma, laser, oxyfuel…", _each(lambda k: k.plate.process)),
    ("depth", COUNTED, "how many contours lie around it, 0 for a part on the sheet", lambda k: k.depths()),
    ("host", TEXTS, "id of the part in whose hole its part lies, empty for none", lambda k: k.hosts()),
    ("hosted", FLAGS, "whether its part lies in a hole of another part", lambda k: [h != "" for h in k.hosts()]),
    ("neighbours_count", COUNTED, _NEAR, lambda k: k.neighbour_counts()),
    ("zone", COUNTED, "zone in which it is cut, from 1", lambda k: k.zones()),
)
NAMED_FACTS: Mapping[str, NamedFact] = {row[0]: NamedFact(*row) for row in _TABLE}


def named_fact(name: str) -> NamedFact | None:
    """The fact of that name, `attribute.<anything>` included; None for an unknown one."""
    if name.startswith(ATTRIBUTE) and name != ATTRIBUTE:
        key = name.removeprefix(ATTRIBUTE)
        return NamedFact(name, FREE, f"what the nest says under {key!r}", lambda k: attributes(k.nest, key))
    return NAMED_FACTS.get(name)


def cut_seconds(nest: Nest, plate: Plate) -> list[float]:
    """What each contour takes by itself, s: its start and its length at its feed, without leads and travel."""
    return [
        plate.mark_s + c.curve.length_mm / plate.mark_mm_s
        if c.kind == "mark"
        else plate.pierce_s + (c.curve.length_mm + c.corner_mm) / (plate.cut_mm_s * c.feed_share)
        for c in nest.contours
    ]


def weights_kg(nest: Nest, plate: Plate) -> list[float]:
    """What the part of each contour weighs: area, thickness, density; 0 for scrap lines."""
    per_mm2 = plate.thickness_mm * plate.density_kg_m3 * 1e-9
    of_part = {part.id: float(part.polygon.area) * per_mm2 for part in nest.parts}
    return [of_part.get(c.part, 0.0) for c in nest.contours]


def middles_mm(nest: Nest, axis: int) -> list[float]:
    """The middle of each contour's extent along x (axis 0) or y (axis 1), in the coordinates of the drawing."""
    bounds = extents_mm(nest)
    return [float(v) for v in (bounds[:, axis] + bounds[:, axis + 2]) / 2]


def corner_distances_mm(nest: Nest) -> list[float]:
    """How far the middle of each contour is from the sheet's lower left corner."""
    x0, y0, *_ = nest.sheet.bounds
    return [math.hypot(x - x0, y - y0) for x, y in zip(middles_mm(nest, 0), middles_mm(nest, 1), strict=True)]


def extents_mm(nest: Nest) -> Floats:
    """The bounding box (n, 4) of every contour: x and y from, x and y to."""
    return np.asarray(shapely.bounds([c.line for c in nest.contours]), dtype=np.float64).reshape(-1, 4)


def areas_mm2(nest: Nest) -> list[float]:
    """Area inside every contour, 0 for a mark or a slit."""
    return [float(c.polygon.area) if c.encloses else 0.0 for c in nest.contours]


def lengths_mm(nest: Nest) -> list[float]:
    """Length of every contour."""
    return [c.curve.length_mm for c in nest.contours]


def sizes_mm(nest: Nest, axis: int) -> list[float]:
    """Extent of every contour along x (axis 0) or y (axis 1)."""
    bounds = extents_mm(nest)
    return _listed(bounds[:, axis + 2] - bounds[:, axis])


def rectangle_sides_mm(nest: Nest, longer: bool) -> list[float]:
    """The longer or the shorter side of the smallest rectangle, at any angle, around every contour."""
    sides = rectangles_mm(nest)
    return _listed(sides.max(axis=1) if longer else sides.min(axis=1))


def edge_gaps_mm(nest: Nest, side: str) -> list[float]:
    """Distance of every contour from a side of the sheet, from the nearest of the four where side is `edge`."""
    xmin, ymin, xmax, ymax = nest.sheet.bounds
    bounds = extents_mm(nest)
    gaps = {
        "left": bounds[:, 0] - xmin,
        "right": xmax - bounds[:, 2],
        "bottom": bounds[:, 1] - ymin,
        "top": ymax - bounds[:, 3],
    }
    return _listed(np.min(list(gaps.values()), axis=0) if side == "edge" else gaps[side])


def rectangles_mm(nest: Nest) -> Floats:
    """Two sides (n, 2) of the smallest rectangle around every contour."""
    lines = np.array([c.line for c in nest.contours], dtype=object)
    hulls = shapely.convex_hull(lines)
    flat = shapely.get_dimensions(hulls) < 2
    sides = np.zeros((len(lines), 2))
    corners = shapely.get_coordinates(shapely.oriented_envelope(lines[~flat])).reshape(-1, 5, 2)
    for k in (0, 1):
        sides[~flat, k] = np.hypot(*(corners[:, k + 1] - corners[:, k]).T)
    sides[flat, 0] = shapely.length(hulls[flat])
    return sides


def _listed(values: Floats) -> list[float]:
    return [float(v) for v in values]
