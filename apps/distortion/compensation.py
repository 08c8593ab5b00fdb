"""Parts drawn otherwise than they are wanted, by as much as they will be off: cut and cold, they are as wanted.

How a part is off is a field over it: larger or smaller along x and along y, and, where its shape is compensated as
well, sheared and bent. It is fitted to the points that were followed and taken off the drawing. What was done is kept
with the part, so that from then on its errors are told against what is wanted.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import shapely

from kerfwise.encoder.cut import Tab
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point, Segment
from kerfwise.encoder.nest import Contour, Nest, Part

from .change import COMPENSATED, POWERS, Change, change_of, middle_of
from .part_errors import PartError, fit_rigid

Kind = Literal["size", "shape"]
MOST_SHARE = 0.005
"""No cut makes a part larger or smaller by more than that."""
CLOSE_MM = 0.005
"""So near edges of a changed part are to what the field makes of them."""
LEAST_TOLD = 0.005
"""mm per m that are worth a word."""
MOST_PIECES = 64
TOLD_APART = 0.01
"""Fields that are so nearly alike at the points followed share what is found: round a disc, x² + y² is a mere shift."""


def fitted(part: Part, error: PartError, kind: Kind) -> Change:
    """How the cold part is off, as a field: of its size alone, or of its shape too, by weighted least squares."""
    single = np.eye(2 * len(POWERS)).reshape(-1, 2, len(POWERS))
    turn = single[len(POWERS)] - single[1]
    fields = np.stack([single[0], single[len(POWERS) + 1], turn]) if kind == "size" else single
    columns = [Change(middle_of(part), field).at(error.xy) for field in fields]
    columns += [np.broadcast_to(shift, error.xy.shape) for shift in np.eye(2)]
    root = np.sqrt(error.length_mm)[:, None]
    weighed = (np.stack(columns, axis=-1) * root[:, :, None]).reshape(-1, len(columns))
    norms = np.linalg.norm(weighed, axis=0)
    norms[norms == 0.0] = 1.0
    best = np.linalg.lstsq(weighed / norms, (error.off * root).ravel(), rcond=TOLD_APART)[0] / norms
    by = np.tensordot(best[: len(fields)], fields, 1)
    turned = (by[1, 0] - by[0, 1]) / 2  # where the part lies is nobody's concern
    return Change(middle_of(part), by - turned * turn)


def left_mm(nest: Nest, errors: Sequence[PartError], kind: Kind) -> float:
    """The mean over the parts of what each would be off at its worst place, were it compensated, mm."""
    left = []
    for part, error in zip(nest.parts, errors, strict=True):
        if error.max_mm is not None:
            off = fit_rigid(error.xy, error.off - fitted(part, error, kind).at(error.xy), error.length_mm)
            left.append(float(np.hypot(*off.T).max()))
    return sum(left) / len(left) if left else 0.0


def size_lines(nest: Nest, errors: Sequence[PartError]) -> Iterator[str]:
    """What is told of a nest: by how much its parts come out too small, and what compensation would leave."""
    known = [(part, error) for part, error in zip(nest.parts, errors, strict=True) if error.max_mm is not None]
    shares = [float(fitted(part, error, "size").by[[0, 1], [0, 1]].mean()) for part, error in known]
    if not shares or max(map(abs, shares)) < LEAST_TOLD:
        return
    mean = sum(shares) / len(shares)
    small = "small" if mean <= 0 else "large"
    yield f"{'size':10} too {small} by {abs(mean):.2f} mm per m on average ({min(shares):+.2f} to {max(shares):+.2f})"
    of_size, of_shape = (left_mm(nest, errors, kind) for kind in ("size", "shape"))
    yield f"{'would be':10} {of_size:.2f} mm with size compensated, {of_shape:.2f} mm with the shape (--compensated)"
    if any(COMPENSATED in part.attributes for part in nest.parts):
        yield f"{'against':10} the drawing before compensation"


@dataclass(frozen=True, eq=False, slots=True)
class Compensated:
    """A nest whose parts are drawn so that they come out as wanted, and how each of them was changed, by its id."""

    nest: Nest
    changes: dict[str, Change]

    def line(self, watts: float) -> str:
        """What was done, and on what assumption: the power that the sheet absorbs."""
        shares = sorted(1.0 + change.share for change in self.changes.values())
        span = f"{shares[0]:.5f} to {shares[-1]:.5f} times as large" if shares else "as they were"
        return (
            f"{len(shares)} of {len(self.nest.parts)} parts drawn {span}, for this plan and {watts:g} W in the sheet "
            "(heat.absorbed_power_w); plan the new nest, and look at its errors, which are told against the drawing"
        )


def compensated(nest: Nest, errors: Sequence[PartError], kind: Kind, kerf_mm: float) -> Compensated:
    """The nest, as it is drawn, with each part changed by what it will be off; one that is not cut stays.

    Raises InputError if a part would be changed by more than any cut does, gaps between parts became narrower than the
    kerf, a part reached over the edge of the sheet, or bridges join parts.
    """
    drawn = nest.drawn or nest
    if drawn.bridges or drawn.apart:
        raise InputError("parts that bridges join cannot be compensated: take the bridges out of the drawing first")
    changes: dict[str, Change] = {}
    parts = list(drawn.parts)
    for k, (part, error) in enumerate(zip(drawn.parts, errors, strict=True)):
        if error.max_mm is None:
            continue
        off = fitted(part, error, kind)
        before = change_of(part)
        change = Change(off.middle, (0.0 if before is None else before.by) - off.by)
        corners = part.outer.polygon.envelope.exterior.coords[:4]
        moved_mm, most_mm = np.hypot(*change.at(np.array(corners)).T).max(), MOST_SHARE * math.dist(*corners[::2]) / 2
        if moved_mm > most_mm:
            raise InputError(
                f"{escape_text(part.id)} would be drawn otherwise by {moved_mm:.2f} mm, more than any cut asks for "
                f"({most_mm:.2f} mm): look at heat.absorbed_power_w and at the material"
            )
        said = {"along_x": change.by[0].round(6).tolist(), "along_y": change.by[1].round(6).tolist()}
        parts[k] = replace(
            _changed(part, Change(off.middle, -off.by)), attributes={**part.attributes, COMPENSATED: said}
        )
        changes[part.id] = change
    made = replace(drawn, parts=tuple(parts), sha256="", notes=(), reading=None)
    if wrong := tuple(_too_near(drawn, made, kerf_mm)):
        raise InputError("there is no room for the parts as large as they would have to be", details=wrong)
    return Compensated(made, changes)


def _too_near(before: Nest, after: Nest, kerf_mm: float) -> Iterator[str]:
    """Parts that are nearer to each other than a kerf, or over the edge of the sheet, and were not or less before."""
    was, now = ([part.polygon for part in nest.parts] for nest in (before, after))
    one, other = shapely.STRtree(now).query(now, "dwithin", distance=kerf_mm)
    for i, j in sorted((int(i), int(j)) for i, j in zip(one, other, strict=True) if i < j):
        apart_mm = float(now[i].distance(now[j]))
        if apart_mm < min(kerf_mm, float(was[i].distance(was[j]))) or now[i].intersects(now[j]):
            names = (escape_text(after.parts[k].id) for k in (i, j))
            yield f"{' and '.join(names)} would lie {apart_mm:.3f} mm apart: the kerf is {kerf_mm:g} mm wide"
    for part, metal, old in zip(after.parts, now, was, strict=True):
        over_mm2 = float(metal.difference(after.sheet.polygon).area)
        if over_mm2 > float(old.difference(before.sheet.polygon).area) + CLOSE_MM:
            yield f"{escape_text(part.id)} would reach over the edge of the sheet"


# A changed part, contour by contour.


def _changed(part: Part, change: Change) -> Part:
    def contour(old: Contour) -> Contour:
        edges = tuple(replace(one, edge=_curve(one.edge, change)) for one in old.edge_bevels)
        return replace(old, curve=_curve(old.curve, change), edge_bevels=edges)

    return replace(
        part,
        outer=contour(part.outer),
        holes=tuple(map(contour, part.holes)),
        marks=tuple(map(contour, part.marks)),
        slits=tuple(map(contour, part.slits)),
        tabs=tuple(Tab(_points([tab.at], change)[0], tab.width_mm) for tab in part.tabs),
    )


def _points(points: Sequence[Point], change: Change) -> list[Point]:
    xy = np.array(points)
    return [(x, y) for x, y in (xy + change.at(xy)).round(6).tolist()]


def _curve(curve: Curve, change: Change) -> Curve:
    """The curve moved; its lines and arcs are divided where pieces as few would not lie as near as `CLOSE_MM`."""
    rows: list[tuple[float, ...]] = []
    segments = curve.segments
    for segment in segments:
        rows += _pieces(segment, change)
    if not curve.closed:
        rows.append((*_points([segments[-1].end], change)[0], 0.0))
    return Curve.of(rows, curve.closed)


def _pieces(segment: Segment, change: Change) -> list[tuple[float, ...]]:
    """The segment moved: rows of x, y and bulge, without its end."""
    count = 1
    while True:
        at = [segment.point_at(k / (4 * count)) for k in range(4 * count + 1)]
        moved = _points(at, change)
        rows, off_mm = [], 0.0
        for a, early, half, late, b in zip(*(moved[k::4] for k in range(4)), moved[4::4]):  # noqa: B905
            bulge = _bulge(a, half, b) if segment.bulge else 0.0
            rows.append((*a, bulge))
            piece = Segment(a, b, bulge)
            off_mm = max(
                off_mm, *(math.dist(piece.point_at(s), p) for s, p in ((0.25, early), (0.5, half), (0.75, late)))
            )
        if off_mm < CLOSE_MM or count >= MOST_PIECES:
            return rows
        count *= 2


def _bulge(begin: Point, half: Point, end: Point) -> float:
    """The bulge of the arc from one point to another that passes so near to a third in its middle."""
    dx, dy = end[0] - begin[0], end[1] - begin[1]
    mx, my = half[0] - (begin[0] + end[0]) / 2, half[1] - (begin[1] + end[1]) / 2
    return 2.0 * (dy * mx - dx * my) / (dx * dx + dy * dy)
