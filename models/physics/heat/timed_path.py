"""Where the torch burns, and when: all that a simulation of heat needs to know of a program."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.encoder.errors import InputError


@dataclass(frozen=True, eq=False, slots=True)
class TorchOn:
    """One stretch with the torch on.

    `contour` is the id of what is cut ("" if unknown), `xy` (k, 2) the points of the path, mm, `at_s` (k,) when the
    torch is there, s from the program's start, never falling. Two points in one place are a torch that stands, as it
    does to pierce. Between points it moves evenly.
    """

    contour: str
    xy: Floats
    at_s: Floats

    @property
    def seconds(self) -> float:
        """How long the torch is on."""
        return float(self.at_s[-1] - self.at_s[0]) if len(self.at_s) else 0.0


@dataclass(frozen=True, eq=False, slots=True)
class TimedPath:
    """The torch-on stretches of a program in order, marks left out, and when the program ends, s."""

    burns: tuple[TorchOn, ...]
    end_s: float

    @property
    def seconds_on(self) -> float:
        """How long the torch is on altogether."""
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

    It runs evenly, or where `slowness` (k - 1,) is given takes so many times longer for each of its steps.

    Raises
    ------
    InputError
        If it ends before it begins.

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


def without(burn: TorchOn, unlit_mm: Sequence[tuple[float, float]]) -> tuple[TorchOn, ...]:
    """The stretch without those parts of its way, mm from its start, that the torch makes unlit, over tabs.

    Examples
    --------
    >>> burn = torch_on("P.outer", np.array([[0.0, 0.0], [10.0, 0.0]]), 0.0, 10.0)
    >>> [lit.xy[:, 0].tolist() for lit in without(burn, [(4.0, 6.0)])]
    [[0.0, 0.0, 4.0], [6.0, 10.0]]
    """
    if not unlit_mm:
        return (burn,)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(burn.xy, axis=0).T))])
    ends = [0.0, *(mm for stretch in unlit_mm for mm in stretch), float(along[-1])]
    table = np.column_stack([burn.xy, burn.at_s])
    made = []
    for number, (low, high) in enumerate(zip(ends[::2], ends[1::2], strict=True)):
        first = int(np.searchsorted(along, low, side="right")) if number else 0
        last = int(np.searchsorted(along, high, side="left"))
        begin, end = np.column_stack([np.interp([low, high], along, column) for column in table.T])
        rows = np.vstack([*([begin] if number else []), table[first:last], end])
        made.append(TorchOn(burn.contour, rows[:, :2], rows[:, 2]))
    return tuple(made)


def in_order(burns: Sequence[TorchOn], end_s: float) -> TimedPath:
    """The path of these stretches.

    Raises
    ------
    InputError
        If one begins before the one before it has ended, by more than 10 ms.
    """
    for before, after in pairwise(burns):
        if after.at_s[0] < before.at_s[-1] - 0.01:
            raise InputError(
                f"{after.contour} begins at {after.at_s[0]:.2f} s, before {before.contour} ends at "
                f"{before.at_s[-1]:.2f} s: times must follow each other for heat to be simulated"
            )
    return TimedPath(tuple(burns), max([end_s, *(float(b.at_s[-1]) for b in burns)]))
