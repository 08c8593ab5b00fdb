"""What parts that touch lose to the one cut between them: no more than half a kerf, and only along edges that touch."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.encoder.geometry.segment import Segment
from kerfwise.encoder.listed import listed
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.rules.rule import Violation

_RULE = "edge-loss"
_CHORD_MM, _SLACK_MM, _LEAST_MM2 = 0.001, 0.01, 0.01
_NAMED = 5
_MEETS, _SURELY = 2, 20
"""An edge that comes to another outline at a right angle is near it for twice as far as counts as touching; edges that
touch for 20 times as far do not only do so near a corner."""
_ALONG, _INSIDE_MM = math.sin(math.radians(0.19)), 0.002
"""Edges that turn by less, and are nearer by so much than counts as touching, do touch: at a larger angle they part."""


@dataclass(frozen=True, slots=True)
class Accepted:
    """Which losses are accepted: along edges that touch, within `touch_mm`, if one of the edges by which the parts hang
    together touches along `shortest_mm`, which is infinite where no loss is."""

    touch_mm: float
    shortest_mm: float


@dataclass(frozen=True, eq=False, slots=True)
class _Touching:
    """The straight edges of a drawn outline that touch others, those of them that surely do, along another edge and
    not only near a corner, the parts that they touch, and along how much at the most, mm."""

    edges: tuple[Segment, ...]
    surely: tuple[Segment, ...]
    others: tuple[int, ...]
    longest_mm: float


def lost_elsewhere(nest: Nest, kerf_mm: float, accepted: Accepted) -> Iterator[Violation]:
    """Where a part that is judged is not the drawn one less half a kerf along straight edges that touch another part.

    Found from the areas of the drawn part and of the judged one, whoever made that: edges touch where another outline
    is no more than `touch_mm` away along some of them. The whole strip along such an edge has to be lost, nothing else
    may be, and the loss has to be one that is accepted.
    """
    drawn = nest.drawn
    if drawn is None:
        return
    pairs = enumerate(zip(drawn.parts, nest.parts, strict=True))
    changed = {k: (before, after) for k, (before, after) in pairs if after.outer.curve is not before.outer.curve}
    if not changed:
        return
    outlines = [part.outer.curve.line(_CHORD_MM) for part in drawn.parts]
    tree = shapely.STRtree(outlines)
    touching = {k: _touching(k, drawn, outlines, tree, accepted.touch_mm) for k in changed}
    longest_mm = _longest_mm(touching)
    for k, (before, after) in changed.items():
        name, along_mm = before.outer.id, longest_mm[k]
        if along_mm < accepted.shortest_mm - 2 * accepted.touch_mm:
            least = "the profile accepts no loss"
            if math.isfinite(accepted.shortest_mm):
                least = f"its parts touch along {along_mm:.2f} mm at the most, {accepted.shortest_mm:g} are asked"
            yield Violation(
                _RULE, (name,), f"{name} loses metal along its edges (cuts.common.accept_loss), and {least}"
            )
            continue
        for area, does in _wrongly(before.outer, after.outer, kerf_mm / 2, touching[k]):
            if area.area > _LEAST_MM2:
                x, y = area.centroid.coords[0]
                what = does.format(f"{area.area:.2f} mm² at ({x:z.1f}, {y:z.1f})")
                yield Violation(_RULE, (name,), f"{name} {what}")


def _wrongly(
    before: Contour, after: Contour, by_mm: float, touching: _Touching
) -> Iterator[tuple[shapely.Geometry, str]]:
    """Areas that a part loses, gains or keeps, and should not."""
    was, now = (contour.curve.polygon(_CHORD_MM) for contour in (before, after))
    allowed = _strips(touching.edges, by_mm + _SLACK_MM, before.polygon.length)
    lost = shapely.intersection(_strips(touching.surely, by_mm - _SLACK_MM, 0.0), was)
    yield shapely.difference(shapely.difference(was, now), allowed), "loses {}, where no edge touches"
    yield shapely.difference(now, was), "gains {}, where no edge touches"
    yield shapely.intersection(now, lost), "keeps {}, beside an edge that touches"


def _touching(
    k: int, drawn: Nest, outlines: list[shapely.LineString], tree: shapely.STRtree, touch_mm: float
) -> _Touching:
    edges = [s for s in drawn.parts[k].outer.curve.segments if not s.is_arc]
    lines = shapely.linestrings([(s.start, s.end) for s in edges])
    near = [j for j in tree.query(outlines[k], "dwithin", distance=touch_mm).tolist() if j != k]
    meet_mm = np.array([
        shapely.length(shapely.intersection(lines, shapely.buffer(outlines[j], touch_mm))) for j in near
    ]).reshape(len(near), len(edges))  # fmt: skip
    own = tuple(edges[e] for e in np.flatnonzero((meet_mm > _MEETS * touch_mm).any(axis=0)).tolist())
    others_edges = [s for j in near for s in drawn.parts[j].outer.curve.segments if not s.is_arc]
    surely = tuple(edge for edge in own if _surely_touches(edge, others_edges, touch_mm))
    others = np.flatnonzero((meet_mm > _MEETS * touch_mm).any(axis=1)).tolist()
    return _Touching(own, surely, tuple(near[j] for j in others), float(meet_mm.max(initial=0.0)))


def _surely_touches(edge: Segment, others: Sequence[Segment], touch_mm: float) -> bool:
    """Whether an edge lies along one of others for as far as they look at each other."""
    if not others:
        return False
    along = np.array(edge.tangent_at(0.0))
    ends = np.array([(s.start, s.end) for s in others]) - np.array(edge.start)
    at_mm, off_mm = ends @ along, ends @ np.array([-along[1], along[0]])
    step_mm = at_mm[:, 1] - at_mm[:, 0]
    slope = np.divide(off_mm[:, 1] - off_mm[:, 0], step_mm, out=np.full(len(others), np.inf), where=step_mm != 0)
    low, high = np.maximum(at_mm.min(axis=1), 0.0), np.minimum(at_mm.max(axis=1), edge.length_mm)
    k = np.flatnonzero((np.abs(slope) <= _ALONG) & (high - low > _SURELY * touch_mm))
    off = [off_mm[k, 0] + slope[k] * (place_mm[k] - at_mm[k, 0]) for place_mm in (low, high)]
    return bool((np.abs(off).max(axis=0, initial=0.0) <= touch_mm - _INSIDE_MM).any())


def _longest_mm(touching: Mapping[int, _Touching]) -> dict[int, float]:
    """Along how much one of the edges touches, at the most, by which each part hangs together with others."""
    touched_by = defaultdict(list)
    for k, row in touching.items():
        for j in row.others:
            touched_by[j].append(k)
    found: dict[int, float] = {}
    for k in sorted(touching, key=lambda k: touching[k].longest_mm, reverse=True):
        ahead = [k]
        while ahead:
            if (one := ahead.pop()) not in found:
                found[one] = touching[k].longest_mm
                ahead += touched_by[one]
    return found


def _strips(edges: Sequence[Segment], wide_mm: float, further_mm: float) -> shapely.Geometry:
    """What lies so near to the lines of edges, that far beyond their ends."""
    lines = shapely.union_all([_line(s, further_mm) for s in edges])
    return shapely.buffer(lines, wide_mm, cap_style="flat")


def _line(s: Segment, by_mm: float) -> shapely.LineString:
    """The line of an edge, so much longer at both ends."""
    (x, y), (dx, dy) = s.start, s.tangent_at(0.0)
    far = s.length_mm + by_mm
    return shapely.LineString([(x - by_mm * dx, y - by_mm * dy), (x + far * dx, y + far * dy)])


def told_of_losses(nest: Nest) -> Iterator[str]:
    """That parts lose metal: a check never passes over it in silence."""
    if not nest.losses:
        return
    names = [f"{loss.contour} ({loss.loss_mm:.3g} mm)" for loss in nest.losses]
    parts = "a part that touches another loses" if len(names) == 1 else f"{len(names)} parts that touch others lose"
    yield f"{parts} half a kerf along those edges (cuts.common.accept_loss): {listed(names, _NAMED)}"
    if marks := list(_marks_lost(nest)):
        yield f"made and then cut away, where the part loses its edge: {listed(marks, _NAMED)}"


def _marks_lost(nest: Nest) -> Iterator[str]:
    """Marks of which something lies in what their part loses."""
    if nest.drawn is None:
        return
    losing = {loss.contour for loss in nest.losses}
    for before, after in zip(nest.drawn.parts, nest.parts, strict=True):
        if before.outer.id in losing:
            lost = shapely.difference(before.outer.polygon, after.outer.polygon)
            yield from (mark.id for mark in after.marks if shapely.intersection(mark.line, lost).length > _SLACK_MM)
