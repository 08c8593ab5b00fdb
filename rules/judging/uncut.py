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

from .islands import Islands
from .metal import Metal
from .placement import host_holes, places
from .strips import Strips


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


class Uncut:
    """What is left of the metal of one place while its parts are cut: each at the cut that `at` (parts,) says.

    Parts that are never cut have a number that is larger than all.
    """

    def __init__(self, metal: Metal, at: Ints) -> None:
        self.metal = metal
        self.out = np.zeros(len(metal.parts), dtype=bool)
        self.told = np.zeros(len(metal.parts), dtype=bool)
        self.strips, self.islands = Strips(metal, at), Islands(metal, at, self.out)

    def cut(self, p: int) -> Iterator[tuple[str, list[int], list[int]]]:
        """Take part `p` out; what lies badly then, as (kind, out, left) in numbers of this place.

        The first of `left` lies badly. A part that was told is not told again.
        """
        self.out[p] = True
        self.islands.take_out(p)
        for kind, out, left in chain(self.strips.after(p, self.out, self.told), self.islands.after(p)):
            if not self.told[left[0]]:
                self.told[left[0]] = True
                yield kind, out, left


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
    uncut = {
        place: Uncut(ground, np.array([first.get(part, len(order) + 1) for part in ground.parts]))
        for place, ground in grounds.items()
    }
    for part, k in first.items():
        if (here := uncut.get(where[part])) is None:
            continue
        parts = here.metal.parts
        for kind, out, left in here.cut(in_place[part]):
            yield Cutting(k, kind, tuple(parts[m] for m in out), tuple(parts[m] for m in left))


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
