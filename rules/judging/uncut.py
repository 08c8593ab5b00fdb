"""Narrow strips and islands of uncut metal, by plain geometry, while a sheet is cut: the whole of no-narrow-strips.

Everything is looked at near the part just cut out: `strips` and `islands` say how far.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np
import shapely

from kerfwise.arrays import Ints
from kerfwise.encoder.kept import kept_with_nest
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.side_by_side import side_by_side

from .islands import Islands
from .metal import Badly, Metal
from .placement import host_holes, places
from .strips import Strips

MANY_PARTS = 200
"""With fewer, a second thread gains nothing."""


@dataclass(frozen=True, slots=True)
class Cutting:
    """After cut `k` (counted from 1 in the order given) the parts `left` lie badly, because the parts `out` are out.

    `kind` "strip": `left` is one part, in metal narrower than a strip between parts that are out. "island": `left` are
    a part on a piece of metal closed off by parts that are out, and one elsewhere.
    """

    k: int
    kind: str
    out: tuple[int, ...]
    left: tuple[int, ...]


def lying_badly(metal: Metal, order: Sequence[int], at: Ints) -> dict[int, list[Badly]]:
    """What lies badly in one place after each part of an order, told once a part, in the numbers of the place.

    `at` (parts,) says when each is cut; for parts that never are it has a number that is larger than all. Strips and
    islands have nothing to do with each other, so they are looked for side by side.
    """
    strips, islands = side_by_side(
        lambda: _found(Strips(metal, at), order), lambda: _found(Islands(metal, at), order), len(order) >= MANY_PARTS
    )
    told: set[int] = set()
    found: dict[int, list[Badly]] = {}
    for p in order:
        for badly in chain(strips[p], islands[p]):
            if (left := badly[2][0]) not in told:
                told.add(left)
                found.setdefault(p, []).append(badly)
    return found


def _found(looks: Strips | Islands, order: Sequence[int]) -> dict[int, list[Badly]]:
    return {p: list(looks.take_out(p)) for p in order}


def strips_and_islands(nest: Nest, order: tuple[str, ...], strip_mm: float, web_mm: float) -> tuple[Cutting, ...]:
    """What lies badly after each cut of an order of contour ids, told once a part; numbers are those of parts.

    Kept for the last few orders, with the nest as drawn: the plan that is found is looked at again as a plan, and as a
    program.
    """
    return _told(_as_drawn(nest), order, strip_mm, web_mm)


def _as_drawn(nest: Nest) -> Nest:
    """The nest as drawn, where its parts have the same outlines on the same sheet, and lie in the same holes."""
    drawn = nest.drawn
    if drawn is None or drawn.sheet is not nest.sheet or len(drawn.parts) != len(nest.parts):
        return nest
    same = all(
        one.id == other.id and one.outer.curve is other.outer.curve
        for one, other in zip(nest.parts, drawn.parts, strict=True)
    )
    return drawn if same and places(drawn, host_holes(drawn)) == places(nest, host_holes(nest)) else nest


@kept_with_nest(most=4)
def _told(nest: Nest, order: tuple[str, ...], strip_mm: float, web_mm: float) -> tuple[Cutting, ...]:
    return tuple(_badly(nest, order, strip_mm, web_mm))


def _badly(nest: Nest, order: Sequence[str], strip_mm: float, web_mm: float) -> Iterator[Cutting]:
    number = {part.outer.id: k for k, part in enumerate(nest.parts)}
    grounds, where = _grounds(nest, strip_mm, web_mm)
    in_place = {part: p for ground in grounds.values() for p, part in enumerate(ground.parts)}
    first: dict[int, int] = {}
    for k, contour in enumerate(order, 1):
        if contour in number:
            first.setdefault(number[contour], k)
    in_turn: dict[str, list[int]] = {place: [] for place in grounds}
    for part in first:
        if part in in_place:
            in_turn[where[part]].append(in_place[part])
    found = {
        place: lying_badly(ground, in_turn[place], np.array([first.get(q, len(order) + 1) for q in ground.parts]))
        for place, ground in grounds.items()
    }
    for part, k in first.items():
        if part in in_place:
            ground = grounds[where[part]]
            for kind, out, left in found[where[part]].get(in_place[part], ()):
                yield Cutting(k, kind, tuple(ground.parts[m] for m in out), tuple(ground.parts[m] for m in left))


@kept_with_nest(most=2)
def _grounds(nest: Nest, strip_mm: float, web_mm: float) -> tuple[dict[str, Metal], list[str]]:
    """The metal of each place with several parts by the id of its hole ("" for the sheet); the place of each part."""
    hosts = host_holes(nest)
    at = places(nest, hosts)
    where = [at[part.id] for part in nest.parts]
    holes = {hole.id: hole.polygon for hole in hosts.values()}
    grounds = {}
    lying: dict[str, list[int]] = defaultdict(list)
    for k, of in enumerate(where):
        lying[of].append(k)
    for place, own in sorted((place, own) for place, own in lying.items() if len(own) > 1):
        ground = shapely.make_valid(holes[place] if place else nest.sheet.polygon)
        areas = shapely.make_valid(np.array([nest.parts[k].outer.polygon for k in own], dtype=object))
        grounds[place] = Metal(ground, own, areas, strip_mm, web_mm)
    return grounds, where
