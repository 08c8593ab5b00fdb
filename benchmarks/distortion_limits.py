"""Where errors of parts come from, and how small any plan could make them: made nests, taken apart.

Usage: python -m kerfwise.benchmarks.distortion_limits [--process oxyfuel|plasma|laser] [--first SEED] [--seeds N]

For each nest the plan of the shipped profile is simulated on a coarse mesh, and then

- *bands alone*: only how the yielded bands bend each part when all is cold, which no order changes;
- *no yielding*: the same plan, all metal elastic;
- *but for scale*: the plan's error without what a uniform scale of each part would take away: a part that is cut while
  the sheet is warm all over is too small when cold, by one share in all directions;
- *waits*: the same plan with 15 % more time, spent evenly between the cuts; and with an hour between any two cuts;
- *bridges*: every outer contour stops short of a bridge of 15 mm in its middle; all bridges are cut at the end;
- *alone*: each part is the only one cut, on a cold sheet, entered as planned; and then by the best of its entries and
  ways round, whether the rules allow it there or not.

The mean over the parts of the worst place of each, mm. The last column is what is left of the plan's error: less than
that no order, no entry and no wait can be expected to reach, except by chance where errors of neighbours cancel.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from kerfwise.apps.distortion.cutting import Moved, cell_mm, cut_sheet
from kerfwise.apps.distortion.part_errors import PartError, errors_of
from kerfwise.benchmarks.distortion_plans import Planned, planned
from kerfwise.benchmarks.distortion_rules import PROCESSES
from kerfwise.encoder.nest import Nest, Part
from kerfwise.models.physics.heat import TimedPath
from kerfwise.models.physics.heat.timed_path import TorchOn, in_order, without_tabs

WAIT_SHARE, LONG_WAIT_S = 0.15, 3600.0
BRIDGE_MM, PIERCE_S = 15.0, 10.0
CELLS = 800
COLUMNS = (
    "process", "seed", "plan", "bands alone", "no yielding", "but for scale", "waits of 15 %", "an hour between cuts",
    "bridges last", "alone, as planned", "alone, the best way", "of the plan",
)  # fmt: skip


def waiting(path: TimedPath, wait_s: float) -> TimedPath:
    """The same with a wait before each burn but the first."""
    burns = [replace(burn, at_s=burn.at_s + k * wait_s) for k, burn in enumerate(path.burns)]
    return in_order(burns, path.end_s + wait_s * max(0, len(burns) - 1))


def bridged(path: TimedPath, nest: Nest) -> TimedPath:
    """Every outer contour but for a bridge in its middle; the bridges at the end, in the same order."""
    burns: list[TorchOn] = []
    bridges: list[TorchOn] = []
    for burn in path.burns:
        length = float(np.hypot(*np.diff(burn.xy, axis=0).T).sum())
        if nest.contour(burn.contour).kind != "outer" or length < 4 * BRIDGE_MM:
            burns.append(burn)
            continue
        low, high = (length - BRIDGE_MM) / 2, (length + BRIDGE_MM) / 2
        burns += without_tabs(burn, [(low, high)])
        bridges += without_tabs(burn, [(0.0, low), (high, length)])[1:2]
    now_s = path.end_s
    for bridge in bridges:
        begin_s = now_s + PIERCE_S
        burns.append(replace(bridge, at_s=bridge.at_s - bridge.at_s[0] + begin_s))
        now_s = float(burns[-1].at_s[-1])
    return in_order(burns, now_s)


def worst_of(errors: tuple[PartError, ...]) -> float:
    """The mean of the worst places, mm."""
    return float(np.mean([e.max_mm for e in errors if e.max_mm is not None]))


class Nested:
    """One nest with its plan, and simulations of it."""

    def __init__(self, given: Planned) -> None:
        self.nest, self.path, self._given = given.nest, given.path, given

    def moved(self, path: TimedPath, yields: bool = True) -> Moved:
        """A path, simulated on `CELLS` cells."""
        how = replace(self._given.orders.how, grid_mm=cell_mm(self.nest, CELLS), yields=yields)
        return cut_sheet(self.nest, path, self._given.profile.heat, how)

    def mean(self, path: TimedPath, yields: bool = True) -> float:
        """Its error, mm."""
        return worst_of(errors_of(self.nest, self.moved(path, yields)))

    def bands_alone(self) -> float:
        """What no order changes, mm."""
        moved = self.moved(self.path)
        return worst_of(errors_of(self.nest, replace(moved, off=moved.cold)))

    def but_for_scale(self) -> float:
        """The plan's error with each part scaled as is best for it, mm."""
        left = []
        for error in errors_of(self.nest, self.moved(self.path)):
            if error.max_mm is not None:
                arm = error.xy - error.xy.mean(axis=0)
                off = error.off - (error.off * arm).sum() / (arm * arm).sum() * arm
                left.append(float(np.hypot(*off.T).max()))
        return float(np.mean(left))

    def alone(self, part: Part, burns: Sequence[TorchOn]) -> float:
        """A part cut as the only one, mm."""
        errors = errors_of(self.nest, self.moved(in_order(burns, float(burns[-1].at_s[-1]))))
        return next(e.max_mm or 0.0 for e in errors if e.part == part.id)

    def each_alone(self) -> Iterator[tuple[float, float]]:
        """Of each part: its error alone as planned, and by the best way, mm."""
        for part in self.nest.parts:
            mine = [burn for burn in self.path.burns if self.nest.contour(burn.contour).part == part.id]
            if not mine or mine[-1].contour != part.outer.id:
                continue
            inner = [burn for burn in mine if burn.contour != part.outer.id]
            begin_s = float(inner[-1].at_s[-1]) + 5.0 if inner else 0.0
            ways = self._given.orders.ways(self.nest.index[part.outer.id], begin_s)
            as_planned = self.alone(part, mine)
            yield as_planned, min([as_planned, *(self.alone(part, [*inner, *way]) for way in ways)])

    def row(self) -> Iterator[float]:
        """The figures of the table, mm."""
        yield (plan := self.mean(self.path))
        yield self.bands_alone()
        yield self.mean(self.path, yields=False)
        yield self.but_for_scale()
        gaps = max(1, len(self.path.burns) - 1)
        yield self.mean(waiting(self.path, WAIT_SHARE * self.path.end_s / gaps))
        yield self.mean(waiting(self.path, LONG_WAIT_S))
        yield self.mean(bridged(self.path, self.nest))
        alone, best = np.array(list(self.each_alone())).mean(axis=0).tolist()
        yield from (alone, best, best / plan)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--process", choices=list(PROCESSES), action="append")
    parser.add_argument("--first", type=int, default=101)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--work", type=float, default=1.0)
    given = parser.parse_args()
    print("| " + " | ".join(COLUMNS) + " |")
    print("|---|" + "---:|" * (len(COLUMNS) - 1))
    for process in given.process or PROCESSES:
        for seed in range(given.first, given.first + given.seeds):
            *mm, share = Nested(planned(seed, process, given.work)).row()
            print(f"| {process} | {seed} | " + " | ".join(f"{v:.3f}" for v in mm) + f" | {share:.0%} |", flush=True)


if __name__ == "__main__":
    main()
