"""What a plan says of its time: the model, the blocks counted, and what the seconds are spent on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .clock import RunTimes
from .motion import Motion


@dataclass(frozen=True, slots=True)
class TimeReport:
    """Seconds that a program cuts (and marks), moves idle, pierces, and waits for metal to cool, by the model named.

    `nc_blocks` is the number n of blocks of the program, comments left out.

    Examples
    --------
    >>> TimeReport("constant feed", 40, 90.0, 9.0, 1.0).idle_share
    0.09
    """

    model: str
    nc_blocks: int
    cut_s: float
    idle_s: float
    pierce_s: float
    dwell_s: float = 0.0

    @property
    def total_s(self) -> float:
        """The whole program, s."""
        return self.cut_s + self.idle_s + self.pierce_s + self.dwell_s

    @property
    def idle_share(self) -> float:
        """Idle travel's share of the total, 0…1."""
        return self.idle_s / self.total_s if self.total_s > 0 else 0.0

    def as_json(self) -> dict[str, Any]:
        """The report as `kerfwise time --json` prints it."""
        return {
            "cut_s": round(self.cut_s, 3),
            "idle_s": round(self.idle_s, 3),
            "pierce_s": round(self.pierce_s, 3),
            "total_s": round(self.total_s, 3),
            "idle_share": round(self.idle_share, 6),
            "nc_blocks": self.nc_blocks,
            **({"dwell_s": round(self.dwell_s, 3)} if self.dwell_s else {}),
            "model": self.model,
        }


def report_times(times: RunTimes, motion: Motion, nc_blocks: int) -> TimeReport:
    """What is said of these times."""
    return TimeReport(motion.words, nc_blocks, times.cut_s, times.idle_s, times.pierce_s, times.dwell_s)
