"""What a program does, as the check's reader found it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import shapely

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point, Segment
from kerfwise.encoder.tolerance import TOLERANCE_MM
from kerfwise.rules.profile.machine_section import Origin


@dataclass(frozen=True, eq=False, slots=True)
class Burn:
    """One stretch with a tool on, rapids left out: torch $0, others mark.

    `line` is where it begins, `comment` the last comment before it. Times in s from the program's start. `travels_mm`
    are the moves with no tool on since the burn before, `wait_s` is how long it has stood still since, off. The tool
    stands for `pierce_s` before it moves, by the program's own words, after the control has held it for `held_s` by
    itself, and for `paused_s` later on; `step_feeds_mm_s` are the speeds of the lines and arcs of its
    path, one each. `powers` are the S words of a laser that it moves with, `pierce_powers` those that it stands with.
    Along the stretches `unlit` of its path, mm from its start, the torch is off, as over tabs. The further `torches`
    burn with the first one. What such a one burns is a burn of its own, once `of_all_torches` has made it: of `torch`.
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
        x, y = self.path.vertices[0, :2].tolist()
        return x, y

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


def of_all_torches(program: NcProgram, shift: Callable[[int], Point], turned: int = 0) -> NcProgram:
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
