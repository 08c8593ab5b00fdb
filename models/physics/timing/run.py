"""What a clock is given: the torch-on paths of a program in order, and the idle moves between them."""

from __future__ import annotations

from dataclasses import dataclass

from kerfwise.encoder.geometry.curve import Curve


@dataclass(frozen=True, eq=False, slots=True)
class Run:
    """One open torch-on path from where the torch is switched on to where it goes off.

    The torch waits for `wait_s` before it is lit. `travels_mm` are the lengths of the idle moves that lead to it.
    `marks` says that it only marks; `pierced` is False where it comes in from the sheet edge. `moving_s` is how long it
    takes at feeds of its own, and `standing_s` how long the torch stands meanwhile, lit, as a program states them; None
    where the model of motion, or the machine's feeds, say so. Then it moves at `feed_share` of its feed. A `linked` one
    goes on from the run before it, with the torch on. `unlit_mm` of the path are over tabs, where the torch moves on at
    its feed and burns nothing.
    """

    path: Curve
    marks: bool = False
    pierced: bool = True
    travels_mm: tuple[float, ...] = ()
    wait_s: float = 0.0
    moving_s: float | None = None
    standing_s: float | None = None
    feed_share: float = 1.0
    linked: bool = False
    unlit_mm: float = 0.0


@dataclass(frozen=True, eq=False, slots=True)
class Job:
    """The runs of a program, its last idle moves, and how many NC blocks it has."""

    runs: tuple[Run, ...]
    homing_mm: tuple[float, ...]
    nc_blocks: int

    @property
    def pierces(self) -> int:
        """Runs that pierce the sheet."""
        return sum(run.pierced and not run.marks and not run.linked for run in self.runs)

    @property
    def on_mm(self) -> float:
        """L_on: length with the torch, or the marking tool, on, mm."""
        return sum(run.path.length_mm - run.unlit_mm for run in self.runs)

    @property
    def idle_mm(self) -> float:
        """L_off: length of all idle moves, mm."""
        return sum(mm for run in self.runs for mm in run.travels_mm) + sum(self.homing_mm)
