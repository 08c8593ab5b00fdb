"""Rounds cut in two: long strips in halves, parts that hang by a last stretch, pairs whose common edge comes last."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from kerfwise.encoder.cut import Span, Stretch
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import tolerance_mm
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.torch_path import compensated

from .candidate import Candidate, CommonOptions
from .common_edges import common_edges, rounds_at_corners
from .common_paths import Run
from .older_kerfs import OlderKerfs
from .stretches import way_of

# Half of a strip's round runs from the middle of one long side round a short side to the middle of the other, so that
# both long sides are begun, and the strip does not bend to one side. A last stretch is a straight piece of the round
# right before the place where the torch joined it: it holds the part until all others of the zone hang by theirs. Two
# parts a kerf apart are cut round together, up to a last stretch of each at one end of the edge between them. Whichever
# of the two is cut first then has that edge in its last stretch, while both still hang.

_ROUNDS = 4.0
"""A round is so many times as long as the last stretch of it, at the least."""
_FAR_MM = 100.0
"""Places this far from the sheet's edge, or further, are alike."""
_NEAR_SHARE = 0.1
"""Of the sides: so near the middle of a long side all places are alike."""
_LEAST_KERFS = 4.0
"""A last stretch of one of a pair is so many kerfs long, at the least."""
_SAME_MM = 1e-3
HALF, MOST = "half", "most"
"""How a contour is cut in two: as a strip, or all of it but a last stretch; one of a pair has the other's id."""


@dataclass(frozen=True, slots=True)
class SplitOptions:
    """Strips whose sides have this ratio, or more, are cut in halves; of other parts `last_mm` are cut last.

    Two parts a kerf apart are a pair where `shared` says how their edges may lie.
    """

    half_ratio: float | None = None
    last_mm: float | None = None
    shared: CommonOptions | None = None


def to_be_split(nest: Nest, kerf_mm: float, options: SplitOptions, left: Collection[str]) -> dict[str, str]:
    """Ids of the outer contours, of those that are `left`, that are cut in two, and how: HALF, MOST, or with which.

    Contours that another part stands within two kerfs of are cut in one round, but for pairs.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> plate = nest(600, 200, part("Strip", rect(10, 10, 400, 40)), part("A", rect(10, 80, 80, 60)))
    >>> to_be_split(plate, 1.5, SplitOptions(4.0, 20.0), [c.id for c in plate.contours])
    {'Strip.outer': 'half', 'A.outer': 'most'}
    """
    if options.half_ratio is None and options.last_mm is None:
        return {}
    lines = [contour.line for contour in nest.contours]
    near = shapely.STRtree(lines).query(lines, "dwithin", distance=2 * kerf_mm + 2 * tolerance_mm(kerf_mm)).T.tolist()
    beside: dict[str, set[str]] = {}
    for a, b in near:
        if nest.contours[a].part != nest.contours[b].part:
            beside.setdefault(nest.contours[a].id, set()).add(nest.contours[b].id)
    found: dict[str, str] = {}
    for part in nest.parts:
        name, long_enough = part.outer.id, part.outer.curve.length_mm >= _ROUNDS * (options.last_mm or math.inf)
        if name not in {*left}:
            continue
        if name in beside:
            (other, *more) = beside[name]
            if not more and long_enough and beside[other] == {name} and other in {*left}:
                found |= {name: other} if _shared_run(nest, name, other, kerf_mm, options.shared) else {}
            continue
        short_mm, long_mm = _sides_mm(part.outer)
        if options.half_ratio is not None and long_mm >= options.half_ratio * short_mm:
            found[name] = HALF
        elif long_enough:
            found[name] = MOST
    return {name: how for name, how in found.items() if how in (HALF, MOST) or how in found}


def _shared_run(nest: Nest, name: str, other: str, kerf_mm: float, shared: CommonOptions | None) -> Run | None:
    """The one edge that two outer contours share, on the torch's ring of the first as it is drawn."""
    if shared is None or nest.contour(other).kind != "outer":
        return None
    numbers = nest.index[name], nest.index[other]
    runs = common_edges(nest, numbers, kerf_mm, shared).of.get(numbers[0], {}).get(numbers[1], ())
    return runs[0] if len(runs) == 1 else None


def _sides_mm(contour: Contour) -> tuple[float, float]:
    corners = _box(contour)
    one, other = (math.dist(corners[k], corners[k + 1]) for k in (0, 1))
    return min(one, other), max(one, other)


def _box(contour: Contour) -> list[Point]:
    box = shapely.minimum_rotated_rectangle(contour.line)
    return [(float(x), float(y)) for x, y in shapely.get_coordinates(box)[:4]]


def split_ways(
    nest: Nest,
    split: Mapping[str, str],
    candidates: Sequence[Candidate],
    met: OlderKerfs | None,
    kerf_mm: float,
    options: SplitOptions,
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
    last_mm, begun = options.last_mm or 0.0, set[str]()
    for name, how in split.items():
        contour, own = nest.contour(name), of_contour[nest.index[name]]
        if name in begun:
            continue
        leads = [c for _, c in own]
        rooms_mm = [min(float(edge.distance(shapely.Point(c.join))), _FAR_MM) for c in leads]
        worth = [(meets[k], -round(room_mm, 3)) for (k, _), room_mm in zip(own, rooms_mm, strict=True)]
        if how == HALF:
            along = _half(contour, leads, worth, kerf_mm)
        elif how == MOST:
            along = _all_but(contour, leads, worth, kerf_mm, last_mm)
        else:
            along = _round_both(nest, (name, how), leads, worth, kerf_mm, options)
        if along:
            begun |= {one.contour for one in along}
            way = way_of(nest, f"{contour.part}.{how if how in (HALF, MOST) else 'pair'}", along, kerf_mm)
            yield replace(way, holds=how != HALF)


def _round_both(
    nest: Nest,
    pair: tuple[str, str],
    leads: Sequence[Candidate],
    worth: Sequence[tuple[int, float]],
    kerf_mm: float,
    options: SplitOptions,
) -> list[Stretch]:
    """Round both of a pair, from a lead of the first near one end of the edge that they share; nothing without one."""
    shared, last_mm = _shared_run(nest, *pair, kerf_mm, options.shared), options.last_mm or 0.0
    contour, other = (nest.contour(name) for name in pair)
    drawn = compensated(contour, kerf_mm)
    found = []
    for k, lead in enumerate(leads if shared is not None else ()):
        ends = [drawn.point_at(shared[0]), drawn.point_at(shared[0] + shared[1])] if shared is not None else []
        first, second = ends if (lead.direction == "ccw") == contour.curve.is_ccw else ends[::-1]
        ring, far = (compensated(one, kerf_mm).towards(lead.direction) for one in (contour, other))
        left_mm = (ring.project(lead.join)[0] - ring.project(second)[0]) % ring.length_mm
        if _LEAST_KERFS * kerf_mm <= left_mm <= ring.length_mm / _ROUNDS:
            leave, join = _over(ring, far, first, kerf_mm)
            end = far.point_at((far.project(second)[0] - last_mm) % far.length_mm)
            along = [
                Stretch(contour.id, Span(lead.join, leave), lead.direction),
                Stretch(other.id, Span(join, end), lead.direction),
            ]
            found.append((worth[k][0], round(abs(left_mm - last_mm), 3), k, along))
    return min(found)[3] if found else []


def _over(ring: Curve, far: Curve, at: Point, kerf_mm: float) -> tuple[Point, Point]:
    """Where one ring is left, and the other joined, at the end of their edge: straight on over it where they do so."""
    at_mm, far_mm = ring.project(at)[0], far.project(at)[0]
    before = next((b for b, mm in rounds_at_corners(ring, kerf_mm) if _is_at(ring, b + mm, at_mm)), None)
    after = next((b + mm for b, mm in rounds_at_corners(far, kerf_mm) if _is_at(far, b, far_mm)), None)
    if before is not None and after is not None:
        leave, join = ring.point_at(before), far.point_at(after)
        if abs(math.dist(leave, join) - kerf_mm) <= 2 * tolerance_mm(kerf_mm):
            return leave, join
    return ring.point_at(at_mm), far.point_at(far_mm)


def _is_at(ring: Curve, at_mm: float, other_mm: float) -> bool:
    return abs((at_mm - other_mm + ring.length_mm / 2) % ring.length_mm - ring.length_mm / 2) <= _SAME_MM


def _half(
    contour: Contour, leads: Sequence[Candidate], worth: Sequence[tuple[int, float]], kerf_mm: float
) -> list[Stretch]:
    """From a lead that joins near the middle of a long side to the middle of the other."""
    ring = compensated(contour, kerf_mm)
    corners = _box(contour)
    sides = [(corners[k], corners[(k + 1) % 4]) for k in range(4)]
    middles = [(np.array(a) + np.array(b)) / 2 for a, b in sorted(sides, key=lambda s: -math.dist(*s))[:2]]
    places = [ring.nearest(middle.tolist()) for middle in middles]
    near_mm = _NEAR_SHARE * math.dist(*sides[0]) + _NEAR_SHARE * math.dist(*sides[1])
    found = [
        (int(math.dist(lead.join, here) / near_mm), worth[k], k, there)
        for k, lead in enumerate(leads)
        for here, there in (places, places[::-1])
    ]
    if not found:
        return []
    _, _, k, there = min(found)
    return [Stretch(contour.id, Span(leads[k].join, there), leads[k].direction)]


def _all_but(
    contour: Contour, leads: Sequence[Candidate], worth: Sequence[tuple[int, float]], kerf_mm: float, last_mm: float
) -> list[Stretch]:
    """Nearly all round from a lead, up to the stretch that is left: best one that is straight."""
    found = []
    for k, lead in enumerate(leads):
        ring = compensated(contour, kerf_mm).towards(lead.direction)
        at_mm = ring.project(lead.join)[0]
        left = ring.between((at_mm - last_mm) % ring.length_mm, last_mm)
        bent_mm = left.length_mm - math.dist(left.start, left.end)
        found.append((worth[k][0], round(bent_mm, 3), worth[k][1], k, left.start))
    if not found:
        return []
    *_, k, end = min(found)
    return [Stretch(contour.id, Span(leads[k].join, end), leads[k].direction)]
