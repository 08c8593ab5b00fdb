"""Each contour and part by itself: rings cross nothing, holes lie within, no line is drawn twice."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.measures import MOST_MEETINGS, has_too_many_crossings
from kerfwise.encoder.geometry.tolerances import COINCIDE_MM, TOUCH_MM

from .errors import REPAIR, InputError
from .nest import Contour, Note, Part, Sheet

# Each contour by itself: closed rings must enclose something, and cross nothing of their own.


def flat(curve: Curve) -> bool:
    """True for a ring that encloses no area: on average no wider than a touch.

    Examples
    --------
    >>> flat(Curve.of([(0, 0), (50, 0)])), flat(Curve.of([(0, 0), (9, 9), (9, 0), (0, 9)]))
    (True, False)
    """
    least_mm2 = TOUCH_MM * curve.length_mm / 2
    if len(curve.segments) < 2:
        return True
    # the loops of a figure eight cancel out in the signed area
    return abs(curve.signed_area_mm2) <= least_mm2 and enclosed(curve).area <= least_mm2


def enclosed(curve: Curve) -> shapely.Geometry:
    """The area inside a closed curve, made valid where the curve crosses itself; empty for a mere line.

    Raises InputError if it crosses itself so often that making it valid would take minutes.
    """
    points = curve.flatten()
    if len(points) < 3:
        return shapely.Polygon()
    polygon = shapely.Polygon(points)
    if polygon.is_valid:
        return polygon
    _expect_few_crossings(curve, points)
    return shapely.make_valid(polygon)


DOMINANT = 0.95
"""A ring has one main loop if that has this share of the whole area."""


def main_loop(curve: Curve) -> shapely.Polygon | None:
    """The loop that nearly all of what a ring encloses is in; None of a ring that crosses itself without such a one.

    Examples
    --------
    >>> main_loop(Curve.of([(0, 0), (9, 9), (9, 0), (0, 9)])) is None
    True
    """
    loops = [piece for piece in shapely.get_parts(enclosed(curve)) if piece.geom_type == "Polygon"]
    if not loops:
        return None
    largest = max(loops, key=lambda loop: float(loop.area))
    whole, ring = sum(loop.area for loop in loops), shapely.Polygon(largest.exterior)
    is_main = largest.area >= DOMINANT * whole and ring.area - largest.area <= (1 - DOMINANT) * whole
    return largest if is_main else None


def _expect_few_crossings(curve: Curve, points: Floats) -> None:
    if has_too_many_crossings(points, closed=True, most=MOST_MEETINGS):
        raise InputError(
            f"the ring that starts {place(curve)} crosses or touches itself more than {MOST_MEETINGS} times: no "
            "part is drawn so; correct it in CAD, or leave its layer out (drawing.layers.ignore)"
        )


def speck(curve: Curve) -> bool:
    """True for a curve that is as good as a point."""
    return not curve.segments or curve.length_mm <= TOUCH_MM


def contour_problems(contours: Sequence[Contour]) -> dict[str, str]:
    """Contour id → what is wrong with it, for every mark without length and every ring that is no proper one."""
    problems = {
        c.id: f"{c.id} has no length, {place(c.curve)}: remove it, or try {REPAIR}, which removes it"
        for c in contours
        if c.kind == "mark" and speck(c.curve)
    }
    rings = [c for c in contours if c.kind != "mark"]
    problems |= {
        c.id: f"{c.id} encloses no area, {place(c.curve)}: remove it, or try {REPAIR}, which removes it"
        for c in rings
        if flat(c.curve)
    }
    sound = [c for c in rings if c.id not in problems]
    for k in np.flatnonzero(~shapely.is_valid(np.array([c.polygon for c in sound], dtype=object))).tolist():
        mends = f", or try {REPAIR}" if main_loop(sound[k].curve) is not None else ""
        problems[sound[k].id] = f"{sound[k].id} {_crossing(sound[k].polygon)}: correct it in CAD{mends}"
    return {c.id: problems[c.id] for c in contours if c.id in problems}


def sheet_ring_problems(sheet: Sheet) -> list[str]:
    """A line for each ring of the sheet itself that is no proper one, and for a hole that is not in it."""
    named = [("the sheet's outline", sheet.outline)]
    named += [(f"the sheet's hole {k}", hole) for k, hole in enumerate(sheet.holes, 1)]
    problems = []
    for name, curve in named:
        if flat(curve):
            problems.append(f"{name} encloses no area, {place(curve)}: draw the sheet again")
        elif not curve.polygon().is_valid:
            problems.append(f"{name} {_crossing(curve.polygon())}: draw the sheet again")
    if not problems and not sheet.polygon.is_valid:
        problems.append(f"the sheet's holes overlap or reach out of it ({shapely.is_valid_reason(sheet.polygon)})")
    return problems


def place(curve: Curve) -> str:
    """Where a curve starts, for messages."""
    x, y = curve.start
    return f"at ({x:.3f}, {y:.3f})"


def _crossing(polygon: shapely.Polygon) -> str:
    """Shapely's reason, as "Ring Self-intersection[12.5 3]", in the words of the trade."""
    reason = shapely.is_valid_reason(polygon)
    touches = reason.startswith("Ring")
    found = re.search(r"\[(\S+) (\S+)\]", reason)
    where = f" at ({float(found[1]):.3f}, {float(found[2]):.3f})" if found else ""
    return f"{'touches' if touches else 'crosses'} itself{where}"


# Each part by itself: its holes and marks must lie in it, apart from each other.


def hole_problems(parts: Sequence[Part]) -> tuple[list[str], list[Note]]:
    """Holes that reach out of their part or overlap each other, and notes on those that touch.

    `parts`: parts whose rings are proper each.
    """
    holes = [h for p in parts for h in p.holes]
    if not holes:
        return [], []
    hosts = [p.outer for p in parts for _ in p.holes]
    inner = np.array([h.polygon for h in holes], dtype=object)
    outer = np.array([o.polygon for o in hosts], dtype=object)
    part = np.unique([h.part for h in holes], return_inverse=True)[1]
    i, j = shapely.STRtree(inner).query(inner, predicate="dwithin", distance=TOUCH_MM)
    siblings = (i < j) & (part[i] == part[j])
    i, j = i[siblings], j[siblings]

    near = shapely.distance(shapely.get_exterior_ring(inner), shapely.get_exterior_ring(outer)) < TOUCH_MM
    suspect = np.flatnonzero(near | ~shapely.covered_by(inner, outer))
    beyond = shapely.difference(inner[suspect], outer[suspect])
    common = shapely.intersection(inner[i], inner[j])

    problems: list[str] = []
    notes: list[Note] = []
    for k, area in zip(suspect.tolist(), beyond, strict=True):
        _sort_out(holes[k], hosts[k], area, "reaches out of", problems, notes)
    for a, b, area in zip(i.tolist(), j.tolist(), common, strict=True):
        _sort_out(holes[a], holes[b], area, "overlaps", problems, notes)
    return problems, notes


def _sort_out(
    one: Contour, other: Contour, area: shapely.Geometry, verb: str, problems: list[str], notes: list[Note]
) -> None:
    if thick(area):
        problems.append(f"{one.id} {verb} {other.id} {around(area)}: correct the part in CAD")
    else:
        notes.append(Note("warning", f"{one.id} touches {other.id}", (one.id, other.id)))


def mark_notes(parts: Sequence[Part]) -> list[Note]:
    """A note for each mark that runs off the metal of its part, or one for all of many."""
    marked = [(p, m) for p in parts for m in p.marks]
    lines = np.array([m.line for _, m in marked], dtype=object)
    metal = shapely.buffer(metal_of([p for p, _ in marked]), TOUCH_MM, quad_segs=2)
    off = np.flatnonzero(~shapely.covered_by(lines, metal)).tolist()
    names = [marked[k][1].id for k in off]
    if len(names) <= FEW_MARKS:
        return [Note("warning", f"{name} runs off its part", (name,)) for name in names]
    shown = f"{', '.join(names[:FEW_MARKS])}, …"
    return [Note("warning", f"{len(names)} marks run off their parts: {shown}", tuple(names))]


FEW_MARKS = 3
"""So many marks that run off their parts have a note each."""


def thick(area: shapely.Geometry) -> bool:
    """True when an area is more than the sliver between curves that touch."""
    return not shapely.is_empty(shapely.buffer(area, -TOUCH_MM))


def around(area: shapely.Geometry) -> str:
    """A point in an area, for messages."""
    at = shapely.point_on_surface(area)
    return f"at ({at.x:.3f}, {at.y:.3f})"


# The metal of parts whose rings may not lie as they should.


def metal_of(parts: Sequence[Part]) -> NDArray[np.object_]:
    """The area of each part as a valid shape: of its outer contour, less all that its holes enclose."""
    return np.array([_metal(p) for p in parts], dtype=object)


def _metal(part: Part) -> shapely.Geometry:
    if not any(flat(c.curve) for c in (part.outer, *part.holes)) and part.polygon.is_valid:
        return part.polygon
    return enclosed(part.outer.curve).difference(shapely.union_all([enclosed(h.curve) for h in part.holes]))


# The same line drawn twice would be cut twice: it is taken out once, and that is said.

MOST_ALIKE = 1000
"""Lines with the same box that are compared: each with each, so that the work goes with the square."""


def coincident(curves: Sequence[Curve]) -> list[tuple[int, int]]:
    """Pairs i < j of curves that run along the same line, whichever way round and wherever they start.

    Raises InputError if so many have the same box that comparing them all would take long, with the place and how many
    they are.

    Examples
    --------
    >>> square = [(0, 0), (9, 0), (9, 9), (0, 9)]
    >>> coincident([Curve.of(square), Curve.of(square[::-1]), Curve.of(square).moved(1, 0)])
    [(0, 1)]
    """
    some = np.array([k for k, c in enumerate(curves) if c.segments], dtype=np.int64)
    lines = np.array([curves[k].line() for k in some.tolist()], dtype=object)
    # curves that coincide have the same bounding box, give or take the chords of their arcs
    boxes = shapely.bounds(lines)
    _expect_few(boxes)
    corners = shapely.points(boxes[:, :2])
    i, j = shapely.STRtree(corners).query(corners, predicate="dwithin", distance=2 * COINCIDE_MM)
    alike = (i < j) & (np.abs(boxes[i] - boxes[j]).max(axis=1) <= 2 * COINCIDE_MM)
    i, j = i[alike], j[alike]
    same = shapely.hausdorff_distance(lines[i], lines[j]) <= COINCIDE_MM
    return sorted(zip(some[i[same]].tolist(), some[j[same]].tolist(), strict=True))


def _expect_few(boxes: Floats) -> None:
    """Refuse boxes (n, 4) of which too many are the same, before memory is taken for all pairs of them."""
    if len(boxes) <= MOST_ALIKE:
        return
    _, first, counts = np.unique(np.round(boxes / COINCIDE_MM), axis=0, return_index=True, return_counts=True)
    worst = int(counts.argmax())
    if counts[worst] > MOST_ALIKE:
        x, y = boxes[first[worst], :2].tolist()
        raise InputError(
            f"{counts[worst]} lines lie on each other at ({x:.3f}, {y:.3f}), and at most {MOST_ALIKE} are compared: "
            "delete what is drawn more than once (in CAD often called OVERKILL or purge of duplicates)"
        )


def drop_duplicates(parts: Sequence[Part]) -> tuple[tuple[Part, ...], list[Note]]:
    """The parts without contours drawn twice, and a note for each one taken out.

    Taken out are a hole or mark that repeats another of its part, a part that repeats another with all its holes,
    and a hole that is the same line as the outside of a part lying in another hole: what is left of such a hole
    is that part's outer contour. Other coincidences are left to the checks: two different parts in one place
    overlap, and a part that fills a hole touches it.

    Every other contour keeps its id.
    """
    rings = [c for p in parts for c in (p.outer, *p.holes)]
    marks = [c for p in parts for c in p.marks]
    part_of = {p.id: p for p in parts}
    pairs = [(rings[i], rings[j]) for i, j in coincident([c.curve for c in rings])]
    pairs += [(marks[i], marks[j]) for i, j in coincident([c.curve for c in marks]) if marks[i].part == marks[j].part]
    same = {frozenset((a.id, b.id)) for a, b in pairs}
    dropped: dict[str, Note] = {}
    for first, second in pairs:
        keep, drop = (second, first) if (first.kind, second.kind) == ("hole", "outer") else (first, second)
        if keep.id in dropped or drop.id in dropped:
            continue
        if keep.kind == drop.kind == "outer":
            gone, kept = part_of[drop.part], part_of[keep.part]
            if all(any(frozenset((c.id, d.id)) in same for d in kept) for c in gone):
                text = f"part {gone.id} is the same as part {kept.id}, in the same place; it is cut once, as {kept.id}"
                dropped |= {c.id: Note("warning", text, (drop.id, keep.id)) for c in gone}
        elif (keep.part, keep.kind) == (drop.part, drop.kind) or _fills_what_is_left(keep, drop, part_of[drop.part]):
            text = f"{drop.id} is the same line as {keep.id}; it is cut once, as {keep.id}"
            dropped[drop.id] = Note("warning", text, (drop.id, keep.id), common=keep.part != drop.part)
    left = tuple(_without(p, dropped) for p in parts if p.outer.id not in dropped)
    return left, list(dict.fromkeys(dropped.values()))


def _fills_what_is_left(outer: Contour, hole: Contour, host: Part) -> bool:
    """True when a hole is the outline of another part, and that part lies in another hole of the same host."""
    if outer.kind != "outer" or hole.kind != "hole" or outer.part == hole.part:
        return False
    others = [h.polygon for h in host.holes if h.id != hole.id and h.polygon.is_valid]
    return any(p.covers(outer.line) for p in others)


def _without(part: Part, dropped: dict[str, Note]) -> Part:
    if not any(c.id in dropped for c in part):
        return part
    holes = tuple(h for h in part.holes if h.id not in dropped)
    return replace(part, holes=holes, marks=tuple(m for m in part.marks if m.id not in dropped))
