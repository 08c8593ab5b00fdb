"""Repairs that a person would make in contours: rings that cross or touch themselves, and what encloses nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from kerfwise.encoder.contour_checks import flat, main_loop, place, speck
from kerfwise.encoder.display import join_names
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.measures import MOST_MEETINGS, has_too_many_crossings
from kerfwise.encoder.nest import Contour, Nest, Note, Part
from kerfwise.encoder.questions import Asking, Choice, Question

from .fit_arcs import FLATTEN_MM, fit_curve
from .options import REPAIR_FACTOR, ReadOptions

CROSSING = "crossing"
"""The question about contours that cross themselves."""
BOW_TIE = 4
"""A ring of so many corners that crosses itself has them in the wrong order."""


@dataclass(frozen=True, eq=False)
class _Loops:
    """What a ring that crosses itself falls into, the largest loop first.

    `slack_mm` is how wide the widest of the others is, `reach_mm` how far they lie off the largest at most.
    """

    contour: Contour
    pieces: tuple[shapely.Polygon, ...]
    slack_mm: float
    reach_mm: float
    lost_mm2: float

    @property
    def dominant(self) -> bool:
        """Whether one loop encloses nearly all."""
        return main_loop(self.contour.curve) is not None


def repaired(nest: Nest, options: ReadOptions, asking: Asking) -> Nest:
    """The nest without rings that cross themselves, as far as they are mended or answered.

    Loops that are narrower than the join tolerance and no longer than ten of it are cut off. With `repair`, so are all
    of a ring that has one main loop, and what encloses nothing is left out. All other rings raise the question
    `crossing`. Contours keep their ids.
    """
    notes: list[Note] = []
    parts = [
        p for p in (_without_specks(part, notes) if options.repair else part for part in nest.parts) if p is not None
    ]
    rings = [c for part in parts for c in (part.outer, *part.holes) if not flat(c.curve)]
    valid = shapely.is_valid(np.array([c.polygon for c in rings], dtype=object))
    crossed = [_loops(rings[k]) for k in np.flatnonzero(~valid).tolist()]
    curves: dict[str, tuple[Curve, ...]] = {}
    crossing: list[_Loops] = []
    for loops in crossed:
        if not loops.pieces:
            continue
        small = (
            loops.slack_mm <= options.join_tolerance_mm and loops.reach_mm <= REPAIR_FACTOR * options.join_tolerance_mm
        )
        if small or (options.repair and loops.dominant):
            curves[loops.contour.id] = (_curve_of(loops.pieces[0]),)
            notes.append(_cut_off(loops))
        else:
            crossing.append(loops)
    if crossing and asking.may_mend(CROSSING):
        answer = asking.ask(_question(crossing))
        curves |= {one.contour.id: _as_answered(one, answer) for one in crossing}
        ids = [one.contour.id for one in crossing]
        notes.append(
            Note(
                "repaired",
                f"{join_names(ids, 6)} crossed {_itself(ids)}: {_DONE[answer]}, {asking.because(CROSSING)}",
                tuple(ids),
            )
        )
    if not curves:
        return nest if not notes else replace(nest, parts=tuple(parts), notes=(*nest.notes, *notes))
    parts = [piece for part in parts for piece in _with_curves(part, curves)]
    return replace(nest, parts=tuple(parts), notes=(*nest.notes, *notes))


def _itself(ids: Sequence[str]) -> str:
    return "itself" if len(ids) == 1 else "themselves"


def _without_specks(part: Part, notes: list[Note]) -> Part | None:
    gone = [c for c in part if (speck if c.kind == "mark" else flat)(c.curve)]
    if part.outer in gone and len(part.holes) + len(part.marks) > len(gone) - 1:
        gone.remove(part.outer)  # a part that still holds something is no speck: let the checks report it
    notes += [Note("repaired", f"{c.id} encloses nothing, {place(c.curve)}: left out", (c.id,)) for c in gone]
    if part.outer in gone:
        return None
    if not gone:
        return part
    holes = tuple(h for h in part.holes if h not in gone)
    return replace(part, holes=holes, marks=tuple(m for m in part.marks if m not in gone))


def _loops(contour: Contour) -> _Loops:
    """The loops of a ring; none of one that crosses itself so often that nobody would mend it."""
    points = contour.curve.flatten(FLATTEN_MM)
    if has_too_many_crossings(points, closed=True, most=MOST_MEETINGS):
        return _Loops(contour, (), 0.0, 0.0, 0.0)
    found = [p for p in shapely.get_parts(shapely.make_valid(shapely.Polygon(points))) if p.geom_type == "Polygon"]
    pieces = sorted(found, key=lambda p: -p.area)
    if not pieces:
        return _Loops(contour, (), 0.0, 0.0, 0.0)
    outline = pieces[0].exterior
    others = [*pieces[1:], *(shapely.Polygon(hole) for hole in pieces[0].interiors)]
    slack_mm = max((2 * float(shapely.maximum_inscribed_circle(p, tolerance=1e-3).length) for p in others), default=0.0)
    reach_mm = float(shapely.distance(shapely.points(points), outline).max())
    return _Loops(contour, tuple(pieces), slack_mm, reach_mm, sum(p.area for p in others))


def _cut_off(loops: _Loops) -> Note:
    name = loops.contour.id
    reason = shapely.is_valid_reason(loops.contour.curve.polygon(FLATTEN_MM))
    at = reason.partition("[")[2].rstrip("]").split()
    where = f" at ({float(at[0]):.3f}, {float(at[1]):.3f})" if len(at) == 2 else ""
    lost = f"{loops.lost_mm2:.3f} mm² that reach {loops.reach_mm:.3f} mm off it"
    return Note("repaired", f"{name} crossed itself{where}: its main loop is kept, without {lost}", (name,))


# Rings that nobody but a person can mend.

_DONE = {
    "largest": "the largest loop is kept",
    "outline": "the outline around all is kept",
    "loops": "each loop is a contour",
    "corners": "the corners are taken in their order round the middle",
}


def _question(crossing: Sequence[_Loops]) -> Question:
    first, count = crossing[0], len(crossing)
    which = f"{first.contour.id} crosses itself" if count == 1 else f"{count} contours cross themselves"
    sizes = ", ".join(f"{p.area:.6g}" for p in first.pieces[:4]) + (" …" if len(first.pieces) > 4 else "")
    largest = Choice("largest", "the largest loop of each, without the others")
    outline = Choice("outline", "the outline around all loops of each")
    loops = Choice("loops", "each loop as a contour of its own")
    choices: tuple[Choice, ...] = (outline, loops, largest)
    if all(_is_bow_tie(one.contour.curve) for one in crossing):
        choices = (Choice("corners", "its four corners, in their order round the middle"), loops, largest)
    elif all(one.dominant for one in crossing):
        choices = (largest, outline, loops)
    at = place(first.contour.curve)
    text = f"{which}, the first is {first.contour.id}, {at}, with loops of {sizes} mm²: what is cut?"
    return Question(CROSSING, text, choices)


def _is_bow_tie(curve: Curve) -> bool:
    return len(curve.segments) == BOW_TIE and not any(segment.is_arc for segment in curve.segments)


def _as_answered(loops: _Loops, answer: str) -> tuple[Curve, ...]:
    if answer == "corners":
        corners = np.array([segment.start for segment in loops.contour.curve.segments])
        off = corners - corners.mean(axis=0)
        return (Curve.of(corners[np.argsort(np.arctan2(off[:, 1], off[:, 0]))]),)
    if answer == "loops":
        return tuple(_curve_of(piece) for piece in loops.pieces)
    if answer == "largest":
        return (_curve_of(loops.pieces[0]),)
    faces = shapely.polygonize([shapely.node(loops.contour.curve.line(FLATTEN_MM))])
    filled = shapely.union_all([shapely.Polygon(face.exterior) for face in faces.geoms])
    parts = sorted(shapely.get_parts(filled), key=lambda p: -p.area)
    return tuple(_curve_of(piece) for piece in parts)


def _curve_of(piece: shapely.Polygon) -> Curve:
    """The outline of a loop, with arcs again where lines were flattened."""
    curve = fit_curve(np.array(piece.exterior.coords))
    if curve is None or not curve.polygon().is_valid:
        return Curve.of(piece.exterior.coords[:-1])
    return curve


def _with_curves(part: Part, curves: dict[str, tuple[Curve, ...]]) -> list[Part]:
    """The part with its mended contours; of an outer one that falls into several, each makes a part of its own."""
    holes = [
        replace(hole, id=_nth(hole.id, k), curve=curve)
        for hole in part.holes
        for k, curve in enumerate(curves.get(hole.id, (hole.curve,)))
    ]
    outers = curves.get(part.outer.id, (part.outer.curve,))
    if len(outers) == 1:
        return [replace(part, outer=replace(part.outer, curve=outers[0]), holes=tuple(holes))]
    found = []
    for k, outer in enumerate(outers):
        name, area = _nth(part.id, k), outer.polygon()
        own = [c for c in (*holes, *part.marks) if area.contains(shapely.Point(c.curve.vertices[0, :2]))]
        named = [replace(c, id=c.id.replace(part.id, name, 1), part=name) for c in own]
        found.append(
            Part(
                name,
                replace(part.outer, id=f"{name}.outer", part=name, curve=outer),
                tuple(c for c in named if c.kind == "hole"),
                tuple(c for c in named if c.kind == "mark"),
            )
        )
    return found


def _nth(name: str, k: int) -> str:
    return name if k == 0 else f"{name}-{k + 1}"
