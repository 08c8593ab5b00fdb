"""The controls whose programs the check reads, and how each switches its tools: written apart from the dialects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Control:
    """How a control spells its tools; tool 0 cuts, any other marks.

    `numbered` says that M3 and M5 name their tool by $; else there is only one, which cuts. `marks_by` is the digital
    output that M64 sets and M65 clears to mark, None where those words are not for that. `speed_outputs` says that M67
    and M68 with E3 change the speed.
    """

    title: str
    numbered: bool
    marks_by: int | None
    silent_m: frozenset[float]
    speed_outputs: bool


_COMMON_M = frozenset({0.0, 1.0, 7.0, 8.0, 9.0, 48.0, 49.0, 50.0, 51.0, 53.0})

CONTROLS: Mapping[str, Control] = {
    "linuxcnc-qtplasmac": Control(
        "LinuxCNC with QtPlasmaC", True, None, _COMMON_M | {52.0, 66.0, 67.0, 68.0, 190.0}, True
    ),
    "linuxcnc": Control("LinuxCNC", False, 0, _COMMON_M, False),
}
"""By the name that a dialect gives as its `control`."""
QTPLASMAC = CONTROLS["linuxcnc-qtplasmac"]
