"""The controls whose programs the check reads, and how each switches its tools: written apart from the dialects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Control:
    """How a control spells its tools; tool 0 cuts, any other marks.

    `numbered` says that M3 and M5 name their tool by $; else there is only one, which cuts. `marks_by` is the digital
    output that M64 sets and M65 clears to mark, None where those words are not for that. `known_m` are the M words that
    it reads, `refused_m` say of others why not. `speed_output` is the E of the M67 and M68 that change the speed.
    `filtered` says that QtPlasmaC's filter rewrites a program before it is run.
    """

    title: str
    numbered: bool
    marks_by: int | None
    known_m: frozenset[float]
    speed_output: float | None
    filtered: bool
    refused_m: Mapping[float, str] = field(default_factory=dict)


_COMMON_M = frozenset({0.0, 1.0, 2.0, 3.0, 5.0, 7.0, 8.0, 9.0, 30.0, 48.0, 49.0, 50.0, 51.0, 53.0})
_MATERIAL = "it selects another material on the machine than the profile's; select it by hand and post without"
_WAITS = "how long it waits for the machine is not known; post the program without"
_MID_CUT = "it can stop the torch while the path goes on; post the program without"

CONTROLS: Mapping[str, Control] = {
    "linuxcnc-qtplasmac": Control(
        "LinuxCNC with QtPlasmaC",
        numbered=True,
        marks_by=None,
        known_m=_COMMON_M | {52.0, 67.0, 68.0},
        speed_output=3.0,
        filtered=True,
        refused_m={190.0: _MATERIAL, 66.0: _WAITS} | dict.fromkeys((62.0, 63.0, 64.0, 65.0), _MID_CUT),
    ),
    "linuxcnc": Control(
        "LinuxCNC",
        numbered=False,
        marks_by=0,
        known_m=_COMMON_M | {64.0, 65.0},
        speed_output=None,
        filtered=False,
        refused_m={66.0: _WAITS} | dict.fromkeys((62.0, 63.0), _MID_CUT),
    ),
}
"""By the name that a dialect gives as its `control`."""
QTPLASMAC = CONTROLS["linuxcnc-qtplasmac"]
