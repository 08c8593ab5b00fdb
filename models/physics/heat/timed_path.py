"""Where the torch burns, and when, as what it does to the grid in order of time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.models.jit import inner, jit

from .grid import Grid

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

    Raises
    ------
    InputError
        If one of the first torch begins before the one before it has ended, by more than 10 ms.
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
