"""Links: paths through waste on which the torch may stay on from the end of one outer contour to the next."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Floats, Ints, Rows
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import tolerance_mm

from .facts import Facts, LinkPath

# A link leads from where the torch leaves one part to where it joins another, straight or, where no straight one is
# free between two parts, round one corner. It keeps off all metal of parts as the cut itself does; off third
# contours, and the leads to them, by so much that no kerf meets another; and off what the torch has just burnt, but
# for the first kerf. It runs along nothing of the ring that it leads to, and parts that stand a kerf from another
# have none: some of their ring may be burnt already. No two links that a plan could use both come near each other, so
# that nobody has to remember which have been burnt.

_OFF_MM = 0.01
"""What chords may make of a distance."""
_OWN_KERFS = 1.0
"""Kerfs from its beginning in which a link may be in what the torch has just burnt: it leaves at 30° or more."""
_ALONG_KERFS = 2.0
"""Kerfs before its end in which a link may be as near to the contour that it reaches as the cut round that is."""
_AT_ONCE = 20_000
_NOBODY = -1
_CHORD_MM = 0.02


@dataclass(frozen=True, slots=True)
class LinkOptions:
    """The longest link, mm; the kerf, and the metal between a pierced hole and a kerf."""

    longest_mm: float
    kerf_mm: float
    splash_mm: float = 0.0


def with_links(facts: Facts, options: LinkOptions | None, cut_before: Iterable[Cut] = ()) -> Facts:
    """The facts with all links that are no longer than the options say; those of `cut_before` are in the way, too.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> from kerfwise.encoder.candidates import LeadOptions, build_candidates
    >>> from kerfwise.encoder.facts import FactOptions, compute_facts
    >>> two = nest(400, 100, part("A", rect(10, 10, 80, 80)), part("B", rect(102, 10, 80, 80)))
    >>> ways = build_candidates(two, LeadOptions(entries=4))
    >>> facts = with_links(compute_facts(two, FactOptions(), ways), LinkOptions(20.0, 1.5))
    >>> sorted({facts.candidates[link.leave[0]].contour for link in facts.links})
    [0, 1]
    """
    if options is None or options.longest_mm <= 0:
        return facts
    return replace(facts, links=tuple(_links(facts, options, tuple(cut_before))))


def _links(facts: Facts, options: LinkOptions, cut_before: Sequence[Cut]) -> list[LinkPath]:
    alone = _alone(facts, options.kerf_mm)
    leave, reach = _places(facts, alone, _leaving, _leads), _places(facts, alone, _joining, _lead_out)
    if not len(leave.contour):
        return []
    tree = shapely.STRtree(shapely.points(reach.at))
    one, other = tree.query(shapely.points(leave.at), "dwithin", distance=options.longest_mm)
    parts = np.array(facts.nest.owners, dtype=np.int64)
    of, to = leave.contour[one], reach.contour[other]
    apart = (parts[of] != parts[to]) & (facts.parent[of] == facts.parent[to])
    gap = np.hypot(*(leave.at[one] - reach.at[other]).T)
    kept = np.flatnonzero(apart & (gap > options.kerf_mm))
    kept = kept[np.lexsort((other[kept], one[kept]))]
    one, other = one[kept], other[kept]
    in_the_way = _InTheWay.of(facts, options, cut_before)

    def free(links: LinkLines) -> LinkLines:
        clear = np.zeros(len(links), dtype=np.bool_)
        for begin in range(0, len(links), _AT_ONCE):
            rows = slice(begin, begin + _AT_ONCE)
            clear[rows] = in_the_way.clear(leave, reach, links.take(np.arange(len(links))[rows]))
        clear[clear] = _off_tabs(facts, links.take(clear), options.kerf_mm)
        return links.take(clear)

    lines = LinkLines.straight(leave, one, reach, other)
    straight = free(lines)
    bent = round_corners(lines, straight, leave, reach, options.longest_mm, options.kerf_mm, free)
    unmet = _without_meetings(leave, reach, (straight, bent), options.kerf_mm)
    return [
        LinkPath(leave.members[i], reach.members[j], tuple(_xy(at) for at in points))
        for links, kept in zip((straight, bent), unmet, strict=True)
        for i, j, points in zip(links.one[kept].tolist(), links.other[kept].tolist(), links.points[kept], strict=True)
    ]


def _off_tabs(facts: Facts, links: LinkLines, kerf_mm: float) -> Bools:
    """Whether links leave the metal that tabs hang on."""
    tabs = {tab.at: tab.width_mm for candidate in facts.candidates for tab in candidate.tabs}
    if not tabs or not len(links):
        return np.full(len(links), True)
    near = shapely.union_all(shapely.buffer(shapely.points(list(tabs)), [w / 2 + 3 * kerf_mm for w in tabs.values()]))
    return np.asarray(~shapely.intersects(links.lines, near))


def _xy(at: Floats) -> Point:
    return float(at[0]), float(at[1])


def _leaving(candidate: Candidate) -> tuple[Point, object]:
    return candidate.end, (candidate.end, candidate.pierce)


def _joining(candidate: Candidate) -> tuple[Point, object]:
    at = candidate.join
    lead_mm = 0.0 if candidate.lead_in is None else candidate.lead_in.length_mm
    return at, (at, candidate.end, round(lead_mm, 6), candidate.edge_start)


def _alone(facts: Facts, kerf_mm: float) -> frozenset[int]:
    """Outer contours that no other part's contour is so near to that the cuts round both run along each other."""
    nest, near_mm = facts.nest, kerf_mm + 2 * tolerance_mm(kerf_mm) + _OFF_MM
    closed = [k for k, contour in enumerate(nest.contours) if contour.encloses]
    lines = [nest.contours[k].line for k in closed]
    met = {
        closed[a]
        for a, b in shapely.STRtree(lines).query(lines, "dwithin", distance=near_mm).T.tolist()
        if nest.contours[closed[a]].part != nest.contours[closed[b]].part
    }
    return frozenset(k for k in closed if nest.contours[k].kind == "outer" and k not in met)


def _places(
    facts: Facts,
    alone: Collection[int],
    place: Callable[[Candidate], tuple[Point, object]],
    leads: Callable[[Candidate], list[shapely.LineString]],
) -> Places:
    members: dict[tuple[int, object], list[int]] = defaultdict(list)
    at: dict[tuple[int, object], Point] = {}
    for number, candidate in enumerate(facts.candidates):
        if candidate.contour in alone and not candidate.tabs and candidate.span is None:
            point, like = place(candidate)
            key = candidate.contour, like
            members[key].append(number)
            at[key] = point
    contour = np.array([contour for contour, _ in members], dtype=np.int64)
    return Places(
        [tuple(of) for of in members.values()],
        contour,
        np.array(list(at.values()), dtype=np.float64).reshape(-1, 2),
        np.array([shapely.union_all(leads(facts.candidates[of[0]])) for of in members.values()], dtype=object),
    )


@dataclass(frozen=True, eq=False, slots=True)
class _InTheWay:
    """What links keep off: metal of parts, contours, leads and pierces (`of_lead`, `of_hole`: of which contour)."""

    options: LinkOptions
    sheet: shapely.Geometry
    metal: shapely.STRtree
    rings: shapely.STRtree
    leads: shapely.STRtree
    of_lead: Ints
    holes: shapely.STRtree
    of_hole: Ints

    @staticmethod
    def of(facts: Facts, options: LinkOptions, cut_before: Sequence[Cut]) -> _InTheWay:
        """The leads of all candidates, and those that were burnt before anything is planned."""
        nest = facts.nest
        burning = [c for c in facts.candidates if nest.contours[c.contour].shapes_part]
        leads = [(c.contour, line) for c in burning for line in _leads(c)]
        leads += [(_NOBODY, line) for cut in cut_before for line in _lines((cut.lead_in, cut.lead_out))]
        holes = [(c.contour, c.pierce) for c in burning if not c.edge_start]
        holes += [(_NOBODY, cut.pierce) for cut in cut_before if not cut.linked]
        metal = shapely.make_valid(np.array([part.polygon for part in nest.parts], dtype=object))
        sheet = shapely.buffer(shapely.make_valid(nest.sheet.polygon), -options.kerf_mm / 2)
        shapely.prepare(metal)
        shapely.prepare(sheet)
        return _InTheWay(
            options,
            sheet,
            shapely.STRtree(metal),
            shapely.STRtree([c.line for c in nest.without_scrap.contours]),
            shapely.STRtree([line for _, line in leads]),
            np.array([contour for contour, _ in leads], dtype=np.int64),
            shapely.STRtree([shapely.Point(at) for _, at in holes]),
            np.array([contour for contour, _ in holes], dtype=np.int64),
        )

    def clear(self, leave: Places, reach: Places, links: LinkLines) -> Bools:
        """Which lines from places that are left to places that are reached are links."""
        kerf_mm = self.options.kerf_mm
        of, to, lines = leave.contour[links.one], reach.contour[links.other], links.lines
        clear = np.asarray(shapely.covers(self.sheet, lines))
        near_mm = max(kerf_mm / 2 - _OFF_MM - _CHORD_MM, 0.0)
        clear[self.metal.query(lines, "dwithin", distance=near_mm)[0]] = False
        for tree, whose, off_mm in (
            (self.rings, np.arange(len(self.rings)), 1.5 * kerf_mm),
            (self.leads, self.of_lead, kerf_mm),
            (self.holes, self.of_hole, kerf_mm + self.options.splash_mm),
        ):
            rows = np.flatnonzero(clear)
            row, k = tree.query(lines[rows], "dwithin", distance=off_mm)
            row = rows[row]
            clear[row[(whose[k] != of[row]) & (whose[k] != to[row])]] = False
        rows = np.flatnonzero(clear)
        clear[rows] = self._off_own(leave, reach, links.take(rows))
        return clear

    def _off_own(self, leave: Places, reach: Places, links: LinkLines) -> Bools:
        """Which links part from what has just been burnt, and keep off the contour that they reach and its lead-out."""
        kerf_mm = self.options.kerf_mm
        reached = self.rings.geometries[reach.contour[links.other]]
        onward, inward = links.onward(_OWN_KERFS * kerf_mm), links.inward(_OWN_KERFS * kerf_mm)
        clear = shapely.distance(onward, self.rings.geometries[leave.contour[links.one]]) >= kerf_mm - _OFF_MM
        clear &= _far(onward, leave.leads[links.one], kerf_mm / 2)
        if links.bent:  # a corner leaves the choice: the way that is burnt next has metal on both sides
            clear &= shapely.distance(inward, reached) >= kerf_mm - _OFF_MM
        along = links.inward(_ALONG_KERFS * kerf_mm)
        clear &= shapely.distance(along, reached) >= kerf_mm / 2 + tolerance_mm(kerf_mm) + _CHORD_MM
        return np.asarray(clear & _far(inward, reach.leads[links.other], kerf_mm / 2))


def _far(lines: Lines, others: Lines, least_mm: float) -> Bools:
    """Whether each line is so far from the other; what is empty is far from everything."""
    return np.asarray(~(shapely.distance(lines, others) < least_mm))


def _leads(candidate: Candidate) -> list[shapely.LineString]:
    """The lead-in, if there is one, then the lead into the waste at the end."""
    return [*_lines((candidate.lead_in,)), *_lead_out(candidate)]


def _lead_out(candidate: Candidate) -> list[shapely.LineString]:
    """The lead into the waste at the end, if there is one."""
    return _lines((candidate.lead_out if candidate.leaves else None,))


def _lines(leads: Iterable[Curve | None]) -> list[shapely.LineString]:
    return [lead.line(_CHORD_MM) for lead in leads if lead is not None and lead.segments]


def _without_meetings(leave: Places, reach: Places, groups: Sequence[LinkLines], kerf_mm: float) -> list[Ints]:
    """The numbers of links in each group, of which no two can meet in one plan.

    Straight ones go before those round a corner, and the shorter before the longer: a corner takes none of them away.
    """
    one = np.concatenate([links.one for links in groups])
    other = np.concatenate([links.other for links in groups])
    of, to = leave.contour[one], reach.contour[other]
    lines = np.concatenate([links.lines for links in groups])
    onward = np.concatenate([links.onward(_OWN_KERFS * kerf_mm) for links in groups])
    tree = shapely.STRtree(lines)
    rivals: dict[int, set[int]] = defaultdict(set)
    entered, left = [frozenset(m) for m in reach.members], [frozenset(m) for m in leave.members]
    for start in range(0, len(lines), _AT_ONCE // 10):
        p, q = tree.query(lines[start : start + _AT_ONCE // 10], "dwithin", distance=kerf_mm)
        p = p + start
        both = (of[p] != of[q]) & (to[p] != to[q]) & ~((of[p] == to[q]) & (to[p] == of[q])) & (p != q)
        p, q = p[both], q[both]
        chained = (of[p] == to[q]) | (to[p] == of[q])
        apart = ~chained
        rows = np.flatnonzero(of[p] == to[q])  # q leads to where p leaves: by the same way of cutting it alone
        same = np.array([not left[i].isdisjoint(entered[j]) for i, j in zip(one[p[rows]], other[q[rows]], strict=True)])
        rows = rows[same] if len(rows) else rows
        apart[rows] = shapely.distance(onward[p[rows]], lines[q[rows]]) < kerf_mm / 2
        for a, b in zip(p[apart].tolist(), q[apart].tolist(), strict=True):
            rivals[a].add(b)
            rivals[b].add(a)
    length_mm = np.concatenate([links.length_mm for links in groups])
    kept: set[int] = set()
    bent = np.concatenate([np.full(len(links), links.bent) for links in groups])
    for k in np.lexsort((np.arange(len(lines)), length_mm, bent)).tolist():
        if rivals[k].isdisjoint(kept):
            kept.add(k)
    first = np.cumsum([0, *(len(links) for links in groups)])
    every = np.array(sorted(kept), dtype=np.int64)
    return [every[(every >= a) & (every < b)] - a for a, b in pairwise(first)]


# Links as arrays: the places that they join, and the points of their ways.

Lines = NDArray[np.object_]


@dataclass(frozen=True, eq=False, slots=True)
class Places:
    """Candidates that no link tells apart, k places: their contour, and where links begin or end, (k, 2).

    `leads` (k,) are those of the place's own contour that a link from or to it keeps off, as one shape each.
    """

    members: list[tuple[int, ...]]
    contour: Ints
    at: Floats
    leads: Lines


@dataclass(frozen=True, eq=False, slots=True)
class LinkLines(Rows):
    """k links from the places `one` (k,) to the places `other` (k,), each along `points` (k, p, 2), p 2 or 3."""

    one: Ints
    other: Ints
    points: Floats

    @staticmethod
    def straight(leave: Places, one: Ints, reach: Places, other: Ints) -> LinkLines:
        """Straight ones."""
        return LinkLines(one, other, np.stack([leave.at[one], reach.at[other]], axis=1))

    def round(self, corner: Floats) -> LinkLines:
        """The same by way of a corner each, (k, 2)."""
        return LinkLines(self.one, self.other, np.stack([self.points[:, 0], corner, self.points[:, -1]], axis=1))

    @property
    def bent(self) -> bool:
        """Whether they have corners."""
        return bool(self.points.shape[1] > 2)

    @property
    def lines(self) -> Lines:
        """Each as a line."""
        return _link_lines(self.points)

    @property
    def length_mm(self) -> Floats:
        """How long each is."""
        steps = np.diff(self.points, axis=1)
        return np.asarray(np.hypot(steps[..., 0], steps[..., 1]).sum(axis=1))

    def onward(self, less_mm: float) -> Lines:
        """Each without its first `less_mm`: its first straight piece is shortened, to its very end at the most."""
        return _link_lines(_trimmed(self.points, less_mm))

    def inward(self, less_mm: float) -> Lines:
        """The same from the other end."""
        return _link_lines(_trimmed(self.points[:, ::-1], less_mm))


def _link_lines(points: Floats) -> Lines:
    lines: Lines = shapely.linestrings(points)
    return lines


def _trimmed(points: Floats, less_mm: float) -> Floats:
    begin, then = points[:, 0], points[:, 1]
    length_mm = np.hypot(*(then - begin).T)
    share = np.minimum(less_mm / np.maximum(length_mm, 1e-9), 1.0)[:, None]
    return np.concatenate([(begin + share * (then - begin))[:, None], points[:, 1:]], axis=1)


# Links round a corner: two straight pieces, between parts that no straight link joins.

_WAYS = 12
"""Ways from one part to another that corners are tried for: the nearest ends and joins."""
_ALONG = (0.5, 1.5, 3.0, 5.0)
_ASIDE = (1.5, 2.5, 4.0, 6.0)
"""Corners near one of the ends: so many kerfs along the straight line, and so many beside it."""
_SHARES = ((0.25, 0.15), (0.25, 0.3), (0.5, 0.15), (0.5, 0.3), (0.5, 0.45), (0.75, 0.15), (0.75, 0.3))
"""Other corners: shares of the straight line, along it and beside it."""
_CLEAR_KERFS = 1.1
"""Both pieces are longer: the first kerf of a link may lie in what was just burnt."""


def round_corners(
    lines: LinkLines,
    straight: LinkLines,
    leave: Places,
    reach: Places,
    longest_mm: float,
    kerf_mm: float,
    free: Callable[[LinkLines], LinkLines],
) -> LinkLines:
    """The shortest free ways round one corner, between contours that have no straight link.

    `lines` and `straight`: all straight lines, and those that are free. `leave` and `reach`: the places that they join.
    `longest_mm` and `kerf_mm`: the longest link, and the width of the kerf. `free`: leaves out the links that something
    is in the way of.
    """
    pairs = lines.take(_nearest(lines, straight, leave, reach))
    corners = _corners(pairs.points[:, 0], pairs.points[:, 1], kerf_mm)
    way, number = np.nonzero(np.isfinite(corners[..., 0]))
    bent = pairs.take(way).round(corners[way, number])
    short = bent.length_mm <= longest_mm
    found = free(bent.take(short))
    # of each way the shortest; of ways as long the first
    order = np.lexsort((np.arange(len(found)), found.length_mm, found.other, found.one))
    same = (np.diff(found.one[order]) == 0) & (np.diff(found.other[order]) == 0)
    return found.take(np.sort(order[np.append(True, ~same)[: len(order)]]))


def _nearest(lines: LinkLines, straight: LinkLines, leave: Places, reach: Places) -> Ints:
    """The numbers of the lines between contours without a straight link, the nearest few of each two contours."""
    n = int(max(leave.contour.max(initial=0), reach.contour.max(initial=0))) + 1
    of = leave.contour[lines.one] * n + reach.contour[lines.other]
    joined = np.unique(leave.contour[straight.one] * n + reach.contour[straight.other])
    rows = np.flatnonzero(~np.isin(of, joined))
    rows = rows[np.lexsort((rows, lines.length_mm[rows], of[rows]))]
    begins = np.flatnonzero(np.append(True, np.diff(of[rows]) != 0)[: len(rows)])
    rank = np.arange(len(rows)) - np.repeat(begins, np.diff(np.append(begins, len(rows))))
    return np.sort(rows[rank < _WAYS])


def _corners(begin: Floats, end: Floats, kerf_mm: float) -> Floats:
    """Where k links could turn, (k, c, 2): nan where a piece is too short, or the turn more than a right angle."""
    step = end - begin
    gap_mm = np.hypot(*step.T)[:, None]
    along = step / gap_mm
    aside = np.column_stack([-along[:, 1], along[:, 0]])
    near = [(a * kerf_mm, side * b * kerf_mm) for a in _ALONG for b in _ASIDE for side in (1, -1)]
    from_begin, beside = (np.array(values)[None] for values in zip(*near, strict=True))
    shares = [(t, side * h) for t, h in _SHARES for side in (1, -1)]
    share, width = (np.array(values)[None] for values in zip(*shares, strict=True))
    x = np.concatenate([from_begin + 0 * gap_mm, gap_mm - from_begin, share * gap_mm], axis=1)
    y = np.concatenate([beside + 0 * gap_mm, beside + 0 * gap_mm, width * gap_mm], axis=1)
    corners: Floats = begin[:, None] + x[..., None] * along[:, None] + y[..., None] * aside[:, None]
    short = np.minimum(np.hypot(x, y), np.hypot(gap_mm - x, y)) < _CLEAR_KERFS * kerf_mm
    corners[short | (x * (gap_mm - x) < y * y)] = np.nan
    return corners
