"""Facts that single rules look at, worked out from geometry anew: contours and candidates count from 0 here."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.facts.facts import Facts, Stretch
from kerfwise.encoder.geometry.segment import Point
from kerfwise.models.problem.crossings import GRAZE_UM
from kerfwise.models.problem.microns import UM_PER_MM, points_um

FINE_MM = 0.002
"""Chords lie this close to contours whose gaps are measured."""
PER_MM = 100
"""Lengths in MiniZinc data are whole hundredths of a millimetre."""


def pierced_waste(facts: Facts) -> list[tuple[int, int]]:
    """Candidates that pierce inside another contour's hole, and that hole."""
    contours = facts.nest.contours
    holes = [k for k, c in enumerate(contours) if c.kind == "hole"]
    pierced = [k for k, c in enumerate(facts.candidates) if contours[c.contour].kind != "mark"]
    points = shapely.points(np.array([facts.candidates[k].pierce for k in pierced]).reshape(-1, 2))
    rows, inside = shapely.STRtree([contours[h].polygon for h in holes]).query(points, "intersects")
    found = sorted((pierced[row], holes[h]) for row, h in zip(rows.tolist(), inside.tolist(), strict=True))
    return [(c, h) for c, h in found if facts.candidates[c].contour != h]


def met_kerfs(facts: Facts, kerf_mm: float, splash_mm: float) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """Candidates that would meet the kerf of a contour, with that contour; and of a candidate's lead, with that one."""
    kerfs, leads = [], []
    drawn = [c for c in range(len(facts.candidates)) if facts.nest.contours[facts.candidates[c].contour].kind != "mark"]
    for c in drawn:
        part = facts.nest.contours[facts.candidates[c].contour].part
        for k, contour in enumerate(facts.nest.contours):
            if (
                contour.kind != "mark"
                and contour.part != part
                and _meets(facts.candidates[c], contour.line, kerf_mm, kerf_mm, splash_mm)
            ):
                kerfs.append((c, k))
        for d in drawn:
            older = facts.candidates[d]
            if facts.nest.contours[older.contour].part != part and any(
                _meets(facts.candidates[c], lead, kerf_mm / 2, kerf_mm, splash_mm) for lead in _leads(older, 0.0)
            ):
                leads.append((c, d))
    return kerfs, leads


def _meets(candidate: Candidate, line: shapely.LineString, reach_mm: float, kerf_mm: float, splash_mm: float) -> bool:
    """Whether a pierce or a lead meets the kerf that reaches so far from a line."""
    pierce = shapely.Point(candidate.pierce)
    if not candidate.edge_start and pierce.distance(line) < reach_mm + kerf_mm / 2 + splash_mm - 1e-6:
        return True
    return any(lead.distance(line) < reach_mm - 1e-6 for lead in _leads(candidate, kerf_mm / 2))


def _leads(candidate: Candidate, less_mm: float) -> list[shapely.LineString]:
    """The leads of a candidate without their last bit at the contour."""
    found = []
    if candidate.lead_in is not None and candidate.lead_in.length_mm > less_mm + 1e-6:
        found.append(candidate.lead_in.between(0.0, candidate.lead_in.length_mm - less_mm).line())
    if candidate.lead_out is not None and candidate.leaves:
        last_mm = candidate.lead_out.segments[-1].length_mm - less_mm
        if last_mm > 1e-6:
            found.append(candidate.lead_out.between(candidate.lead_out.length_mm - last_mm, last_mm).line())
    return found


def clusters(facts: Facts) -> Ints:
    """A number for every contour: outer contours in one place that face each other, however far along, share theirs."""
    faced = facts.neighbours
    same = facts.parent[faced.row] == facts.parent[faced.neighbour]
    joined = coo_array((np.ones(same.sum()), (faced.row[same], faced.neighbour[same])), shape=(facts.n, facts.n))
    return np.asarray(connected_components(joined, directed=False)[1], dtype=np.int64)


def on_the_frame(facts: Facts, frame_share: float) -> Bools:
    """Contours that face solid metal or the strip along the edge for that share of their length, or their host."""
    lengths_mm = np.array([c.curve.length_mm for c in facts.nest.contours])
    framed = facts.edge_length_mm.sum(axis=1) + facts.solid_mm >= frame_share * lengths_mm - 1e-6
    faced = facts.neighbours
    framed[faced.row[facts.parent[faced.row] != facts.parent[faced.neighbour]]] = True
    return np.asarray(framed)


def tail_needed(facts: Facts, rigid_min: float) -> Ints:
    """For every candidate the tail that must face parts still in, 0.01 mm; 0 where no candidate of the contour can."""
    outer, contour = _owners(facts)
    needed = np.maximum(_whole(rigid_min * facts.tail.total_mm - facts.tail.solid_mm), 0)
    able = np.zeros(facts.n, dtype=np.bool_)
    able[contour[needed <= _faced(facts.tail)]] = True
    return np.where(outer & able[contour], needed, 0)


def head_freed(facts: Facts, head_rigid_max: float) -> Ints:
    """For every candidate the head that should face parts already out, 0.01 mm."""
    outer, _ = _owners(facts)
    rigid_mm = facts.head.solid_mm + _faced(facts.head) / PER_MM
    return np.where(outer, np.maximum(_whole(rigid_mm - head_rigid_max * facts.head.total_mm), 0), 0)


def near_pairs(facts: Facts, radius_mm: float) -> list[tuple[int, int]]:
    """Contours of different parts, cut through, that are nearer than the radius."""
    cut = [(k, c) for k, c in enumerate(facts.nest.contours) if c.kind != "mark"]
    return [
        (i, j)
        for (i, a), (j, b) in combinations(cut, 2)
        if a.part != b.part and a.line.distance(b.line) < radius_mm - 1e-6
    ]


def same_waste(facts: Facts, kerf_mm: float) -> list[tuple[int, int, int]]:
    """Contours of different parts that bound waste towards each other, at most a kerf apart, and the gap, µm.

    A line that the nest gives to two parts stands for both.
    """
    cut = [(k, c) for k, c in enumerate(facts.nest.contours) if c.kind != "mark"]
    inside = {(int(i), int(j)) for i, j in facts.contains}
    lines = {k: shapely.LinearRing(c.curve.flatten(FINE_MM)) for k, c in cut}
    found = []
    for (i, a), (j, b) in combinations(cut, 2):
        apart = a.kind == b.kind == "outer" and not {(i, j), (j, i)} & inside
        guest = (a.kind == "hole" and (i, j) in inside) or (b.kind == "hole" and (j, i) in inside)
        if a.part != b.part and (apart or guest) and (gap_mm := lines[i].distance(lines[j])) <= kerf_mm:
            found.append((i, j, round(gap_mm * UM_PER_MM)))
    number = facts.nest.index
    return found + [(number[note.contours[1]], number[note.contours[1]], 0) for note in facts.nest.notes if note.common]


def tip_moves(facts: Facts, home_mm: Point) -> list[tuple[int | None, Bools]]:
    """Outer contours, and which moves lead over the part of each: from each stop (row) to each, home being number 0.

    Parts that no move leads over are left out. A contour of None is out from the start; no other is when the torch
    leaves home.
    """
    left = facts.nest.index
    over = [(left.get(part.outer.id), part.outer.polygon) for part in facts.whole_nest.parts]
    gone = np.array([outer is None for outer, _ in over], dtype=np.bool_)
    areas = shapely.STRtree(shapely.buffer([area for _, area in over], -GRAZE_UM / UM_PER_MM))
    pierces = rounded_mm([home_mm, *(c.pierce for c in facts.candidates)], home_mm)
    leads = np.zeros((len(over), len(pierces), len(pierces)), dtype=np.bool_)
    for stop, end in enumerate(rounded_mm([home_mm, *(c.end for c in facts.candidates)], home_mm)):
        moves = shapely.linestrings(np.stack([np.broadcast_to(end, pierces.shape), pierces], axis=1))
        reached, part = areas.query(moves, "intersects")
        leads[part, stop, reached] = True
    leads[~gone, 0] = False
    leads[:, 0, 0] = False
    return [(outer, leads[k]) for k, (outer, _) in enumerate(over) if leads[k].any()]


def rounded_mm(points_mm: list[Point], home_mm: Point) -> Floats:
    """Points at whole µm, as every engine sees them."""
    return points_um(points_mm, home_mm) / UM_PER_MM


def _owners(facts: Facts) -> tuple[Bools, Ints]:
    """For every candidate: whether it cuts an outer contour, and which contour."""
    contour = np.array([c.contour for c in facts.candidates], dtype=np.int64)
    outer = np.array([c.kind == "outer" for c in facts.nest.contours], dtype=np.bool_)
    return outer[contour], contour


def _faced(stretch: Stretch) -> Ints:
    """Length of every candidate's stretch that faces contours, 0.01 mm."""
    lengths = np.rint(stretch.neighbours.length_mm * PER_MM)
    return np.bincount(stretch.neighbours.row, lengths, minlength=len(stretch.total_mm)).astype(np.int64)


def _whole(lengths_mm: Floats) -> Ints:
    """Lengths as whole 0.01 mm, rounded up but for what is noise."""
    return np.ceil(lengths_mm * PER_MM - 1e-6).astype(np.int64)
