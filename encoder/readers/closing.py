"""Open lines that a person would close: with gaps, past their corners, or along the edge of a part beside them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Note
from kerfwise.encoder.questions import Choice

from .drawing import SNAP_MM, DrawnCurve
from .join import Joined, face_rings, join
from .options import REPAIR_FACTOR

WIDE_SHARE, WIDE_MM = 0.1, 10.0
"""A line may be closed by a straight one that is no longer than this share of it, and than this."""


CLOSE, SHARED = "open:close", "open:shared"
"""The answers that have lines closed: over gaps and at corners, or along edges of parts."""


@dataclass(frozen=True, eq=False)
class Closing:
    """Closed lines that open ones can become: `rings` of `chains`, and `replaced` rings that they divide.

    `left` are what stays open of the chains.

    `choice` is the answer that has it done; `likely` that nothing else is likelier. `notes` say what was done.
    """

    choice: Choice
    rings: tuple[DrawnCurve, ...]
    chains: tuple[DrawnCurve, ...]
    replaced: tuple[DrawnCurve, ...]
    likely: bool
    notes: tuple[Note, ...]
    left: tuple[DrawnCurve, ...] = ()


def closings(
    chains: Sequence[DrawnCurve], broken: Sequence[DrawnCurve], outers: Sequence[DrawnCurve], tolerance_mm: float
) -> list[Closing]:
    """The ways to close open lines of one layer, the likeliest first.

    `chains`: the open lines of the layer. `broken`: those of them that may be contours which were meant to close.
    `outers`: the outer contours of parts.
    """
    found = [_along_parts(chains, broken, outers, tolerance_mm), _over_gaps(chains, broken, tolerance_mm)]
    return sorted((one for one in found if one is not None), key=lambda one: not one.likely)


# Over gaps and past corners.


def _over_gaps(chains: Sequence[DrawnCurve], broken: Sequence[DrawnCurve], tolerance_mm: float) -> Closing | None:
    across = [(float(np.hypot(*(c.curve.vertices[-1, :2] - c.curve.vertices[0, :2]))), c) for c in chains]
    wide = [gap for gap, c in across if gap <= min(WIDE_SHARE * c.curve.length_mm, WIDE_MM)]
    for reach_mm in (REPAIR_FACTOR * tolerance_mm, max(wide, default=0.0) + SNAP_MM):
        joined = join(chains, tolerance_mm, reach_mm)
        left = {c.order for c in joined.chains}
        if joined.rings and (not left or any(c.order not in left for c in broken)):
            return _closed_over(chains, broken, joined)
    return None


def _closed_over(chains: Sequence[DrawnCurve], broken: Sequence[DrawnCurve], joined: Joined) -> Closing:
    gaps, corners = [g.width_mm for g in joined.gaps], [o.width_mm for o in joined.overruns]
    words = [
        f"{len(widths)} {what if len(widths) == 1 else f'{what}s'} of up to {max(widths):.3f} mm {done}"
        for widths, what, done in ((gaps, "gap", "closed"), (corners, "overrun", "cut off"))
        if widths
    ]
    left = len(joined.chains)
    rest = f"; {left} other open line{'s' if left != 1 else ''} marked in metal, left out in waste" if left else ""
    choice = Choice(CLOSE, f"repaired: {' and '.join(words) or 'closed'}{rest}")
    notes = [*gap_notes(joined), *overrun_notes(joined)]
    notes += [Note("repaired", f"the line {p.place} is drawn twice; it is cut once") for p in joined.repeats]
    meant = {chain.order for chain in broken}
    likely = not any(chain.order in meant for chain in joined.chains)
    return Closing(choice, joined.rings, tuple(chains), (), likely, tuple(notes), joined.chains)


def gap_notes(joined: Joined, over_mm: float = 0.0) -> list[Note]:
    """A word on each gap wider than so much that was closed."""
    return [
        Note("repaired", f"a gap of {g.width_mm:.3f} mm at ({g.at[0]:.3f}, {g.at[1]:.3f}) is closed")
        for g in joined.gaps
        if g.width_mm > over_mm
    ]


def overrun_notes(joined: Joined, over_mm: float = 0.0) -> list[Note]:
    """A word on each corner that lines ran past by more than so much, and were cut back to."""
    return [
        Note(
            "repaired",
            f"lines that ran {o.width_mm:.3f} mm past their corner at ({o.at[0]:.3f}, {o.at[1]:.3f}) are cut back",
        )
        for o in joined.overruns
        if o.width_mm > over_mm
    ]


# Along edges of parts: a line that begins and ends on the outlines of others makes a part with them.


def _along_parts(
    chains: Sequence[DrawnCurve], broken: Sequence[DrawnCurve], outers: Sequence[DrawnCurve], tolerance_mm: float
) -> Closing | None:
    """Parts that share an edge with others, of lines whose ends lie on other lines."""
    lines = [*outers, *chains]
    tree = shapely.STRtree([line.curve.line() for line in lines])
    hanging = [c for c in chains if all(_held(c, end, lines, tree, tolerance_mm) for end in (0, -1))]
    if not hanging:
        return None
    reach = shapely.union_all([c.curve.line() for c in hanging])
    near = [o for o in outers if shapely.dwithin(o.curve.line(), reach, tolerance_mm)]
    if not near:
        return None
    edges = [piece for line in near for piece in split_at_vertices(line, (*near, *hanging), tolerance_mm)]
    new = [piece for line in hanging for piece in split_at_vertices(line, (*near, *hanging), tolerance_mm)]
    of_chains = {id(piece) for piece in new}
    rings: list[DrawnCurve] = []
    divided: list[DrawnCurve] = []
    for ring, of in face_rings([*edges, *new], tolerance_mm):
        middle = shapely.point_on_surface(ring.area)
        if not of_chains & {id(piece) for piece in of}:
            continue
        own = [o for o in near if o.area.contains(middle)]
        divided += [o for o in own if o not in divided]
        rings.append(ring)
    if not rings:
        return None
    first = hanging[0].curve.vertices[[0, -1], :2].tolist()
    count = len(rings)
    which = "1 part that shares" if count == 1 else f"{count} parts that share"
    common = "cuts.common: {shortest: 20 mm, accept_loss: true}"
    words = f"cut: {which} an edge with another, which one cut makes ({common})"
    place = " to ".join(f"({x:.3f}, {y:.3f})" for x, y in first)
    text = f"open lines closed along the edges of parts: {which} an edge with another, the first line from {place}"
    note = Note("repaired", text)
    in_waste = not any(shapely.buffer(o.area, -tolerance_mm).intersects(reach) for o in near)
    likely = in_waste and all(c in hanging for c in broken)
    return Closing(Choice(SHARED, words), tuple(rings), tuple(hanging), tuple(divided), likely, (note,))


def _held(chain: DrawnCurve, end: int, lines: Sequence[DrawnCurve], tree: shapely.STRtree, tolerance_mm: float) -> bool:
    """Whether an end lies on another line."""
    at = shapely.Point(chain.curve.vertices[end, :2])
    return any(lines[k] is not chain for k in tree.query(at, predicate="dwithin", distance=tolerance_mm).tolist())


def split_at_vertices(line: DrawnCurve, lines: Sequence[DrawnCurve], tolerance_mm: float) -> list[DrawnCurve]:
    """The pieces of a line, cut where vertices of others lie on it, and ending on those; none of a ring without."""
    shape, curve = line.curve.line(), line.curve
    others = np.concatenate([o.curve.vertices[:, :2] for o in lines if o is not line])
    on = others[shapely.dwithin(shapely.points(others), shape, tolerance_mm)]
    length_mm = curve.length_mm
    cuts: list[tuple[float, tuple[float, float]]] = [] if curve.closed else [
        (0.0, _xy(curve.vertices[0])), (length_mm, _xy(curve.vertices[-1]))
    ]  # fmt: skip
    for x, y in on.tolist():
        at_mm, _ = curve.project((x, y))
        apart = [min(abs(at_mm - s), length_mm - abs(at_mm - s) if curve.closed else np.inf) for s, _ in cuts]
        if min(apart, default=np.inf) > tolerance_mm:
            cuts.append((at_mm, (x, y)))
    cuts.sort()
    if curve.closed:
        if not cuts:
            return []
        cuts.append((cuts[0][0] + length_mm, cuts[0][1]))
    pieces = []
    for (start, a), (end, b) in pairwise(cuts):
        rows = curve.between(start, end - start).vertices.copy()
        rows[0, :2], rows[-1, :2] = a, b
        pieces.append(replace(line, curve=Curve(rows, closed=False)))
    return pieces


def _xy(vertex: Sequence[float]) -> tuple[float, float]:
    return float(vertex[0]), float(vertex[1])
