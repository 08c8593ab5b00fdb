"""How long the torch must wait before each burn for the metal to stay under a limit, and where no wait helps.

Burn by burn: what a burn does is simulated together with the rest after it in which its heat spreads, so that a place
that gets too hot is counted for the burn that heats it. Temperatures add up, and what an earlier burn left fades: the
longer the wait the cooler it stays, down to what the burn reaches on a cold sheet with the kerfs as they are.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from kerfwise.encoder.cut import HotSpot
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.heat_section import Heat

from .grid import Grid
from .physical import SheetSimulation, settling_s, time_step_s
from .timed_path import TimedPath, TorchOn
from .watch import WatchedSheet, watch_of

STEP_S = 0.5
"""Waits are found to so many seconds; they are never too short."""
FIRST_S = 2.0


@dataclass(frozen=True, slots=True)
class Heated:
    """One burn that would get metal too hot: its contour, the place, and the wait that it needs.

    `spot` is what comes of it without a wait of its own, those before it having been made. `wait_s` is None where none
    does: then `least_c` is how hot the place gets on a cold sheet, over the limit, or how hot it gets with the longest
    wait allowed.
    """

    contour: str
    spot: HotSpot
    wait_s: float | None
    least_c: float


@dataclass(frozen=True, slots=True)
class Pacing:
    """What pacing a program comes to: the burns that are too hot as they stand, in order, and the peak that is left.

    `peak_c` is the highest temperature of the program with the waits.
    """

    heated: tuple[Heated, ...]
    peak_c: float
    waits: Mapping[str, float] = field(default_factory=dict)

    @property
    def possible(self) -> bool:
        """Whether the waits keep the metal under the limit."""
        return all(h.wait_s is not None for h in self.heated)

    @property
    def wait_s(self) -> float:
        """All waits together, s."""
        return sum(self.waits.values())


def pace(
    nest: Nest, path: TimedPath, heat: Heat, thickness_mm: float, limit_c: float, longest_s: float, grid: Grid
) -> Pacing:
    """The waits with which a program's order keeps to a limit; none is longer than `longest_s`.

    A burn for which there is no such wait begins after the longest one that helps, and so on with the rest.
    """
    watch = watch_of(nest, path, heat, thickness_mm, grid)
    at, late_s, peak_c = _Standing(watch.sheet()), 0.0, heat.ambient_c
    heated: list[Heated] = []
    waits: dict[str, float] = {}
    for burn in path.burns:
        done, spot = _after(watch, at, later(burn, late_s))
        if spot.peak_c > limit_c:
            first = spot
            wait_s, done, spot = _wait(watch, at, later(burn, late_s), limit_c, longest_s)
            late_s += wait_s
            kept = spot.peak_c <= limit_c
            heated.append(Heated(burn.contour, first, wait_s if kept else None, spot.peak_c))
            if wait_s:
                waits[burn.contour] = wait_s
        peak_c = max(peak_c, spot.peak_c)
        at = done
    return Pacing(tuple(heated), peak_c, waits)


def later(burn: TorchOn, seconds: float) -> TorchOn:
    """The burn so many seconds later than it says."""
    return replace(burn, at_s=burn.at_s + seconds)


@dataclass(frozen=True, eq=False, slots=True)
class _Standing:
    """A sheet less than a step before the end of the burn that was last, whose last moment is still to come."""

    sheet: SheetSimulation
    last: tuple[TorchOn, ...] = ()


def _after(watch: WatchedSheet, at: _Standing, burn: TorchOn) -> tuple[_Standing, HotSpot]:
    """The sheet when the burn is done, and the hottest place that it leads to, rest after it included."""
    events, end_s = watch.events(*at.last, burn), float(burn.at_s[-1])
    done = at.sheet.copy()
    done.forget_peaks()
    done.run(events, end_s - time_step_s(watch.heat))
    settled = done.copy()
    settled.run(events, end_s + settling_s(watch.heat))
    return _Standing(done, (burn,)), watch.hottest(settled.peak_c(), float(burn.at_s[0]))


def _wait(
    watch: WatchedSheet, at: _Standing, burn: TorchOn, limit_c: float, longest_s: float
) -> tuple[float, _Standing, HotSpot]:
    """The shortest wait that helps, else the longest allowed; none at all if the burn is too hot by itself."""
    cold = at.sheet.copy()
    cold.cool_down()
    _, alone = _after(watch, _Standing(cold), burn)
    if alone.peak_c > limit_c:
        return 0.0, _after(watch, at, burn)[0], alone
    low_s, high_s = 0.0, min(FIRST_S, longest_s)
    done, spot = _after(watch, at, later(burn, high_s))
    while spot.peak_c > limit_c and high_s < longest_s:
        low_s, high_s = high_s, min(2 * high_s, longest_s)
        done, spot = _after(watch, at, later(burn, high_s))
    while spot.peak_c <= limit_c and high_s - low_s > STEP_S:
        middle_s = (low_s + high_s) / 2
        tried, there = _after(watch, at, later(burn, middle_s))
        if there.peak_c <= limit_c:
            high_s, done, spot = middle_s, tried, there
        else:
            low_s = middle_s
    return high_s, done, spot
