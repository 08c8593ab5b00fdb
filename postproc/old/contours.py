"""From the burns of a program to a nest: rounds become contours, and what lies in what tells parts from their holes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.encoder.compensation import compensated
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.offset import offset_curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Kind, Nest, Note, Part, Sheet
from kerfwise.encoder.validate import validated
from kerfwise.postproc.check.reader.program import Burn

from .loops import NoRound, Round, tidied
from .loops import round_of as round_of_path

MARGIN_MM = 20.0
"""Sheet that is assumed around the burns where nobody says how large it is."""
_OFF_MM = 1.0
"""How far beyond a sheet's edge the torch's path may come, as it does where parts stand on the edge."""
_SAME_MM = 0.1
_CORNER_MM = 0.04
"""How far the kerf beside a contour that was told from a burn may lie off that burn."""


@dataclass(frozen=True, slots=True)
class Unclear:
    """A burn of which nobody can say what it cuts: the line, and why."""

    line: int
    why: str

    def __str__(self) -> str:
        return f"line {self.line}: {self.why}"


class NoNest(Exception):
    """The burns of a program make no nest; `unclear` are those at fault."""

    def __init__(self, unclear: Sequence[Unclear]) -> None:
        self.unclear = tuple(unclear)
        super().__init__("; ".join(map(str, unclear)))


@dataclass(frozen=True, eq=False, slots=True)
class Told:
    """A nest that was told from burns: which burn, counted from 0, each contour is of, and what the torch goes round.

    Marks have no round.
    """

    nest: Nest
    burn_of: Mapping[str, int]
    round_of: Mapping[str, Curve]


@dataclass(frozen=True, eq=False, slots=True)
class _Tagged:
    """A burn, and the round it makes where it is cut through; marks have none."""

    burn: Burn
    round: Round | None


def nest_of(
    burns: Sequence[Burn],
    kerf_mm: float,
    sheet_mm: tuple[float, float] | None = None,
    zero: Point | None = None,
    file: str = "",
) -> Told:
    """The nest that burns cut, all of them, each a contour or a mark.

    A round in no other, or in an even number of others, is the outline of a part; one in an odd number is a hole of the
    part straight around it. The contours lie half a kerf beside the rounds.

    Parameters
    ----------
    burns
        In the drawing's coordinates.
    kerf_mm
        Width of the kerf; 0 for contours on the torch's path itself.
    sheet_mm
        The sheet, from `zero` on; None to lay one around the burns.
    zero
        The sheet's lower left corner, where the program says it; else (0, 0) for a sheet of a given size.
    file
        Of the program, for the nest's name.

    Raises
    ------
    NoNest
        If a burn is no contour, or none can be told from it.
    InputError
        If the sheet given does not hold the burns.
    """
    tagged, unclear = _tagged(burns)
    if unclear:
        raise NoNest(unclear)
    rounds = [k for k, one in enumerate(tagged) if one.round is not None]
    areas = [tagged[k].round.ring.polygon() for k in rounds]  # type: ignore[union-attr]
    around = _around(burns, rounds, areas)
    depth = {k: len(around[k]) for k in rounds}
    kinds: dict[int, Kind] = {k: "hole" if depth[k] % 2 else "outer" for k in rounds}
    part_of: dict[int, int] = {}
    for k in rounds:
        part_of[k] = k if kinds[k] == "outer" else max(around[k], key=lambda j: depth[j])
    marks = {k: _marked(tagged[k].burn, rounds, areas, depth) for k in range(len(tagged)) if tagged[k].round is None}
    part_of |= marks
    name_of = {k: f"P{n}" for n, k in enumerate((k for k in rounds if kinds[k] == "outer"), 1)}
    if not name_of:
        raise NoNest([Unclear(burns[0].line if burns else 0, "nothing is cut through")])
    made = [_part(name, k, tagged, part_of, kinds, kerf_mm) for k, name in name_of.items()]
    burn_of = {name: k for _, of_part in made for name, k in of_part.items()}
    sheet, notes = _sheet(burns, sheet_mm, zero)
    try:
        nest = validated(Nest(sheet, tuple(part for part, _ in made), file, "", notes))
    except InputError as error:
        raise NoNest([Unclear(burns[0].line, "; ".join((error.message, *error.details[:3])))]) from None
    if set(nest.index) != set(burn_of):
        again = sorted(burns[k].line for name, k in burn_of.items() if name not in nest.index)
        raise NoNest([Unclear(line, "it cuts what another burn has cut") for line in again])
    round_of = {name: of.ring for name, k in burn_of.items() if (of := tagged[k].round) is not None}
    return Told(nest, burn_of, round_of)


def _tagged(burns: Sequence[Burn]) -> tuple[list[_Tagged], list[Unclear]]:
    tagged, unclear = [], []
    for burn in burns:
        try:
            tagged.append(_Tagged(burn, None if burn.tool != 0 else round_of_path(burn.path)))
        except NoRound as why:
            unclear.append(Unclear(burn.line, str(why)))
    return tagged, unclear


def _around(burns: Sequence[Burn], rounds: Sequence[int], areas: Sequence[shapely.Polygon]) -> dict[int, list[int]]:
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
            line = burns[rounds[was]].line
            crossing.append(Unclear(burns[rounds[again]].line, f"it cuts what the burn of line {line} has cut"))
        elif not areas[b].contains(areas[a]):
            line = burns[rounds[b]].line
            crossing.append(Unclear(burns[rounds[a]].line, f"its round crosses that of line {line}"))
        around[rounds[a]].append(rounds[b])
    if crossing:
        raise NoNest(crossing)
    return around


def _marked(burn: Burn, rounds: Sequence[int], areas: Sequence[shapely.Polygon], depth: dict[int, int]) -> int:
    """The part that a mark is on."""
    x, y = burn.path.vertices[0, :2].tolist()
    under = [k for k, area in zip(rounds, areas, strict=True) if shapely.contains_xy(area, x, y)]
    if not under or len(under) % 2 == 0:
        raise NoNest([Unclear(burn.line, "it marks no part")])
    return max(under, key=lambda k: depth[k])


def _part(
    name: str,
    outer: int,
    tagged: Sequence[_Tagged],
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
        _contour(f"{name}.outer", name, "outer", tagged[outer], kerf_mm),
        tuple(_contour(f"{name}.hole{n}", name, "hole", tagged[k], kerf_mm) for n, k in enumerate(holes, 1)),
        tuple(
            Contour(f"{name}.mark{n}", name, "mark", Curve(tagged[k].burn.path.vertices, closed=False))
            for n, k in enumerate(marks, 1)
        ),
    )
    made = (part.outer, *part.holes, *part.marks)
    return part, {contour.id: k for contour, k in zip(made, (outer, *holes, *marks), strict=True)}


def _contour(contour_id: str, part: str, kind: Kind, of: _Tagged, kerf_mm: float) -> Contour:
    assert of.round is not None
    ring = tidied(of.round.ring)
    if kerf_mm > 0:
        try:
            ring = offset_curve(ring, -kerf_mm / 2 if kind == "outer" else kerf_mm / 2)
        except ValueError as error:
            raise NoNest(
                [Unclear(of.burn.line, f"no contour lies {kerf_mm / 2:g} mm beside it, half a kerf: {error}")]
            ) from None
    return Contour(contour_id, part, kind, ring)


def fits_kerf(told: Told, kerf_mm: float) -> bool:
    """Whether the torch's way round each contour is the round that it was told from, both ways."""
    for contour in told.nest.contours:
        if contour.encloses:
            try:
                ring = compensated(contour, kerf_mm).line()
            except InputError:
                return False
            if shapely.hausdorff_distance(ring, told.round_of[contour.id].line(), densify=0.1) > _CORNER_MM:
                return False
    return True


def _sheet(
    burns: Sequence[Burn], sheet_mm: tuple[float, float] | None, zero: Point | None
) -> tuple[Sheet, tuple[Note, ...]]:
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
