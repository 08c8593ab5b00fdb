"""From the burns of a program to a nest: rounds become contours, and what lies in what tells parts from their holes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.encoder.compensation import compensated
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.offset import offset_curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Kind, Nest, Part
from kerfwise.encoder.validate import validated
from kerfwise.postproc.check.reader.program import Burn

from .loops import tidied
from .sheet_around import sheet_around
from .tagged import Tagged, tagged
from .unclear import NoNest, Unclear

_SAME_MM = 0.1
_CORNER_MM = 0.04
"""How far the kerf beside a contour that was told from a burn may lie off that burn."""


@dataclass(frozen=True, eq=False, slots=True)
class Told:
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
) -> Told:
    """The nest that burns cut, all of them, each a contour or a mark, or several contours with the torch on between.

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
    tab_mm
        A burn that stops no further than this from where it joined a contour has left a tab; 0 where there are none.
    aside
        The lines of burns that are no part of it.

    Raises
    ------
    NoNest
        If a burn is no contour, or none can be told from it.
    InputError
        If the sheet given does not hold the burns.
    """
    made, unclear = tagged(burns, tab_mm, aside)
    if unclear:
        raise NoNest(unclear)
    rounds = [k for k, one in enumerate(made) if one.round is not None]
    areas = [made[k].round.ring.polygon() for k in rounds]  # type: ignore[union-attr]
    around = _around(made, rounds, areas)
    depth = {k: len(around[k]) for k in rounds}
    kinds: dict[int, Kind] = {k: "hole" if depth[k] % 2 else "outer" for k in rounds}
    part_of: dict[int, int] = {}
    for k in rounds:
        part_of[k] = k if kinds[k] == "outer" else max(around[k], key=lambda j: depth[j])
    part_of |= {k: _marked(one.burn, rounds, areas, depth) for k, one in enumerate(made) if one.round is None}
    name_of = {k: f"P{n}" for n, k in enumerate((k for k in rounds if kinds[k] == "outer"), 1)}
    if not name_of:
        raise NoNest([Unclear(burns[0].line if burns else 0, "nothing is cut through")])
    parts = [_part(name, k, made, part_of, kinds, kerf_mm) for k, name in name_of.items()]
    cut_by = dict(sorted(((name, k) for _, of_part in parts for name, k in of_part.items()), key=lambda row: row[1]))
    sheet, notes = sheet_around(burns, sheet_mm, zero)
    try:
        nest = validated(Nest(sheet, tuple(part for part, _ in parts), file, "", notes))
    except InputError as error:
        text = "; ".join((error.message, *error.details[:3]))
        line = next((made[k].burn.line for name, k in cut_by.items() if f"{name} " in text), burns[0].line)
        raise NoNest([Unclear(line, text)]) from None
    if set(nest.index) != set(cut_by):
        again = sorted(made[k].burn.line for name, k in cut_by.items() if name not in nest.index)
        raise NoNest([Unclear(line, "it cuts what another burn has cut") for line in again])
    round_of = {name: of.ring for name, k in cut_by.items() if (of := made[k].round) is not None}
    return Told(nest, {name: made[k].number for name, k in cut_by.items()}, round_of)


def _around(made: Sequence[Tagged], rounds: Sequence[int], areas: Sequence[shapely.Polygon]) -> dict[int, list[int]]:
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
            line = made[rounds[was]].burn.line
            crossing.append(Unclear(made[rounds[again]].burn.line, f"it cuts what the burn of line {line} has cut"))
        elif not areas[b].contains(areas[a]):
            line = made[rounds[b]].burn.line
            crossing.append(Unclear(made[rounds[a]].burn.line, f"its round crosses that of line {line}"))
        around[rounds[a]].append(rounds[b])
    if crossing:
        raise NoNest(crossing)
    return around


def _marked(burn: Burn, rounds: Sequence[int], areas: Sequence[shapely.Polygon], depth: dict[int, int]) -> int:
    """The part that a mark is on."""
    x, y = burn.start
    under = [k for k, area in zip(rounds, areas, strict=True) if shapely.contains_xy(area, x, y)]
    if not under or len(under) % 2 == 0:
        raise NoNest([Unclear(burn.line, "it marks no part")])
    return max(under, key=lambda k: depth[k])


def _part(
    name: str,
    outer: int,
    made: Sequence[Tagged],
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
        _contour(f"{name}.outer", name, "outer", made[outer], kerf_mm),
        tuple(_contour(f"{name}.hole{n}", name, "hole", made[k], kerf_mm) for n, k in enumerate(holes, 1)),
        tuple(
            Contour(f"{name}.mark{n}", name, "mark", Curve(made[k].burn.path.vertices, closed=False))
            for n, k in enumerate(marks, 1)
        ),
    )
    contours = (part.outer, *part.holes, *part.marks)
    return part, {contour.id: k for contour, k in zip(contours, (outer, *holes, *marks), strict=True)}


def _contour(contour_id: str, part: str, kind: Kind, of: Tagged, kerf_mm: float) -> Contour:
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


def fits_kerf(told: Told, kerf_mm: float, step_mm: float = 0.0) -> bool:
    """Whether the torch's way round each contour is the round that it was told from, both ways, within a step."""
    for contour in told.nest.contours:
        if contour.encloses:
            try:
                ring = compensated(contour, kerf_mm).line()
            except InputError:
                return False
            if shapely.hausdorff_distance(ring, told.round_of[contour.id].line(), densify=0.1) > max(
                _CORNER_MM, step_mm
            ):
                return False
    return True
