"""What a program does, as the check's reader found it: burns, ways between them, and the time that took."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np
import shapely

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.measures import MOST_MEETINGS, has_too_many_crossings
from kerfwise.encoder.geometry.segment import Point, Segment
from kerfwise.encoder.geometry.tolerances import TOLERANCE_MM
from kerfwise.rules.profile.plant_sections import Origin


@dataclass(frozen=True, eq=False, slots=True)
class Burn:
    """One stretch with a tool on, rapids left out: torch $0, others mark.

    `line` is where it begins, `comment` the last comment before it. Times in s from the program's start. `travels_mm`
    are the moves with no tool on since the burn before, `wait_s` is how long it has stood still since, off. The tool
    stands for `pierce_s` before it moves, by the program's own words, after the control has held it for `held_s` by
    itself, and for `paused_s` later on; `step_feeds_mm_s` are the speeds of the lines and arcs of its
    path, one each. `powers` are the S words of a laser that it moves with, `pierce_powers` those that it stands with.
    Along the stretches `unlit` of its path, mm from its start, the torch is off, as over tabs. The further `torches`
    burn with the first one. What such a one burns is a burn of its own, once `expand_torches` has made it: of `torch`.
    `axes` are the tilt and the turn of the torch at each vertex of its path, degrees; () on machines without.
    """

    tool: int
    line: int
    path: Curve
    start_s: float
    end_s: float
    comment: str
    travels_mm: tuple[float, ...] = ()
    pierce_s: float = 0.0
    paused_s: float = 0.0
    step_feeds_mm_s: tuple[float, ...] = ()
    wait_s: float = 0.0
    held_s: float = 0.0
    powers: tuple[float, ...] = ()
    pierce_powers: tuple[float, ...] = ()
    unlit: tuple[tuple[float, float], ...] = ()
    torches: tuple[int, ...] = ()
    torch: int = 1
    axes: tuple[tuple[float, ...], ...] = ()

    @property
    def tilted(self) -> bool:
        """Whether the torch leans anywhere on its way."""
        return any(tilt != 0 for tilt, _ in self.axes)

    @property
    def lean_share(self) -> float:
        """The share of its greatest feed that it goes at as a whole, where it leans: the way in the metal is longer."""
        shares = {math.cos(math.radians(tilt)) for tilt, _ in self.axes}
        if len(shares) < 2:
            return min(shares, default=1.0)
        most, lengths = max(self.step_feeds_mm_s), [segment.length_mm for segment in self.path.segments]
        slow_mm = [mm * most / feed for mm, feed in zip(lengths, self.step_feeds_mm_s, strict=True)]
        return math.fsum(lengths) / math.fsum(slow_mm)

    @property
    def feeds_mm_s(self) -> tuple[float, ...]:
        """The speeds it moves at, each once, the least first."""
        return tuple(sorted(set(self.step_feeds_mm_s)))

    @property
    def paced(self) -> tuple[tuple[Segment, float], ...]:
        """The lines and arcs of its path, and the share of its greatest speed that each is run at."""
        most = max(self.step_feeds_mm_s, default=1.0)
        return tuple((s, feed / most) for s, feed in zip(self.path.segments, self.step_feeds_mm_s, strict=False))

    @property
    def start(self) -> Point:
        """Where the tool goes on."""
        return self.path.start

    @property
    def pierces_only(self) -> bool:
        """Whether it is a hole that the torch pierces, and does not move."""
        return self.tool == 0 and not self.path.segments

    @property
    def unlit_mm(self) -> float:
        """How far the torch is off along its path."""
        return sum(high - low for low, high in self.unlit)

    @property
    def moving_s(self) -> float:
        """How long the tool moves, at the program's own feeds, s."""
        return self.end_s - self.start_s - self.held_s - self.pierce_s - self.paused_s


def parted_where_leads_cross(burn: Burn, near_mm: float = TOLERANCE_MM) -> Burn:
    """The burn with a vertex where one of its first two lines crosses one of its last two, if it closes nowhere else.

    Leads that run on straight past a corner join the contour there, in the middle of a block.
    """
    segments, last = burn.path.segments, len(burn.path.segments) - 1
    if burn.tool != 0 or burn.axes or burn.unlit or last < 3 or _comes_back(burn.path, near_mm):
        return burn
    found = []
    for low, high in product((0, 1), (last - 1, last)):
        one, other = segments[low], segments[high]
        if high - low > 1 and not (one.is_arc or other.is_arc):
            first, then = (shapely.LineString([line.start, line.end]) for line in (one, other))
            at = first.intersection(then)
            found += [(high - low, low, high, (at.x, at.y))] if isinstance(at, shapely.Point) else []
    if not found:
        return burn
    _, low, high, at = max(found)
    rows, feeds = burn.path.vertices.tolist(), list(burn.step_feeds_mm_s)
    for k in (high, low):
        rows.insert(k + 1, [*at, 0.0])
        feeds.insert(k + 1, feeds[k])
    return replace(burn, path=Curve(np.array(rows), closed=False), step_feeds_mm_s=tuple(feeds))


def _comes_back(path: Curve, near_mm: float) -> bool:
    """Whether a vertex of a path lies on another, or on the blocks at its other end: then it closes there."""
    points = shapely.points(path.vertices[:, :2])
    if len(shapely.STRtree(points).query(points, predicate="dwithin", distance=near_mm)[0]) > len(points):
        return True
    flat = path.flatten(near_mm / 4)
    ends = (path.vertices[:2, :2], flat[len(flat) // 2 :]), (path.vertices[-2:, :2], flat[: len(flat) // 2 + 1])
    return any(shapely.dwithin(shapely.LineString(way), shapely.points(end), near_mm).any() for end, way in ends)


@dataclass(frozen=True, slots=True)
class MoveStretch:
    """Moves that are not as they should be: rapids with a tool on, or travel at cutting feed."""

    line: int
    length_mm: float


@dataclass(frozen=True, slots=True)
class Fault:
    """What a program does wrong by itself, whatever it cuts: the line, the rule it breaks, and a sentence."""

    line: int
    rule: str
    text: str


@dataclass(frozen=True, eq=False, slots=True)
class NcProgram:
    """What a program does. `idle_mm` is all travel with no tool on, `slow_travel` the part of it at cutting feed.

    `homing_mm` are the moves after the last burn, `end` is where they lead, `blocks` the lines that are more than
    comments, and `moving_s` the time with a tool on at the program's own feeds, s. `rapids` are the lines and ends of
    moves with no tool on. `origin` and `zero`, a point of the drawing, are where the program says that the machine's
    zero is, None where it does not. `step_mm` is the least step that its control counts in, 0 where no digit is missed.
    """

    burns: tuple[Burn, ...]
    hot_rapids: tuple[MoveStretch, ...]
    slow_travel: tuple[MoveStretch, ...]
    faults: tuple[Fault, ...]
    comments: tuple[str, ...]
    idle_mm: float
    homing_mm: tuple[float, ...]
    end: Point
    blocks: int
    moving_s: float
    rapids: tuple[tuple[int, Point], ...] = ()
    origin: Origin | None = None
    zero: Point | None = None
    step_mm: float = 0.0


def at_holes(program: NcProgram) -> list[bool]:
    """Whether each burn begins where an earlier burn of the torch has stood and not moved: at a hole pierced before."""
    burns = program.burns
    holes = [(k, burn.start) for k, burn in enumerate(burns) if burn.pierces_only]
    if not holes:
        return [False] * len(burns)
    tree = shapely.STRtree(shapely.points([at for _, at in holes]))
    begins = shapely.points([burn.start for burn in burns])
    found = [False] * len(burns)
    within_mm = max(TOLERANCE_MM, program.step_mm)
    for k, hole in zip(*(row.tolist() for row in tree.query(begins, "dwithin", distance=within_mm)), strict=True):
        found[k] = found[k] or (holes[hole][0] < k and burns[k].tool == 0 and not burns[k].pierces_only)
    return found


def expand_torches(program: NcProgram, shift: Callable[[int], Point], turned: int = 0) -> NcProgram:
    """The program with what each further torch burns as a burn of its own, right behind that of the first torch.

    `shift` says how far each torch is from the first, mm. They burn at one time: `turned` by so many places, others
    come first.
    """
    burns: list[Burn] = []
    for burn in program.burns:
        together = [burn, *(replace(burn, path=burn.path.moved(*shift(k)), torch=k) for k in burn.torches)]
        place = turned % len(together)
        burns += [*together[place:], *together[:place]]
    return replace(program, burns=tuple(burns))


# What the torch has done so far: its burns, its ways between them, and the time that took.

_NOTHING_MM = 1e-9
"""A curve leaves out segments no longer than this."""


@dataclass(slots=True)
class _Open:
    """A burn that has not ended yet."""

    tool: int
    line: int
    start_s: float
    rows: list[tuple[float, float, float]]
    comment: str
    travels_mm: tuple[float, ...]
    wait_s: float
    held_s: float = 0.0
    pierce_s: float = 0.0
    paused_s: float = 0.0
    step_feeds_mm_s: list[float] = field(default_factory=list)
    powers: set[float] = field(default_factory=set)
    pierce_powers: set[float] = field(default_factory=set)
    unlit: list[tuple[float, float]] = field(default_factory=list)
    torches: tuple[int, ...] = ()
    axes: list[tuple[float, ...]] = field(default_factory=list)


@dataclass(slots=True)
class Track:
    """Where the torch is and has been; `travel_mm_s` is the speed of rapids.

    A torch that goes off, moves on at a feed for no more than `tab_mm`, and is lit again at once, burns on: it has gone
    over a tab, where the same torches are lit again. `torches` are the further ones that are selected.
    Of a wait before it is lit `preheat_s` belong to the burn. `_closed` is the burn that may go on so, `_over` what it
    has gone since, unlit.
    """

    travel_mm_s: float
    at: Point = (0.0, 0.0)
    clock_s: float = 0.0
    idle_mm: float = 0.0
    moving_s: float = 0.0
    wait_s: float = 0.0
    comment: str = ""
    open: _Open | None = None
    burns: list[Burn] = field(default_factory=list)
    hot_rapids: list[MoveStretch] = field(default_factory=list)
    slow_travel: list[MoveStretch] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    travels_mm: list[float] = field(default_factory=list)
    rapids: list[tuple[int, Point]] = field(default_factory=list)
    tab_mm: float = 0.0
    torches: tuple[int, ...] = ()
    preheat_s: float = 0.0
    axes: tuple[float, ...] = ()
    _closed: _Open | None = None
    _over: list[tuple[Segment, float]] = field(default_factory=list)

    def fault(self, line: int, rule: str, text: str) -> None:
        """Note what the program does wrong."""
        self.faults.append(Fault(line, rule, text))

    def begin(self, tool: int, line: int, held_s: float = 0.0) -> None:
        """A tool starts where the torch stands; the control holds it there for `held_s`."""
        if self._goes_on(tool):
            return
        before_s = self.preheat_s if tool == 0 and self.wait_s >= self.preheat_s - 1e-6 else 0.0
        self.open = _Open(
            tool,
            line,
            self.clock_s - before_s,
            [],
            self.comment,
            tuple(self.travels_mm),
            max(self.wait_s - before_s, 0.0),
            held_s=held_s,
            pierce_s=before_s,
            torches=self.torches,
        )
        self.clock_s += held_s
        self.travels_mm.clear()
        self.wait_s = 0.0

    def close(self) -> None:
        """End the burn that is going on, if any; one that did not move is a hole and is kept."""
        if self.open is None:
            return
        o, path = self.open, Curve.of([*self.open.rows, (*self.at, 0.0)], closed=False)
        if has_too_many_crossings(path.vertices[:, :2], closed=False, most=MOST_MEETINGS):
            raise InputError(
                f"the path that is cut from here on crosses or touches itself more than {MOST_MEETINGS} times: not "
                "supported here; put the torch out where a cut ends",
                line=o.line,
            )
        self.burns.append(
            Burn(
                o.tool, o.line, path, o.start_s, self.clock_s, o.comment, o.travels_mm, o.pierce_s, o.paused_s,
                tuple(o.step_feeds_mm_s), o.wait_s, o.held_s,
                tuple(sorted(o.powers)), tuple(sorted(o.pierce_powers)), tuple(o.unlit), o.torches,
                axes=(*o.axes, self.axes) if self.axes else (),
            )
        )  # fmt: skip
        self._closed, self._over = (o, []) if self.tab_mm > 0 and o.tool == 0 and o.rows else (None, [])
        self.open = None

    def _goes_on(self, tool: int) -> bool:
        """Take up the burn before, where the torch has only gone over a tab since."""
        length_mm = sum(segment.length_mm for segment, _ in self._over)
        before, self._closed = self._closed, None
        if before is None or (tool, self.torches) != (before.tool, before.torches):
            return False
        if not 0 < length_mm <= self.tab_mm or self.wait_s > 0:
            return False
        lit = self.burns.pop()
        before.unlit.append((lit.path.length_mm, lit.path.length_mm + length_mm))
        before.rows += [(*segment.start, segment.bulge) for segment, _ in self._over]
        before.step_feeds_mm_s += [feed_mm_s for _, feed_mm_s in self._over]
        self.idle_mm -= length_mm
        del self.travels_mm[-len(self._over) :], self.rapids[-len(self._over) :], self.slow_travel[-len(self._over) :]
        self.open = before
        return True

    def wait(self, seconds: float) -> None:
        """Stand still."""
        self.clock_s += seconds
        if self.open is None:
            self.wait_s += seconds
        elif self.open.rows:
            self.open.paused_s += seconds
        else:
            self.open.pierce_s += seconds

    def rapid(self, end: Point, line: int) -> None:
        """Travel; with a tool on that ends a burn and begins another."""
        length = math.dist(self.at, end)
        self._closed = None
        self.clock_s += length / self.travel_mm_s
        tool = None if self.open is None else self.open.tool
        if tool is not None and length > 0:
            self.hot_rapids.append(MoveStretch(line, length))
            self.close()
        self.at = end
        if tool is None:
            self._idle(length, line)
        elif self.open is None:
            self.begin(tool, line)

    def turn(self, axes: tuple[float, ...], deg_min: float, line: int) -> None:
        """Turn the torch where it stands; with a tool on that is a place of its path."""
        before, self.axes = self.axes or (0.0, 0.0), axes
        self.clock_s += max(abs(b - a) for a, b in zip(before, axes, strict=True)) / deg_min * 60
        if self.open is not None:
            self.open.rows.append((*self.at, 0.0))
            self.open.axes.append(before)

    def feed(self, segment: Segment, feed_mm_s: float, line: int, axes: tuple[float, ...] = ()) -> None:
        """Move along a line or an arc at cutting feed, the axes turning to `axes`; one of no length is no move."""
        length_mm = segment.length_mm
        if length_mm <= 0:
            return
        before, self.axes = self.axes or (0.0,) * len(axes), axes
        seconds = length_mm / feed_mm_s
        self.clock_s += seconds
        self.at = segment.end
        if self.open is None:
            self._over.append((segment, feed_mm_s))
            self._idle(length_mm, line)
            self.slow_travel.append(MoveStretch(line, length_mm))
        else:
            self.moving_s += seconds
            if length_mm > _NOTHING_MM:
                self.open.step_feeds_mm_s.append(feed_mm_s)
            self.open.rows.append((*segment.start, segment.bulge))
            self.open.axes.append(before)

    def _idle(self, length_mm: float, line: int) -> None:
        self.idle_mm += length_mm
        self.travels_mm.append(length_mm)
        self.rapids.append((line, self.at))


# What one line of an old program changes.

State = dict[str, tuple[str, ...]]
"""What is in force: for each thing that words can set, the blocks that have set it."""


@dataclass(frozen=True, slots=True)
class LineEffect:
    """One line that holds words: how many burns are over after it, and what it does while nothing burns.

    `state` is what is in force after it: units, feed, material and so on.
    `rapid` is its word of travel, `implied` the motion word in force that it moves by and does not say;
    `moves` says that it says one, `carries` that it holds words of the height and the like, or of the plant's own.
    `travels` says that it moves with the torch off, `waits` that it stands so, `halts` that the program stops there.
    """

    line: int
    burns: int
    travels: bool
    waits: bool
    halts: bool
    state: State
    rapid: str = ""
    implied: str = ""
    moves: bool = False
    carries: bool = False
