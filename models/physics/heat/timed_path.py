"""The sheet as points on a square grid, and where the torch burns, and when, as what it does to the grid."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple, TypeVar

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Float32s, Floats, Int32s, Ints
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.models.jit import inner, jit
from kerfwise.rules.profile.plant_sections import Heat, HeatModel

# Where the torch burns, and when: all that a simulation of heat needs to know of a program.


@dataclass(frozen=True, eq=False, slots=True)
class TorchOn:
    """One stretch with the torch on.

    `contour` is the id of what is cut ("" if unknown), `xy` (k, 2) the points of the path, mm, `at_s` (k,) when the
    torch is there, s from the program's start, never falling. Two points in one place are a torch that stands, as it
    does to pierce. Between points it moves evenly. A further `torch` than the first burns while the first one does.
    """

    contour: str
    xy: Floats
    at_s: Floats
    torch: int = 1

    @property
    def seconds(self) -> float:
        """How long the torch is on."""
        return float(self.at_s[-1] - self.at_s[0]) if len(self.at_s) else 0.0

    def by(self, torch: int, contour: str, away_mm: Point) -> TorchOn:
        """What another torch burns at the same time, so far from this one."""
        return TorchOn(contour, self.xy + np.array(away_mm), self.at_s, torch)


@dataclass(frozen=True, eq=False, slots=True)
class TimedPath:
    """The torch-on stretches of a program in order, marks left out, and when the program ends, s.

    What several torches burn at one time follows each other, the first torch first.
    """

    burns: tuple[TorchOn, ...]
    end_s: float

    @property
    def of_first(self) -> tuple[TorchOn, ...]:
        """What the first torch burns: one stretch after the other."""
        return tuple(burn for burn in self.burns if burn.torch == 1)

    @property
    def seconds_on(self) -> float:
        """How long torches are on altogether, each by itself."""
        return sum(burn.seconds for burn in self.burns)


def torch_on(
    contour: str,
    points: Floats,
    begin_s: float,
    end_s: float,
    pierce_s: float = 0.0,
    slowness: Floats | None = None,
) -> TorchOn:
    """A stretch that stands at its first point for `pierce_s` and then runs along `points` (k, 2) to its end.

    It runs evenly, or where `slowness` (k - 1,) is given takes so many times longer for each of its steps. Raises
    InputError if it ends before it begins.

    Examples
    --------
    >>> burn = torch_on("P.outer", np.array([[0.0, 0.0], [30.0, 0.0], [30.0, 10.0]]), 5.0, 10.0, 1.0)
    >>> burn.at_s.tolist(), burn.xy[:2].tolist()
    ([5.0, 6.0, 9.0, 10.0], [[0.0, 0.0], [0.0, 0.0]])
    """
    if end_s < begin_s:
        raise InputError(f"{contour} is said to end at {end_s:g} s, before it begins at {begin_s:g} s")
    moves_s = begin_s + min(pierce_s, end_s - begin_s)
    steps = np.hypot(*np.diff(points, axis=0).T) if len(points) > 1 else np.zeros(0)
    if slowness is not None and len(slowness) == len(steps):
        steps = steps * slowness
    along = np.concatenate([[0.0], np.cumsum(steps)])
    share = along / along[-1] if along[-1] > 0 else np.zeros(len(along))
    at_s = moves_s + share * (end_s - moves_s)
    xy = np.concatenate([points[:1], points])
    times = np.concatenate([[begin_s], at_s])
    if along[-1] == 0:  # it only stands there
        times[-1] = end_s
    return TorchOn(contour, xy, times)


def without_tabs(burn: TorchOn, unlit_mm: Sequence[tuple[float, float]]) -> tuple[TorchOn, ...]:
    """The stretch without those parts of its way, mm from its start, that the torch makes unlit, over tabs.

    Examples
    --------
    >>> burn = torch_on("P.outer", np.array([[0.0, 0.0], [10.0, 0.0]]), 0.0, 10.0)
    >>> [lit.xy[:, 0].tolist() for lit in without_tabs(burn, [(4.0, 6.0)])]
    [[0.0, 0.0, 4.0], [6.0, 10.0]]
    """
    if not unlit_mm:
        return (burn,)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(burn.xy, axis=0).T))])
    ends = [0.0, *(mm for stretch in unlit_mm for mm in stretch), float(along[-1])]
    table = np.column_stack([burn.xy, burn.at_s])
    pieces = []
    for number, (low, high) in enumerate(zip(ends[::2], ends[1::2], strict=True)):
        first = int(np.searchsorted(along, low, side="right")) if number else 0
        last = int(np.searchsorted(along, high, side="left"))
        begin, end = np.column_stack([np.interp([low, high], along, column) for column in table.T])
        rows = np.vstack([*([begin] if number else []), table[first:last], end])
        pieces.append(TorchOn(burn.contour, rows[:, :2], rows[:, 2], burn.torch))
    return tuple(pieces)


def in_order(burns: Sequence[TorchOn], end_s: float) -> TimedPath:
    """The path of these stretches.

    Raises InputError if one of the first torch begins before the one before it has ended, by more than 10 ms.
    """
    for before, after in pairwise(burn for burn in burns if burn.torch == 1):
        if after.at_s[0] < before.at_s[-1] - 0.01:
            raise InputError(
                f"{after.contour} begins at {after.at_s[0]:.2f} s, before {before.contour} ends at "
                f"{before.at_s[-1]:.2f} s: times must follow each other for heat to be simulated"
            )
    return TimedPath(tuple(burns), max([end_s, *(float(b.at_s[-1]) for b in burns)]))


# How the kernels of the simulation are compiled: machine code that is kept on disk between runs.

F = TypeVar("F", bound=Callable[..., object])

# Sums may be taken in any order, so that rows are added up several numbers at a time.
_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "fastmath": {"reassoc", "contract", "nsz"}}


def compiled(function: F) -> F:
    """Compile a function that other compiled functions call."""
    return inner(**_OPTIONS)(function)


def entry(function: F) -> F:
    """Compile a function that Python calls, and keep the machine code beside its file."""
    return jit(**_OPTIONS)(function)


# What the torch does to the grid, in order of time: energy put in on both sides of the kerf, and links cut.

SIDE = 0.7072
"""How far beside the kerf its heat goes in, grid steps: just over half a diagonal, so that it stays on its side."""
SPACING = 0.25
"""Longest stretch of path, grid steps, whose heat goes in at one point."""


class Events(NamedTuple):
    """Sorted by time. Of every dose: when, its two points (flat index, -1 for none) and share of the power's time, s.

    Of every link cut: when, its lower point (flat index), and whether it runs along y.
    """

    dose_s: Floats
    left: Ints
    right: Ints
    seconds: Floats
    cut_s: Floats
    link: Ints
    along_y: NDArray[np.bool_]


def events_of(path: TimedPath, grid: Grid) -> Events:
    """The events of a path on a grid.

    A link between two neighbouring points is cut when the torch crosses the line between them. A closed contour
    crosses every way from inside to outside, so that no heat passes it afterwards.
    """
    rows = [_of_burn(burn.xy, burn.at_s, grid) for burn in path.burns]
    columns = [np.concatenate(c) for c in zip(*rows, strict=True)] if rows else [np.zeros(0)] * 7
    dose = np.argsort(columns[0], kind="stable")
    cut = np.argsort(columns[4], kind="stable")
    left, right, link = (columns[k].astype(np.int64) for k in (1, 2, 5))
    return Events(
        columns[0][dose], left[dose], right[dose], columns[3][dose], columns[4][cut], link[cut],
        columns[6][cut].astype(np.bool_),
    )  # fmt: skip


def _of_burn(xy: Floats, at_s: Floats, grid: Grid) -> tuple[NDArray[np.generic], ...]:
    nx, ny = grid.shape
    scaled = np.ascontiguousarray((xy - (grid.x0_mm, grid.y0_mm)) / grid.step_mm)
    steps = np.abs(np.diff(scaled, axis=0))
    doses = int(np.ceil(np.hypot(steps[:, 0], steps[:, 1]) / SPACING).sum()) + 4 * len(xy)
    cuts = int(np.ceil(steps.sum())) + 2 * len(xy)
    dose, point = np.zeros((doses, 2)), np.full((doses, 2), -1, dtype=np.int64)
    cut, link = np.zeros(cuts), np.zeros((cuts, 2), dtype=np.int64)
    made, broken = _fill(scaled, at_s, nx, ny, dose, point, cut, link)
    return (
        dose[:made, 0], point[:made, 0], point[:made, 1], dose[:made, 1], cut[:broken], link[:broken, 0],
        link[:broken, 1],
    )  # fmt: skip


@compiled
def _flat(x: float, y: float, nx: int, ny: int) -> int:
    i, j = int(np.floor(x + 0.5)), int(np.floor(y + 0.5))
    return i * ny + j if 0 <= i < nx and 0 <= j < ny else -1


@compiled
def _stand(x: float, y: float, when_s: float, took_s: float, nx: int, ny: int, dose: Floats, point: Ints) -> None:
    """A torch that stands heats the four points around it, the nearer the more: a pierce has no sides yet."""
    i, j = int(np.floor(x)), int(np.floor(y))
    for di in range(2):
        for dj in range(2):
            share = (x - i if di else 1 - x + i) * (y - j if dj else 1 - y + j)
            dose[2 * di + dj, 0], dose[2 * di + dj, 1] = when_s, took_s * share
            point[2 * di + dj, 0] = _flat(float(i + di), float(j + dj), nx, ny)


@entry
def _fill(
    xy: Floats, at_s: Floats, nx: int, ny: int, dose: Floats, point: Ints, cut: Floats, link: Ints
) -> tuple[int, int]:
    """Fill in the doses and the cuts of one burn; `xy` in grid steps from the first point."""
    made, broken = 0, 0
    tx, ty = 1.0, 0.0
    for k in range(len(xy) - 1):
        x0, y0, x1, y1 = xy[k, 0], xy[k, 1], xy[k + 1, 0], xy[k + 1, 1]
        dx, dy, took = x1 - x0, y1 - y0, at_s[k + 1] - at_s[k]
        length = np.sqrt(dx * dx + dy * dy)
        if length > 0:
            tx, ty = dx / length, dy / length
        pieces = max(1, int(np.ceil(length / SPACING)))
        if took > 0 and length == 0:
            _stand(x0, y0, at_s[k] + 0.5 * took, took, nx, ny, dose[made : made + 4], point[made : made + 4])
            made += 4
        elif took > 0:
            for p in range(pieces):
                f = (p + 0.5) / pieces
                x, y = x0 + f * dx, y0 + f * dy
                dose[made, 0], dose[made, 1] = at_s[k] + f * took, took / pieces
                point[made, 0] = _flat(x - SIDE * ty, y + SIDE * tx, nx, ny)
                point[made, 1] = _flat(x + SIDE * ty, y - SIDE * tx, nx, ny)
                made += 1
        # Lines through the points, at whole numbers: a line is crossed if the ends lie on different sides of it.
        low, high = min(x0, x1), max(x0, x1)
        for i in range(max(0, int(np.floor(low)) + 1), min(nx - 1, int(np.floor(high))) + 1):
            if (x0 < i) != (x1 < i):
                f = (i - x0) / dx
                j = int(np.floor(y0 + f * dy))
                if 0 <= j < ny - 1:
                    cut[broken], link[broken, 0], link[broken, 1] = at_s[k] + f * took, i * ny + j, 1
                    broken += 1
        low, high = min(y0, y1), max(y0, y1)
        for j in range(max(0, int(np.floor(low)) + 1), min(ny - 1, int(np.floor(high))) + 1):
            if (y0 < j) != (y1 < j):
                f = (j - y0) / dy
                i = int(np.floor(x0 + f * dx))
                if 0 <= i < nx - 1:
                    cut[broken], link[broken, 0], link[broken, 1] = at_s[k] + f * took, i * ny + j, 0
                    broken += 1
    return made, broken


MOST_POINTS = 30_000_000
NO_PART = -1
SCRAP = -2
SHIFT_X, SHIFT_Y = 0.1373, 0.2179
"""The grid begins that many steps outside the sheet: drawings lie on round numbers, and no cut should run exactly
along a row of points, where the last digit decides on which side of it they are."""


@dataclass(frozen=True, eq=False, slots=True)
class Grid:
    """Points at the middle of squares `step_mm` wide; index (i, j) counts along x and y.

    `x0_mm`, `y0_mm` is the first point. `metal` says which points lie on the sheet. `part` is the index of the part a
    point lies in, `NO_PART` outside all of them, `SCRAP` in a hole, what falls out of a part.
    """

    x0_mm: float
    y0_mm: float
    step_mm: float
    metal: Bools
    part: Int32s

    @property
    def shape(self) -> tuple[int, int]:
        """Points along x and along y."""
        return self.metal.shape[0], self.metal.shape[1]

    def near(self, lines: Iterable[shapely.LineString], within_mm: float) -> Bools:
        """Which points lie within a distance of any of the lines."""
        found = np.zeros(self.shape, dtype=np.bool_)
        for line in lines:
            self._mark(found, line.buffer(within_mm), True)
        return found

    def _mark(self, array: Bools | Int32s, polygon: shapely.Geometry, value: bool | int) -> None:
        """Set `array` where points lie in the polygon; only those in its bounding box are looked at."""
        x0, y0, x1, y1 = polygon.bounds
        along_x, along_y = self._span(x0, x1, self.x0_mm), self._span(y0, y1, self.y0_mm)
        window = array[along_x, along_y]
        if not window.size:
            return
        x = self.x0_mm + self.step_mm * np.arange(along_x.start, along_x.start + window.shape[0])
        y = self.y0_mm + self.step_mm * np.arange(along_y.start, along_y.start + window.shape[1])
        shapely.prepare(polygon)
        window[shapely.contains_xy(polygon, x[:, None], y[None, :])] = value

    def _span(self, low_mm: float, high_mm: float, first_mm: float) -> slice:
        """The points from `low_mm` to `high_mm`, and perhaps one more at either end."""
        begin, end = (low_mm - first_mm) / self.step_mm, (high_mm - first_mm) / self.step_mm
        return slice(max(0, math.floor(begin)), max(0, math.ceil(end) + 1))


def make_grid(nest: Nest, step_mm: float) -> Grid:
    """The grid over a nest's sheet. Raises InputError if it would have more points than fit in memory."""
    x0, y0, x1, y1 = nest.sheet.bounds
    nx, ny = math.ceil((x1 - x0) / step_mm + SHIFT_X), math.ceil((y1 - y0) / step_mm + SHIFT_Y)
    if nx * ny > MOST_POINTS:
        least_mm = 1.06 * math.sqrt((x1 - x0) * (y1 - y0) / MOST_POINTS)
        raise InputError(
            f"heat.grid: {step_mm:g} mm makes {nx} x {ny} points of this sheet, more than fit in memory: give a wider "
            f"grid, {least_mm:.2g} mm or more"
        )
    shape = (nx, ny)
    metal = np.zeros(shape, dtype=np.bool_)
    part = np.full(shape, NO_PART, dtype=np.int32)
    grid = Grid(x0 + (0.5 - SHIFT_X) * step_mm, y0 + (0.5 - SHIFT_Y) * step_mm, step_mm, metal, part)
    grid._mark(metal, nest.sheet.polygon, True)
    for hole in (hole for p in nest.parts for hole in p.holes):
        grid._mark(part, hole.polygon, SCRAP)
    for k, p in enumerate(nest.parts):
        grid._mark(part, p.polygon, k)
    return grid


# What a simulation of heat found: peaks, points too hot, and for how long, in all and part by part.


@dataclass(frozen=True, eq=False, slots=True)
class HeatRun:
    """Maps (nx, ny) of the highest temperature, °C, and of the seconds above the limit; energies in J.

    `put_in` is what the torch left in the sheet, `lost` what the air took, `stored` what is in the sheet at the end.
    All three are 0 for a model that knows no energy.
    """

    peak_c: Float32s
    above_s: Float32s
    put_in_j: float = 0.0
    lost_j: float = 0.0
    stored_j: float = 0.0


@dataclass(frozen=True, slots=True)
class PartHeat:
    """One part, outside the kerf's band: its highest temperature, points too hot, the longest that one stayed so.

    `peak_c` is None for a part that lies in the band with all its points: nothing is known of it.
    """

    part: str
    peak_c: float | None
    overheats: int
    above_s: float


@dataclass(frozen=True, eq=False, slots=True)
class HeatResult:
    """What `simulate` answers.

    An overheat is a point of the grid on a part or on the skeleton, outside the kerf's band, that was hotter than the
    limit. `counted` says which points these may be; scrap in holes is none of them. `peak_c` is the highest temperature
    among them. `energy_error` is the share of the energy put in that is neither in the sheet nor in the air at the end,
    None for a model without energies.
    """

    model: HeatModel
    grid: Grid
    limit_c: float
    run: HeatRun
    counted: Bools
    overheats: int
    peak_c: float
    above_s: float
    parts: tuple[PartHeat, ...]
    energy_error: float | None


def made_result(model: HeatModel, nest: Nest, grid: Grid, heat: Heat, run: HeatRun, counted: Bools) -> HeatResult:
    """Count what a run has found, among the points that are counted."""
    hot = counted & (run.peak_c > heat.limit_c)
    put_in = run.put_in_j
    return HeatResult(
        model,
        grid,
        heat.limit_c,
        run,
        counted,
        int(hot.sum()),
        _highest(run.peak_c, counted, heat.ambient_c),
        _highest(run.above_s, counted, 0.0),
        _by_part(nest, grid, heat, run, counted, hot),
        None if model == "logical" else abs(put_in - run.lost_j - run.stored_j) / put_in if put_in else 0.0,
    )


def _by_part(nest: Nest, grid: Grid, heat: Heat, run: HeatRun, counted: Bools, hot: Bools) -> tuple[PartHeat, ...]:
    on_parts = counted & (grid.part >= 0)
    of = grid.part[on_parts]
    peak = np.full(len(nest.parts), heat.ambient_c, dtype=np.float32)
    longest = np.zeros(len(nest.parts), dtype=np.float32)
    np.maximum.at(peak, of, run.peak_c[on_parts])
    np.maximum.at(longest, of, run.above_s[on_parts])
    count = np.bincount(of[hot[on_parts]], minlength=len(nest.parts))
    seen = np.bincount(of, minlength=len(nest.parts)) > 0
    return tuple(
        PartHeat(part.id, float(peak[k]) if seen[k] else None, int(count[k]), float(longest[k]))
        for k, part in enumerate(nest.parts)
    )


def _highest(values: Float32s, counted: Bools, none: float) -> float:
    return float(values[counted].max()) if counted.any() else none


# The sheet by the contour that lies nearest: where an overheat is says whose order it has to do with.


def hot_contours(nest: Nest) -> Ints:
    """Numbers of the contours that heat the sheet: all but marks."""
    return np.array([k for k, contour in enumerate(nest.contours) if contour.kind != "mark"], dtype=np.int64)


class Regions:
    """Points of a grid by the nearest contour that is no mark.

    Parameters
    ----------
    nest
        Sheet and parts.
    grid
        That of `make_grid`.
    """

    def __init__(self, nest: Nest, grid: Grid) -> None:
        self._hot, self._n, self._grid = hot_contours(nest), len(nest.contours), grid
        self._tree = shapely.STRtree([nest.contours[k].line for k in self._hot])

    def count(self, found: HeatResult) -> Ints:
        """Overheats near each contour, (n,), by contour number."""
        grid = self._grid
        i, j = np.nonzero(found.counted & (found.run.peak_c > found.limit_c))
        if not len(i):
            return np.zeros(self._n, dtype=np.int64)
        points = shapely.points(grid.x0_mm + grid.step_mm * i, grid.y0_mm + grid.step_mm * j)
        return np.bincount(self._hot[self._tree.nearest(points)], minlength=self._n).astype(np.int64)
