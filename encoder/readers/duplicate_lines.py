"""Closed lines drawn twice or too near each other, outlines that overlap, and holes that reach an edge: notches."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from kerfwise.arrays import point_tree
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.graphs import weak_components
from kerfwise.encoder.nest import Note, Part
from kerfwise.encoder.questions import Asking, Choice, Question

from .closing import split_at_vertices
from .drawing import SNAP_MM, DrawnCurve
from .fit_arcs import FLATTEN_MM, fit_curve
from .join import join
from .layers import counted
from .options import ReadOptions
from .sheet import surrounding

LEAST_MM = 0.2
"""Metal narrower than this is none on any machine."""
CORNER = 1.5
"""How much further than along their sides two outlines may lie apart at corners."""


def drawn_once(
    rings: Sequence[DrawnCurve], options: ReadOptions, asking: Asking
) -> tuple[tuple[DrawnCurve, ...], list[Note]]:
    """The rings, each line once, and a word on those that were drawn beside themselves.

    Two that lie within the join tolerance all round are one: the first that was drawn. Others that leave less metal
    between them than the kerf are asked about.
    """
    limit_mm = max(options.kerf_mm, LEAST_MM)
    groups = _groups(rings, limit_mm)
    if not groups:
        return tuple(rings), []
    near = [(group, gap) for group, gap in groups if gap <= options.join_tolerance_mm]
    wide = [(group, gap) for group, gap in groups if gap > options.join_tolerance_mm]
    gone = {k for group, _ in near for k in group[1:]}
    notes = [
        Note(
            "warning",
            f"the line {rings[group[0]].place} is drawn {_times(len(group))}, {gap:.3f} mm apart: it is cut once, as "
            "it is drawn first",
        )
        for group, gap in near
    ]
    if wide:
        answer = asking.ask(
            _question([[rings[k] for k in group] for group, _ in wide], [gap for _, gap in wide], limit_mm)
        )
        for group, gap in wide if answer != "both" else ():
            by_size = sorted(group, key=lambda k: abs(rings[k].curve.signed_area_mm2))
            kept = by_size[0] if answer == "inner" else by_size[-1]
            gone |= set(group) - {kept}
            notes.append(
                Note(
                    "warning",
                    f"the line {rings[kept].place} is drawn {_times(len(group))}, {gap:.3f} mm apart: cut once",
                )
            )
    return tuple(ring for k, ring in enumerate(rings) if k not in gone), notes


WIDEST_MM = 25.0
"""The radius of the largest hole that is drawn with its thread or its countersink, most likely."""
LEAST_SHARE = 0.4
"""The radius of the inner circle of such a hole, at least, in shares of the outer one's."""
ROUND_SHARE = 0.985
"""Of the area of a circle of the same length: a polygon of 24 sides has more."""
CENTRED_MM = 0.05


def holes_drawn_once(
    rings: Sequence[DrawnCurve], options: ReadOptions, asking: Asking
) -> tuple[tuple[DrawnCurve, ...], list[Note]]:
    """The rings without one of each two that may be one hole: drawn with its thread or its countersink, or traced.

    Such a pair is a hole with a disc in it: two circles about one centre with nothing in the inner one, or two rings
    with less room between than two kerfs. By the lines alone the disc would be a part.
    """
    if len(rings) < 3:
        return tuple(rings), []
    pairs = _holes_with_discs(rings, max(options.kerf_mm, LEAST_MM))
    if not pairs:
        return tuple(rings), []
    answer = asking.ask(_hole_question([(rings[hole], rings[disc]) for hole, disc in pairs], options))
    if answer == "both":
        return tuple(rings), []
    gone = {hole if answer == "inner" else disc for hole, disc in pairs}
    text = f"of {len(pairs)} holes drawn twice" if len(pairs) > 1 else "of a hole drawn twice"
    note = Note("warning", f"{text} the {answer} line is cut: {counted(rings[k].layer for k in sorted(gone))} left out")
    return tuple(ring for k, ring in enumerate(rings) if k not in gone), [note]


def _holes_with_discs(rings: Sequence[DrawnCurve], kerf_mm: float) -> list[tuple[int, int]]:
    """Rings that are holes by how deep they lie, each with the one ring in it that may be the same hole."""
    areas = [ring.area for ring in rings]
    depth, parent = surrounding(areas)
    inside = np.bincount(parent[parent >= 0], minlength=len(rings))
    found = []
    for disc in np.flatnonzero((depth > 0) & (depth % 2 == 0)).tolist():
        hole = int(parent[disc])
        if depth[hole] != depth[disc] - 1 or inside[hole] != 1:
            continue
        lines = rings[hole].curve.line(), rings[disc].curve.line()
        near = float(shapely.distance(*lines)) <= 2 * kerf_mm
        beside = near and float(shapely.hausdorff_distance(*lines, densify=0.25)) <= CORNER * 2 * kerf_mm
        if beside or (inside[disc] == 0 and _alike_round(areas[hole], areas[disc])):
            found.append((hole, disc))
    return found


def _alike_round(hole: shapely.Geometry, disc: shapely.Geometry) -> bool:
    """Whether two areas are circles about one centre, as those of a thread or a countersink are."""
    if not all(4 * math.pi * one.area > ROUND_SHARE * one.length**2 for one in (hole, disc)):
        return False
    outer, inner = (math.sqrt(one.area / math.pi) for one in (hole, disc))
    centred = float(shapely.distance(hole.centroid, disc.centroid)) <= CENTRED_MM
    return centred and outer <= WIDEST_MM and inner >= LEAST_SHARE * outer


def _hole_question(pairs: Sequence[tuple[DrawnCurve, DrawnCurve]], options: ReadOptions) -> Question:
    count = len(pairs)
    which = "a hole holds a disc" if count == 1 else f"{count} holes hold a disc each"
    return Question(
        "doubled",
        f"{which}, the first {pairs[0][1].place}, which may be the same hole drawn twice, as with a thread or a "
        "countersink: which line is cut?",
        (
            Choice("inner", "the inner one: the core of a thread, the bore of a countersink"),
            Choice("outer", "the outer one"),
            Choice("both", "both: the disc is a part"),
        ),
    )


def _times(count: int) -> str:
    return "twice" if count == 2 else f"{count} times"


def _question(groups: Sequence[Sequence[DrawnCurve]], gaps: Sequence[float], limit_mm: float) -> Question:
    count, first = len(groups), groups[0][0]
    which = f"{count} closed lines are" if count > 1 else f"the closed line {first.place} is"
    apart = f"{min(gaps):.3g}" if max(gaps) - min(gaps) < 5e-3 else f"{min(gaps):.3g}…{max(gaps):.3g}"
    return Question(
        "doubled",
        f"{which} drawn twice, {apart} mm apart ({counted(g[0].layer for g in groups)}), and the {limit_mm:g} mm of "
        "the kerf leave no metal between: which one is cut?",
        (
            Choice("outer", "the outer one of each"),
            Choice("inner", "the inner one of each"),
            Choice("both", "both, as they are drawn"),
        ),
    )


def _groups(rings: Sequence[DrawnCurve], limit_mm: float) -> list[tuple[list[int], float]]:
    """Rings that run beside each other all the way, and how far apart they are at most, mm; identical ones are not."""
    if len(rings) < 2:
        return []
    lines = np.array([ring.curve.line() for ring in rings], dtype=object)
    pairs = point_tree(shapely.bounds(lines)).query_pairs(CORNER * limit_mm, p=np.inf, output_type="ndarray")
    found, gaps = [], []
    for a, b in sorted(map(tuple, pairs.tolist())):
        apart = float(shapely.hausdorff_distance(lines[a], lines[b], densify=0.25))
        if not SNAP_MM < apart <= CORNER * limit_mm:
            continue
        common = shapely.intersection(rings[a].area, rings[b].area).area
        if 2 * common < min(rings[a].area.area, rings[b].area.area):
            continue  # small neighbours, side by side
        between = abs(rings[a].area.area - rings[b].area.area) / max(min(lines[a].length, lines[b].length), SNAP_MM)
        if between <= limit_mm:
            found.append((a, b))
            gaps.append(apart)
    if not found:
        return []
    nodes = np.array(found, dtype=np.int64)
    label = weak_components(len(rings), nodes)
    widest: dict[int, float] = {}
    for (a, _), gap in zip(found, gaps, strict=True):
        widest[int(label[a])] = max(widest.get(int(label[a]), 0.0), gap)
    touched = {k for pair in found for k in pair}
    return [
        ([k for k in range(len(rings)) if k in touched and label[k] == one], gap) for one, gap in sorted(widest.items())
    ]


def thin_parts(parts: Sequence[Part], options: ReadOptions) -> list[Part]:
    """The parts of which the kerf would leave nothing anywhere."""
    limit_mm = max(options.kerf_mm, LEAST_MM)
    return [
        part
        for part in parts
        if 2 * part.polygon.area < limit_mm * part.polygon.length
        and shapely.buffer(shapely.make_valid(part.polygon), -limit_mm / 2, quad_segs=4).is_empty
        and part.polygon.area > 0
    ]


def thin_question(thin: Sequence[Part], options: ReadOptions) -> Question:
    """What outlines are for between which there is no metal once they are cut."""
    limit_mm = max(options.kerf_mm, LEAST_MM)
    x, y = thin[0].outer.curve.start
    count = len(thin)
    which = "1 closed line encloses" if count == 1 else f"{count} closed lines enclose"
    return Question(
        "thin",
        f"{which} metal that is nowhere wider than the {limit_mm:g} mm of the kerf, the first at ({x:.3f}, {y:.3f}): "
        "nothing would be left of such parts. What are they for?",
        (
            Choice("ignore", "left out"),
            Choice("mark", "marked, where they lie in the metal of a part"),
            Choice("cut", "cut, as they are drawn"),
        ),
    )


LEAST_MM2 = 0.01
"""Outlines that overlap by less are drawn to touch."""


def without_overlaps(rings: Sequence[DrawnCurve], asking: Asking) -> tuple[tuple[DrawnCurve, ...], list[Note]]:
    """The rings with those that overlap each other made one, as is answered; those of a DXF file stay.

    Parts of a DXF file that overlap are parts of a nest that went wrong; shapes of an SVG file are drawn over each
    other for want of better.
    """
    groups = _overlapping(rings)
    if not groups:
        return tuple(rings), []
    answer = asking.ask(_overlap_question([rings[k] for k in groups[0]], groups))
    if answer == "refuse":
        return tuple(rings), []
    gone: set[int] = set()
    curves: dict[int, list[DrawnCurve]] = {}
    for group in groups:
        largest = max(group, key=lambda k: rings[k].area.area)
        gone |= set(group)
        curves[largest] = [rings[largest]] if answer == "largest" else _merged(rings, group, largest, answer == "join")
    kept = [one for k, ring in enumerate(rings) for one in (curves.get(k, []) if k in gone else [ring])]
    done = {"join": "made one outline round them", "notch": "the smaller ones cut out of the largest"}
    text = f"{counted(rings[k].layer for k in sorted(gone))} overlap: {done.get(answer, 'the largest of each is kept')}"
    return tuple(kept), [Note("repaired", text)]


def _overlapping(rings: Sequence[DrawnCurve]) -> list[list[int]]:
    """Groups of rings that overlap, by their numbers: none lies in the other."""
    drawn = [k for k, ring in enumerate(rings) if ring.within is not None]
    areas = np.array([rings[k].area for k in drawn], dtype=object)
    if len(areas) < 2:
        return []
    one, other = shapely.STRtree(areas).query(areas, predicate="overlaps")
    first = one < other
    one, other = one[first], other[first]
    common = shapely.area(shapely.intersection(areas[one], areas[other]))
    least = np.minimum(shapely.area(areas[one]), shapely.area(areas[other]))
    deep = (common > LEAST_MM2) & (least - common > LEAST_MM2)
    pairs = np.column_stack([one[deep], other[deep]])
    if not len(pairs):
        return []
    label = weak_components(len(areas), pairs)
    touched = np.unique(pairs)
    return [[drawn[k] for k in touched.tolist() if label[k] == number] for number in np.unique(label[touched]).tolist()]


def _overlap_question(first: Sequence[DrawnCurve], groups: Sequence[Sequence[int]]) -> Question:
    count = sum(map(len, groups))
    return Question(
        "overlap",
        f"{count} outlines overlap each other, the first {first[0].place}: what is meant?",
        (
            Choice("join", "one outline round those that overlap"),
            Choice("notch", "the smaller ones are cut out of the largest, as notches"),
            Choice("largest", "the largest of each; the others are left out"),
            Choice("refuse", "not cut: the drawing is refused, to be changed"),
        ),
    )


def _merged(rings: Sequence[DrawnCurve], group: Sequence[int], largest: int, join: bool) -> list[DrawnCurve]:
    """The outlines of all areas together, or of the largest without the others."""
    areas = {k: shapely.make_valid(Curve(rings[k].curve.vertices, True).polygon(FLATTEN_MM)) for k in group}
    if join:
        shape = shapely.union_all(list(areas.values()))
    else:
        others = shapely.union_all([area for k, area in areas.items() if k != largest])
        shape = shapely.difference(areas[largest], others)
    outlines = [
        ring
        for part in shapely.get_parts(shape)
        if part.geom_type == "Polygon"
        for ring in (part.exterior, *part.interiors)
        if ring.length > SNAP_MM and shapely.Polygon(ring).area > LEAST_MM2
    ]
    points = [np.array(ring.coords) for ring in outlines]
    return [replace(rings[largest], curve=fit_curve(each) or Curve.of(each[:-1])) for each in points]


# Holes that have a stretch of their edge in common with their part's outline, or with another hole of it. No metal is
# between: the hole is a notch, or the two are one. Where a notch goes right across, the part is two.

LEAST_SHARED_MM = 0.1
"""Edges that have less than this in common touch at a point."""


def with_notches(rings: Sequence[DrawnCurve], tolerance_mm: float) -> tuple[tuple[DrawnCurve, ...], list[Note]]:
    """The rings with holes that share an edge with their part's outline, or with another hole, made one with that."""
    found = list(rings)
    notes: list[Note] = []
    while (pair := _sharing(found, tolerance_mm)) is not None:
        one, other = pair
        made = _outline_of_both(found[one], found[other], tolerance_mm)
        if made is None:
            break
        places = f"the hole {found[other].place} shares an edge with the line {found[one].place}"
        text = f"{places}: they are cut as one outline"
        notes.append(Note("repaired", text))
        found = [each for k, each in enumerate(found) for each in (made if k == one else () if k == other else (each,))]
    return tuple(found), notes


def _sharing(rings: Sequence[DrawnCurve], tolerance_mm: float) -> tuple[int, int] | None:
    """The first ring and hole that have a stretch of their edge in common, of a part's outline and its holes."""
    if len(rings) < 2:
        return None
    depth, parent = surrounding([ring.area for ring in rings])
    lines = np.array([ring.curve.line() for ring in rings], dtype=object)
    near = np.column_stack(shapely.STRtree(lines).query(lines, predicate="dwithin", distance=SNAP_MM))
    for one, other in near.tolist():
        hole = depth[other] % 2 == 1
        beside = one < other and depth[one] % 2 == 1 and parent[one] == parent[other]
        if hole and (parent[other] == one or beside) and _shared_mm(lines[one], lines[other]) > LEAST_SHARED_MM:
            return one, other
    return None


def _shared_mm(one: shapely.Geometry, other: shapely.Geometry) -> float:
    band = shapely.buffer(one, SNAP_MM, cap_style="flat", quad_segs=2)
    return float(shapely.intersection(other, band).length) - 4 * SNAP_MM


def _outline_of_both(one: DrawnCurve, other: DrawnCurve, tolerance_mm: float) -> list[DrawnCurve] | None:
    """What is left of two rings without the edge that they share; None where that does not close."""
    left = [
        piece
        for ring, beside in ((one, other), (other, one))
        for piece in split_at_vertices(ring, (beside, replace(ring)), tolerance_mm)  # at all of its own, too
        if piece.curve.line().interpolate(0.5, normalized=True).distance(beside.curve.line()) > SNAP_MM
    ]
    joined = join(left, tolerance_mm)
    if joined.chains or not joined.rings:
        return None
    return [replace(one, curve=ring.curve) for ring in joined.rings]
