"""What parts that touch lose to the one cut between them: no more than half a kerf, and only along edges that touch."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely

from kerfwise.encoder.geometry.segment import Segment
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.rules.rule import Violation

_RULE = "edge-loss"
_CHORD_MM, _SLACK_MM, _LEAST_MM2 = 0.001, 0.01, 0.01
_NAMED = 5


def lost_elsewhere(nest: Nest, kerf_mm: float, touch_mm: float) -> Iterator[Violation]:
    """Where a part that is judged is not the drawn one less half a kerf along straight edges that touch another part.

    Found from the areas of the drawn part and of the judged one: edges touch where another outline is no more than
    `touch_mm` away along some of them.
    """
    drawn = nest.drawn
    if drawn is None:
        return
    pairs = enumerate(zip(drawn.parts, nest.parts, strict=True))
    changed = [(k, before, after) for k, (before, after) in pairs if after.outer.curve is not before.outer.curve]
    if not changed:
        return
    outlines = [part.outer.curve.line(_CHORD_MM) for part in drawn.parts]
    tree = shapely.STRtree(outlines)
    for k, before, after in changed:
        was, now = (contour.curve.polygon(_CHORD_MM) for contour in (before.outer, after.outer))
        near = [outlines[j] for j in tree.query(outlines[k], "dwithin", distance=touch_mm).tolist() if j != k]
        allowed = _bands(before.outer, near, kerf_mm / 2 + _SLACK_MM, touch_mm)
        elsewhere = shapely.difference(shapely.difference(was, now), allowed)
        grown = shapely.difference(now, was)
        for area, does in ((elsewhere, "loses"), (grown, "gains")):
            if area.area > _LEAST_MM2:
                x, y = area.centroid.coords[0]
                text = f"{before.outer.id} {does} {area.area:.2f} mm² at ({x:z.1f}, {y:z.1f}), where no edge touches"
                yield Violation(_RULE, (before.outer.id,), text)


def _bands(contour: Contour, near: list[shapely.LineString], wide_mm: float, touch_mm: float) -> shapely.Geometry:
    """What lies so near to the lines of straight edges that touch another outline."""
    others = shapely.buffer(shapely.union_all(near), touch_mm)
    edges = [s for s in contour.curve.segments if not s.is_arc]
    lines = shapely.linestrings([(s.start, s.end) for s in edges])
    meet_mm = shapely.length(shapely.intersection(lines, others))
    touching = [edges[k] for k in np.flatnonzero(meet_mm > 2 * touch_mm).tolist()]
    around = contour.polygon.length
    return shapely.buffer(shapely.union_all([_line(s, around) for s in touching]), wide_mm, cap_style="flat")


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
    shown = ", ".join(names[:_NAMED]) + (f" and {len(names) - _NAMED} more" if len(names) > _NAMED else "")
    parts = "a part that touches another loses" if len(names) == 1 else f"{len(names)} parts that touch others lose"
    yield f"{parts} half a kerf along those edges (cuts.common.accept_loss): {shown}"
