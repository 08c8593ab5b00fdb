"""How long the torch must wait before each burn for the metal to stay under a limit, and where no wait helps.

Burn by burn: what a burn does is simulated together with the rest after it in which its heat spreads, so that a place
that gets too hot is counted for the burn that heats it. Temperatures add up, and what an earlier burn left fades: the
longer the wait the cooler it stays, down to what the burn reaches on a cold sheet with the kerfs as they are.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from kerfwise.arrays import Bools
from kerfwise.encoder.cut import HotSpot
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.plant_sections import Heat

from .physical import SheetSimulation, settling_s, time_step_s
from .simulate import counted_points, expect_bounded
from .timed_path import Events, Grid, TimedPath, TorchOn, events_of, make_grid

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
        done, spot = _after(watch, at, delay_burn(burn, late_s))
        if spot.peak_c > limit_c:
            first = spot
            wait_s, done, spot = _wait(watch, at, delay_burn(burn, late_s), limit_c, longest_s)
            late_s += wait_s
            kept = spot.peak_c <= limit_c
            heated.append(Heated(burn.contour, first, wait_s if kept else None, spot.peak_c))
            if wait_s:
                waits[burn.contour] = wait_s
        peak_c = max(peak_c, spot.peak_c)
        at = done
    return Pacing(tuple(heated), peak_c, waits)


def delay_burn(burn: TorchOn, seconds: float) -> TorchOn:
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
    done, spot = _after(watch, at, delay_burn(burn, high_s))
    while spot.peak_c > limit_c and high_s < longest_s:
        low_s, high_s = high_s, min(2 * high_s, longest_s)
        done, spot = _after(watch, at, delay_burn(burn, high_s))
    while spot.peak_c <= limit_c and high_s - low_s > STEP_S:
        middle_s = (low_s + high_s) / 2
        tried, there = _after(watch, at, delay_burn(burn, middle_s))
        if there.peak_c <= limit_c:
            high_s, done, spot = middle_s, tried, there
        else:
            low_s = middle_s
    return high_s, done, spot


# A sheet while it is cut, one burn after the other, and how hot its metal gets meanwhile, outside the kerf's band.


@dataclass(frozen=True, eq=False, slots=True)
class WatchedSheet:
    """A nest's sheet, and the points whose temperature counts while a program runs.

    `counted` are those of parts and of the skeleton outside the kerf's band of the whole program.
    """

    nest: Nest
    grid: Grid
    heat: Heat
    thickness_mm: float
    counted: Bools

    def sheet(self) -> SheetSimulation:
        """The sheet as warm as the air, uncut; with the limit that the heat section has."""
        return SheetSimulation(self.grid, self.heat, self.thickness_mm)

    def events(self, *burns: TorchOn) -> Events:
        """What these burns do to the grid."""
        return events_of(TimedPath(burns, float(burns[-1].at_s[-1])), self.grid)

    def hottest(self, peak_c: np.ndarray, at_s: float, among: Bools | None = None) -> HotSpot:
        """The hottest of the counted points (or of those among them) on a map of temperatures."""
        counted = self.counted if among is None else self.counted & among
        masked = np.where(counted, peak_c, -np.inf)
        i, j = np.unravel_index(int(masked.argmax()), masked.shape)
        grid = self.grid
        if not counted.any():
            return HotSpot(self.heat.ambient_c, (grid.x0_mm, grid.y0_mm), at_s)
        part = int(grid.part[i, j])
        place = (grid.x0_mm + float(i) * grid.step_mm, grid.y0_mm + float(j) * grid.step_mm)
        return HotSpot(float(masked[i, j]), place, at_s, self.nest.parts[part].id if part >= 0 else "")


def watch_of(nest: Nest, path: TimedPath, heat: Heat, thickness_mm: float, grid: Grid | None = None) -> WatchedSheet:
    """What has to be watched while a program runs."""
    grid = make_grid(nest, heat.grid_mm) if grid is None else grid
    expect_bounded(int(grid.metal.sum()), path, heat)
    return WatchedSheet(nest, grid, heat, thickness_mm, counted_points(grid, path, heat))


def hot_spots(nest: Nest, path: TimedPath, heat: Heat, thickness_mm: float, limit_c: float) -> tuple[HotSpot, ...]:
    """The hottest place of each burn, from when it begins until the next one does, or the last one's heat has spread.

    A place that has passed the limit is told once: afterwards it is not looked at any more.
    """
    watch = watch_of(nest, path, heat, thickness_mm)
    sheet, found = watch.sheet(), []
    fresh = np.ones(watch.grid.shape, dtype=np.bool_)
    events = events_of(path, watch.grid)
    begins = [float(burn.at_s[0]) for burn in path.burns]
    ends = [*begins[1:], max(path.end_s, float(path.burns[-1].at_s[-1])) + settling_s(heat)] if begins else []
    for begin_s, end_s in zip(begins, ends, strict=True):
        sheet.forget_peaks()
        sheet.run(events, end_s)
        peak_c = sheet.peak_c()
        found.append(watch.hottest(peak_c, begin_s, fresh))
        fresh &= peak_c <= limit_c
    return tuple(found)
