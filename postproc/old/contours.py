"""From the burns of a program to a nest: rounds become contours, and what lies in what tells parts from their holes."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, replace
from itertools import zip_longest

import numpy as np
import shapely

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.offset import offset_curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Kind, Nest, Note, Part, Sheet
from kerfwise.encoder.torch_path import compensated
from kerfwise.encoder.validate import validated
from kerfwise.postproc.check.reader.program import Burn

from .loops import AmbiguousNest, BurnContour, Unclear, contours_of_burns, simplify_ring

_SAME_MM = 0.1
_CORNER_MM = 0.04
"""How far the kerf beside a contour that was told from a burn may lie off that burn."""


@dataclass(frozen=True, eq=False, slots=True)
class NestOfBurns:
    """A nest that was told from burns: which burn, counted from 0, each contour is of, and what the torch goes round.

    Contours of one burn stand in `burn_of` in the order in which it cuts them. Marks have no round.
    """

    nest: Nest
    burn_of: Mapping[str, int]
    round_of: Mapping[str, Curve]


def nest_of(
    burns: Sequence[Burn],
    kerf_mm: float,
    sheet_mm: tuple[float, float] | None = None,
    zero: Point | None = None,
    file: str = "",
    tab_mm: float = 0.0,
    aside: Set[int] = frozenset(),
) -> NestOfBurns:
    """The nest that burns cut, all of them, each a contour or a mark, or several contours with the torch on between.

    A round in no other, or in an even number of others, is the outline of a part; one in an odd number is a hole of the
    part straight around it. The contours lie half a kerf beside the rounds. `burns`: in the drawing's coordinates.
    `kerf_mm`: width of the kerf; 0 for contours on the torch's path itself. `sheet_mm`: the sheet, from `zero` on; None
    to lay one around the burns. `zero`: the sheet's lower left corner, where the program says it; else (0, 0) for a
    sheet of a given size. `file`: of the program, for the nest's name. `tab_mm`: a burn that stops no further than this
    from where it joined a contour has left a tab; 0 where there are none. `aside`: the lines of burns that are no part
    of it. Raises NoNest if a burn is no contour, or none can be told from it; InputError if the sheet given does not
    hold the burns.
    """
    contours, unclear = contours_of_burns(burns, tab_mm, aside)
    if unclear:
        raise AmbiguousNest(unclear)
    rounds = [k for k, one in enumerate(contours) if one.round is not None]
    areas = [contours[k].round.ring.polygon() for k in rounds]  # type: ignore[union-attr]
    around = _around(contours, rounds, areas)
    depth = {k: len(around[k]) for k in rounds}
    kinds: dict[int, Kind] = {k: "hole" if depth[k] % 2 else "outer" for k in rounds}
    part_of: dict[int, int] = {}
    for k in rounds:
        part_of[k] = k if kinds[k] == "outer" else max(around[k], key=lambda j: depth[j])
    part_of |= {k: _marked(one.burn, rounds, areas, depth) for k, one in enumerate(contours) if one.round is None}
    name_of = {k: f"P{n}" for n, k in enumerate((k for k in rounds if kinds[k] == "outer"), 1)}
    if not name_of:
        raise AmbiguousNest([Unclear(burns[0].line if burns else 0, "nothing is cut through")])
    parts = [_part(name, k, contours, part_of, kinds, kerf_mm) for k, name in name_of.items()]
    cut_by = dict(sorted(((name, k) for _, of_part in parts for name, k in of_part.items()), key=lambda row: row[1]))
    sheet, notes = sheet_around(burns, sheet_mm, zero)
    try:
        nest = validated(Nest(sheet, tuple(part for part, _ in parts), file, "", notes))
    except InputError as error:
        text = "; ".join((error.message, *error.details[:3]))
        line = next((contours[k].burn.line for name, k in cut_by.items() if f"{name} " in text), burns[0].line)
        raise AmbiguousNest([Unclear(line, text)]) from None
    if set(nest.index) != set(cut_by):
        again = sorted(contours[k].burn.line for name, k in cut_by.items() if name not in nest.index)
        raise AmbiguousNest([Unclear(line, "it cuts what another burn has cut") for line in again])
    round_of = {name: of.ring for name, k in cut_by.items() if (of := contours[k].round) is not None}
    return NestOfBurns(nest, {name: contours[k].number for name, k in cut_by.items()}, round_of)


def _around(
    contours: Sequence[BurnContour], rounds: Sequence[int], areas: Sequence[shapely.Polygon]
) -> dict[int, list[int]]:
    """The rounds around each round."""
    around: dict[int, list[int]] = {k: [] for k in rounds}
    if not areas:
        return around
    tree = shapely.STRtree(areas)
    inner, outer = tree.query(np.array([area.representative_point() for area in areas]), predicate="within")
    crossing: list[Unclear] = []
    for a, b in zip(inner.tolist(), outer.tolist(), strict=True):
        if a == b or areas[b].area < areas[a].area:
            continue
        if areas[b].hausdorff_distance(areas[a]) < _SAME_MM:
            again, was = max(a, b), min(a, b)
            line = contours[rounds[was]].burn.line
            crossing.append(Unclear(contours[rounds[again]].burn.line, f"it cuts what the burn of line {line} has cut"))
        elif not areas[b].contains(areas[a]):
            line = contours[rounds[b]].burn.line
            crossing.append(Unclear(contours[rounds[a]].burn.line, f"its round crosses that of line {line}"))
        around[rounds[a]].append(rounds[b])
    if crossing:
        raise AmbiguousNest(crossing)
    return around


def _marked(burn: Burn, rounds: Sequence[int], areas: Sequence[shapely.Polygon], depth: dict[int, int]) -> int:
    """The part that a mark is on."""
    x, y = burn.start
    under = [k for k, area in zip(rounds, areas, strict=True) if shapely.contains_xy(area, x, y)]
    if not under or len(under) % 2 == 0:
        raise AmbiguousNest([Unclear(burn.line, "it marks no part")])
    return max(under, key=lambda k: depth[k])


def _part(
    name: str,
    outer: int,
    burn_contours: Sequence[BurnContour],
    part_of: dict[int, int],
    kinds: dict[int, Kind],
    kerf_mm: float,
) -> tuple[Part, dict[str, int]]:
    """A part, and the burn of each of its contours."""
    own = sorted(k for k, part in part_of.items() if part == outer and k != outer)
    holes = [k for k in own if kinds.get(k) == "hole"]
    marks = [k for k in own if k not in kinds]
    part = Part(
        name,
        _contour(f"{name}.outer", name, "outer", burn_contours[outer], kerf_mm),
        tuple(_contour(f"{name}.hole{n}", name, "hole", burn_contours[k], kerf_mm) for n, k in enumerate(holes, 1)),
        tuple(
            Contour(f"{name}.mark{n}", name, "mark", Curve(burn_contours[k].burn.path.vertices, closed=False))
            for n, k in enumerate(marks, 1)
        ),
    )
    contours = (part.outer, *part.holes, *part.marks)
    return part, {contour.id: k for contour, k in zip(contours, (outer, *holes, *marks), strict=True)}


def _contour(contour_id: str, part: str, kind: Kind, of: BurnContour, kerf_mm: float) -> Contour:
    assert of.round is not None
    ring = simplify_ring(of.round.ring)
    if kerf_mm > 0:
        try:
            ring = offset_curve(ring, -kerf_mm / 2 if kind == "outer" else kerf_mm / 2)
        except ValueError as error:
            raise AmbiguousNest(
                [Unclear(of.burn.line, f"no contour lies {kerf_mm / 2:g} mm beside it, half a kerf: {error}")]
            ) from None
    return Contour(contour_id, part, kind, ring)


def fits_kerf(nest_of_burns: NestOfBurns, kerf_mm: float, step_mm: float = 0.0) -> bool:
    """Whether the torch's way round each contour is the round that it was told from, both ways, within a step."""
    for contour in nest_of_burns.nest.contours:
        if contour.encloses:
            try:
                ring = compensated(contour, kerf_mm).line()
            except InputError:
                return False
            if shapely.hausdorff_distance(ring, nest_of_burns.round_of[contour.id].line(), densify=0.1) > max(
                _CORNER_MM, step_mm
            ):
                return False
    return True


MARGIN_MM = 20.0
"""Sheet that is assumed around the burns where nobody says how large it is."""
_OFF_MM = 1.0
"""How far beyond a sheet's edge the torch's path may come, as it does where parts stand on the edge."""


def sheet_around(
    burns: Sequence[Burn], sheet_mm: tuple[float, float] | None, zero: Point | None
) -> tuple[Sheet, tuple[Note, ...]]:
    """The sheet of a given size from `zero` on, or else one around the burns, with a note that says so.

    Raises InputError if the sheet given does not hold the burns.
    """
    bounds = np.array([burn.path.line().bounds for burn in burns])
    (x0, y0), (x1, y1) = bounds[:, :2].min(axis=0).tolist(), bounds[:, 2:].max(axis=0).tolist()
    if sheet_mm is None:
        m = MARGIN_MM
        left, low = (x0 - m, y0 - m) if zero is None else (min(zero[0], x0), min(zero[1], y0))
        left, low, right, high = (round(v, 3) for v in (left, low, x1 + m, y1 + m))
        text = (
            f"the program does not say how large the sheet is: {right - left:g} x {high - low:g} mm are assumed, {m:g} "
            "mm around what it cuts; rules on the sheet's edges mean little (--sheet WxH gives it)"
        )
        return Sheet(_rectangle(left, low, right, high), stated=False), (Note("warning", text),)
    (w, h), (x, y) = sheet_mm, zero or (0.0, 0.0)
    if x0 < x - _OFF_MM or y0 < y - _OFF_MM or x1 > x + w + _OFF_MM or y1 > y + h + _OFF_MM:
        raise InputError(
            f"--sheet {w:g}x{h:g}: the program cuts from ({x0:g}, {y0:g}) to ({x1:g}, {y1:g}), beyond that sheet "
            f"from ({x:g}, {y:g}) on; give its size, or leave it out"
        )
    return Sheet(_rectangle(x, y, x + w, y + h)), ()


def _rectangle(x0: float, y0: float, x1: float, y1: float) -> Curve:
    return Curve.of([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


# The names that a program of kerfwise gives its contours, for the nest that is told from its burns.

_CUT = re.compile(r"(?:CUT|MARK) \d+ (?P<contour>.+?) ZONE \d+\b.*", re.IGNORECASE)
_ID = re.compile(r"(?P<part>.+)\.(?P<kind>outer|hole|mark)(?P<number>\d*)")


def name_by_comments(nest_of_burns: NestOfBurns, comments: Sequence[str]) -> NestOfBurns | None:
    """The same nest with the names of the program's comments; None where these do not fit what the burns cut.

    Each contour that is cut has a comment, in their order, also where one burn cuts several.
    """
    ordered = sorted(
        nest_of_burns.burn_of, key=lambda contour_id: nest_of_burns.burn_of[contour_id]
    )  # those of one burn in its order
    found = [parsed for text in comments if (parsed := _CUT.fullmatch(text)) is not None]
    names: dict[str, str] = {}
    for contour_id, words in zip_longest(ordered, found):
        parsed = None if words is None else _ID.fullmatch(words["contour"])
        if contour_id is None or parsed is None or parsed["kind"] != nest_of_burns.nest.contour(contour_id).kind:
            return None
        names[contour_id] = words["contour"]
    if len(set(names.values())) != len(names):
        return None
    parts = []
    for part in nest_of_burns.nest.parts:
        named = {_ID.fullmatch(names[contour.id])["part"] for contour in part}  # type: ignore[index]
        if len(named) != 1:
            return None
        parts.append(_named(part, named.pop(), names))
    if len({part.id for part in parts}) != len(parts):
        return None
    burn_of = {names[contour_id]: k for contour_id, k in nest_of_burns.burn_of.items()}
    round_of = {names[contour_id]: ring for contour_id, ring in nest_of_burns.round_of.items()}
    return NestOfBurns(replace(nest_of_burns.nest, parts=tuple(parts)), burn_of, round_of)


def _named(part: Part, name: str, names: dict[str, str]) -> Part:
    def named(contour: Contour) -> Contour:
        return replace(contour, id=names[contour.id], part=name)

    return replace(
        part, id=name, outer=named(part.outer), holes=tuple(map(named, part.holes)), marks=tuple(map(named, part.marks))
    )
