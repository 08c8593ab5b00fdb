"""Pierces and leads, and the kerfs of older cuts that they meet, by plain geometry."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Bools
from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.geometry.curve import Curve, lines_of
from kerfwise.encoder.geometry.tolerances import tolerance_mm
from kerfwise.encoder.nest import Contour, Nest

# Where the pierces and leads of a sequence of cuts lie, by plain geometry: the judging half of rule pierce.

Finding = tuple[tuple[int, ...], tuple[str, ...], str]
"""Positions of the cuts, contour ids, text."""

SLACK_MM = 0.03
"""Contours and leads are judged as chords within 0.01 mm each."""


class PiercePlaces:
    """The cuts (marks and scrap lines aside) of one sequence with the contours around them, each looked up in a tree.

    Linked cuts are not pierced: the torch is on already.

    A contour counts with all points that it encloses, whether shapely calls its ring valid or not.
    """

    def __init__(self, nest: Nest, cuts: CutSequence) -> None:
        self.nest = nest
        self.at = cuts.positions()
        self.finishing = {id(cut) for cut in cuts}
        self.cuts: list[tuple[int, Cut, Contour]] = [
            (k, cut, contour) for k, cut in cuts.burns if (contour := nest.contour(cut.contour)).shapes_part
        ]
        self.through = [c for c in nest.contours if c.shapes_part]
        self.rings = [c for c in nest.contours if c.encloses]
        self.pierced = [row for row in self.cuts if not row[1].linked]
        self.points: Any = shapely.points(np.array([cut.pierce for _, cut, _ in self.pierced]).reshape(-1, 2))
        self.lines = shapely.STRtree([c.line for c in self.through])
        self.enclosing = self._enclosing()

    def _enclosing(self) -> list[set[str]]:
        """For each cut that is pierced, the contours that its pierce lies inside."""
        rows, inside = shapely.STRtree([c.polygon for c in self.rings]).query(self.points, "intersects")
        found: list[set[str]] = [set() for _ in self.pierced]
        for row, k in zip(rows.tolist(), inside.tolist(), strict=True):
            found[row].add(self.rings[k].id)
        return found

    def misplaced(self) -> Iterator[Finding]:
        """Pierces on a part, outside the hole that they belong to, or inside the outline that they belong to."""
        for (k, cut, contour), inside in zip(self.pierced, self.enclosing, strict=True):
            if contour.kind == "hole" and contour.id not in inside:
                yield (k,), (contour.id,), f"{contour.id} (cut {k}) is pierced outside itself, at {spot(cut)}"
            elif contour.kind == "outer" and contour.id in inside:
                yield (k,), (contour.id,), f"{contour.id} (cut {k}) is pierced inside itself, at {spot(cut)}"
            elif contour.kind == "slit" and (self.nest.contour(contour.slot_of).kind == "hole") != (
                contour.slot_of in inside
            ):
                yield (
                    (k,),
                    (contour.id, contour.slot_of),
                    f"{contour.id} (cut {k}) is not pierced in the waste of {contour.slot_of}, at {spot(cut)}",
                )
            for outline in sorted(inside - {self.nest.part_of[contour.part].outer.id}):
                owner = self.nest.part_of[self.nest.contour(outline).part]
                if outline == owner.outer.id and not any(hole.id in inside for hole in owner.holes):
                    yield (
                        (k,),
                        (contour.id, outline),
                        f"{contour.id} (cut {k}) is pierced on part {owner.id}, at {spot(cut)}",
                    )

    def too_near(self, clearance_mm: float, let: Collection[int] = ()) -> Iterator[Finding]:
        """Pierces nearer to a contour than the clearance; those off the sheet and those `let` are none."""
        pierced = ~shapely.disjoint(self.nest.sheet.polygon, self.points)
        on_edge = shapely.distance(self.nest.sheet.polygon.boundary, self.points) <= SLACK_MM
        mask = np.array([k not in let or id(cut) not in self.finishing for k, cut, _ in self.pierced], dtype=np.bool_)
        rows = np.flatnonzero(pierced & ~on_edge & mask)
        for row, k in pairs_found(self.lines.query(self.points[rows], "dwithin", distance=clearance_mm - SLACK_MM)):
            (at, _, contour), near = self.pierced[rows[row]], self.through[k]
            if near is contour and contour.kind == "slit":
                continue
            gap = shapely.distance(self.points[rows[row]], near.line)
            text = f"{contour.id} (cut {at}) is pierced {gap:.2f} mm from {near.id}, less than {clearance_mm:g} mm"
            yield (at,), tuple(dict.fromkeys((contour.id, near.id))), text

    def over_dropped_waste(self) -> Iterator[Finding]:
        """Pierces in the waste of a hole that has been cut before."""
        for (k, _, contour), inside in zip(self.pierced, self.enclosing, strict=True):
            for hole in sorted(inside - {contour.id}):
                if self.nest.contour(hole).kind == "hole" and self.at.get(hole, k) < k:
                    text = (
                        f"{contour.id} (cut {k}) is pierced in the waste of {hole}, which has fallen out since cut "
                        f"{self.at[hole]}"
                    )
                    yield (self.at[hole], k), (contour.id, hole), text

    def crossing_leads(self) -> Iterator[Finding]:
        """Leads that cross a contour; their own they may touch where they join it."""
        leads = [(k, contour, *lead) for k, cut, contour in self.cuts for lead in _named_leads(cut)]
        drawn = lines_of([curve for *_, curve in leads], CHORD_MM)
        for row, j in pairs_found(self.lines.query(drawn, "intersects")):
            (k, contour, name, _), met = leads[row], self.through[j]
            if met is contour and (contour.kind == "slit" or not _strays(drawn[row], contour)):
                continue
            other = "its own contour" if met is contour else met.id
            ids = (contour.id,) if met is contour else (contour.id, met.id)
            yield (k,), ids, f"the {name} of {contour.id} (cut {k}) crosses {other}"


def _strays(lead: shapely.LineString, contour: Contour) -> bool:
    """Whether a lead goes to the side of its contour that is metal to be kept."""
    if contour.kind == "outer":
        return bool(shapely.intersects(contour.polygon.buffer(-SLACK_MM), lead))
    return not shapely.covers(contour.polygon.buffer(SLACK_MM), lead)


def pairs_found(found: Any) -> list[tuple[int, int]]:
    """What a tree found, in a fixed order."""
    rows, columns = found
    return sorted(zip(rows.tolist(), columns.tolist(), strict=True))


def spot(cut: Cut) -> str:
    """Where a cut is pierced, for sentences."""
    return f"({cut.pierce[0]:.2f}, {cut.pierce[1]:.2f})"


# Pierces and leads over the kerfs of older cuts, by plain geometry: the judging half of rule pierce, too.

CHORD_MM = 0.01


@dataclass(frozen=True, eq=False, slots=True)
class _BurntLine:
    """One line that an earlier cut has burnt along, or whose one side it has: its kerf reaches `reach_mm` from it.

    A link may leave beside a lead of the contour that it comes from (`is_own_lead`), as a lead-out may.
    """

    position: int
    moment: int
    contour: Contour
    what: str
    line: Any
    reach_mm: float
    is_own_lead: bool = False


@dataclass(frozen=True, eq=False, slots=True)
class _Lead:
    """A lead of a cut, without what lies beside its own contour."""

    position: int
    moment: int
    contour: Contour
    name: str
    line: Any


def leads_over_older_kerfs(
    nest: Nest, cuts: CutSequence, kerf_mm: float, splash_mm: float, let: Collection[int] = ()
) -> Iterator[Finding]:
    """Pierces nearer than half the kerf and the splash to the kerf of an earlier cut, and leads that cross one.

    The kerf of a contour reaches from it one kerf into its waste, that of a lead or a slit half a kerf to both sides. A
    part's own metal lies between its contours, so that they are not looked at against each other, but for slits. The
    cuts at the positions that are `let` may begin in an older kerf.
    """
    through = [(k, c, nest.contour(c.contour)) for k, c in cuts.burns if _burns(nest, c)]
    when = {id(c): cuts.moment(k, c) for k, c, _ in through}
    if not through:
        return
    burns = list(_burns_of(through, when, kerf_mm))
    tree = shapely.STRtree([burn.line for burn in burns])
    through_metal = _through_metal(nest, [cut for _, cut, _ in through])
    pierced = [
        row
        for row, holed in zip(through, through_metal.tolist(), strict=True)
        if holed and not row[1].linked and not (row[0] in let and when[id(row[1])] % 2 == 0)
    ]
    points = shapely.points(np.array([cut.pierce for _, cut, _ in pierced]).reshape(-1, 2))
    least_mm = kerf_mm / 2 + splash_mm
    reach_mm = np.array([burn.reach_mm for burn in burns])
    for row, b in pairs_found(tree.query(points, "dwithin", distance=kerf_mm + least_mm - SLACK_MM)):
        (k, cut, contour), burn = pierced[row], burns[b]
        gap_mm = float(shapely.distance(points[row], burn.line)) - burn.reach_mm
        if _older(burn, when[id(cut)], contour) and gap_mm < least_mm - SLACK_MM:
            where = (
                f"in the kerf of {burn.what}, where there is no metal"
                if gap_mm < 0
                else f"{gap_mm:.2f} mm from the kerf of {burn.what}, less than {least_mm:g} mm"
            )
            text = f"{contour.id} (cut {k}) is pierced {where}, at {spot(cut)}"
            yield (burn.position, k), (contour.id, burn.contour.id), text
    before = {k: nest.contour(cuts[k - 2].contour) for k, cut, _ in through if cut.linked and k > 1}
    rows = [row for row in through if not (row[0] in let and when[id(row[1])] % 2 == 0)]
    leads = list(_leads_of(rows, when, kerf_mm, before))
    free = np.array([lead.line for lead in leads], dtype=object)
    for row, b in pairs_found(tree.query(free, "dwithin", distance=kerf_mm - SLACK_MM)):
        lead, burn = leads[row], burns[b]
        left = lead.name == "link" and burn.position == lead.position - 1 and burn.is_own_lead
        if (
            not left
            and _older(burn, lead.moment, lead.contour)
            and shapely.dwithin(lead.line, burn.line, max(reach_mm[b] - SLACK_MM, 0.0))
        ):
            text = f"the {lead.name} of {lead.contour.id} (cut {lead.position}) crosses the kerf of {burn.what}"
            yield (burn.position, lead.position), (lead.contour.id, burn.contour.id), text


def leads_over_holes(nest: Nest, cuts: CutSequence, kerf_mm: float, splash_mm: float) -> Iterator[Finding]:
    """Leads that cross holes pierced in a pass before, and holes that are too near to each other: half kerf and splash.

    A cut begins at its own hole, and meets that alone.
    """
    holes, at = cuts.pierces, cuts.positions()
    if not holes:
        return
    tree = shapely.STRtree(shapely.points(np.array([hole.at for hole in holes])))
    through = [(k, cut, nest.contour(cut.contour)) for k, cut in cuts.burns if _burns(nest, cut)]
    leads = list(_leads_of(through, {}, kerf_mm, {}))
    free = np.array([lead.line for lead in leads], dtype=object)
    for row, h in pairs_found(tree.query(free, "dwithin", distance=kerf_mm / 2 - SLACK_MM)):
        lead, hole = leads[row], holes[h]
        if hole.before <= lead.position and hole.contour != lead.contour.id:
            other = hole.contour or "nothing"
            text = f"the {lead.name} of {lead.contour.id} (cut {lead.position}) crosses the hole pierced for {other}"
            yield (lead.position,), (lead.contour.id, *([hole.contour] if hole.contour else ())), text
    points = tree.geometries
    for a, b in pairs_found(tree.query(points, "dwithin", distance=kerf_mm + splash_mm - SLACK_MM)):
        if a < b:
            gap_mm = float(shapely.distance(points[a], points[b])) - kerf_mm / 2
            names = tuple(hole.contour for hole in (holes[a], holes[b]) if hole.contour)
            at_mm = f"({holes[b].at[0]:.2f}, {holes[b].at[1]:.2f})"
            text = (
                f"the hole at {at_mm} is pierced {gap_mm:.2f} mm from another, less than {kerf_mm / 2 + splash_mm:g} mm"
            )
            yield tuple(at[name] for name in names if name in at), names, text


def _burns(nest: Nest, cut: Cut) -> bool:
    return nest.contour(cut.contour).shapes_part


def _through_metal(nest: Nest, cuts: Sequence[Cut]) -> Bools:
    """Whether the torch pierces metal where each cut begins; not where it comes in from the edge of the sheet."""
    at, sheet = shapely.points(np.array([cut.pierce for cut in cuts]).reshape(-1, 2)), nest.sheet.polygon
    return np.asarray(shapely.intersects(sheet, at) & (shapely.distance(sheet.boundary, at) > SLACK_MM))


def _older(burn: _BurntLine, moment: int, contour: Contour) -> bool:
    both_in_waste = burn.contour.part != contour.part or "slit" in (burn.contour.kind, contour.kind)
    return burn.moment < moment and both_in_waste


def stretch_line(cut: Cut, contour: Contour) -> shapely.LineString:
    """The contour as drawn; of a cut that begins it only what is beside its stretch."""
    if cut.span is None:
        return contour.line
    curve = contour.curve.towards(cut.direction)
    begin_mm, end_mm = curve.project(cut.span.begin)[0], curve.project(cut.span.end)[0]
    length_mm = (end_mm - begin_mm) % curve.length_mm
    return curve.between(begin_mm, length_mm).line(CHORD_MM) if length_mm > 0 else contour.line


def _burns_of(through: list[tuple[int, Cut, Contour]], when: Mapping[int, int], kerf_mm: float) -> Iterator[_BurntLine]:
    leads = [list(_named_leads(cut)) for _, cut, _ in through]
    lines = iter(lines_of([lead for row in leads for _, lead in row], CHORD_MM))
    for (k, cut, contour), row in zip(through, leads, strict=True):
        moment, reach_mm = when[id(cut)], kerf_mm if contour.encloses else kerf_mm / 2
        told, line = f"{contour.id} (cut {k})", contour.line
        if moment % 2:
            told, line = f"{contour.id} (begun before cut {k})", stretch_line(cut, contour)
        yield _BurntLine(k, moment, contour, told, line, reach_mm)
        for name, _ in row:
            what = f"the {name} of {told}"
            yield _BurntLine(k, moment, contour, what, next(lines), kerf_mm / 2, is_own_lead=name != "link")


def _leads_of(
    through: Sequence[tuple[int, Cut, Contour]], when: Mapping[int, int], kerf_mm: float, before: Mapping[int, Contour]
) -> Iterator[_Lead]:
    """The leads of cuts, each without its half a kerf at the contour; a lead-out without its overcut.

    A link is also without what lies in the kerf of the contour it comes from, `before` by position, and its first kerf.
    """
    named = [(*row, name, lead) for row in through for name, lead in _named_leads(row[1])]
    ways: list[Curve | None] = []
    for _, _, _, name, lead in named:
        free_mm = lead.length_mm - kerf_mm / 2
        if name == "lead-out":
            ways.append(lead)
        else:
            ways.append(lead.between(0.0, free_mm) if free_mm > SLACK_MM / 100 else None)  # else none but rounding
    leads = iter(lines_of([way for way in ways if way is not None], CHORD_MM))
    free = [None if way is None else next(leads) for way in ways]
    ways_out = [k for k, (_, _, _, name, _) in enumerate(named) if name == "lead-out"]
    kerfs = shapely.buffer(np.array([named[k][2].line for k in ways_out], dtype=object), kerf_mm + SLACK_MM)
    lines = np.array([free[k] for k in ways_out], dtype=object)
    for k, beyond in zip(ways_out, shapely.difference(lines, kerfs), strict=True):
        free[k] = beyond
    for (position, cut, contour, name, _), left in zip(named, free, strict=True):
        if left is not None and name == "link" and position in before:
            begins = shapely.buffer(shapely.Point(cut.pierce), kerf_mm)
            older = shapely.buffer(before[position].line, kerf_mm + SLACK_MM)
            left = shapely.difference(left, shapely.union(begins, older))
        if left is not None and not left.is_empty:
            yield _Lead(position, when.get(id(cut), 2 * position), contour, name, left)


def _named_leads(cut: Cut) -> Iterator[tuple[str, Curve]]:
    for name, lead in (("link" if cut.linked else "lead-in", cut.lead_in), ("lead-out", cut.lead_out)):
        if lead is not None and lead.length_mm > 0:
            yield name, lead


# Cuts that begin in the kerf of an older one, where there is nothing to pierce.


def starts_in_older_kerfs(nest: Nest, cuts: CutSequence, kerf_mm: float) -> frozenset[int]:
    """Positions of the cuts along a stretch of a contour that begin on the torch's way round one that is out.

    So do those that begin on a stretch that was cut before, be it of their own contour.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> from kerfwise.encoder.cut import Span
    >>> two = nest(200, 100, part("A", rect(10, 10, 50, 50)), part("B", rect(61.5, 10, 50, 50)))
    >>> first = Cut("A.outer", (10, 10), "ccw", (4, 4))
    >>> then = Cut("B.outer", (61.5, 10), "ccw", (60.75, 10), span=Span((60.75, 10), (60.75, 60)))
    >>> (
    ...     starts_in_older_kerfs(two, CutSequence((first, then)), 1.5),
    ...     starts_in_older_kerfs(two, CutSequence((then, first)), 1.5),
    ... )
    (frozenset({2}), frozenset())
    """
    rows = [(k, cut) for k, cut in enumerate(cuts, 1) if _may_be(cut, kerf_mm)]
    if not rows:
        return frozenset()
    position = cuts.positions()
    own = [(2 * position[c.id], c.id, c.line) for c in nest.contours if c.kind == "outer" and c.id in position]
    begun = [(k, cut) for k, cut in cuts.begun if cut.contour in nest.index]
    own += [(2 * k - 1, "", stretch_line(cut, nest.contour(cut.contour))) for k, cut in begun]
    points = shapely.points(np.array([cut.pierce for _, cut in rows]))
    tree = shapely.STRtree([line for _, _, line in own])
    within_mm = kerf_mm / 2 + tolerance_mm(kerf_mm) + SLACK_MM
    row, met = tree.query(points, "dwithin", distance=within_mm)
    found = zip(row.tolist(), met.tolist(), strict=True)
    return frozenset(rows[r][0] for r, m in found if own[m][0] < 2 * rows[r][0] and own[m][1] != rows[r][1].contour)


def _may_be(cut: Cut, kerf_mm: float) -> bool:
    """Whether a cut follows a stretch of its contour, from where it begins, or from over the kerf beside a corner."""
    leads = (lead for lead in (cut.lead_in, cut.lead_out) if lead is not None)
    return cut.span is not None and not cut.linked and all(lead.length_mm <= 2 * kerf_mm for lead in leads)
