"""Kerf that the control adds: where its torch goes beside the path that a program names (G41, G42), half the kerf off.

As LinuxCNC does it (docs, "Cutter compensation"): the first move, a line, ends half the kerf beside its end; lines and
arcs after it are half the kerf beside what is named, corners on the torch's side are cut short where those meet, and
other corners are rounded by an arc about them; G40 leaves the torch where it is. What LinuxCNC refuses is refused.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import NamedTuple

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point, Segment

from .program import Track
from .words import Block

LEFT, RIGHT, OFF = frozenset({41.0, 41.1}), frozenset({42.0, 42.1}), frozenset({40.0})
WORDS = LEFT | RIGHT | OFF
ENDS = frozenset({2.0, 30.0})
_SAME_MM = 1e-6
_SMOOTH_RAD = 1e-4
"""A corner that turns by less is none: what is written has so many digits."""
_SHORT_MM = 0.01


class Named(NamedTuple):
    """One move as a program names it: its line or arc, and the line of the program."""

    segment: Segment
    line: int


def torch_moves(moves: Sequence[Named], left: bool, half_mm: float) -> list[list[Segment]]:
    """What the torch makes of each move, from where it is as the first begins.

    Raises InputError with line, for a first move that is an arc or too short, and for turns that are too tight for the
    torch.

    Examples
    --------
    >>> corners = [(-5, 0), (0, 0), (9, 0), (9, 9)]
    >>> named = [Named(Segment(a, b), 1) for a, b in pairwise(corners)]
    >>> [[segment.end for segment in made] for made in torch_moves(named, True, 1.0)]
    [[(0.0, 1.0)], [(8.0, 1.0)], [(8.0, 9.0)]]
    >>> [len(made) for made in torch_moves(named, False, 1.0)]
    [1, 1, 2]
    """
    aside = half_mm if left else -half_mm
    first = moves[0]
    if first.segment.is_arc or first.segment.chord_mm < half_mm:
        text = "the first move behind G41 or G42 is to be a line of at least half the kerf, by which the torch runs up"
        raise InputError(f"{text}: not supported here otherwise", line=first.line)
    x, y = first.segment.end
    dx, dy = first.segment.tangent_at(1.0)
    made = [[Segment(first.segment.start, (x - dy * aside, y + dx * aside))]]
    for before, now in pairwise(moves):
        segment = _beside(now, aside)
        last = made[-1][-1]
        if math.dist(last.end, segment.start) <= _SAME_MM:
            made.append([_from(segment, last.end)])
            continue
        ax, ay = before.segment.tangent_at(1.0)
        bx, by = now.segment.tangent_at(0.0)
        turn = math.atan2(ax * by - ay * bx, ax * bx + ay * by)
        if abs(turn) < _SMOOTH_RAD:
            made.append([_from(segment, last.end)])
        elif (turn > 0) == left:
            corner = _crossing(last, segment, now.line)
            made[-1][-1] = _piece(last, last.start, corner, before.line)
            made.append([_from(segment, corner, now.line)])
        else:
            made.append([Segment(last.end, segment.start, math.tan(turn / 4)), segment])
    return made


def _beside(move: Named, aside: float) -> Segment:
    """The line or arc so far to the left."""
    ends, segment = [], move.segment
    for fraction, (x, y) in ((0.0, segment.start), (1.0, segment.end)):
        dx, dy = segment.tangent_at(fraction)
        ends.append((x - dy * aside, y + dx * aside))
    if segment.is_arc and segment.radius_mm - math.copysign(1.0, segment.bulge) * aside < _SAME_MM:
        text = f"an arc of {segment.radius_mm:g} mm, which is no more than half the kerf, on the torch's side"
        raise InputError(f"{text}: no control can follow it; not supported here", line=move.line)
    return replace(segment, start=ends[0], end=ends[1])


def _from(segment: Segment, start: Point, line: int = 0) -> Segment:
    return _piece(segment, start, segment.end, line)


def _piece(segment: Segment, start: Point, end: Point, line: int) -> Segment:
    """A part of a line or arc; one that would run backwards has no room for the torch."""
    if not segment.is_arc:
        dx, dy = segment.tangent_at(0.0)
        back = (end[0] - start[0]) * dx + (end[1] - start[1]) * dy < -_SHORT_MM
        bulge = 0.0
    else:
        cx, cy = segment.centre
        way = math.copysign(1.0, segment.bulge)
        sweep = way * (math.atan2(end[1] - cy, end[0] - cx) - math.atan2(start[1] - cy, start[0] - cx)) % math.tau
        if sweep - abs(segment.sweep_rad) > math.pi:  # it ends in front of where it begins
            sweep -= math.tau
        back = sweep * segment.radius_mm < -_SHORT_MM
        bulge = way * math.tan(sweep / 4)
    if back and line:
        raise InputError(
            "the path turns tighter than half the kerf: the torch has no room beside it, and controls stop there; not "
            "supported here",
            line=line,
        )
    return Segment(start, end, bulge)


def _crossing(one: Segment, other: Segment, line: int) -> Point:
    """Where two lines or circles cross, nearest to the end of the first."""
    found = _crossings(one, other)
    if not found:
        text = "the torch has no room in this corner of the path: half the kerf is more than it leaves"
        raise InputError(f"{text}; controls stop there; not supported here", line=line)
    middle = (one.end[0] + other.start[0]) / 2, (one.end[1] + other.start[1]) / 2
    return min(found, key=lambda at: math.dist(at, middle))


def _crossings(one: Segment, other: Segment) -> list[Point]:
    if one.is_arc and not other.is_arc:
        return _crossings(other, one)
    if not other.is_arc:
        (x, y), (dx, dy) = one.start, one.tangent_at(0.0)
        (u, v), (ex, ey) = other.start, other.tangent_at(0.0)
        det = dx * ey - dy * ex
        t = ((u - x) * ey - (v - y) * ex) / det if abs(det) > 1e-12 else None
        return [] if t is None else [(x + t * dx, y + t * dy)]
    (cx, cy), r = other.centre, other.radius_mm
    if not one.is_arc:
        (x, y), (dx, dy) = one.start, one.tangent_at(0.0)
        b = (x - cx) * dx + (y - cy) * dy
        inside = b * b - ((x - cx) ** 2 + (y - cy) ** 2 - r * r)
        root = math.sqrt(max(inside, 0.0))
        return [] if inside < -1e-9 else [(x + t * dx, y + t * dy) for t in (-b - root, -b + root)]
    (ax, ay), q = one.centre, one.radius_mm
    d = math.hypot(cx - ax, cy - ay)
    if d < 1e-12:
        return []
    a = (q * q - r * r + d * d) / (2 * d)
    ux, uy, inside = (cx - ax) / d, (cy - ay) / d, q * q - a * a
    up = math.sqrt(max(inside, 0.0))
    return [] if inside < -1e-9 else [(ax + a * ux + s * up * uy, ay + a * uy - s * up * ux) for s in (1.0, -1.0)]


# The same while a program is run: its moves are heard twice, first as they are named, then as the torch makes them.


@dataclass(slots=True)
class Listened:
    """A track that only hears where moves lead."""

    at: Point
    heard: list[Named] = field(default_factory=list)
    open: None = None

    def fault(self, *_: object) -> None:
        """What is wrong is told the second time."""

    def wait(self, _: float) -> None:
        """Waits change no path."""

    def rapid(self, end: Point, line: int) -> None:
        """Travel."""
        if end != self.at:
            self.heard.append(Named(Segment(self.at, end), line))
        self.at = end

    def feed(self, segment: Segment, _: float, line: int) -> None:
        """A line or an arc."""
        if segment.length_mm > 0:
            self.heard.append(Named(segment, line))
        self.at = segment.end


@dataclass(slots=True)
class Beside:
    """A track on which what is named becomes what the torch makes of it; `at` is where the path is."""

    track: Track
    at: Point
    made: list[list[Segment]]

    @property
    def open(self) -> object:
        """The burn that is going on, if any."""
        return self.track.open

    def fault(self, line: int, rule: str, text: str) -> None:
        """As on the track."""
        self.track.fault(line, rule, text)

    def wait(self, seconds: float) -> None:
        """As on the track."""
        self.track.wait(seconds)

    def rapid(self, end: Point, line: int) -> None:
        """Travel beside the path."""
        if end != self.at:
            self.track.rapid(self.made.pop(0)[-1].end, line)
        self.at = end

    def feed(self, segment: Segment, feed_mm_s: float, line: int) -> None:
        """Cut, or move at a feed, beside the path."""
        if segment.length_mm > 0:
            for one in self.made.pop(0):
                self.track.feed(one, feed_mm_s, line)
        self.at = segment.end


def side_of(block: Block) -> bool | None:
    """Whether a block has the torch keep to the left, or right; None where it does not say."""
    for word in block.g:
        if word.value in LEFT | RIGHT:
            return word.value in LEFT
    return None


def without_kerf(block: Block) -> Block:
    """A block without the words that have the control add the kerf."""
    g = tuple(word for word in block.g if word.value not in LEFT | RIGHT)
    words = block.words if len(g) == len(block.g) else {k: w for k, w in block.words.items() if k not in "DL"}
    return block._replace(g=g, words=words)
