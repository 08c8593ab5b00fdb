"""Where the pierces and leads of a sequence of cuts lie, by plain geometry: the judging half of rule pierce."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Any

import numpy as np
import shapely

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.nest import Contour, Nest

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
        asked = np.array([k not in let for k, _, _ in self.pierced], dtype=np.bool_)
        rows = np.flatnonzero(pierced & ~on_edge & asked)
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
        leads = [
            (k, contour, name, curve.line())
            for k, cut, contour in self.cuts
            for name, curve in (("link" if cut.linked else "lead-in", cut.lead_in), ("lead-out", cut.lead_out))
            if curve is not None and curve.length_mm > 0
        ]
        drawn = np.array([line for *_, line in leads], dtype=object)
        for row, j in pairs_found(self.lines.query(drawn, "intersects")):
            (k, contour, name, line), met = leads[row], self.through[j]
            if met is contour and (contour.kind == "slit" or not _strays(line, contour)):
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
