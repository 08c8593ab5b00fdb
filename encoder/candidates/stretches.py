"""Ways along stretches of contours that are cut before these are finished, and what they leave; rounds cut in two."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.arrays import unique_pairs
from kerfwise.encoder.cut import Cut, Span, Stretch
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import tolerance_mm
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.torch_path import compensated

from .candidate import Candidate, CommonOptions, LeadOptions
from .common_edges import CommonEdges, common_edges, rounds_at_corners
from .common_paths import Run, along_the_rest, states
from .older_kerfs import OlderKerfs

# A contour may be cut in several stretches: some of it now, as a part of a way along its neighbours, the rest later.
#
# Such a way is one item of the order, a contour of kind `stretch`. The contours that it runs along are cut along what
# it leaves of them, each later, from one old kerf to another; until then their metal holds where it is uncut.

_MEETS_MM = 1e-6


def way_of(nest: Nest, name: str, along: Sequence[Stretch], kerf_mm: float) -> Contour:
    """The way of that name along stretches, in order; a straight link leads from each to the next.

    Examples
    --------
    >>> from kerfwise.encoder.cut import Span
    >>> from kerfwise.rules.case import nest, part, rect
    >>> two = nest(300, 100, part("A", rect(10, 10, 80, 60)), part("B", rect(100, 10, 80, 60)))
    >>> along = [
    ...     Stretch("A.outer", Span((10, 9), (90, 9)), "ccw"),
    ...     Stretch("B.outer", Span((100, 9), (180, 9)), "ccw"),
    ... ]
    >>> way_of(two, "way1", along, 2.0).curve.as_rows()
    [[10.0, 9.0], [90.0, 9.0], [100.0, 9.0], [180.0, 9.0]]
    """
    rows: list[list[float]] = []
    for stretch in along:
        more = _piece(nest.contour(stretch.contour), stretch, kerf_mm).vertices.tolist()
        more[-1][2] = 0.0
        if rows and max(abs(rows[-1][0] - more[0][0]), abs(rows[-1][1] - more[0][1])) <= _MEETS_MM:
            rows.pop()
        rows += more
    return Contour(name, "", "stretch", Curve(np.array(rows), closed=False), along=tuple(along))


def _piece(contour: Contour, stretch: Stretch, kerf_mm: float) -> Curve:
    ring = compensated(contour, kerf_mm).towards(stretch.direction)
    begin_mm, end_mm = ring.project(stretch.span.begin)[0], ring.project(stretch.span.end)[0]
    return ring.between(begin_mm, (end_mm - begin_mm) % ring.length_mm)


def run_of(contour: Contour, stretch: Stretch, kerf_mm: float) -> Run:
    """Where a stretch begins on the torch's ring as it is drawn, and how long it is, mm."""
    ring = compensated(contour, kerf_mm)
    begin_mm, end_mm = ring.project(stretch.span.begin)[0], ring.project(stretch.span.end)[0]
    if (stretch.direction == "ccw") != contour.curve.is_ccw:
        begin_mm, end_mm = end_mm, begin_mm
    return float(begin_mm), float((end_mm - begin_mm) % ring.length_mm)


@dataclass(frozen=True, eq=False, slots=True)
class StretchWays:
    """The nest with its ways along stretches, and all candidates.

    `rest` has those of the contours of the nest, sorted by contour, `ways` those of the ways; `met` is what all of them
    meet of older kerfs, numbered in that order, None where nobody asks.
    """

    nest: Nest
    rest: tuple[Candidate, ...]
    ways: tuple[Candidate, ...]
    met: OlderKerfs | None

    @property
    def count(self) -> int:
        """How many candidates there are in all."""
        return len(self.rest) + len(self.ways)


def past_ways(nest: Nest, begun: Iterable[Cut], kerf_mm: float) -> tuple[Contour, ...]:
    """The ways that were burnt before a stop, from their stretches."""
    along: dict[str, list[Stretch]] = {}
    for cut in begun:
        if cut.span is not None and cut.contour in nest.index:
            along.setdefault(cut.way, []).append(Stretch(cut.contour, cut.span, cut.direction))
    return tuple(way_of(nest, name, stretches, kerf_mm) for name, stretches in along.items())


def begun_by(ways: Iterable[Contour]) -> dict[str, tuple[str, ...]]:
    """Contour id → the names of the ways along stretches of it."""
    found: dict[str, tuple[str, ...]] = {}
    for way in ways:
        for name in dict.fromkeys(stretch.contour for stretch in way.along):
            found[name] = (*found.get(name, ()), way.id)
    return found


def rest_candidates(
    nest: Nest, options: LeadOptions, common: CommonOptions, gone: Collection[int] = ()
) -> list[Candidate]:
    """The ways along what is left of each contour that the nest's ways begin: from one old kerf to another.

    Contours that ways begin and that stand a kerf apart share the edge between them: it is cut with whichever of them
    is cut first. What is `gone` was cut before. A contour of which several pieces are left has none.
    """
    begun = begun_by(nest.stretches)
    numbers = [nest.index[name] for name in begun]
    shared = common_edges(nest, numbers, options.kerf_mm, common)
    of = {k: {**shared.of.get(k, {}), **_runs(nest, k, begun, options.kerf_mm)} for k in numbers}
    edges = CommonEdges(of, {k: shared.junctions.get(k, ()) for k in numbers})
    found: list[Candidate] = []
    for number in sorted({*numbers} - {*gone}):
        ring = compensated(nest.contours[number], options.kerf_mm)
        first = {nest.index[name] for name in begun[nest.contours[number].id]} | (of[number].keys() & set(gone))
        for out, run in states(ring, of[number], options.kerf_mm, edges.junctions[number], first):
            found += along_the_rest(nest, number, out, edges, run, options, common)
    return found


def _runs(nest: Nest, number: int, begun: Mapping[str, Sequence[str]], kerf_mm: float) -> dict[int, tuple[Run, ...]]:
    contour = nest.contours[number]
    found: dict[int, tuple[Run, ...]] = {}
    for name in begun[contour.id]:
        along = (stretch for stretch in nest.contour(name).along if stretch.contour == contour.id)
        found[nest.index[name]] = tuple(run_of(contour, stretch, kerf_mm) for stretch in along)
    return found


def way_candidates(
    nest: Nest, number: int, leads: Sequence[tuple[int, Candidate]], options: LeadOptions
) -> list[tuple[int, Candidate]]:
    """A way from either end, with the leads of candidates that join its first contour, or its last, right there.

    Candidates have numbers: each way has that of its lead, and they come in this order.
    """
    way = nest.contours[number]
    allowed = options.directions["outer"]
    backwards = tuple(stretch.reversed for stretch in reversed(way.along))
    found: list[tuple[int, Candidate]] = []
    for onwards, along in ((True, way.along), (False, backwards)):
        if any(stretch.direction not in allowed for stretch in along):
            continue
        curve = way.curve if onwards else way.curve.reversed()
        begin, end = curve.start, curve.end
        for k, lead in leads:
            if lead.direction == along[0].direction and _joins(lead, nest.index[along[0].contour], begin):
                lead_mm = 0.0 if lead.lead_in is None else lead.lead_in.length_mm
                item = replace(
                    lead,
                    contour=number,
                    entry_mm=0.0 if onwards else way.curve.length_mm,
                    direction="ccw" if onwards else "cw",
                    lead_out=Curve.of([end], closed=False),
                    end=end,
                    cut_mm=lead_mm + curve.length_mm,
                    leaves=False,
                    out=(),
                    still_in=(),
                )
                found.append((k, item))
    return sorted(found, key=lambda row: row[0])


def _joins(lead: Candidate, contour: int, at: Point) -> bool:
    x, y = lead.join
    return lead.contour == contour and lead.span is None and max(abs(x - at[0]), abs(y - at[1])) <= _MEETS_MM


def with_stretches(
    nest: Nest,
    ways: Sequence[Contour],
    candidates: Sequence[Candidate],
    met: OlderKerfs | None,
    options: LeadOptions,
    common: CommonOptions,
    gone: Collection[int] = (),
    past: Sequence[Contour] = (),
) -> StretchWays | str:
    """The nest with these ways, and the candidates that are then left of those that it has without them.

    Ways that are `past` were burnt before a stop, and so were contours that are `gone`. In place of all that the name
    of a way that has no lead, would leave a contour in several pieces, or has a link over all leads of another contour.
    Raises InputError if a contour that was begun before the stop cannot be finished in one go.
    """
    made = replace(nest, stretches=(*ways, *past))
    begun = {made.index[name] for name in begun_by(made.stretches)}
    along = rest_candidates(made, options, common, gone)
    leads = [(k, c) for k, c in enumerate(candidates) if c.contour in begun]
    others = [(k, c) for k, c in enumerate(candidates) if c.contour not in begun]
    items: list[tuple[int, Candidate]] = []  # with the number of the candidate that each has its lead of
    for way in ways:
        number, line = made.index[way.id], shapely.MultiLineString(links_in(way))
        found = way_candidates(made, number, leads, options)
        free = [(k, c) for k, c in others if not _in_the_way(c, line, options)]
        mine = {made.index[stretch.contour] for stretch in way.along}
        rest = {c.contour for c in along}
        if not found or not mine <= rest or {c.contour for _, c in free} != {c.contour for _, c in others}:
            return way.id
        items += found
        others = free
    if missing := begun - {*gone} - {c.contour for c in along}:
        raise InputError(
            f"{made.contours[min(missing)].id} was begun before the stop, and no stretch of it is left that can be cut "
            "in one go: cut it by hand, or from the old program"
        )
    made = replace(nest, stretches=tuple(ways))
    rows = sorted([*((c, k) for k, c in others), *((c, -1) for c in along)], key=_by_contour)
    rest_of, ways_in = tuple(c for c, _ in rows), tuple(c for _, c in items)
    if met is None:
        return StretchWays(made, rest_of, ways_in, None)
    old = [k for _, k in rows] + [k for k, _ in items]
    return StretchWays(made, rest_of, ways_in, _met(made, met, old, [c.contour for c in (*rest_of, *ways_in)]))


def _by_contour(row: tuple[Candidate, int]) -> int:
    return row[0].contour


def _in_the_way(candidate: Candidate, burnt: shapely.Geometry, options: LeadOptions) -> bool:
    """Whether a pierce, or a lead, comes so near to the links of a way that they could meet."""
    leads = [lead.line() for lead in (candidate.lead_in, candidate.lead_out) if lead is not None and lead.segments]
    reach_mm = options.kerf_mm + (options.splash_mm or 0.0)
    return any(shapely.dwithin(shape, burnt, reach_mm) for shape in (shapely.Point(candidate.pierce), *leads))


def _met(nest: Nest, met: OlderKerfs, old: Sequence[int], contour: Sequence[int]) -> OlderKerfs:
    """What candidates meet, by new numbers: `old` were those they had, or whose lead they have, -1 for none.

    What meets the kerf of a contour meets that of the way along it.
    """
    new: dict[int, list[int]] = {}
    for number, k in enumerate(old):
        new.setdefault(k, []).append(number)
    ways = {nest.index[name]: [nest.index[way] for way in of] for name, of in begun_by(nest.stretches).items()}
    rings = [
        (number, other)
        for k, ring in met.rings.tolist()
        for number in new.get(k, ())
        for other in (ring, *ways.get(ring, ()))
        if other != contour[number]
    ]
    leads = [
        (later, earlier)
        for a, b in met.leads.tolist()
        for later in new.get(a, ())
        for earlier in new.get(b, ())
        if contour[later] != contour[earlier]
    ]
    return OlderKerfs(*(unique_pairs(np.array(rows, dtype=np.int64).reshape(-1, 2)) for rows in (rings, leads)))


def links_in(way: Contour) -> list[tuple[Point, Point]]:
    """From where to where each link of a way leads, in order."""
    return [(one.span.end, other.span.begin) for one, other in pairwise(way.along)]


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
