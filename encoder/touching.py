"""Parts whose straight edges touch, drawn half a kerf smaller there: one cut between them makes both, and each loses.

What is left stands one kerf apart, as parts with common edges do. An edge is moved as a whole, with all that lies in
line with it, so that it stays straight: the part loses half a kerf along all of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from .candidates.common_edges import FacingEdge, facing_edges
from .components import weak_components
from .errors import InputError
from .geometry.curve import Curve
from .geometry.trimmed import edge_moved_in
from .kept import kept_with_nest
from .nest import Contour, Loss, Nest, with_parts

_OVERLAP_MM = 0.01


@kept_with_nest(most=4)
def with_loss(nest: Nest, kerf_mm: float, shortest_mm: float, within_mm: float) -> Nest:
    """The nest without what touching parts lose to the cut between them; it keeps the nest as drawn.

    Edges touch where they look at each other and are no more than `within_mm` apart. Of parts that hang together by
    such edges one has to touch along `shortest_mm` at least; else none is changed. What was noted of pairs that touch
    is answered by what they lose (`losses`), and left out of the notes.

    Raises
    ------
    InputError
        If an edge cannot be moved: what lies beside it is too small, or a hole too near.

    Examples
    --------
    >>> from kerfwise.encoder.by_hand import nest, part, rect
    >>> two = nest(300, 200, part("A", rect(10, 10, 80, 60)), part("B", rect(90, 30, 80, 60)))
    >>> made = with_loss(two, 1.5, 20.0, 0.05)
    >>> [contour.polygon.bounds for contour in made.contours]
    [(10.0, 10.0, 89.25, 70.0), (90.75, 30.0, 170.0, 90.0)]
    >>> [(loss.contour, loss.others, loss.loss_mm) for loss in made.losses]
    [('A.outer', ('B.outer',), 0.75), ('B.outer', ('A.outer',), 0.75)]
    """
    touching = list(_touching(nest, shortest_mm, within_mm)) if kerf_mm > 0 else []
    rows: dict[int, list[FacingEdge]] = {}
    for edge in touching:
        rows.setdefault(edge.contour, []).append(edge)
    if not rows:
        return nest
    problems: list[str] = []
    moved = {}
    for number, edges in sorted(rows.items()):
        contour = nest.contours[number]
        try:
            moved[contour.id] = replace(contour, curve=_moved_in(nest, contour, edges, kerf_mm / 2))
        except ValueError as error:
            problems.append(f"{contour.id}: {error}")
    if problems:
        raise InputError(
            f"an edge that touches another part cannot lose half a kerf, {kerf_mm / 2:g} mm "
            "(cuts.common.accept_loss): leave a web there",
            file=nest.file or None,
            details=tuple(problems),
        )
    parts = (replace(p, outer=moved[p.outer.id]) if p.outer.id in moved else p for p in nest.parts)
    losses = []
    for number, edges in sorted(rows.items()):
        others = tuple(nest.contours[k].id for k in sorted({edge.other for edge in edges}))
        losses.append(Loss(nest.contours[number].id, others, kerf_mm / 2))
    told = {frozenset((loss.contour, other)) for loss in losses for other in loss.others}
    notes = tuple(note for note in nest.notes if note.common or frozenset(note.contours) not in told)
    return replace(with_parts(nest, tuple(parts)), losses=tuple(losses), notes=notes)


def _touching(nest: Nest, shortest_mm: float, within_mm: float) -> Iterator[FacingEdge]:
    """Edges of two outer contours that touch, of parts that hang together by one as long as asked."""
    outers = [(k, c) for k, c in enumerate(nest.contours) if c.kind == "outer"]
    found = [edge for edge in facing_edges(outers, 0.0, within_mm) if edge.length_mm > _OVERLAP_MM]
    if not found:
        return
    pairs = np.array([(edge.contour, edge.other) for edge in found], dtype=np.int64)
    label = weak_components(len(nest.contours), pairs)
    long = {int(label[edge.contour]) for edge in found if edge.length_mm >= shortest_mm}
    yield from (edge for edge in found if int(label[edge.contour]) in long)


def _moved_in(nest: Nest, contour: Contour, edges: Sequence[FacingEdge], by_mm: float) -> Curve:
    curve = contour.curve.towards("ccw")
    for edge in edges:
        curve = edge_moved_in(curve, edge.begin, edge.end, by_mm)
    area, part = curve.polygon(), nest.part_of[contour.part]
    if not area.is_valid:
        raise ValueError("what is left would cross itself")
    for hole in part.holes:
        if not area.contains(hole.polygon):
            raise ValueError(f"{hole.id} is nearer to the edge than that")
    return curve if contour.curve.is_ccw else curve.reversed()
