"""Rounds that are cut in two: long strips in halves, and parts that a last stretch holds until others are cut."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from kerfwise.encoder.cut import Span, Stretch
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import tolerance_mm
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.torch_path import compensated

from .candidate import Candidate
from .older_kerfs import OlderKerfs
from .stretches import joined_at, way_of

# Half of a strip's round runs from the middle of one long side round a short side to the middle of the other, so that
# both long sides are begun, and the strip does not bend to one side. A last stretch is a straight piece of the round
# right before the place where the torch joined it: it holds the part until all others of the zone hang by theirs.

_ROUNDS = 4.0
"""A round is so many times as long as the last stretch of it, at the least."""
_FAR_MM = 100.0
"""Places this far from the sheet's edge, or further, are alike."""
_NEAR_SHARE = 0.1
"""Of the sides: so near the middle of a long side all places are alike."""


@dataclass(frozen=True, slots=True)
class SplitOptions:
    """Strips whose sides have this ratio, or more, are cut in halves; of other parts `last_mm` are cut last."""

    half_ratio: float | None = None
    last_mm: float | None = None


def to_be_split(nest: Nest, kerf_mm: float, options: SplitOptions, left: Collection[str]) -> dict[str, bool]:
    """Ids of the outer contours, of those that are `left`, that are cut in two, and whether in halves.

    Contours that another part stands within two kerfs of are cut in one round.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> plate = nest(600, 200, part("Strip", rect(10, 10, 400, 40)), part("A", rect(10, 80, 80, 60)))
    >>> to_be_split(plate, 1.5, SplitOptions(4.0, 20.0), [c.id for c in plate.contours])
    {'Strip.outer': True, 'A.outer': False}
    """
    if options.half_ratio is None and options.last_mm is None:
        return {}
    lines = [contour.line for contour in nest.contours]
    near = shapely.STRtree(lines).query(lines, "dwithin", distance=2 * kerf_mm + 2 * tolerance_mm(kerf_mm)).T.tolist()
    crowded = {nest.contours[a].id for a, b in near if nest.contours[a].part != nest.contours[b].part}
    found: dict[str, bool] = {}
    for part in nest.parts:
        if part.outer.id not in {*left} or part.outer.id in crowded:
            continue
        short_mm, long_mm = _sides_mm(part.outer)
        if options.half_ratio is not None and long_mm >= options.half_ratio * short_mm:
            found[part.outer.id] = True
        elif options.last_mm is not None and part.outer.curve.length_mm >= _ROUNDS * options.last_mm:
            found[part.outer.id] = False
    return found


def _sides_mm(contour: Contour) -> tuple[float, float]:
    corners = _box(contour)
    one, other = (math.dist(corners[k], corners[k + 1]) for k in (0, 1))
    return min(one, other), max(one, other)


def _box(contour: Contour) -> list[Point]:
    box = shapely.minimum_rotated_rectangle(contour.line)
    return [(float(x), float(y)) for x, y in shapely.get_coordinates(box)[:4]]


def split_ways(
    nest: Nest,
    split: Mapping[str, bool],
    candidates: Sequence[Candidate],
    met: OlderKerfs | None,
    kerf_mm: float,
    last_mm: float,
) -> Iterator[Contour]:
    """The ways that begin these contours, each from where a lead joins; a contour without a lead has none.

    Leads that meet no older kerf are better, and then those on a side far from the sheet's edge: what is cut last ends
    where the torch joined, and ends along rigid metal there.
    """
    edge = shapely.boundary(nest.sheet.polygon)
    meets = Counter[int]() if met is None else Counter([*met.rings[:, 0].tolist(), *met.leads.ravel().tolist()])
    of_contour: dict[int, list[tuple[int, Candidate]]] = {nest.index[name]: [] for name in split}
    for k, c in enumerate(candidates):
        if c.contour in of_contour and c.span is None and not c.tabs:
            of_contour[c.contour].append((k, c))
    for name, in_halves in split.items():
        contour, own = nest.contour(name), of_contour[nest.index[name]]
        leads = [c for _, c in own]
        rooms_mm = [min(float(edge.distance(shapely.Point(joined_at(c)))), _FAR_MM) for c in leads]
        worth = [(meets[k], -round(room_mm, 3)) for (k, _), room_mm in zip(own, rooms_mm, strict=True)]
        if in_halves:
            stretch = _half(contour, leads, worth, kerf_mm)
        else:
            stretch = _all_but(contour, leads, worth, kerf_mm, last_mm)
        if stretch is not None:
            word = "half" if in_halves else "most"
            way = way_of(nest, f"{contour.part}.{word}", [stretch], kerf_mm)
            yield replace(way, holds=not in_halves)


def _half(
    contour: Contour, leads: Sequence[Candidate], worth: Sequence[tuple[int, float]], kerf_mm: float
) -> Stretch | None:
    """From a lead that joins near the middle of a long side to the middle of the other."""
    ring = compensated(contour, kerf_mm)
    corners = _box(contour)
    sides = [(corners[k], corners[(k + 1) % 4]) for k in range(4)]
    middles = [(np.array(a) + np.array(b)) / 2 for a, b in sorted(sides, key=lambda s: -math.dist(*s))[:2]]
    places = [ring.point_at(ring.project(middle.tolist())[0]) for middle in middles]
    near_mm = _NEAR_SHARE * math.dist(*sides[0]) + _NEAR_SHARE * math.dist(*sides[1])
    found = [
        (int(math.dist(joined_at(lead), here) / near_mm), worth[k], k, (float(there[0]), float(there[1])))
        for k, lead in enumerate(leads)
        for here, there in (places, places[::-1])
    ]
    if not found:
        return None
    _, _, k, there = min(found)
    return Stretch(contour.id, Span(joined_at(leads[k]), there), leads[k].direction)


def _all_but(
    contour: Contour, leads: Sequence[Candidate], worth: Sequence[tuple[int, float]], kerf_mm: float, last_mm: float
) -> Stretch | None:
    """Nearly all round from a lead, up to the stretch that is left: best one that is straight."""
    found = []
    for k, lead in enumerate(leads):
        ring = compensated(contour, kerf_mm).towards(lead.direction)
        at_mm = ring.project(joined_at(lead))[0]
        left = ring.between((at_mm - last_mm) % ring.length_mm, last_mm)
        ends = (left.point_at(0.0), left.point_at(left.length_mm))
        bent_mm = left.length_mm - math.dist(*ends)
        found.append((worth[k][0], round(bent_mm, 3), worth[k][1], k, (float(ends[0][0]), float(ends[0][1]))))
    if not found:
        return None
    *_, k, end = min(found)
    return Stretch(contour.id, Span(joined_at(leads[k]), end), leads[k].direction)
