"""Ways along stretches of contours that are cut before these are finished, and what they leave of each contour."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.arrays import unique_pairs
from kerfwise.encoder.cut import Cut, Stretch
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.torch_path import compensated

from .candidate import Candidate, CommonOptions, LeadOptions
from .common_edges import CommonEdges, common_edges
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
