"""The path that a program names where its control adds the kerf: the torch's own, half the kerf aside."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

from kerfwise.encoder.cut import Direction
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point, Segment

NOTHING_MM = 1e-6
STUB_MM = 0.02
_CORNER_MM, _STRAIGHT_RAD = 1e-3, 0.01
_BENT_RAD = 0.2
"""By how much the torch may turn away from its side where no arc rounds the corner: controls make an arc of it."""


def keeps_left(kind: str, direction: Direction) -> bool | None:
    """Whether the torch has the contour to its right; None where it is on the contour itself: marks, slits, scrap.

    Examples
    --------
    >>> keeps_left("outer", "cw"), keeps_left("hole", "cw"), keeps_left("mark", "ccw")
    (True, False, None)
    """
    if kind not in ("outer", "hole"):
        return None
    return (kind == "outer") == (direction == "cw")


def named_path(way: Sequence[Segment], left: bool, kerf_mm: float) -> list[tuple[Segment, ...]]:
    """What a program names of each line and arc of the torch's `way`: nothing of arcs about a corner of the contour.

    A lead that joins, or leaves, at the end of such an arc does so STUB_MM further off, so that controls, which round
    that corner themselves, make all of the arc. Raises InputError if the torch turns where no control would follow a
    path beside it.

    Examples
    --------
    >>> way = [Segment((0, 1), (9, 1)), Segment((9, 1), (10, 0), -math.tan(math.pi / 8)), Segment((10, 0), (10, -9))]
    >>> [[(s.start, s.end) for s in named] for named in named_path(way, True, 2.0)]
    [[((0.0, 0.0), (9.0, 0.0))], [], [((9.0, 0.0), (9.0, -9.0))]]
    """
    aside_mm = (-1 if left else 1) * kerf_mm / 2  # to the left of the torch's way
    rows = [(k, segment) for k, segment in _with_stubs(way, aside_mm) if not _is_corner(segment, aside_mm)]
    moved = [_moved(segment, aside_mm) for _, segment in rows]
    for j, k in pairwise(range(len(rows))):
        before, after = moved[j], moved[k]
        if math.dist(before.end, after.start) <= NOTHING_MM:
            continue
        corner = _meeting(before, after)
        if corner is None or _turns_away(rows[j][1], rows[k][1], left):
            x, y = rows[k][1].start
            raise InputError(
                f"kerf: the torch turns at ({x:.3f}, {y:.3f}) where no control could keep beside a path: write the "
                "kerf into the path (leave kerf out of the dialect), or take straight leads"
            )
        moved[j], moved[k] = _ending(before, corner), _beginning(after, corner)
    named: list[tuple[Segment, ...]] = [()] * len(way)
    for (k, _), segment in zip(rows, moved, strict=True):
        named[k] += (segment,)
    return named


def _with_stubs(way: Sequence[Segment], aside_mm: float) -> Iterator[tuple[int, Segment]]:
    """The way with its numbers, and a stub in front of and behind an arc about a corner that a lead joins or leaves."""
    way = list(way)
    corners = [_is_corner(segment, aside_mm) for segment in way]
    for k, segment in enumerate(way):
        joined, left = corners[k] and not _runs_on(way, k - 1), corners[k] and not _runs_on(way, k)
        if k + 1 < len(way) and corners[k + 1] and not _runs_on(way, k) and not segment.is_arc:
            segment = Segment(segment.start, _further(way[k + 1], 0.0, -STUB_MM))
        if k and corners[k - 1] and not _runs_on(way, k - 1) and not segment.is_arc:
            segment = Segment(_further(way[k - 1], 1.0, STUB_MM), segment.end)
        if joined:
            yield k, Segment(_further(segment, 0.0, -STUB_MM), segment.start)
        yield k, segment
        if left:
            yield k, Segment(segment.end, _further(segment, 1.0, STUB_MM))


def _runs_on(way: Sequence[Segment], k: int) -> bool:
    """Whether the way goes straight on from a line or arc to the next."""
    if not 0 <= k < len(way) - 1:
        return False
    (ax, ay), (bx, by) = way[k].tangent_at(1.0), way[k + 1].tangent_at(0.0)
    return abs(math.atan2(ax * by - ay * bx, ax * bx + ay * by)) < _STRAIGHT_RAD


def _further(segment: Segment, fraction: float, mm: float) -> Point:
    (x, y), (dx, dy) = segment.point_at(fraction), segment.tangent_at(fraction)
    return x + dx * mm, y + dy * mm


def run_up(first: Segment, length_mm: float) -> Point:
    """Where the torch is before it runs up to a path, straight on to its first line or arc."""
    (x, y), (dx, dy) = first.start, first.tangent_at(0.0)
    return x - dx * length_mm, y - dy * length_mm


def _over_mm(segment: Segment, left_mm: float) -> float:
    """The radius that is left of an arc which is moved so far to its left; that of a line is infinite."""
    return segment.radius_mm - (math.copysign(left_mm, left_mm * segment.bulge) if segment.is_arc else 0.0)


def _is_corner(segment: Segment, left_mm: float) -> bool:
    """Whether an arc shrinks to the corner that it is about."""
    if (over_mm := _over_mm(segment, left_mm)) < -_CORNER_MM:
        x, y = segment.start
        raise InputError(
            f"kerf: the torch turns at ({x:.3f}, {y:.3f}) about less than half the kerf, on the side of the part: "
            "no control could keep beside such a path; write the kerf into the path (leave kerf out of the dialect)"
        )
    return over_mm < _CORNER_MM


def _moved(segment: Segment, left_mm: float) -> Segment:
    """A line or arc so far to its left."""
    ends = []
    for fraction, (x, y) in ((0.0, segment.start), (1.0, segment.end)):
        dx, dy = segment.tangent_at(fraction)
        ends.append((x - dy * left_mm, y + dx * left_mm))
    return replace(segment, start=ends[0], end=ends[1])


def _turns_away(before: Segment, after: Segment, left: bool) -> bool:
    (ax, ay), (bx, by) = before.tangent_at(1.0), after.tangent_at(0.0)
    turn = math.atan2(ax * by - ay * bx, ax * bx + ay * by)
    return (-turn if left else turn) > _BENT_RAD


def _meeting(before: Segment, after: Segment) -> Point | None:
    """Where the lines or circles of two segments meet, nearest to where they should."""
    near = ((before.end[0] + after.start[0]) / 2, (before.end[1] + after.start[1]) / 2)
    if not before.is_arc and not after.is_arc:
        found = _of_lines(before, after)
    elif before.is_arc and after.is_arc:
        found = _of_circles(before, after)
    else:
        found = _of_line_and_circle(*((before, after) if after.is_arc else (after, before)))
    return min(found, key=lambda at: math.dist(at, near), default=None)


def _of_lines(one: Segment, other: Segment) -> list[Point]:
    (x, y), (dx, dy) = one.end, one.tangent_at(1.0)
    (u, v), (ex, ey) = other.start, other.tangent_at(0.0)
    across = dx * ey - dy * ex
    if abs(across) < 1e-12:
        return []
    along = ((u - x) * ey - (v - y) * ex) / across
    return [(x + along * dx, y + along * dy)]


def _of_line_and_circle(line: Segment, arc: Segment) -> list[Point]:
    (x, y), (dx, dy), (cx, cy) = line.start, line.tangent_at(0.0), arc.centre
    foot = (cx - x) * dx + (cy - y) * dy
    off_mm = abs((cx - x) * dy - (cy - y) * dx)
    half = arc.radius_mm**2 - off_mm**2
    if half < -1e-9:
        return []
    reach = math.sqrt(max(half, 0.0))
    return [(x + t * dx, y + t * dy) for t in (foot - reach, foot + reach)]


def _of_circles(one: Segment, other: Segment) -> list[Point]:
    (ax, ay), (bx, by), r, q = one.centre, other.centre, one.radius_mm, other.radius_mm
    apart = math.dist((ax, ay), (bx, by))
    if apart < 1e-9:
        return []
    along = (r * r - q * q + apart * apart) / (2 * apart)
    half = r * r - along * along
    if half < -1e-9:
        return []
    reach, dx, dy = math.sqrt(max(half, 0.0)), (bx - ax) / apart, (by - ay) / apart
    return [(ax + along * dx - s * reach * dy, ay + along * dy + s * reach * dx) for s in (1, -1)]


def _ending(segment: Segment, at: Point) -> Segment:
    return replace(segment, end=at, bulge=_bulge(segment, segment.start, at))


def _beginning(segment: Segment, at: Point) -> Segment:
    return replace(segment, start=at, bulge=_bulge(segment, at, segment.end))


def _bulge(segment: Segment, start: Point, end: Point) -> float:
    """The bulge of the piece of an arc's circle between two points of it, the same way round."""
    if not segment.is_arc:
        return 0.0
    cx, cy = segment.centre
    sweep = math.atan2(end[1] - cy, end[0] - cx) - math.atan2(start[1] - cy, start[0] - cx)
    turn = math.copysign(1.0, segment.bulge)
    sweep = turn * ((turn * sweep) % math.tau)
    if abs(sweep) - abs(segment.sweep_rad) > math.pi:  # it has turned past its other end
        sweep -= turn * math.tau
    return math.tan(sweep / 4)
