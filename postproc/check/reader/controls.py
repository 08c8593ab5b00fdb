"""The controls whose programs the check reads, and how each spells them: written apart from the dialects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from .rows import LONGEST

_LINUXCNC_G = frozenset(
    {0.0, 1.0, 2.0, 3.0, 4.0, 17.0, 20.0, 21.0, 40.0, 49.0, 54.0, 61.0, 61.1, 64.0, 80.0, 90.0, 90.1, 91.0, 91.1, 92.1}
    | {94.0, 97.0}
)


@dataclass(frozen=True, slots=True)
class Control:
    """How a control spells a program; tool 0 cuts, any other marks.

    `known_g` and `known_m` are the words that it reads, `refused_m` say of others why not. `numbered` says that M3 and
    M5 name their tool by $; else there is only one, which cuts. `marks_by` is the digital output that M64 sets and M65
    clears to mark, None where those words are not for that. `starts` and `stops` are M words that switch a tool of
    their own. `speed_output` is the E of the M67 and M68 that change the speed. `filtered` says that QtPlasmaC's filter
    rewrites a program before it is run.

    `beam` says that it is a laser of GRBL, lit by M3 and M4 with a power S in moves at a feed only; up to the power
    `marks_up_to` it marks, `full_power` is 100 %. `dwell` is the letter of the seconds of G4. `bare` says that X and Y
    without a motion word are a line with the torch on, and travel with it off. `fixed` are G words in force always,
    which nobody has to say. `program` is the letter of the number that a program begins with. `longest` is the greatest
    number of bytes of a line, `longest_code` that without blanks and comments. `obeyed` are characters that it obeys
    wherever they stand, and with which none beyond ASCII may stand either.

    `selects` and `deselects` are the M words, with the letter of the torch's number and what that is less, by which
    further torches burn with the first one, where there are any.

    `process` is the M word that selects by T what `starts` and `stops` switch; the processes `marking` mark.

    `arcs` says that programs are ESSI (ISO 6582), blocks of signed numbers without letters, and how arcs are told
    there, by centre or by radius. `step_mm` is what 1 means there; feeds are whole, in steps of `feed_step_mm_min`.
    """

    title: str
    known_m: frozenset[float]
    known_g: frozenset[float] = _LINUXCNC_G
    refused_m: Mapping[float, str] = field(default_factory=dict)
    numbered: bool = False
    marks_by: int | None = None
    starts: Mapping[float, int] = field(default_factory=dict)
    stops: Mapping[float, int] = field(default_factory=dict)
    speed_output: float | None = None
    filtered: bool = False
    beam: bool = False
    marks_up_to: float = 0.0
    full_power: float = 0.0
    dwell: str = "P"
    bare: bool = False
    centre_absolute: bool = False
    fixed: frozenset[float] = frozenset()
    comments: bool = True
    program: str = ""
    longest: int = LONGEST
    longest_code: int = LONGEST
    obeyed: str = ""
    selects: float | None = None
    deselects: float | None = None
    torch_letter: str = "T"
    torch_less: int = 0
    process: float | None = None
    marking: frozenset[float] = frozenset()
    arcs: Literal["", "centre", "radius"] = ""
    step_mm: float = 0.0
    feed_step_mm_min: float = 0.0


_COMMON_M = frozenset({0.0, 1.0, 2.0, 3.0, 5.0, 7.0, 8.0, 9.0, 30.0, 48.0, 49.0, 50.0, 51.0, 53.0})
_MATERIAL = "it selects another material on the machine than the profile's; select it by hand and post without"
_WAITS = "how long it waits for the machine is not known; post the program without"
_MID_CUT = "it can stop the torch while the path goes on; post the program without"
_LOADS = "it loads another program on the control, which is not checked; post the program with M02 at its end"


def _essi(title: str, arcs: Literal["centre", "radius"]) -> Control:
    none: frozenset[float] = frozenset()
    return Control(title, known_m=none, known_g=none, comments=False, arcs=arcs, step_mm=0.1, feed_step_mm_min=1.0)


CONTROLS: Mapping[str, Control] = {
    "linuxcnc-qtplasmac": Control(
        "LinuxCNC with QtPlasmaC",
        numbered=True,
        known_m=_COMMON_M | {52.0, 67.0, 68.0},
        speed_output=3.0,
        filtered=True,
        refused_m={190.0: _MATERIAL, 66.0: _WAITS} | dict.fromkeys((62.0, 63.0, 64.0, 65.0), _MID_CUT),
    ),
    "linuxcnc": Control(
        "LinuxCNC",
        marks_by=0,
        selects=64.0,
        deselects=65.0,
        torch_letter="P",
        torch_less=1,
        known_m=_COMMON_M | {64.0, 65.0},
        refused_m={66.0: _WAITS} | dict.fromkeys((62.0, 63.0), _MID_CUT),
    ),
    "grbl": Control(
        "GRBL in laser mode",
        known_g=_LINUXCNC_G - {61.1, 64.0, 90.1, 97.0},
        known_m=frozenset({0.0, 2.0, 3.0, 4.0, 5.0, 8.0, 9.0, 30.0}),
        fixed=frozenset({61.0, 91.1}),
        beam=True,
        marks_up_to=400.0,
        full_power=1000.0,
        longest=127,
        longest_code=79,
        obeyed="!?~",
    ),
    "eia": Control(
        "Hypertherm EDGE with Phoenix",
        known_g=frozenset({0.0, 1.0, 2.0, 3.0, 4.0, 20.0, 21.0, 40.0, 90.0, 91.0}),
        known_m=frozenset({0.0, 1.0, 2.0, 7.0, 8.0, 9.0, 10.0, 15.0, 16.0, 30.0, 36.0, 37.0, 38.0, 50.0, 51.0}),
        selects=37.0,
        deselects=38.0,
        process=36.0,
        marking=frozenset({3.0, 4.0}),
        refused_m={65.0: _LOADS},
        starts={7.0: 0, 15.0: 0, 9.0: 1},
        stops={8.0: 0, 16.0: 0, 10.0: 1},
        dwell="X",
    ),
    "burny": Control(
        "Burny",
        known_g=frozenset({2.0, 3.0, 4.0, 40.0, 70.0, 71.0, 90.0}),
        known_m=frozenset({0.0, 1.0, 3.0, 4.0, 14.0, 15.0, 30.0}),
        starts={4.0: 0},
        stops={3.0: 0},
        dwell="F",
        bare=True,
        centre_absolute=True,
        comments=False,
        program="P",
    ),
    "essi": _essi("ESSI, arcs by their centre", "centre"),
    "essi-radius": _essi("ESSI, arcs by their radius", "radius"),
}
"""By the name that a dialect gives as its `control`."""
QTPLASMAC = CONTROLS["linuxcnc-qtplasmac"]
