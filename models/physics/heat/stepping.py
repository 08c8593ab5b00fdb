"""The kernel of the physical model: explicit steps of the heat equation over the points of a sheet."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Float32s

from .compiled import compiled, entry
from .events import Events

COLD_K = np.float32(1e-7)
"""What is warmer than the air by less is taken for as cold as the air."""


class Plate(NamedTuple):
    """Arrays of (nx + 2, ny + 2), a rim of no metal around them: what the kernel reads and writes.

    `link_x[i, j]` is 1 while heat passes from (i, j) to (i + 1, j), `link_y` the same along y. `now` and `following`
    change places every step, as do `warm` and `warm_next`, which say of each row whether any point of it is warm.
    `above` counts the steps above the limit. `energy` is what was put in and what the air took, J.
    """

    metal: Bools
    link_x: Float32s
    link_y: Float32s
    now: Float32s
    following: Float32s
    peak: Float32s
    above: NDArray[np.int32]
    warm: Bools
    warm_next: Bools
    energy: NDArray[np.float64]


class Law(NamedTuple):
    """Length of a step, s; power that stays in the sheet, W; what warms a point by a kelvin, J.

    `spread` is α Δt / Δx², `keep` the share of its excess that a point keeps in a step, the air taking the rest.
    """

    step_s: float
    power_w: float
    point_j_k: float
    spread: np.float32
    keep: np.float32
    limit_k: np.float32


def new_plate(metal: Bools) -> Plate:
    """A sheet as warm as the air, uncut."""
    whole = np.pad(metal, 1)

    def zeros() -> Float32s:
        return np.zeros(whole.shape, dtype=np.float32)

    def row() -> Bools:
        return np.zeros(len(whole), dtype=np.bool_)

    above = np.zeros(whole.shape, dtype=np.int32)
    plate = Plate(whole, zeros(), zeros(), zeros(), zeros(), zeros(), above, row(), row(), np.zeros(2))
    plate.link_x[:-1] = whole[:-1] & whole[1:]
    plate.link_y[:, :-1] = whole[:, :-1] & whole[:, 1:]
    return plate


def swapped(plate: Plate) -> Plate:
    """The plate with the temperatures of now and of the next step in each other's place."""
    return plate._replace(now=plate.following, following=plate.now, warm=plate.warm_next, warm_next=plate.warm)


@entry
def run_steps(plate: Plate, law: Law, events: Events, steps: int, begin_s: float) -> bool:
    """So many steps from a time on; True if the temperatures are in `following` afterwards."""
    nx, ny = plate.now.shape[0] - 2, plate.now.shape[1] - 2
    dose, cut = np.searchsorted(events.dose_s, begin_s), np.searchsorted(events.cut_s, begin_s)
    a, b, warm, warm_next = plate.now, plate.following, plate.warm, plate.warm_next
    spread, keep = law.spread, law.keep
    for step in range(steps):
        until_s = begin_s + (step + 1) * law.step_s
        # A step ahead of the torch, so that no heat passes the kerf between a dose and the cut beside it.
        while cut < len(events.cut_s) and events.cut_s[cut] < until_s + law.step_s:
            i, j = events.link[cut] // ny + 1, events.link[cut] % ny + 1
            if events.along_y[cut]:
                plate.link_y[i, j] = 0
            else:
                plate.link_x[i, j] = 0
            cut += 1
        while dose < len(events.dose_s) and events.dose_s[dose] < until_s:
            _put_in(plate, law, a, warm, events.left[dose], events.right[dose], events.seconds[dose])
            dose += 1
        total_k = 0.0
        for i in range(1, nx + 1):
            if not (warm[i - 1] or warm[i] or warm[i + 1]):
                if warm_next[i]:
                    b[i] = 0
                    warm_next[i] = False
                continue
            row_k, hottest = np.float32(0), np.float32(0)
            for j in range(1, ny + 1):
                t = a[i, j]
                t += spread * (
                    plate.link_x[i, j] * (a[i + 1, j] - t)
                    + plate.link_x[i - 1, j] * (a[i - 1, j] - t)
                    + plate.link_y[i, j] * (a[i, j + 1] - t)
                    + plate.link_y[i, j - 1] * (a[i, j - 1] - t)
                )
                row_k += t
                t = t * keep if t > COLD_K else np.float32(0)
                b[i, j] = t
                plate.peak[i, j] = max(plate.peak[i, j], t)
                hottest = max(hottest, t)
            total_k += float(row_k)
            warm_next[i] = hottest > 0
            if hottest > law.limit_k:
                for j in range(1, ny + 1):
                    plate.above[i, j] += b[i, j] > law.limit_k
        plate.energy[1] += total_k * (1.0 - keep) * law.point_j_k
        a, b = b, a
        warm, warm_next = warm_next, warm
    return steps % 2 == 1


@compiled
def _put_in(plate: Plate, law: Law, a: Float32s, warm: Bools, left: int, right: int, seconds: float) -> None:
    """Half of the energy to each side of the kerf, all to the one that is metal."""
    ny = a.shape[1] - 2
    left_i, left_j, right_i, right_j = left // ny + 1, left % ny + 1, right // ny + 1, right % ny + 1
    on_left = left >= 0 and plate.metal[left_i, left_j]
    on_right = right >= 0 and plate.metal[right_i, right_j]
    joules = law.power_w * seconds
    each = np.float32(joules / law.point_j_k * (0.5 if on_left and on_right else 1.0))
    if on_left:
        a[left_i, left_j] += each
        warm[left_i] = True
    if on_right:
        a[right_i, right_j] += each
        warm[right_i] = True
    if on_left or on_right:
        plate.energy[0] += joules
