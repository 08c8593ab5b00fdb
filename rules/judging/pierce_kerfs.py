"""Pierces and leads over the kerfs of older cuts, by plain geometry: the judging half of rule pierce, too."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Bools
from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.geometry.curve import Curve, lines_of
from kerfwise.encoder.nest import Contour, Nest

from .pierce_places import SLACK_MM, Finding, pairs_found, spot

CHORD_MM = 0.01


@dataclass(frozen=True, eq=False, slots=True)
class _BurntLine:
    """One line that an earlier cut has burnt along, or whose one side it has: its kerf reaches `reach_mm` from it.

    A link may leave beside a lead of the contour that it comes from (`is_own_lead`), as a lead-out may.
    """

    position: int
    contour: Contour
    what: str
    line: Any
    reach_mm: float
    is_own_lead: bool = False


@dataclass(frozen=True, eq=False, slots=True)
class _Lead:
    """A lead of a cut, without what lies beside its own contour."""

    position: int
    contour: Contour
    name: str
    line: Any


def over_older_kerfs(
    nest: Nest, cuts: CutSequence, kerf_mm: float, splash_mm: float, let: Collection[int] = ()
) -> Iterator[Finding]:
    """Pierces nearer than half the kerf and the splash to the kerf of an earlier cut, and leads that cross one.

    The kerf of a contour reaches from it one kerf into its waste, that of a lead or a slit half a kerf to both sides. A
    part's own metal lies between its contours, so that they are not looked at against each other, but for slits. The
    cuts at the positions that are `let` may begin in an older kerf.
    """
    finished = [(k, c, nest.contour(c.contour)) for k, c in enumerate(cuts, 1) if _burns(nest, c)]
    through = [(k, c, nest.contour(c.contour)) for k, c in cuts.burns if _burns(nest, c)]
    if not finished:
        return
    burns = list(_burns_of(finished, kerf_mm))
    tree = shapely.STRtree([burn.line for burn in burns])
    through_metal = _through_metal(nest, [cut for _, cut, _ in through])
    pierced = [
        row
        for row, holed in zip(through, through_metal.tolist(), strict=True)
        if holed and not row[1].linked and row[0] not in let
    ]
    points = shapely.points(np.array([cut.pierce for _, cut, _ in pierced]).reshape(-1, 2))
    least_mm = kerf_mm / 2 + splash_mm
    reach_mm = np.array([burn.reach_mm for burn in burns])
    for row, b in pairs_found(tree.query(points, "dwithin", distance=kerf_mm + least_mm - SLACK_MM)):
        (k, cut, contour), burn = pierced[row], burns[b]
        gap_mm = float(shapely.distance(points[row], burn.line)) - burn.reach_mm
        if _older(burn, k, contour) and gap_mm < least_mm - SLACK_MM:
            where = (
                f"in the kerf of {burn.what}, where there is no metal"
                if gap_mm < 0
                else f"{gap_mm:.2f} mm from the kerf of {burn.what}, less than {least_mm:g} mm"
            )
            text = f"{contour.id} (cut {k}) is pierced {where}, at {spot(cut)}"
            yield (burn.position, k), (contour.id, burn.contour.id), text
    before = {k: nest.contour(cuts[k - 2].contour) for k, cut, _ in through if cut.linked and k > 1}
    leads = list(_leads_of([row for row in through if row[0] not in let], kerf_mm, before))
    free = np.array([lead.line for lead in leads], dtype=object)
    for row, b in pairs_found(tree.query(free, "dwithin", distance=kerf_mm - SLACK_MM)):
        lead, burn = leads[row], burns[b]
        left = lead.name == "link" and burn.position == lead.position - 1 and burn.is_own_lead
        if (
            not left
            and _older(burn, lead.position, lead.contour)
            and shapely.dwithin(lead.line, burn.line, max(reach_mm[b] - SLACK_MM, 0.0))
        ):
            text = f"the {lead.name} of {lead.contour.id} (cut {lead.position}) crosses the kerf of {burn.what}"
            yield (burn.position, lead.position), (lead.contour.id, burn.contour.id), text


def over_holes(nest: Nest, cuts: CutSequence, kerf_mm: float, splash_mm: float) -> Iterator[Finding]:
    """Leads that cross holes pierced in a pass before, and holes that are too near to each other: half kerf and splash.

    A cut begins at its own hole, and meets that alone.
    """
    holes, at = cuts.pierces, cuts.positions()
    if not holes:
        return
    tree = shapely.STRtree(shapely.points(np.array([hole.at for hole in holes])))
    through = [(k, cut, nest.contour(cut.contour)) for k, cut in cuts.burns if _burns(nest, cut)]
    leads = list(_leads_of(through, kerf_mm, {}))
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


def _older(burn: _BurntLine, position: int, contour: Contour) -> bool:
    both_in_waste = burn.contour.part != contour.part or "slit" in (burn.contour.kind, contour.kind)
    return burn.position < position and both_in_waste


def _burns_of(through: list[tuple[int, Cut, Contour]], kerf_mm: float) -> Iterator[_BurntLine]:
    leads = [list(_named_leads(cut)) for _, cut, _ in through]
    lines = iter(lines_of([lead for row in leads for _, lead in row], CHORD_MM))
    for (k, _, contour), row in zip(through, leads, strict=True):
        yield _BurntLine(
            k, contour, f"{contour.id} (cut {k})", contour.line, kerf_mm if contour.encloses else kerf_mm / 2
        )
        for name, _ in row:
            what = f"the {name} of {contour.id} (cut {k})"
            yield _BurntLine(k, contour, what, next(lines), kerf_mm / 2, is_own_lead=name != "link")


def _leads_of(
    through: Sequence[tuple[int, Cut, Contour]], kerf_mm: float, before: Mapping[int, Contour]
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
    made = iter(lines_of([way for way in ways if way is not None], CHORD_MM))
    free = [None if way is None else next(made) for way in ways]
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
            yield _Lead(position, contour, name, left)


def _named_leads(cut: Cut) -> Iterator[tuple[str, Curve]]:
    for name, lead in (("link" if cut.linked else "lead-in", cut.lead_in), ("lead-out", cut.lead_out)):
        if lead is not None and lead.length_mm > 0:
            yield name, lead
